//! How tight rotation bounds and excursions are, against dense sampling of the true set. The table of all 1,000
//! problems is in docs/accuracy.md; `make accuracy` writes it.

mod common;
#[path = "common/parts.rs"]
mod parts;
#[path = "common/sampled.rs"]
mod sampled;
#[path = "common/tight.rs"]
mod tight;

use tight::{Ratios, measure, problem};

/// Problems of the 1,000 that are measured here; `PALPATE_TIGHTNESS_PROBLEMS` sets another number.
const NUM_PROBLEMS: u64 = 150;

#[test]
fn bounds_hold_and_are_tight() {
    let asked = std::env::var("PALPATE_TIGHTNESS_PROBLEMS").ok();
    let num_problems = asked.map_or(NUM_PROBLEMS, |text| text.parse().expect("a number of problems"));
    let ratios: Vec<Ratios> = (0..num_problems)
        .map(|seed| measure(&problem(seed)).interpretation.expect("a true set that can be sampled"))
        .collect();
    check("rotation bound", ratios.iter().map(|one| one.rotation).collect());
    check("excursion", ratios.iter().map(|one| one.excursion).collect());
}

fn check(name: &str, mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    let [least, median, most] = [0, 50, 99].map(|percentage| ratios[ratios.len() * percentage / 100]);
    assert!(least >= 1.0, "{name}: less than what sampling finds, {least}");
    assert!(median <= 1.05, "{name}: median {median}");
    assert!(most <= 1.2, "{name}: 99 % {most}");
}
