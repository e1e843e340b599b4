//! Times of planning on one core, as JSON: first paths, whole trees, proofs, many hypotheses, growth with faces.
//!
//! `cargo run --release --example plan_speed [problems]`; `make planning-figures` writes the page from it.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/planning.rs"]
mod planning;

use std::sync::Arc;
use std::time::{Duration, Instant};

use common::star;
use fastrand::Rng;
use measure::spread;
use palpate::plane::Model;
use palpate::{
    EllisCounters, Hypothesis, Plan, PlanSettings, Planner, Sensor, TreeMethod, TreeSettings, plan, plan_tree,
};
use planning::{fine, left_by_contacts, sensor};
use serde_json::{Value, json};

/// No more problems of a kind are begun after this time.
const LONGEST: Duration = Duration::from_secs(60);

/// Boxes of lines that `complete` may examine.
const EFFORT: u64 = 2_000_000;

const FACES: [usize; 7] = [8, 12, 18, 27, 40, 60, 90];

/// Hypotheses of each problem of the growth.
const NUM_GROWN: usize = 8;

fn main() {
    measure::use_one_core();
    let count = std::env::args().nth(1).map_or(100, |text| text.parse().expect("a number"));
    measure::print(&json!({
        "first_path": first_path(count),
        "counts": counts(count),
        "tree": tree(count),
        "proof": proof(count / 2),
        "hundred": hundred(count / 10),
        "growth": FACES.map(|faces| growth(faces, count / 10)),
        "grown": NUM_GROWN,
        "margin": <PlanSettings>::default().margin,
    }));
}

/// Pairs of contacts on the six objects that leave so many hypotheses.
fn pairs(seed: u64, low: usize, high: usize) -> impl Iterator<Item = Vec<Hypothesis>> {
    let objects = parts::OBJECTS.map(parts::part).to_vec();
    let mut random = Rng::with_seed(seed);
    std::iter::from_fn(move || {
        loop {
            let chosen = Arc::clone(&objects[random.usize(0..objects.len())]);
            let found = left_by_contacts(&mut random, &objects, chosen, 2, &fine(0.0));
            if (low..=high).contains(&found.len()) {
                return Some(found);
            }
        }
    })
}

fn usual() -> Sensor {
    sensor(&fine(0.0), 0.0)
}

fn by(hypotheses: &[Hypothesis], planner: Planner) -> Plan {
    let settings = PlanSettings { planner, effort: EFFORT, ..PlanSettings::default() };
    plan(hypotheses, &usual(), &settings).expect("good settings")
}

/// Seconds for each problem, until there are enough or time is up; and what came out.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn timed<T>(
    problems: impl Iterator<Item = Vec<Hypothesis>>,
    count: usize,
    mut work: impl FnMut(&[Hypothesis]) -> T,
) -> (Vec<f64>, Vec<T>) {
    let begun = Instant::now();
    let (mut times, mut results) = (Vec::new(), Vec::new());
    for hypotheses in problems.take(count) {
        let started = Instant::now();
        results.push(work(&hypotheses));
        times.push(started.elapsed().as_secs_f64());
        if begun.elapsed() > LONGEST {
            break;
        }
    }
    (times, results)
}

fn first_path(count: usize) -> Value {
    let (mut times, plans) = timed(pairs(1, 2, 30), count, |some| by(some, Planner::Auto));
    let perfect =
        plans.iter().filter(|plan| plan.path.as_ref().is_some_and(|path| path.score <= 1.0)).count();
    json!({ "seconds": spread(&mut times), "perfect": perfect })
}

/// Operations of the thesis's own search on the same problems, in all, and what its section 3.5 says.
fn counts(count: usize) -> Value {
    let plans: Vec<Plan> = pairs(1, 2, 30).take(count).map(|some| by(&some, Planner::Ellis)).collect();
    let sum = |of: &dyn Fn(&EllisCounters) -> u64| -> u64 {
        plans.iter().filter_map(|plan| plan.counters.as_ref()).map(of).sum()
    };
    json!({
        "problems": plans.len(),
        "inner_products": sum(&|all| all.inner_products),
        "inner_products_thesis": sum(&EllisCounters::predicted_inner_products),
        "generators": sum(&|all| all.generators),
        "candidates": sum(&|all| all.candidates),
        "unsensed": sum(&|all| all.unsensed),
        "critical_points": sum(&|all| all.critical_points),
        "critical_points_thesis": sum(&EllisCounters::predicted_critical_points),
        "critical_kept": sum(&|all| all.critical_kept),
        "overlaps": sum(&|all| all.overlaps),
        "paths": sum(&|all| all.paths),
    })
}

/// Whole trees of 20 to 25 hypotheses, by the planner for the loop.
fn tree(count: usize) -> Value {
    let settings = PlanSettings { planner: Planner::Auto, effort: EFFORT, ..PlanSettings::default() };
    let greedy = TreeSettings { method: TreeMethod::Greedy, ..TreeSettings::default() };
    let (mut times, trees) = timed(pairs(2, 20, 25), count, |some| {
        plan_tree(some, &usual(), &settings, &greedy).expect("good settings")
    });
    let mean = trees.iter().map(|tree| tree.expected_touches).sum::<f64>() / trees.len() as f64;
    json!({ "seconds": spread(&mut times), "expected_touches": mean })
}

/// `complete` with its proof, or to the end of its effort, for 20 to 25 hypotheses.
fn proof(count: usize) -> Value {
    let (mut times, plans) = timed(pairs(3, 20, 25), count, |some| by(some, Planner::Complete));
    let proved = plans.iter().filter(|plan| plan.proved).count();
    let mut boxes: Vec<f64> = plans.iter().map(|plan| plan.num_boxes as f64).collect();
    json!({ "seconds": spread(&mut times), "proved": proved, "boxes": spread(&mut boxes), "effort": EFFORT })
}

/// One path for exactly so many hypotheses of stars.
fn of_stars(seed: u64, faces: usize, num_stars: usize, most: usize) -> impl Iterator<Item = Vec<Hypothesis>> {
    let mut random = Rng::with_seed(seed);
    std::iter::from_fn(move || {
        loop {
            let models: Vec<Arc<Model>> = (0..num_stars).map(|_| star(&mut random, faces)).collect();
            let chosen = Arc::clone(&models[0]);
            let mut found = left_by_contacts(&mut random, &models, chosen, 2, &fine(0.0));
            if found.len() >= most {
                found.truncate(most);
                return Some(found);
            }
        }
    })
}

fn hundred(count: usize) -> Value {
    let (mut times, plans) = timed(of_stars(4, 12, 40, 100), count, |some| by(some, Planner::Auto));
    let mean = plans.iter().filter_map(|plan| Some(plan.path.as_ref()?.score)).sum::<f64>();
    json!({ "seconds": spread(&mut times), "score": mean / plans.len() as f64 })
}

fn growth(faces: usize, count: usize) -> Value {
    let problems = || of_stars(5 + faces as u64, faces, 4, NUM_GROWN);
    let (mut auto, _) = timed(problems(), count, |some| by(some, Planner::Auto));
    let (mut complete, plans) = timed(problems(), count, |some| by(some, Planner::Complete));
    let proved = plans.iter().filter(|plan| plan.proved).count();
    json!({ "faces": faces, "auto": spread(&mut auto), "complete": spread(&mut complete), "proved": proved })
}
