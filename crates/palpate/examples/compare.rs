//! Problems of the campaign by their numbers: what each planner finds, and how long it takes.
//!
//! `cargo run --release --example compare -- EFFORT NUMBER...`
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "a program that measures")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/planning.rs"]
mod planning;

use std::time::Instant;

use palpate::{PlanSettings, plan};

fn main() {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a whole number"));
    let effort = numbers.next().expect("EFFORT NUMBER...");
    for number in numbers {
        let case = planning::case(number);
        println!("{number}: {}, {} hypotheses", case.family, case.hypotheses.len());
        for (name, planner) in planning::PLANNERS {
            let settings = PlanSettings { planner, effort, ..case.settings.clone() };
            let started = Instant::now();
            let plan = plan(&case.hypotheses, &case.sensor, &settings).expect("good settings");
            println!(
                "  {name:10} {:>10.1?} score {:?} bound {:.3} proved {} boxes {} judged {}",
                started.elapsed(),
                plan.path.as_ref().map(|path| path.score),
                plan.bound,
                plan.proved,
                plan.num_boxes,
                plan.num_judged
            );
        }
    }
}
