//! The planners of space on random problems: what they find, against `auto`. Figures with `--nocapture`.

mod common;
#[path = "common/planning_space.rs"]
mod planning_space;
#[path = "common/solids.rs"]
mod solids;

use std::time::Instant;

use glam::DVec3;
use palpate::{Dimension, PlanSettings, Planner, judge, plan};

/// Problems, and lines that are judged in each at most.
const NUM_PROBLEMS: u64 = 10;
const EFFORT: u64 = 60;

/// Of each planner: paths found, perfect ones, the mean expected number left, seconds.
#[test]
#[expect(clippy::disallowed_methods, reason = "it is measured how long they take")]
fn every_planner_finds_paths_and_says_of_them_what_the_judge_says() {
    let named = |name: &&str| Planner::named::<DVec3>(name).expect("it is one of space");
    let planners: Vec<Planner> = DVec3::PLANNERS.iter().map(named).collect();
    let mut found = vec![0_u64; planners.len()];
    let mut perfect = vec![0_u64; planners.len()];
    let mut expected = vec![0.0; planners.len()];
    let mut seconds = vec![0.0; planners.len()];
    for number in 0..NUM_PROBLEMS {
        let case = planning_space::case(number);
        for (k, &planner) in planners.iter().enumerate() {
            let settings = PlanSettings { planner, effort: EFFORT, ..case.settings.clone() };
            let start = Instant::now();
            let path = plan(&case.hypotheses, &case.sensor, &settings).expect("well-formed").path;
            seconds[k] += start.elapsed().as_secs_f64();
            let n = case.hypotheses.len() as f64;
            let Some(path) = path else {
                expected[k] += 1.0;
                continue;
            };
            let again = judge(&case.hypotheses, &case.sensor, path.line, Some(path.length), &settings);
            assert_eq!(again.expect("a good line").score, path.score, "{number} {planner:?}");
            found[k] += 1;
            perfect[k] += u64::from(path.score == 1.0);
            expected[k] += path.expected_score / n;
        }
    }
    for (k, planner) in planners.iter().enumerate() {
        let share = expected[k] / NUM_PROBLEMS as f64;
        let (found, perfect, seconds) = (found[k], perfect[k], seconds[k]);
        println!(
            "{:<10} found {found} perfect {perfect} expected share {share:.3} seconds {seconds:.1}",
            planner.name()
        );
    }
    assert!(found.iter().all(|found| 2 * found >= NUM_PROBLEMS), "{found:?}");
}
