//! `complete` is never worse than random lines or than another planner, where it proved its path (`docs/theory.md`, T13).
//!
//! A slice of `make campaign-plan`.

#[path = "common/against.rs"]
mod against;
mod common;
#[path = "common/parts.rs"]
mod parts;
#[path = "common/planning.rs"]
mod planning;

use std::f64::consts::TAU;
use std::sync::Arc;

use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::Line;
use palpate::plan::Prepared;
use palpate::plane::{Model, Pose};
use palpate::{
    Contact, Evidence, Hypothesis, Normal, PlanSettings, Planner, Sensor, Settings, plan, recognize,
};

/// Lines of a smallest box of `complete` differ from its middle by no more than this share of m.
const SMALLEST: f64 = 0.9;

const PROBLEMS: u64 = 24;
const LINES: u64 = 5_000;
const EFFORT: u64 = 30_000;

#[test]
fn nothing_is_better_than_what_complete_proved() {
    let mut num_proved = 0;
    for number in 0..PROBLEMS {
        let case = planning::case(number);
        let outcome = against::against(&case, number, LINES, EFFORT);
        if outcome.complete.proved {
            num_proved += 1;
            assert!(outcome.better.is_empty(), "problem {number}: {:?}", outcome.better);
        }
        // Cut short or not, nothing is below the bound.
        let lowest = outcome.better.iter().map(|one| one.score).fold(f64::INFINITY, f64::min);
        assert!(lowest >= outcome.complete.bound - 1e-9, "problem {number}: {lowest}");
    }
    assert!(num_proved >= PROBLEMS / 2, "{num_proved} of {PROBLEMS}");
}

/// Lines near one that was judged: turned and shifted so that nothing moves by more than `share` of m, seen from the line.
fn near(
    case: &planning::Case,
    prepared: &Prepared,
    line: (f64, f64),
    share: f64,
    random: &mut Rng,
) -> Option<Line> {
    let (size, radius) = (case.margin() / case.settings.margin, prepared.radius());
    let most = (share * case.settings.margin).min(share * case.margin() / radius.max(size));
    let turn = most * [-1.0, 1.0][random.usize(0..2)] * random.f64();
    let reach = share * case.margin() - turn.abs() * radius;
    prepared.line(line.0 + turn, line.1 + reach * [-1.0, 1.0][random.usize(0..2)])
}

#[test]
fn a_line_of_margin_m_is_matched_by_all_nearby() {
    let (mut random, mut num_lines) = (Rng::with_seed(3), 0);
    for number in 0..PROBLEMS {
        let case = planning::case(number);
        let prepared = Prepared::new(&case.hypotheses, &case.sensor, &case.settings).expect("hypotheses");
        for _ in 0..200 {
            let numbers = (TAU * random.f64(), prepared.radius() * (2.0 * random.f64() - 1.0));
            let Some(line) = prepared.line(numbers.0, numbers.1) else { continue };
            if prepared.score(&line).is_none() {
                continue;
            }
            let path = prepared.judge(&line);
            if path.margin < case.margin() {
                continue;
            }
            num_lines += 1;
            for _ in 0..3 {
                let other =
                    near(&case, &prepared, numbers, SMALLEST, &mut random).expect("all lines are allowed");
                let other = prepared.judge(&other);
                assert_eq!(other.fault, None, "problem {number}: {numbers:?} {:?}", other.line);
                let as_good = |k: usize, j: usize| {
                    other.outcomes[k].separated(&other.outcomes[j], &case.sensor)
                        || !path.outcomes[k].separated(&path.outcomes[j], &case.sensor)
                };
                let n = case.hypotheses.len();
                assert!((0..n).all(|k| (0..k).all(|j| as_good(k, j))), "problem {number}: {numbers:?}");
            }
        }
    }
    assert!(num_lines > 500, "{num_lines}");
}

/// A tall plate with a window of some width in it.
fn window(width: f64) -> Arc<Model> {
    let outer = [(0.0, -500.0), (100.0, -500.0), (100.0, 580.0), (0.0, 580.0)].map(|(x, y)| dvec2(x, y));
    let right = 40.0 + width;
    let hole = [(40.0, 20.0), (40.0, 60.0), (right, 60.0), (right, 20.0)].map(|(x, y)| dvec2(x, y));
    Arc::new(Model::polygon("window", &outer, &[hole.to_vec()], &[], 0.0, 0.0).expect("a plate"))
}

/// Two plates at one pose, which differ only in their windows.
fn windows() -> Vec<Hypothesis> {
    let touch = |x: f64, y: f64, normal: DVec2| {
        let normal = Normal::new(normal, 1e-3).expect("a normal");
        Contact::new(dvec2(x, y), 0.0, 1e-3).expect("a contact").with_normal(normal)
    };
    let contacts = vec![
        touch(10.0, -500.0, -DVec2::Y),
        touch(90.0, -500.0, -DVec2::Y),
        touch(0.0, 10.0, -DVec2::X),
        touch(0.0, 70.0, -DVec2::X),
        touch(100.0, 30.0, DVec2::X),
    ];
    let evidence = Evidence { contacts, ..Evidence::default() };
    let found =
        recognize(&[window(30.0), window(40.0)], &evidence, &Settings::default()).expect("well formed");
    found.hypotheses.into_iter().filter(|one| one.poses.contains(Pose::IDENTITY)).collect()
}

#[test]
fn lines_that_begin_between_parts_of_an_outline_are_not_overlooked() {
    let hypotheses = windows();
    let sensor = Sensor::new(0.5, Some(0.07), 0.6).expect("a good sensor");
    // From its left border, which is in the window, lines tell the windows apart.
    let workspace = Some([dvec2(45.0, 30.0), dvec2(160.0, 50.0)]);
    let settings =
        PlanSettings { planner: Planner::Complete, workspace, margin: 3e-3, ..PlanSettings::default() };
    let prepared = Prepared::new(&hypotheses, &sensor, &settings).expect("hypotheses");
    let path = prepared.judge(&prepared.line(0.0, 1.0).expect("into the workspace"));
    assert!(path.fault.is_none() && path.score <= 1.0 && path.margin > 3e-3 * 1_100.0);
    let plan = plan(&hypotheses, &sensor, &settings).expect("good settings");
    assert!(plan.bound <= path.score, "{} is said to be the least there is", plan.bound);
}
