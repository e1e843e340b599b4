//! Times of recognition on one core, as JSON: two contacts, pose sets, growth with faces and with contacts.
//!
//! `make speed` writes docs/speed.md and its pictures from them.

#[path = "../tests/common/bundled.rs"]
mod bundled;
#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/smooth.rs"]
mod smooth;

use std::sync::Arc;
use std::time::{Duration, Instant};

use common::{Noise, Problem, contacts, star};
use fastrand::Rng;
use glam::dvec2;
use measure::{seconds, solve, spread};
use palpate::plane::{Model, PoseSet};
use palpate::{Settings, recognize};
use serde_json::{Value, json};

/// The bounds of DESIGN: ±0.5 and ±4°.
const NOISE: Noise = Noise { position_error: 0.5, normal_error: Some(4.0 * DEGREE), tip_radius: 0.0 };
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Random pairs of contacts on the six objects.
const NUM_PAIRS: usize = 600;

/// Random problems behind each point of the growth, on some random parts.
const NUM_PROBLEMS: usize = 24;
const NUM_PARTS: usize = 4;

/// No more problems are begun for a point of the growth after this time.
const LONGEST: Duration = Duration::from_secs(30);

const FACES: [usize; 13] = [8, 12, 18, 27, 40, 60, 90, 130, 200, 300, 400, 600, 800];

fn main() {
    measure::use_one_core();
    measure::print(&json!({
        "position_error": NOISE.position_error,
        "normal_error_deg": 4.0,
        "pairs": pairs(),
        "bundled": bundled_pairs(),
        "queries": queries(),
        "faces": growth_with_faces(),
        "contacts": growth_with_contacts(),
        "problems": NUM_PROBLEMS,
    }));
}

/// Two random contacts on one of the six objects: against all six, and against the right one alone.
fn pairs() -> Value {
    let objects = parts::OBJECTS.map(parts::part);
    let mut random = Rng::with_seed(11);
    let (mut six, mut single) = (Vec::new(), Vec::new());
    let (mut hypotheses, mut interpretations) = (Vec::new(), Vec::new());
    for k in 0..NUM_PAIRS {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &NOISE);
        let all =
            || recognize(&objects, &problem.evidence, &Settings::default()).expect("a well-formed problem");
        let found = all();
        hypotheses.push(found.hypotheses.len() as f64);
        interpretations.push(found.interpretation_count().at_least as f64);
        six.push(seconds(all));
        single.push(seconds(|| solve(&problem)));
    }
    let within_1ms = six.iter().filter(|time| **time <= 1e-3).count() as f64 / six.len() as f64;
    json!({
        "within_1ms": within_1ms,
        "six": spread(&mut six),
        "single": spread(&mut single),
        "hypotheses": spread(&mut hypotheses),
        "interpretations": spread(&mut interpretations),
    })
}

/// The contacts that are bundled with each of the six objects, against all six.
fn bundled_pairs() -> Value {
    let objects = parts::OBJECTS.map(parts::part);
    let row = |name: &str| {
        let evidence = bundled::evidence(name);
        let all = || recognize(&objects, &evidence, &Settings::default()).expect("well-formed contacts");
        json!({ "part": name, "seconds": seconds(all), "hypotheses": all().hypotheses.len() })
    };
    parts::OBJECTS.map(row).to_vec().into()
}

/// What is asked of the pose set of the true hypothesis.
fn queries() -> Value {
    let objects = parts::OBJECTS.map(parts::part);
    let mut random = Rng::with_seed(12);
    let mut times: [(&str, Vec<f64>); 5] =
        ["contains", "sample of 100", "rotation bound", "excursion", "largest slack"]
            .map(|name| (name, Vec::new()));
    for k in 0..NUM_PAIRS / 3 {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &NOISE);
        let poses = || true_poses(&problem);
        let set = poses();
        let point = problem.model.vertices[0].point;
        times[0].1.push(seconds(|| set.contains(problem.world_from_model)));
        times[1].1.push(seconds(|| set.sample(100, 0)));
        times[2].1.push(seconds(|| set.rotation_bound()));
        times[3].1.push(seconds(|| set.excursion(point)));
        times[4].1.push(first_largest_slack(&poses()));
    }
    times.map(|(name, mut values)| json!({ "query": name, "seconds": spread(&mut values) })).to_vec().into()
}

fn true_poses(problem: &Problem) -> PoseSet {
    let mut found = solve(problem).hypotheses.into_iter().map(|one| one.poses);
    found.find(|poses| poses.contains(problem.world_from_model)).expect("the true pose is never lost")
}

/// It is found once for each set: the first time counts.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn first_largest_slack(poses: &PoseSet) -> f64 {
    let started = Instant::now();
    std::hint::black_box(poses.largest_slack());
    started.elapsed().as_secs_f64()
}

fn growth_with_faces() -> Value {
    let mut rows = Vec::new();
    for (shape, num_contacts) in [("star", 2), ("star", 4), ("pebble", 2), ("pebble", 4)] {
        for faces in FACES {
            let part = |random: &mut Rng| match shape {
                "star" => star(random, faces),
                _ => smooth::pebble(faces),
            };
            let mut row = point(faces as u64, num_contacts, &part);
            row["shape"] = shape.into();
            row["faces"] = faces.into();
            rows.push(row);
        }
    }
    rows.into()
}

fn growth_with_contacts() -> Value {
    let mut rows = Vec::new();
    for shape in ["human-hand", "star, 40 faces", "pebble, 200 faces", "ellipse, 200 faces"] {
        let part = |random: &mut Rng| match shape {
            "human-hand" => parts::part(shape),
            "star, 40 faces" => star(random, 40),
            "pebble, 200 faces" => smooth::pebble(200),
            _ => smooth::ellipse(200, dvec2(70.0, 50.0)),
        };
        for num_contacts in 2..=12 {
            let mut row = point(5, num_contacts, &part);
            row["shape"] = shape.into();
            rows.push(row);
        }
    }
    rows.into()
}

/// Times, boxes and hypotheses of random problems on random parts.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn point(seed: u64, num_contacts: usize, part: &dyn Fn(&mut Rng) -> Arc<Model>) -> Value {
    let mut random = Rng::with_seed(seed);
    let models: Vec<Arc<Model>> = (0..NUM_PARTS).map(|_| part(&mut random)).collect();
    let begun = Instant::now();
    let (mut times, mut boxes, mut hypotheses) = (Vec::new(), Vec::new(), Vec::new());
    let mut complete = true;
    for k in 0..NUM_PROBLEMS {
        if begun.elapsed() > LONGEST {
            break;
        }
        let problem = contacts(&mut random, models[k % NUM_PARTS].clone(), num_contacts, &NOISE);
        let found = solve(&problem);
        times.push(seconds(|| solve(&problem)));
        boxes.push(found.reports[0].num_boxes as f64);
        hypotheses.push(found.hypotheses.len() as f64);
        complete &= found.complete;
    }
    json!({
        "contacts": num_contacts,
        "seconds": spread(&mut times),
        "boxes": spread(&mut boxes),
        "hypotheses": spread(&mut hypotheses),
        "complete": complete,
    })
}
