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

fn quantile(mut values: Vec<f64>, at: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() as f64 * at) as usize).min(values.len() - 1)]
}

#[test]
fn bounds_hold_and_are_tight() {
    let asked = std::env::var("PALPATE_TIGHTNESS_PROBLEMS").ok();
    let num_problems = asked.map_or(NUM_PROBLEMS, |text| text.parse().expect("a number of problems"));
    let ratios: Vec<Ratios> = (0..num_problems)
        .map(|seed| measure(&problem(seed)).interpretation.expect("a true set that can be sampled"))
        .collect();
    let figures: [(&str, fn(&Ratios) -> f64); 2] =
        [("rotation", |one| one.rotation), ("excursion", |one| one.excursion)];
    for (name, figure) in figures {
        let values: Vec<f64> = ratios.iter().map(figure).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least >= 1.0, "{name}: less than what sampling finds, {least}");
        let (median, most) = (quantile(values.clone(), 0.5), quantile(values, 0.99));
        assert!(median <= 1.05, "{name}: median {median}");
        assert!(most <= 1.2, "{name}: 99 % {most}");
    }
}
