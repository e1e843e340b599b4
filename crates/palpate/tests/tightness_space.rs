//! How tight rotation bounds and excursions are in space, against sampling of the true set. The table of all 200
//! problems is in docs/accuracy.md; `make accuracy` writes it.

mod common;
#[path = "common/sampled_space.rs"]
mod sampled_space;
#[path = "common/solids.rs"]
mod solids;
#[path = "common/tight_space.rs"]
mod tight_space;

use palpate::space::Prior;
use palpate::{Settings, recognize};
use tight_space::{Ratios, measure, problem};

/// Problems of the 200 that are measured here; `PALPATE_TIGHTNESS_PROBLEMS` sets another number.
const NUM_PROBLEMS: u64 = 40;

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
    let [least, median, most] = [0, 50, 90].map(|percentage| ratios[ratios.len() * percentage / 100]);
    assert!(least >= 1.0, "{name}: less than what sampling finds, {least}");
    assert!(median <= 1.1, "{name}: median {median}");
    assert!(most <= 1.5, "{name}: 90 % {most}");
}

/// Contacts that leave much, on their own, and a prior that does not: what it allows is the bound.
#[test]
fn no_rotation_bound_is_above_what_the_prior_allows() {
    let mut num_bounded = 0;
    for seed in 0..30 {
        let mut problem = problem(seed);
        problem.evidence.contacts.truncate(1 + seed as usize % 3);
        let models = [problem.model];
        let settings = Settings::default();
        let table = problem.world_from_model.rotation * glam::DVec3::Z;
        let (rotation, tilt) = (0.05, 0.02);
        let around = Prior::new(problem.world_from_model, 5.0, rotation).expect("good input");
        let lying = around.on_plane(table, 5.0, tilt).expect("good input");
        for (prior, most) in [(around, 2.0 * rotation), (lying, 2.0 * (rotation + tilt))] {
            problem.evidence.prior = Some(prior);
            let found = recognize(&models, &problem.evidence, &settings).expect("good input");
            for one in &found.hypotheses {
                let bound = one.poses.rotation_bound();
                assert!(bound <= most + 1e-5, "problem {seed}: {bound} > {most}");
                num_bounded += usize::from(bound > 0.999 * most);
            }
        }
    }
    assert!(num_bounded > 10, "the prior bounds {num_bounded} of them");
}
