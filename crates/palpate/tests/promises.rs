//! A path's promise holds: whatever pose of the set is true, and wherever its noise is in the bounds, the reading leaves the
//! true hypothesis, and none that the path is said to separate from it.

mod common;
#[path = "common/parts.rs"]
mod parts;

use std::f64::consts::TAU;
use std::sync::Arc;

use common::{Noise, comb, contacts, star, uniform};
use fastrand::Rng;
use glam::DVec2;
use palpate::plan::Prepared;
use palpate::plane::{Model, Pose};
use palpate::{Hypothesis, Path, PlanSettings, Sensor, Settings, plan, recognize};

/// The distance to a closed outline, from nothing but its faces.
fn distance(model: &Model, point: DVec2) -> (f64, DVec2) {
    let mut nearest = (f64::INFINITY, DVec2::ZERO);
    for face in &model.faces {
        let span = face.end - face.start;
        let t = ((point - face.start).dot(span) / span.length_squared()).clamp(0.0, 1.0);
        let place = face.start + t * span;
        if point.distance(place) < nearest.0 {
            nearest = (point.distance(place), place);
        }
    }
    nearest
}

/// The first contact of a ball, by going on as far as is surely free: the place of its centre, and the outward normal.
fn touch(
    model: &Model,
    pose: Pose,
    start: DVec2,
    direction: DVec2,
    length: f64,
    radius: f64,
) -> Option<(DVec2, DVec2)> {
    let inverse = pose.inverse();
    let mut t = 0.0;
    let mut last = DVec2::ZERO;
    while t <= length {
        let at = inverse.apply(start + t * direction);
        let (gap, place) = distance(model, at);
        if gap <= radius + 1e-9 {
            let away = if radius > 0.0 { at - place } else { last };
            return Some((start + t * direction, pose.rotation.rotate(away).normalize_or_zero()));
        }
        last = at - place;
        t += gap - radius;
    }
    None
}

/// For a point tip the way to the nearest place turns unreliable at contact: the normal of the face that is nearest there.
fn face_normal(model: &Model, pose: Pose, center: DVec2) -> DVec2 {
    let at = pose.inverse().apply(center);
    let gap = |face: &palpate::plane::Face| {
        let span = face.end - face.start;
        let t = ((at - face.start).dot(span) / span.length_squared()).clamp(0.0, 1.0);
        at.distance(face.start + t * span)
    };
    let nearest = model.faces.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("faces");
    pose.rotation.rotate(nearest.normal)
}

/// Readings of one hypothesis at sampled poses; the number of those that were checked.
fn check(path: &Path, hypotheses: &[Hypothesis], number: usize, sensor: &Sensor, random: &mut Rng) -> usize {
    let hypothesis = &hypotheses[number];
    let model = &hypothesis.model;
    let mut count = 0;
    for pose in hypothesis.poses.sample(12, random.u64(..)) {
        let extreme = random.u8(0..3) == 0;
        let mut share = || if extreme { [-1.0, 1.0][random.usize(0..2)] } else { 2.0 * random.f64() - 1.0 };
        let aside = share() * sensor.path_error * path.line.left();
        let start = path.line.start + aside;
        let reached = touch(model, pose, start, path.line.direction, path.length, sensor.tip_radius);
        let reading = reached.map(|(center, normal)| {
            let normal = if sensor.tip_radius > 0.0 { normal } else { face_normal(model, pose, center) };
            let turn = share() * sensor.normal_error.unwrap_or(0.0);
            let away = share().abs() * sensor.position_error;
            let center = center + away * DVec2::from_angle(TAU * share());
            path.reading(center, Some(DVec2::from_angle(turn).rotate(normal)))
        });
        if let Some((center, normal)) = reached {
            let normal = if sensor.tip_radius > 0.0 { normal } else { face_normal(model, pose, center) };
            let incidence = normal.angle_to(-path.line.direction).abs();
            assert!(incidence <= sensor.max_incidence + 1e-6, "skids at {incidence}");
        }
        let left = path.outcome_of(reading);
        assert!(
            left.contains(&number),
            "the truth {number} is not among {left:?}: {reading:?} {:?}",
            path.outcomes[number]
        );
        let class = path.classes.iter().find(|class| class.contains(&number)).expect("a class");
        assert!(left.iter().all(|other| class.contains(other)), "{left:?} is more than {class:?}");
        for other in left {
            let apart = path.outcomes[other].separated(&path.outcomes[number], sensor);
            assert!(!apart, "{other} answers as {number} does");
        }
        count += 1;
    }
    count
}

fn problems(random: &mut Rng) -> (Vec<Arc<Model>>, Noise) {
    let models = match random.u8(0..4) {
        0 => vec![star(random, 9), star(random, 12)],
        1 => vec![comb(random, 3), comb(random, 4)],
        _ => parts::OBJECTS.map(parts::part).to_vec(),
    };
    let noise = Noise {
        position_error: uniform(random, 0.05, 1.5),
        normal_error: Some(uniform(random, 0.5, 6.0).to_radians()),
        tip_radius: if random.u8(0..3) == 0 { uniform(random, 0.5, 3.0) } else { 0.0 },
    };
    (models, noise)
}

#[test]
fn a_reading_leaves_the_truth_and_nothing_that_the_path_separates_from_it() {
    let mut random = Rng::with_seed(31);
    let (mut readings, mut planned, mut usable) = (0, 0, 0);
    while planned < 60 {
        let (models, noise) = problems(&mut random);
        let chosen = Arc::clone(&models[random.usize(0..models.len())]);
        let problem = contacts(&mut random, chosen, 2, &noise);
        let found = recognize(&models, &problem.evidence, &Settings::default()).expect("well-formed");
        if !(2..=30).contains(&found.hypotheses.len()) {
            continue;
        }
        let sensor = Sensor::new(noise.position_error, noise.normal_error, uniform(&mut random, 0.6, 1.4))
            .and_then(|sensor| sensor.with_tip(noise.tip_radius, [0.0, 0.3][random.usize(0..2)]))
            .expect("a sensor");
        let settings = PlanSettings { vertices: Some(noise.tip_radius > 0.0), ..PlanSettings::default() };
        let prepared = Prepared::new(&found.hypotheses, &sensor, &settings).expect("hypotheses");
        let mut paths: Vec<Path> = (0..300)
            .filter_map(|_| {
                prepared.line(TAU * random.f64(), prepared.radius() * uniform(&mut random, -1.0, 1.0))
            })
            .filter(|line| prepared.score(line).is_some())
            .map(|line| prepared.judge(&line))
            .take(40)
            .collect();
        let settings = PlanSettings { effort: 300, ..settings };
        paths.extend(plan(&found.hypotheses, &sensor, &settings).expect("a plan").path);
        planned += 1;
        for path in paths {
            usable += 1;
            for number in 0..found.hypotheses.len() {
                readings += check(&path, &found.hypotheses, number, &sensor, &mut random);
            }
        }
    }
    println!("{readings} readings of {usable} usable paths");
    assert!(usable > 300 && readings > 20_000);
}
