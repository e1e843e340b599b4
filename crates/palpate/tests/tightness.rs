//! How tight rotation bounds and excursions are, against dense sampling of the true set.

mod common;
#[path = "common/parts.rs"]
mod parts;

use common::{Noise, Problem, contacts, star, uniform};
use fastrand::Rng;
use glam::DVec2;
use palpate::plane::Pose;
use palpate::{Feature, Settings, recognize};

/// The part of a convex polygon with `normal·p <= offset`.
fn clip(polygon: &[DVec2], normal: DVec2, offset: f64) -> Vec<DVec2> {
    let mut kept = Vec::new();
    for (k, &here) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (a, b) = (normal.dot(here) - offset, normal.dot(next) - offset);
        if a <= 0.0 {
            kept.push(here);
        }
        if (a < 0.0) != (b < 0.0) && a != b {
            kept.push(here.lerp(next, (a / (a - b)).clamp(0.0, 1.0)));
        }
    }
    kept
}

/// Translations valid at `angle`: the intersection of stadiums, each as the hull of inscribed 96-gons.
fn translations(problem: &Problem, assignment: &[Feature], angle: f64) -> Vec<DVec2> {
    let turn = DVec2::from_angle(angle);
    let center = problem.evidence.contacts[0].center;
    let reach = 1e3;
    let mut region: Vec<DVec2> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| center + reach * DVec2::new(x, y))
        .into();
    for (contact, feature) in problem.evidence.contacts.iter().zip(assignment) {
        let Feature::Face(number) = feature else { return Vec::new() };
        let face = &problem.model.faces[*number as usize];
        let normal = contact.normal.unwrap();
        if turn.rotate(face.normal).angle_to(normal.direction).abs() > normal.error + 1e-6 {
            return Vec::new();
        }
        let ends = [face.start, face.end].map(|end| contact.center - turn.rotate(end));
        for k in 0..96 {
            let direction =
                DVec2::from_angle(std::f64::consts::TAU * k as f64 / 96.0).rotate(turn.rotate(face.normal));
            let inner =
                (contact.position_error + 1e-6 * problem.model.size) * (std::f64::consts::PI / 96.0).cos();
            let support = ends.map(|end| end.dot(direction)).into_iter().fold(f64::MIN, f64::max) + inner;
            region = clip(&region, direction, support);
            if region.is_empty() {
                return region;
            }
        }
    }
    region
}

#[test]
fn bounds_are_tight() {
    let (mut rotations, mut excursions) = (Vec::new(), Vec::new());
    let mut random = Rng::with_seed(3);
    let objects = parts::OBJECTS.map(parts::part);
    while rotations.len() < 1000 {
        let model = if random.bool() { star(&mut random, 9) } else { objects[random.usize(0..6)].clone() };
        let noise = Noise {
            position_error: 10_f64.powf(uniform(&mut random, -2.0, 0.6)),
            normal_error: Some(10_f64.powf(uniform(&mut random, -1.0, 1.176)).to_radians()),
            tip_radius: 0.0,
        };
        let count = random.usize(2..6);
        let problem = contacts(&mut random, model, count, &noise);
        let found = recognize(&[problem.model.clone()], &problem.evidence, &Settings::default()).unwrap();
        let hypothesis =
            found.hypotheses.iter().find(|one| one.poses.contains(problem.world_from_model)).unwrap();
        let Some(one) = hypothesis.interpretations().find(|one| one.assignment == problem.assignment) else {
            continue;
        };
        let outer = one.poses.rotation_bound();
        let middle = one.poses.witness().angle();
        let q = problem.model.vertices[0].point;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        let mut places = Vec::new();
        for k in -400..=400 {
            let angle = middle + 1.01 * outer * f64::from(k) / 400.0;
            let region = translations(&problem, &one.assignment, angle);
            if !region.is_empty() {
                low = low.min(angle);
                high = high.max(angle);
                places.extend(region.iter().map(|t| Pose::new(angle, *t).apply(q)));
            }
        }
        let width = (0..90)
            .map(|k| {
                let v = DVec2::from_angle(f64::from(k) * std::f64::consts::PI / 90.0);
                let along = places.iter().map(|p| v.dot(*p));
                along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
            })
            .fold(0.0, f64::max);
        // A grid step at either end is not resolved.
        let inner = (high - low).max(0.0);
        assert!(one.poses.excursion(q) >= width && outer >= inner);
        if outer / (inner + outer / 400.0) > 1.1 || one.poses.excursion(q) / width > 1.1 {
            println!(
                "r {} e {} {inner} {outer} {width} {} n {count} eps {} del {}",
                outer / (inner + outer / 400.0),
                one.poses.excursion(q) / width,
                one.poses.excursion(q),
                noise.position_error,
                noise.normal_error.unwrap()
            );
        }
        rotations.push(outer / (inner + outer / 400.0));
        excursions.push(one.poses.excursion(q) / width);
    }
    for ratios in [&mut rotations, &mut excursions] {
        ratios.sort_by(f64::total_cmp);
        println!(
            "median {:.4} 90% {:.4} 99% {:.4} max {:.3}",
            ratios[500], ratios[900], ratios[990], ratios[999]
        );
    }
}
