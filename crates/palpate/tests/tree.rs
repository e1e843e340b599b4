//! The interpretation tree over random pair tables against every assignment there is (`docs/theory.md`, T1).

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::sync::atomic::Ordering::Relaxed;

use fastrand::Rng;
use palpate::recognize::Halt;
use palpate::tree::{ContactPairs, Counters, FeaturePairs, PairRange, Range, search};

/// `pairs[a][b]`, with an index or without.
struct Table {
    pairs: Vec<Vec<PairRange>>,
    indexed: bool,
}

impl FeaturePairs for Table {
    fn pair(&self, first: usize, second: usize) -> PairRange {
        self.pairs[first][second]
    }

    fn near_angle(&self, first: usize, angle: Range) -> Option<impl Iterator<Item = usize>> {
        let near = move |k: &usize| share_a_direction(self.pairs[first][*k].angle, angle);
        self.indexed.then(|| (0..self.pairs.len()).filter(near))
    }
}

fn random_range(random: &mut Rng, most: f64) -> Range {
    let low = 10.0 * random.f64();
    Range { low, high: low + most * random.f64() }
}

fn random_pair(random: &mut Rng) -> PairRange {
    let start = 20.0 * random.f64() - 10.0;
    let width = if random.u8(0..5) == 0 { TAU } else { 4.0 * random.f64() };
    PairRange {
        distance: random_range(random, 6.0),
        angle: Range { low: start, high: start + width },
        direction: random_range(random, 8.0),
        direction_back: random_range(random, 8.0),
    }
}

fn share_a_value(a: Range, b: Range) -> bool {
    a.low.max(b.low) <= a.high.min(b.high)
}

/// The middles are no farther apart than both half widths together.
fn share_a_direction(a: Range, b: Range) -> bool {
    let apart = 0.5 * (a.low + a.high - b.low - b.high);
    let apart = PI - (apart.rem_euclid(TAU) - PI).abs();
    apart <= 0.5 * (a.high - a.low + b.high - b.low)
}

fn agree(sensed: &PairRange, known: &PairRange) -> bool {
    share_a_value(sensed.distance, known.distance)
        && share_a_direction(sensed.angle, known.angle)
        && share_a_value(sensed.direction, known.direction)
        && share_a_value(sensed.direction_back, known.direction_back)
}

/// Every assignment, in lexicographic order, of which all pairs agree.
fn enumerated(table: &Table, contacts: &ContactPairs) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for candidates in &contacts.candidates {
        let longer = |one: &Vec<usize>| candidates.iter().map(|k| [&one[..], &[*k]].concat()).collect();
        all = all.iter().flat_map::<Vec<_>, _>(longer).collect();
    }
    let good = |one: &Vec<usize>| {
        let pair = |i: usize, j: usize| agree(&contacts.pairs[j][i], &table.pairs[one[i]][one[j]]);
        (0..one.len()).all(|j| (0..j).all(|i| pair(i, j)))
    };
    all.retain(good);
    all
}

fn random_problem(random: &mut Rng) -> (Table, ContactPairs) {
    let (num_features, num_contacts) = (random.usize(1..8), random.usize(1..5));
    let mut row = |count: usize| (0..count).map(|_| random_pair(random)).collect::<Vec<_>>();
    let pairs = (0..num_features).map(|_| row(num_features)).collect();
    let sensed = (0..num_contacts).map(&mut row).collect();
    let mut some = || (0..num_features).filter(|_| random.u8(0..4) > 0).collect::<Vec<_>>();
    let candidates = (0..num_contacts).map(|_| some()).collect();
    (Table { pairs, indexed: random.bool() }, ContactPairs { candidates, pairs: sensed })
}

fn found(table: &Table, contacts: &ContactPairs, max_nodes: u64) -> (Vec<Vec<usize>>, Counters, bool) {
    let (mut all, mut counters) = (Vec::new(), Counters::default());
    let end = search(table, contacts, max_nodes, &Halt::default(), &mut counters, &mut |assignment| {
        all.push(assignment.to_vec());
        ControlFlow::Continue(())
    });
    (all, counters, end.is_continue())
}

#[test]
fn the_tree_finds_what_all_assignments_hold_and_nothing_else() {
    let mut random = Rng::with_seed(1);
    let mut total = 0;
    for _ in 0..4_000 {
        let (table, contacts) = random_problem(&mut random);
        let (all, counters, whole) = found(&table, &contacts, u64::MAX);
        assert!(whole);
        assert_eq!(all, enumerated(&table, &contacts));
        assert_eq!(counters.feasible, all.len() as u64);
        let refused = counters.pruned_by_distance + counters.pruned_by_angle + counters.pruned_by_direction;
        assert!(refused <= counters.nodes);
        total += all.len();
    }
    assert!(total > 4_000, "{total}");
}

#[test]
fn a_search_that_is_cut_short_says_so_and_finds_the_first() {
    let mut random = Rng::with_seed(2);
    for _ in 0..500 {
        let (table, contacts) = random_problem(&mut random);
        let (all, counters, _) = found(&table, &contacts, u64::MAX);
        let limit = random.u64(0..counters.nodes + 2);
        let (some, _, whole) = found(&table, &contacts, limit);
        assert_eq!(whole, limit >= counters.nodes);
        assert_eq!(some, all[..some.len()]);
    }
}

/// Once it is told to stop, it tries no more.
#[test]
fn a_search_that_is_stopped_says_so() {
    let mut random = Rng::with_seed(3);
    let mut num_stopped = 0;
    for _ in 0..500 {
        let (table, contacts) = random_problem(&mut random);
        let (all, counters, _) = found(&table, &contacts, u64::MAX);
        let (stop, mut num_found, mut stopped) = (Halt::default(), 0, Counters::default());
        let end = search(&table, &contacts, u64::MAX, &stop, &mut stopped, &mut |assignment| {
            assert_eq!(assignment, all[num_found]);
            num_found += 1;
            stop.store(true, Relaxed);
            ControlFlow::Continue(())
        });
        assert_eq!(num_found, all.len().min(1));
        assert!(stopped.nodes <= counters.nodes);
        num_stopped += usize::from(end.is_break());
    }
    assert!(num_stopped > 100, "{num_stopped}");
}
