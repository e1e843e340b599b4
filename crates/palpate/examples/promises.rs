//! Simulated readings, many of them, against what paths promise; as JSON.
//!
//! `cargo run --release --example promises [readings] [space]`

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/planning.rs"]
mod planning;
#[path = "../tests/common/planning_space.rs"]
mod planning_space;
#[path = "../tests/common/promise.rs"]
mod promise;
#[path = "../tests/common/promise_space.rs"]
mod promise_space;
#[path = "../tests/common/solids.rs"]
mod solids;

use std::process::ExitCode;

use promise::Counts;
use rayon::prelude::*;
use serde_json::json;

/// Problems that are simulated together.
const CHUNK: u64 = 16;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a program that reports")]
fn main() -> ExitCode {
    let wanted: u64 = std::env::args().nth(1).map_or(1_000_000, |text| text.parse().expect("a number"));
    let in_space = std::env::args().nth(2).is_some_and(|text| text == "space");
    let of_problem = if in_space { promise_space::of_problem } else { promise::of_problem };
    let (mut total, mut problems) = (Counts::default(), 0);
    while total.readings < wanted {
        let found: Vec<(u64, Counts)> =
            (problems..problems + CHUNK).into_par_iter().map(|number| (number, of_problem(number))).collect();
        problems += CHUNK;
        for (number, counts) in found {
            if counts.faults() > 0 {
                eprintln!("problem {number}: {counts:?}");
            }
            total.add(&counts);
        }
    }
    let figures = json!({
        "problems": problems,
        "paths": total.paths,
        "readings": total.readings,
        "misses": total.misses,
        "skids": total.skids,
        "lost": total.lost,
        "broken": total.broken,
    });
    println!("{figures:#}");
    if total.faults() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
