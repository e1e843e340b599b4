//! Random problems whose answer is known.

#![allow(dead_code, reason = "each test file uses its own part")]

use std::sync::Arc;

use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::plane::{Model, Pose};
use palpate::{Contact, Evidence, Feature, Normal};

/// A part, contacts on it, and the truth.
pub struct Problem {
    pub model: Arc<Model>,
    pub evidence: Evidence,
    pub world_from_model: Pose,
    pub assignment: Vec<Feature>,
}

pub fn uniform(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

/// A star-shaped polygon of `num_vertices` corners, some 100 to 160 across.
pub fn star(random: &mut Rng, num_vertices: usize) -> Arc<Model> {
    loop {
        let corners: Vec<DVec2> = (0..num_vertices)
            .map(|k| {
                let angle = std::f64::consts::TAU * (k as f64 + 0.6 * random.f64()) / num_vertices as f64;
                uniform(random, 25.0, 80.0) * DVec2::from_angle(angle)
            })
            .collect();
        if let Ok(model) = Model::polygon("star", &corners, &[], &[], 0.0, 0.0) {
            return Arc::new(model);
        }
    }
}

/// A comb: many parallel faces.
pub fn comb(random: &mut Rng, num_teeth: usize) -> Arc<Model> {
    let (pitch, depth) = (uniform(random, 8.0, 20.0), uniform(random, 10.0, 40.0));
    let mut corners = vec![dvec2(0.0, 0.0), dvec2(pitch * num_teeth as f64, 0.0)];
    for tooth in (0..num_teeth).rev() {
        let (left, right) = (pitch * tooth as f64, pitch * (tooth as f64 + 0.5));
        corners.extend([
            dvec2(right + 0.5 * pitch, 20.0),
            dvec2(right, 20.0),
            dvec2(right, 20.0 + depth),
            dvec2(left, 20.0 + depth),
        ]);
    }
    corners.push(dvec2(0.0, 20.0));
    Arc::new(Model::polygon("comb", &corners, &[], &[], 0.0, 0.0).expect("a comb is a polygon"))
}

pub fn regular(num_vertices: usize, radius: f64) -> Arc<Model> {
    let corner = |k| radius * DVec2::from_angle(std::f64::consts::TAU * k as f64 / num_vertices as f64);
    let corners: Vec<DVec2> = (0..num_vertices).map(corner).collect();
    Arc::new(Model::polygon("regular", &corners, &[], &[], 0.0, 0.0).expect("regular polygon"))
}

pub fn pose(random: &mut Rng) -> Pose {
    let translation = dvec2(uniform(random, -300.0, 300.0), uniform(random, -300.0, 300.0));
    Pose::new(uniform(random, -std::f64::consts::PI, std::f64::consts::PI), translation)
}

/// Noise in `[-1, 1]`, a third of it at the bounds.
pub fn noise(random: &mut Rng) -> f64 {
    match random.u8(0..6) {
        0 => 1.0,
        1 => -1.0,
        _ => uniform(random, -1.0, 1.0),
    }
}

pub struct Noise {
    pub position_error: f64,
    pub normal_error: Option<f64>,
    pub tip_radius: f64,
}

/// Contacts on random faces (weighted by length) and, for tips, convex vertices.
pub fn contacts(random: &mut Rng, model: Arc<Model>, count: usize, noise_bounds: &Noise) -> Problem {
    let world_from_model = pose(random);
    let mut problem =
        Problem { model, evidence: Evidence::default(), world_from_model, assignment: Vec::new() };
    for _ in 0..count {
        let (point, normal, feature) = touch(random, &problem.model, noise_bounds.tip_radius > 0.0);
        let center_model = point + noise_bounds.tip_radius * normal;
        let shift =
            noise_bounds.position_error * noise(random).abs() * DVec2::from_angle(uniform(random, 0.0, 7.0));
        let center = world_from_model.apply(center_model) + shift * (1.0 - 1e-12);
        let mut contact = Contact::new(center, noise_bounds.tip_radius, noise_bounds.position_error)
            .expect("bounds are valid");
        if let Some(error) = noise_bounds.normal_error {
            let turn = DVec2::from_angle(error * noise(random) * (1.0 - 1e-12));
            let sensed = turn.rotate(world_from_model.rotation.rotate(normal));
            contact = contact.with_normal(Normal::new(sensed, error).expect("the bound is valid"));
        }
        problem.evidence.contacts.push(contact);
        problem.assignment.push(feature);
    }
    problem
}

fn touch(random: &mut Rng, model: &Model, vertices: bool) -> (DVec2, DVec2, Feature) {
    if vertices && random.u8(0..4) == 0 {
        let convex: Vec<usize> =
            (0..model.vertices.len()).filter(|k| model.vertices[*k].normals.is_some()).collect();
        let number = convex[random.usize(0..convex.len())];
        let vertex = &model.vertices[number];
        let cone = vertex.normals.expect("convex");
        let normal = DVec2::from_angle(cone.start + cone.width * random.f64());
        return (vertex.point, normal, Feature::Vertex(number as u32));
    }
    let total: f64 = model.faces.iter().map(palpate::plane::Face::length).sum();
    let mut at = random.f64() * total;
    let mut number = 0;
    while number + 1 < model.faces.len() && at > model.faces[number].length() {
        at -= model.faces[number].length();
        number += 1;
    }
    let face = &model.faces[number];
    let t = if random.u8(0..8) == 0 { random.u8(0..2).into() } else { random.f64() };
    (face.start.lerp(face.end, t), face.normal, Feature::Face(number as u32))
}
