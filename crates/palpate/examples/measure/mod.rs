//! What the examples that measure share: one core, times, quantiles.

#![allow(dead_code, reason = "each example uses its own part")]

use std::time::Instant;

use palpate::{Recognition, Settings, recognize};
use serde_json::{Value, json};

use crate::common::Problem;

/// Whatever is computed from here on uses one core.
pub fn use_one_core() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool of this program");
}

/// Seconds that `work` takes: the median of some runs, more of them where they are short.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
pub fn seconds<T>(mut work: impl FnMut() -> T) -> f64 {
    const ENOUGH: f64 = 0.02;
    let mut times = Vec::new();
    let begun = Instant::now();
    while times.len() < 3 || (begun.elapsed().as_secs_f64() < ENOUGH && times.len() < 15) {
        let started = Instant::now();
        std::hint::black_box(work());
        times.push(started.elapsed().as_secs_f64());
        if times[0] > 1.0 {
            break;
        }
    }
    quantile(&mut times, 50)
}

/// That percentage of the values is no larger.
pub fn quantile(values: &mut [f64], percentage: usize) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() * percentage / 100).min(values.len() - 1)]
}

/// Median, upper quantiles and the largest value.
pub fn spread(values: &mut [f64]) -> Value {
    let [half, most, nearly_all, all] = [50, 90, 99, 100].map(|percentage| quantile(values, percentage));
    json!({ "count": values.len(), "median": half, "q90": most, "q99": nearly_all, "max": all })
}

/// Every part and pose that explains the problem's contacts.
pub fn solve(problem: &Problem) -> Recognition {
    recognize(std::slice::from_ref(&problem.model), &problem.evidence, &Settings::default())
        .expect("a well-formed problem")
}

/// The figures as JSON on standard output.
#[expect(clippy::print_stdout, reason = "an example's result")]
pub fn print(figures: &Value) {
    println!("{figures:#}");
}
