//! Simulated readings in space against what a path promises.

#![allow(dead_code, reason = "each program uses its own part")]

use fastrand::Rng;
use glam::{DMat3, DVec3};
use palpate::plan::Prepared;
use palpate::space::{Model, Pose};
use palpate::{Hypothesis, Line, Path, Reading, Sensor, plan};

use crate::planning_space;
use crate::promise::Counts;
use crate::solids::direction;

/// Random lines that are tried for one problem, and usable ones that are kept.
const NUM_LINES: usize = 300;
const NUM_PATHS: usize = 12;

/// Poses of each hypothesis for each path.
const NUM_POSES: usize = 8;

/// The first contact of a ball by going on as far as is surely free, from nothing but distances; of a point, by a ray. The place of
/// its centre, and the outward normal.
fn touch(model: &Model, pose: Pose, start: DVec3, path: &Path<DVec3>, radius: f64) -> Option<(DVec3, DVec3)> {
    let back = pose.inverse();
    let (from, along) = (back.apply(start), back.rotation * path.line.direction);
    if radius == 0.0 {
        let hit = model.first_hit(from, along).filter(|hit| hit.distance <= path.length)?;
        let normal = model.faces[hit.face as usize].normal;
        return Some((start + hit.distance * path.line.direction, pose.rotation * normal));
    }
    let mut depth = 0.0;
    while depth <= path.length {
        let at = from + depth * along;
        let nearest = model.nearest(at);
        if nearest.distance <= radius + 1e-9 {
            let normal = (at - nearest.point) / nearest.distance;
            return Some((start + depth * path.line.direction, pose.rotation * normal));
        }
        depth += nearest.distance - radius;
    }
    None
}

/// Across a unit vector.
fn across(random: &mut Rng, axis: DVec3) -> DVec3 {
    let some = direction(random);
    (some - axis * axis.dot(some)).normalize_or(axis.any_orthonormal_vector())
}

/// A simulated touch at a pose: the reading, and the incidence. A third of the time all errors are at their bounds.
fn simulated(
    path: &Path<DVec3>,
    model: &Model,
    pose: Pose,
    sensor: &Sensor,
    random: &mut Rng,
) -> (Option<Reading<DVec3>>, f64) {
    let extreme = random.u8(0..3) == 0;
    let mut shares = [0, 1, 2].map(|_| if extreme { 1.0 } else { random.f64() }).into_iter();
    let mut share = || shares.next().expect("three");
    let start = path.line.start + share() * sensor.path_error * across(random, path.line.direction);
    let Some((center, normal)) = touch(model, pose, start, path, sensor.tip_radius) else {
        return (None, 0.0);
    };
    let turn = share() * sensor.normal_error.unwrap_or(0.0);
    let sensed = center + share() * sensor.position_error * direction(random);
    let turned = DMat3::from_axis_angle(across(random, normal), turn) * normal;
    let incidence = normal.angle_between(-path.line.direction);
    (Some(path.reading(sensed, Some(turned))), incidence)
}

/// Whether the path, shifted by its margin, ends before it meets what it would meet if it went on.
fn too_short(path: &Path<DVec3>, model: &Model, pose: Pose, sensor: &Sensor, random: &mut Rng) -> bool {
    let aside = (sensor.path_error + path.margin) * across(random, path.line.direction);
    let mut endless = path.clone();
    endless.length *= 10.0;
    let met = touch(model, pose, path.line.start + aside, &endless, sensor.tip_radius);
    let last = path.length - sensor.position_error;
    met.is_some_and(|(center, _)| path.line.depth_and_aside(center).0 > last)
}

/// Readings of one hypothesis at sampled poses.
fn readings(
    path: &Path<DVec3>,
    hypotheses: &[Hypothesis<DVec3>],
    number: usize,
    sensor: &Sensor,
    random: &mut Rng,
) -> Counts {
    let mut counts = Counts::default();
    let hypothesis = &hypotheses[number];
    let class = path.classes.iter().find(|class| class.contains(&number)).expect("a class");
    for pose in hypothesis.poses.sample(NUM_POSES, random.u64(..)) {
        let (reading, incidence) = simulated(path, &hypothesis.model, pose, sensor, random);
        counts.broken += u64::from(too_short(path, &hypothesis.model, pose, sensor, random));
        let left = path.outcome_of(reading);
        let apart = |other: &usize| path.outcomes[*other].separated(&path.outcomes[number], sensor);
        let outside = left.iter().any(|other| !class.contains(other) || (*other != number && apart(other)));
        counts.readings += 1;
        counts.misses += u64::from(reading.is_none());
        counts.skids += u64::from(incidence > sensor.max_incidence + 1e-6);
        counts.lost += u64::from(!left.contains(&number));
        counts.broken += u64::from(outside);
    }
    counts
}

/// A line to some place of a face of some hypothesis, more or less against its normal.
fn line(
    random: &mut Rng,
    prepared: &Prepared<DVec3>,
    hypotheses: &[Hypothesis<DVec3>],
) -> Option<Line<DVec3>> {
    let hypothesis = &hypotheses[random.usize(0..hypotheses.len())];
    let pose = hypothesis.poses.witness();
    let (corners, face) = &hypothesis.model.triangles[random.usize(0..hypothesis.model.triangles.len())];
    let shares = [0, 1, 2].map(|_| random.f64() + 1e-3);
    let at =
        corners.iter().zip(shares).map(|(k, share)| share * hypothesis.model.vertices[*k as usize].point);
    let place = at.sum::<DVec3>() / shares.iter().sum::<f64>();
    let normal = pose.rotation * hypothesis.model.faces[*face as usize].normal;
    let along = (0.7 * random.f64() * direction(random) - normal).normalize();
    prepared.along(along, pose.apply(place))
}

/// All that is simulated for the problem of a number: usable random lines, and the path that is planned.
pub fn of_problem(number: u64) -> Counts {
    let planning_space::Case { hypotheses, sensor, settings, .. } = planning_space::case(number);
    let mut random = Rng::with_seed(number);
    let prepared = Prepared::new(&hypotheses, &sensor, &settings).expect("hypotheses");
    let mut paths: Vec<Path<DVec3>> = Vec::new();
    for _ in 0..NUM_LINES {
        let line = line(&mut random, &prepared, &hypotheses);
        // A path that may touch nothing promises little.
        let tells = |path: &Path<DVec3>| path.outcomes.iter().any(|outcome| !outcome.touches.is_empty());
        let usable = line.filter(|line| prepared.score(line).is_some());
        paths.extend(usable.map(|line| prepared.judge(&line)).filter(tells));
        if paths.len() >= NUM_PATHS {
            break;
        }
    }
    paths.extend(plan(&hypotheses, &sensor, &settings).expect("a plan").path);
    let mut counts = Counts { paths: paths.len() as u64, ..Counts::default() };
    for path in &paths {
        for number in 0..hypotheses.len() {
            counts.add(&readings(path, &hypotheses, number, &sensor, &mut random));
        }
    }
    counts
}
