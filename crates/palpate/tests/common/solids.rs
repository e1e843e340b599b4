//! Random problems in space whose answer is known.

#![allow(dead_code, reason = "each file uses its own part")]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use fastrand::Rng;
use glam::{DMat3, DVec3, dvec3};
use palpate::space::{Model, Pose};
use palpate::{Contact, Evidence, Feature, Normal};

use crate::common::{Noise, noise, uniform};

/// A part, contacts on it, and the truth.
pub struct Problem {
    pub model: Arc<Model>,
    pub evidence: Evidence<DVec3>,
    pub world_from_model: Pose,
    pub assignment: Vec<Feature>,
}

/// Evenly on the sphere.
pub fn direction(random: &mut Rng) -> DVec3 {
    let (z, turn) = (uniform(random, -1.0, 1.0), uniform(random, 0.0, TAU));
    let radius = (1.0 - z * z).sqrt();
    dvec3(radius * turn.cos(), radius * turn.sin(), z)
}

/// A box, an angle or channel section, a prism over a convex outline or a hull of points, 150 to 250 across.
pub fn solid(random: &mut Rng) -> Arc<Model> {
    let (points, triangles) = match random.u8(0..5) {
        0 => {
            let [a, b] = [0, 1].map(|_| uniform(random, 0.2, 1.0));
            let outline = [(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)];
            prism(&outline, &[vec![0, 1, 2, 3]], uniform(random, 0.2, 1.0))
        }
        1 => {
            let [a, b] = [0, 1].map(|_| uniform(random, 0.5, 1.0));
            let t = uniform(random, 0.1, 0.3);
            let outline = [(0.0, 0.0), (a, 0.0), (a, t), (t, t), (t, b), (0.0, b)];
            prism(&outline, &[vec![0, 1, 2, 3], vec![0, 3, 4, 5]], uniform(random, 0.2, 1.0))
        }
        2 => {
            let [a, b, c] = [0, 1, 2].map(|_| uniform(random, 0.5, 1.0));
            let [t, s] = [0, 1].map(|_| uniform(random, 0.1, 0.2));
            let outline = [(0.0, 0.0), (a, 0.0), (a, b), (a - t, b), (a - t, s), (t, s), (t, c), (0.0, c)];
            let pieces = [vec![0, 1, 4, 5], vec![1, 2, 3, 4], vec![0, 5, 6, 7]];
            prism(&outline, &pieces, uniform(random, 0.2, 1.0))
        }
        3 => {
            let count = random.u32(3..8);
            let (a, b) = (uniform(random, 0.3, 1.0), uniform(random, 0.3, 1.0));
            let turn = |k: u32, share: f64| TAU * (f64::from(k) + 0.6 * share) / f64::from(count);
            let corner = |k: u32| turn(k, random.f64()).sin_cos();
            let outline: Vec<(f64, f64)> =
                (0..count).map(corner).map(|(sine, cosine)| (a * cosine, b * sine)).collect();
            prism(&outline, &[(0..count).collect()], uniform(random, 0.2, 1.0))
        }
        _ => {
            let stretch = dvec3(uniform(random, 0.3, 1.0), uniform(random, 0.3, 1.0), 1.0);
            let count = random.usize(4..11);
            hull((0..count).map(|_| stretch * direction(random)).collect())
        }
    };
    let apart = |a: &DVec3| points.iter().map(|b| a.distance(*b)).fold(0.0, f64::max);
    let size = points.iter().map(apart).fold(0.0, f64::max);
    let scale = uniform(random, 150.0, 250.0) / size;
    let points: Vec<DVec3> = points.iter().map(|point| scale * *point).collect();
    Arc::new(Model::mesh("solid", &points, &triangles, &[], 0.0, 0.0).expect("a clean solid"))
}

/// Vertices and triangles.
type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

