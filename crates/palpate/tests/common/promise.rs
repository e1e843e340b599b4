//! Simulated readings against what a path promises.

#![allow(dead_code, reason = "each program uses its own part")]

use std::f64::consts::TAU;
use std::sync::Arc;

use fastrand::Rng;
use glam::DVec2;
use palpate::plan::Prepared;
use palpate::plane::{Face, Model, Pose};
use palpate::{Hypothesis, Path, PlanSettings, Reading, Sensor, plan};

use crate::common::{Noise, comb, star, uniform};
use crate::{parts, planning};

/// Random lines that are tried for one problem, and usable ones that are kept.
const NUM_LINES: usize = 300;
const NUM_PATHS: usize = 40;

/// Poses of each hypothesis for each path.
const NUM_POSES: usize = 12;

/// What was counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    pub paths: u64,
    pub readings: u64,
    /// Of these, misses.
    pub misses: u64,
    /// Readings that came from a contact at more than Ω.
    pub skids: u64,
    /// Readings that don't leave the truth.
    pub lost: u64,
    /// Readings that leave a hypothesis outside of the promised class, or one that is said to be separated.
    pub broken: u64,
}

impl Counts {
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.readings += other.readings;
        self.misses += other.misses;
        self.skids += other.skids;
        self.lost += other.lost;
        self.broken += other.broken;
    }

    pub fn faults(&self) -> u64 {
        self.skids + self.lost + self.broken
    }
}

fn nearest_place(face: &Face, point: DVec2) -> DVec2 {
    let span = face.end - face.start;
    face.start + ((point - face.start).dot(span) / span.length_squared()).clamp(0.0, 1.0) * span
}

/// The face nearest to a point, and its place that is.
fn nearest(model: &Model, point: DVec2) -> (&Face, DVec2) {
    let places = model.faces.iter().map(|face| (face, nearest_place(face, point)));
    places
        .min_by(|a, b| point.distance_squared(a.1).total_cmp(&point.distance_squared(b.1)))
        .expect("a model has faces")
}

/// The first contact of a ball, by going on as far as is surely free, from nothing but the faces: the place of its centre, and
/// the outward normal.
fn touch(model: &Model, pose: Pose, start: DVec2, path: &Path, radius: f64) -> Option<(DVec2, DVec2)> {
    let inverse = pose.inverse();
    let mut t = 0.0;
    while t <= path.length {
        let center = start + t * path.line.direction;
        let at = inverse.apply(center);
        let (face, place) = nearest(model, at);
        let gap = at.distance(place);
        if gap <= radius + 1e-9 {
            // For a point the way to the nearest place turns unreliable.
            let normal = if radius > 0.0 { (at - place).normalize_or_zero() } else { face.normal };
            return Some((center, pose.rotation.rotate(normal)));
        }
        t += gap - radius;
    }
    None
}

/// A simulated touch at a pose: the reading, and the incidence. A third of the time all errors are at their bounds.
fn simulated(
    path: &Path,
    model: &Model,
    pose: Pose,
    sensor: &Sensor,
    random: &mut Rng,
) -> (Option<Reading>, f64) {
    let extreme = random.u8(0..3) == 0;
    let mut share = || if extreme { [-1.0, 1.0][random.usize(0..2)] } else { 2.0 * random.f64() - 1.0 };
    let start = path.line.start + share() * sensor.path_error * path.line.left();
    let Some((center, normal)) = touch(model, pose, start, path, sensor.tip_radius) else {
        return (None, 0.0);
    };
    let turn = DVec2::from_angle(share() * sensor.normal_error.unwrap_or(0.0));
    let away = share().abs() * sensor.position_error;
    let sensed = center + away * DVec2::from_angle(TAU * random.f64());
    let incidence = normal.angle_to(-path.line.direction).abs();
    (Some(path.reading(sensed, Some(turn.rotate(normal)))), incidence)
}

/// Whether the path, shifted by its margin, ends before it meets what it would meet if it went on.
fn too_short(path: &Path, model: &Model, pose: Pose, sensor: &Sensor, random: &mut Rng) -> bool {
    let aside = (sensor.path_error + path.margin) * [-1.0, 1.0][random.usize(0..2)];
    let start = path.line.start + aside * path.line.left();
    let mut endless = path.clone();
    endless.length *= 10.0;
    let met = touch(model, pose, start, &endless, sensor.tip_radius);
    met.is_some_and(|(center, _)| path.line.coordinates(center).0 > path.length - sensor.position_error)
}

/// Readings of one hypothesis at sampled poses.
pub fn readings(
    path: &Path,
    hypotheses: &[Hypothesis],
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

fn models(random: &mut Rng) -> Vec<Arc<Model>> {
    match random.u8(0..4) {
        0 => vec![star(random, 9), star(random, 12)],
        1 => vec![comb(random, 3), comb(random, 4)],
        _ => parts::OBJECTS.map(parts::part).to_vec(),
    }
}

/// All that is simulated for the problem of a number: usable random lines, and the path that is planned.
pub fn of_problem(number: u64) -> Counts {
    let mut random = Rng::with_seed(31 + number);
    let (hypotheses, noise) = loop {
        let models = models(&mut random);
        let noise = Noise {
            position_error: uniform(&mut random, 0.05, 1.5),
            normal_error: Some(uniform(&mut random, 0.5, 6.0).to_radians()),
            tip_radius: if random.u8(0..3) == 0 { uniform(&mut random, 0.5, 3.0) } else { 0.0 },
        };
        let chosen = Arc::clone(&models[random.usize(0..models.len())]);
        let hypotheses = planning::left_by_contacts(&mut random, &models, chosen, 2, &noise);
        if (2..=30).contains(&hypotheses.len()) {
            break (hypotheses, noise);
        }
    };
    let path_error = [0.0, 0.3][random.usize(0..2)];
    let sensor =
        Sensor { max_incidence: uniform(&mut random, 0.6, 1.4), ..planning::sensor(&noise, path_error) };
    let settings = PlanSettings { vertices: Some(noise.tip_radius > 0.0), ..PlanSettings::default() };
    let prepared = Prepared::new(&hypotheses, &sensor, &settings).expect("hypotheses");
    let mut drawn = || prepared.line(TAU * random.f64(), prepared.radius() * uniform(&mut random, -1.0, 1.0));
    let lines: Vec<_> = (0..NUM_LINES).filter_map(|_| drawn()).collect();
    let usable = lines.iter().filter(|line| prepared.score(line).is_some()).take(NUM_PATHS);
    let mut paths: Vec<Path> = usable.map(|line| prepared.judge(line)).collect();
    let settings = PlanSettings { effort: 300, ..settings };
    paths.extend(plan(&hypotheses, &sensor, &settings).expect("a plan").path);
    let mut counts = Counts { paths: paths.len() as u64, ..Counts::default() };
    for path in &paths {
        for number in 0..hypotheses.len() {
            counts.add(&readings(path, &hypotheses, number, &sensor, &mut random));
        }
    }
    counts
}
