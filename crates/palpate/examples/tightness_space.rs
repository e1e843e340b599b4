//! Rotation bounds and excursions in space over what sampling of the true set finds, as JSON.
//!
//! `make accuracy` writes docs/accuracy.md from them.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/sampled_space.rs"]
mod sampled_space;
#[path = "../tests/common/solids.rs"]
mod solids;
#[path = "../tests/common/tight_space.rs"]
mod tight_space;

use measure::spread;
use rayon::prelude::*;
use serde_json::{Value, json};
use tight_space::{Measured, Ratios, measure, problem};

const NUM_PROBLEMS: u64 = 200;

fn main() {
    let all: Vec<Measured> = (0..NUM_PROBLEMS).into_par_iter().map(|seed| measure(&problem(seed))).collect();
    let interpretations = all.iter().map(|one| one.interpretation).collect::<Vec<_>>();
    let hypotheses = all.iter().map(|one| one.hypothesis).collect::<Vec<_>>();
    measure::print(&json!({
        "problems": NUM_PROBLEMS,
        "interpretation": table(&interpretations),
        "hypothesis": table(&hypotheses),
    }));
}

fn table(all: &[Option<Ratios>]) -> Value {
    let mut rotations: Vec<f64> = all.iter().flatten().map(|one| one.rotation).collect();
    let mut excursions: Vec<f64> = all.iter().flatten().map(|one| one.excursion).collect();
    let below = |values: &[f64]| values.iter().filter(|ratio| **ratio < 1.0).count();
    let largest = |figure: fn(&Ratios) -> f64| {
        let of = |seed: &usize| all[*seed].as_ref().map_or(0.0, figure);
        (0..all.len()).max_by(|a, b| of(a).total_cmp(&of(b)))
    };
    json!({
        "below_one": [below(&rotations), below(&excursions)],
        "worst_seeds": [largest(|one| one.rotation), largest(|one| one.excursion)],
        "rotation": spread(&mut rotations),
        "excursion": spread(&mut excursions),
    })
}
