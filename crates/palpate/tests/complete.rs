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
