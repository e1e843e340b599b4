//! The interpretation tree (thesis 2.2): one feature for each contact, pruned pair by pair.
//!
//! The search sees no coordinates, only tables of ranges: of distance, angle and direction between two features of a
//! model, and between two contacts. It serves the plane and space alike.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering::Relaxed;

use crate::recognize::Halt;

/// A closed range. Of an angle, it is an arc of the circle, counter-clockwise from `low`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

impl Range {
    /// Whether two ranges have a value in common.
    #[must_use]
    pub fn meets(self, other: Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// The least range that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What two ranges have in common; low above high if nothing.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// The range with so much more at either end.
    #[must_use]
    pub fn widened(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Whether two arcs of the circle have a direction in common.
    #[must_use]
    pub fn meets_on_circle(self, other: Self) -> bool {
        use std::f64::consts::TAU;
        (other.low - self.low).rem_euclid(TAU) <= self.high - self.low
            || (self.low - other.low).rem_euclid(TAU) <= other.high - other.low
    }
}

/// What is known of an ordered pair, of features or of contacts (thesis 2.2.1, 2.2.2; MATH 2.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairRange {
    /// Between the two.
    pub distance: Range,
    /// From the normal of the second to that of the first, an arc.
    pub angle: Range,
    /// Along the normal of the first, from the first to the second.
    pub direction: Range,
    /// Along the normal of the second, from the second to the first.
    pub direction_back: Range,
}

impl PairRange {
    /// Whether what is sensed of two contacts may be of two features of which this is `known`.
    pub fn meets(&self, known: &Self) -> bool {
        self.distance.meets(known.distance)
            && self.angle.meets_on_circle(known.angle)
            && self.direction.meets(known.direction)
            && self.direction_back.meets(known.direction_back)
    }
}

/// The tables of a model: every ordered pair of its features.
pub trait FeaturePairs {
    /// Ranges of the pair `first`, `second`.
    fn pair(&self, first: usize, second: usize) -> PairRange;

    /// Features whose angle to `first` meets `angle`, and perhaps some more, in increasing order of number within
    /// a run: the index of the tables. `None` if there is no index; then every feature is tried.
    fn near_angle(&self, first: usize, angle: Range) -> Option<impl Iterator<Item = usize>>;
}

/// The tables of the contacts: every pair, and the features that each may lie on by itself.
#[derive(Debug, Clone)]
pub struct ContactPairs {
    /// `candidates[i]`: the features that contact `i` may lie on, in increasing order.
    pub candidates: Vec<Vec<usize>>,
    /// `pairs[j][i]` for `i < j`: of contact `i` and contact `j`. An angle that is not known is the full circle.
    pub pairs: Vec<Vec<PairRange>>,
}

/// What the search did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Assignments of a feature to a contact that were tried.
    pub nodes: u64,
    /// Of these, refused by distance.
    pub pruned_by_distance: u64,
    /// Of the rest, refused by angle.
    pub pruned_by_angle: u64,
    /// Of the rest, refused by direction, in either order.
    pub pruned_by_direction: u64,
    /// Complete assignments that passed every pair: feasible, in the thesis's word.
    pub feasible: u64,
}

/// Visits every feasible assignment, in lexicographic order where the tables have no index.
///
/// Ends early, and says so, when `visit` breaks, when `max_nodes` were tried, or soon after `stop` is set.
pub fn search(
    features: &impl FeaturePairs,
    contacts: &ContactPairs,
    max_nodes: u64,
    stop: &Halt,
    counters: &mut Counters,
    visit: &mut impl FnMut(&[usize]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut tree = Tree { features, contacts, max_nodes, stop, counters, visit };
    tree.extend(&mut Vec::with_capacity(contacts.candidates.len()))
}

struct Tree<'a, F, V> {
    features: &'a F,
    contacts: &'a ContactPairs,
    max_nodes: u64,
    stop: &'a Halt,
    counters: &'a mut Counters,
    visit: &'a mut V,
}

impl<F: FeaturePairs, V: FnMut(&[usize]) -> ControlFlow<()>> Tree<'_, F, V> {
    fn extend(&mut self, assignment: &mut Vec<usize>) -> ControlFlow<()> {
        let contact = assignment.len();
        let Some(candidates) = self.contacts.candidates.get(contact) else {
            self.counters.feasible += 1;
            return (self.visit)(assignment);
        };
        let angle = self.contacts.pairs[contact].first().map(|pair| pair.angle);
        let indexed = angle.and_then(|angle| self.features.near_angle(assignment[0], angle));
        if let Some(near) = indexed {
            for feature in near.filter(|feature| candidates.binary_search(feature).is_ok()) {
                self.try_feature(assignment, feature)?;
            }
        } else {
            for &feature in candidates {
                self.try_feature(assignment, feature)?;
            }
        }
        ControlFlow::Continue(())
    }

    fn try_feature(&mut self, assignment: &mut Vec<usize>, feature: usize) -> ControlFlow<()> {
        self.counters.nodes += 1;
        if self.counters.nodes > self.max_nodes || self.stop.load(Relaxed) {
            return ControlFlow::Break(());
        }
        if self.consistent(assignment, feature) {
            assignment.push(feature);
            self.extend(assignment)?;
            assignment.pop();
        }
        ControlFlow::Continue(())
    }

    /// Distance, then angle, then direction in both orders, against every contact that has its feature already.
    fn consistent(&mut self, assignment: &[usize], feature: usize) -> bool {
        let contact = assignment.len();
        for (earlier, &assigned) in assignment.iter().enumerate() {
            let sensed = &self.contacts.pairs[contact][earlier];
            let known = self.features.pair(assigned, feature);
            if !sensed.distance.meets(known.distance) {
                self.counters.pruned_by_distance += 1;
                return false;
            }
            if !sensed.angle.meets_on_circle(known.angle) {
                self.counters.pruned_by_angle += 1;
                return false;
            }
            if !(sensed.direction.meets(known.direction) && sensed.direction_back.meets(known.direction_back))
            {
                self.counters.pruned_by_direction += 1;
                return false;
            }
        }
        true
    }
}
