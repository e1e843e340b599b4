//! Greedy trees against optimal ones, on random problems of the six objects.
//!
//! `cargo run --release --example ambiguity [fewest] [most hypotheses] [problems] [effort] [degrees] [contacts]`
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "it prints, and measures times")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;

use std::time::Instant;

use common::{Noise, contacts};
use fastrand::Rng;
use palpate::{AmbiguityTree, Hypothesis, PlanSettings, Sensor, Settings, TreeMethod, TreeSettings};

fn main() {
    let argument = |k: usize, default: usize| {
        std::env::args().nth(k).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let (fewest, most, count) = (argument(1, 2), argument(2, 10), argument(3, 20));
    let effort = argument(4, 20_000) as u64;
    let error = (argument(5, 4) as f64).to_radians();
    let num_contacts = argument(6, 2);
    let sensor = Sensor::new(0.5, Some(error), 60_f64.to_radians()).expect("bounds are valid");
    let noise = Noise { position_error: 0.5, normal_error: Some(error), tip_radius: 0.0 };
    let objects = parts::OBJECTS.map(parts::part);
    let mut random = Rng::with_seed(5);
    let (mut greedy_sum, mut ahead_sum, mut optimal_sum, mut bound_sum) = (0.0, 0.0, 0.0, 0.0);
    let (mut worst_ratio, mut done) = (1.0_f64, 0);
    while done < count {
        let model = objects[random.usize(0..objects.len())].clone();
        let problem = contacts(&mut random, model, num_contacts, &noise);
        let found =
            palpate::recognize(&objects, &problem.evidence, &Settings::default()).expect("well-formed");
        let n = found.hypotheses.len();
        if n < fewest || n > most {
            continue;
        }
        let settings = PlanSettings { effort, ..PlanSettings::default() };
        let greedy = tree(&found.hypotheses, &sensor, &settings, TreeMethod::Greedy);
        let ahead = tree(&found.hypotheses, &sensor, &settings, TreeMethod::Ahead);
        let optimal = tree(&found.hypotheses, &sensor, &settings, TreeMethod::Optimal);
        done += 1;
        greedy_sum += greedy.expected_touches;
        ahead_sum += ahead.expected_touches;
        optimal_sum += optimal.expected_touches;
        bound_sum += optimal.entropy_bound;
        worst_ratio = worst_ratio.max(greedy.expected_touches / optimal.expected_touches);
        if done == 1 {
            println!("{}", optimal.to_text());
        }
    }
    println!(
        "{done} problems: expected touches greedy {:.4}, ahead {:.4}, optimal {:.4}, entropy bound {:.4}",
        greedy_sum / done as f64,
        ahead_sum / done as f64,
        optimal_sum / done as f64,
        bound_sum / done as f64
    );
    println!("greedy / optimal: {:.4} in the mean, {worst_ratio:.4} at most", greedy_sum / optimal_sum);
    println!("ahead / optimal: {:.4} in the mean", ahead_sum / optimal_sum);
}

fn tree(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    settings: &PlanSettings,
    method: TreeMethod,
) -> AmbiguityTree {
    let started = Instant::now();
    let tree_settings = TreeSettings { method, ..TreeSettings::default() };
    let tree = palpate::plan_tree(hypotheses, sensor, settings, &tree_settings).expect("hypotheses");
    println!(
        "n {:2} {method:?}: expected {:.3} worst {} nodes {} outcomes {} bounds {:.3} {} {:.3} solved {} in {:.0?}",
        hypotheses.len(),
        tree.expected_touches,
        tree.worst_touches,
        tree.num_nodes(),
        tree.max_outcomes,
        tree.entropy_bound,
        tree.worst_bound,
        tree.lower_bound,
        tree.solved(),
        started.elapsed()
    );
    tree
}
