//! Times of recognition on one core, as JSON: pairs of contacts, growth with faces and with contacts.
//!
//! `make speed` writes docs/speed.md and its pictures from them.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/smooth.rs"]
mod smooth;

use std::sync::Arc;

use common::{Noise, Problem, contacts, star};
use fastrand::Rng;
use glam::dvec2;
use measure::{on_one_core, seconds, solve, spread};
use palpate::plane::Model;
use palpate::{Settings, recognize};
use serde_json::{Value, json};

/// The bounds of DESIGN: ±0.5 and ±4°.
const NOISE: Noise = Noise { position_error: 0.5, normal_error: Some(4.0 * DEGREE), tip_radius: 0.0 };
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Random pairs of contacts on one of the six objects.
const NUM_PAIRS: usize = 300;

/// Random problems behind each median of the growth.
const NUM_PROBLEMS: usize = 25;

const FACES: [usize; 13] = [8, 12, 18, 27, 40, 60, 90, 130, 200, 300, 400, 600, 800];

fn main() {
    let figures = on_one_core(|| {
        json!({
            "pairs": pairs(),
            "tables": tables(),
            "faces": growth_with_faces(),
            "contacts": growth_with_contacts(),
        })
    });
    measure::print(&figures);
}

/// Two contacts on one of the six objects: against all six, and against the right one alone.
fn pairs() -> Value {
    let objects = parts::OBJECTS.map(parts::part);
    let mut random = Rng::with_seed(11);
    let (mut six, mut single) = (Vec::new(), Vec::new());
    let (mut num_hypotheses, mut num_interpretations) = (Vec::new(), Vec::new());
    for k in 0..NUM_PAIRS {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &NOISE);
        let all =
            || recognize(&objects, &problem.evidence, &Settings::default()).expect("a well-formed problem");
        let found = all();
        num_hypotheses.push(found.hypotheses.len() as f64);
        num_interpretations.push(found.interpretation_count().at_least as f64);
        six.push(seconds(all));
        single.push(seconds(|| solve(&problem)));
    }
    json!({
        "six": spread(&mut six),
        "single": spread(&mut single),
        "hypotheses": spread(&mut num_hypotheses),
        "interpretations": spread(&mut num_interpretations),
    })
}

/// The pair tables, made once with a model.
fn tables() -> Value {
    let time = |faces: usize| {
        let model = smooth::pebble(faces);
        let problem = contacts(&mut Rng::with_seed(1), model, 1, &NOISE);
        // A fresh model has no tables yet; one contact leaves nearly nothing else to do but to make them.
        let corners: Vec<_> = problem.model.faces.iter().map(|face| face.start).collect();
        let fresh = || Model::polygon("fresh", &corners, &[], &[], 0.0, 0.0).expect("an outline");
        json!({ "faces": faces, "model": seconds(fresh) })
    };
    [20, 200, 800].map(time).to_vec().into()
}

fn growth_with_faces() -> Value {
    let mut rows = Vec::new();
    for (shape, num_contacts) in [("star", 2), ("star", 4), ("pebble", 2), ("pebble", 4)] {
        for faces in FACES {
            let mut random = Rng::with_seed(faces as u64);
            let make =
                |random: &mut Rng| if shape == "star" { star(random, faces) } else { smooth::pebble(faces) };
            let model = make(&mut random);
            let mut row = median_over(&mut random, &model, num_contacts);
            row["shape"] = shape.into();
            row["faces"] = faces.into();
            eprintln!("{row}");
            rows.push(row);
        }
    }
    rows.into()
}

fn growth_with_contacts() -> Value {
    let mut random = Rng::with_seed(5);
    let models = [
        ("human-hand", parts::part("human-hand")),
        ("star", star(&mut random, 40)),
        ("pebble", smooth::pebble(200)),
        ("ellipse", smooth::ellipse(200, dvec2(70.0, 50.0))),
    ];
    let mut rows = Vec::new();
    for (shape, model) in models {
        for num_contacts in 2..=12 {
            let mut row = median_over(&mut random, &model, num_contacts);
            row["shape"] = shape.into();
            eprintln!("{row}");
            rows.push(row);
        }
    }
    rows.into()
}

/// Times, hypotheses and boxes over random problems.
fn median_over(random: &mut Rng, model: &Arc<Model>, num_contacts: usize) -> Value {
    let problems: Vec<Problem> =
        (0..NUM_PROBLEMS).map(|_| contacts(random, model.clone(), num_contacts, &NOISE)).collect();
    let mut times: Vec<f64> = problems.iter().map(|problem| seconds(|| solve(problem))).collect();
    let found: Vec<_> = problems.iter().map(solve).collect();
    let mut boxes: Vec<f64> = found.iter().map(|found| found.reports[0].num_boxes as f64).collect();
    let mut hypotheses: Vec<f64> = found.iter().map(|found| found.hypotheses.len() as f64).collect();
    json!({
        "contacts": num_contacts,
        "seconds": spread(&mut times),
        "boxes": spread(&mut boxes),
        "hypotheses": spread(&mut hypotheses),
        "complete": found.iter().all(|found| found.complete),
    })
}
