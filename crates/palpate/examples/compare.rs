//! How often each planner of the thesis reaches the score of `complete`, and how long each takes.
//!
//! `cargo run --release --example compare -- 2 12 60`: the least and the most hypotheses, and how many problems.
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "a program that measures")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;

use std::time::{Duration, Instant};

use common::{Noise, contacts};
use fastrand::Rng;
use palpate::{Hypothesis, Plan, PlanSettings, Planner, Sensor, Settings, plan, recognize};

/// The planners, `complete` first.
const PLANNERS: [(&str, Planner); 5] = [
    ("complete", Planner::Complete),
    ("auto", Planner::Auto),
    ("ellis", Planner::Ellis),
    ("grimson", Planner::GRIMSON),
    ("schneiter", Planner::SCHNEITER),
];

#[derive(Default)]
struct Tally {
    times: Vec<Duration>,
    num_judged: u64,
    num_reached: usize,
    num_perfect: usize,
    num_guaranteed: usize,
    /// Score less that of `complete`; n if there is no path.
    excess: f64,
}

fn main() {
    let argument = |k: usize, or: usize| std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (low, high, count) = (argument(1, 2), argument(2, 12), argument(3, 60));
    let mut tallies: Vec<Tally> = PLANNERS.iter().map(|_| Tally::default()).collect();
    let mut num_proved = 0;
    for hypotheses in problems(low, high).take(count) {
        let plans = PLANNERS.map(|(_, planner)| timed(&hypotheses, planner));
        num_proved += usize::from(plans[0].0.proved);
        let scores = plans
            .each_ref()
            .map(|(plan, _)| plan.path.as_ref().map_or(hypotheses.len() as f64, |path| path.score));
        if scores[0] > 1.0 {
            println!("n {} scores {scores:?} proved {}", hypotheses.len(), plans[0].0.proved);
        }
        for (tally, ((plan, time), score)) in tallies.iter_mut().zip(plans.iter().zip(scores)) {
            tally.times.push(*time);
            tally.num_judged += plan.num_judged;
            tally.num_reached += usize::from(plan.path.is_some() && score <= scores[0] + 1e-9);
            tally.num_perfect += usize::from(score <= 1.0);
            tally.num_guaranteed += usize::from(score < hypotheses.len() as f64);
            tally.excess += (score - scores[0]) / count as f64;
        }
    }
    println!("{count} problems, {low} to {high} hypotheses; complete proved {num_proved}");
    for ((name, _), tally) in PLANNERS.iter().zip(&mut tallies) {
        tally.times.sort();
        println!(
            "{name:10} reached {:3} perfect {:3} tells {:3} excess {:.3} median {:?} worst {:?} judged {}",
            tally.num_reached,
            tally.num_perfect,
            tally.num_guaranteed,
            tally.excess,
            tally.times[tally.times.len() / 2],
            tally.times[tally.times.len() - 1],
            tally.num_judged
        );
    }
}

/// Pairs of contacts on the six objects that leave so many hypotheses.
fn problems(low: usize, high: usize) -> impl Iterator<Item = Vec<Hypothesis>> {
    let objects = parts::OBJECTS.map(parts::part);
    let normal_error = Some(4_f64.to_radians());
    let noise = Noise { position_error: 0.5, normal_error, tip_radius: 0.0 };
    let mut random = Rng::with_seed(5);
    (0..).filter_map(move |k: usize| {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &noise);
        let found = recognize(&objects, &problem.evidence, &Settings::default()).expect("a good problem");
        (low..=high).contains(&found.hypotheses.len()).then_some(found.hypotheses)
    })
}

fn timed(hypotheses: &[Hypothesis], planner: Planner) -> (Plan, Duration) {
    let sensor = Sensor::new(0.5, Some(4_f64.to_radians()), 60_f64.to_radians()).expect("a good sensor");
    let started = Instant::now();
    let settings = PlanSettings { planner, effort: 300_000, ..PlanSettings::default() };
    (plan(hypotheses, &sensor, &settings).expect("good settings"), started.elapsed())
}
