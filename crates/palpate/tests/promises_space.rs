//! A path's promise holds in space: whatever pose of the set is true, and wherever its noise is in the bounds, the reading leaves
//! the true hypothesis, and none that the path is said to separate from it.

mod common;
#[path = "common/parts.rs"]
mod parts;
#[path = "common/planning.rs"]
mod planning;
#[path = "common/planning_space.rs"]
mod planning_space;
#[path = "common/promise.rs"]
mod promise;
#[path = "common/promise_space.rs"]
mod promise_space;
#[path = "common/solids.rs"]
mod solids;

use promise::Counts;

#[test]
fn a_reading_leaves_the_truth_and_nothing_that_the_path_separates_from_it() {
    let mut total = Counts::default();
    for number in 0..15 {
        let counts = promise_space::of_problem(number);
        assert_eq!(counts.faults(), 0, "problem {number}: {counts:?}");
        total.add(&counts);
    }
    assert!(total.paths > 60 && total.readings > 3_000 && total.misses > 50, "{total:?}");
}