/// Between an outline, counter-clockwise, at height 0 and the same at `height`; `pieces` are convex and make it up.
fn prism(outline: &[(f64, f64)], pieces: &[Vec<u32>], height: f64) -> Shape {
    let count = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |(x, y)| dvec3(*x, *y, z));
    let fans = pieces.iter().flat_map(|piece| (2..piece.len()).map(|k| [piece[0], piece[k - 1], piece[k]]));
    let mut triangles: Vec<[u32; 3]> =
        fans.flat_map(|[a, b, c]| [[a, c, b], [a + count, b + count, c + count]]).collect();
    for k in 0..count {
        let next = (k + 1) % count;
        triangles.extend([[k, next, count + next], [k, count + next, count + k]]);
    }
    (level(0.0).chain(level(height)).collect(), triangles)
}

/// The hull of points on a stretched sphere: all are its corners.
fn hull(points: Vec<DVec3>) -> Shape {
    let count = points.len();
    let mut triangles = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                let others = (0..count).filter(|k| ![a, b, c].contains(k));
                let heights: Vec<f64> = others.map(|k| normal.dot(points[k] - points[a])).collect();
                if heights.iter().all(|height| *height < 0.0) {
                    triangles.push([a as u32, b as u32, c as u32]);
                } else if heights.iter().all(|height| *height > 0.0) {
                    triangles.push([a as u32, c as u32, b as u32]);
                }
            }
        }
    }
    (points, triangles)
}

/// Any rotation, and a place within 300 of the origin.
pub fn pose(random: &mut Rng) -> Pose {
    let turn = uniform(random, 0.0, PI) * direction(random);
    Pose::new(turn, uniform(random, 0.0, 300.0) * direction(random))
}

/// Contacts with normals on random faces, weighted by area; one in eight on a corner of a triangle.
pub fn contacts(random: &mut Rng, model: Arc<Model>, count: usize, bounds: &Noise) -> Problem {
    let world_from_model = pose(random);
    let mut problem =
        Problem { model, evidence: Evidence::default(), world_from_model, assignment: Vec::new() };
    let normal_error = bounds.normal_error.expect("contacts with normals");
    for _ in 0..count {
        let (point, number) = touch(random, &problem.model);
        let normal = world_from_model.rotation * problem.model.faces[number as usize].normal;
        let shift = bounds.position_error * noise(random).abs() * (1.0 - 1e-12) * direction(random);
        let center = world_from_model.apply(point) + bounds.tip_radius * normal + shift;
        let turn = normal_error * noise(random) * (1.0 - 1e-12);
        let axis = normal.cross(direction(random)).normalize_or(normal.any_orthonormal_vector());
        let sensed = DMat3::from_axis_angle(axis, turn) * normal;
        let contact = Contact::new(center, bounds.tip_radius, bounds.position_error)
            .expect("bounds are valid")
            .with_normal(Normal::new(sensed, normal_error).expect("the bound is valid"));
        problem.evidence.contacts.push(contact);
        problem.assignment.push(Feature::Face(number));
    }
    problem
}

/// A point of a face, and the face.
fn touch(random: &mut Rng, model: &Model) -> (DVec3, u32) {
    let corners = |triangle: &[u32; 3]| triangle.map(|k| model.vertices[k as usize].point);
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = corners(triangle);
        (b - a).cross(c - a).length()
    };
    let total: f64 = model.triangles.iter().map(|(triangle, _)| area(triangle)).sum();
    let mut at = random.f64() * total;
    let mut number = 0;
    while number + 1 < model.triangles.len() && at > area(&model.triangles[number].0) {
        at -= area(&model.triangles[number].0);
        number += 1;
    }
    let (triangle, face) = &model.triangles[number];
    let [a, b, c] = corners(triangle);
    let (mut s, mut t) = if random.u8(0..8) == 0 { (0.0, 0.0) } else { (random.f64(), random.f64()) };
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    (a + s * (b - a) + t * (c - a), *face)
}
