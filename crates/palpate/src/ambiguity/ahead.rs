//! A tree that is chosen with a look ahead, where there are too many hypotheses for the best one (MATH 2.4).

use std::collections::BTreeMap;

use super::grow::{Grown, grow};
use super::metrics::total_touches;
use super::pool::{Pool, set_of};
use super::relation::{Relation, Set};
use crate::dimension::Dimension;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// At each node so many relations, those that identify most at once, are followed to the end.
const NUM_FOLLOWED: usize = 16;

/// The greedy tree, or one whose every path is the best if greedy ones follow it; whichever has fewer expected touches.
pub(super) fn plan<V: Dimension>(
    scene: &Scene<V>,
    settings: &PlanSettings<V>,
    max_nodes: usize,
    late: &dyn Fn() -> bool,
) -> Grown<V> {
    let everyone = scene.everyone();
    let root = set_of(&everyone);
    let mut pool = Pool::new(scene, settings, late);
    let greedy = grow(everyone.clone(), max_nodes, &mut |members| pool.plan(members));
    let ahead = grow(everyone, max_nodes, &mut |members| {
        let set = set_of(members);
        let identifies =
            |relation: &Relation| relation.classes(set).is_some_and(|some| some.len() == members.len());
        if !pool.relations().iter().any(identifies) {
            pool.explore(set);
        }
        let best = Ahead { relations: pool.relations(), known: BTreeMap::new() }.best(set);
        pool.choice(best, members)
    });
    let nodes = if total_touches(&ahead) < total_touches(&greedy) { ahead } else { greedy };
    Grown { nodes, bound: pool.bound(root), max_outcomes: None }
}

/// Greedy trees over a pool, without planning.
struct Ahead<'a> {
    relations: &'a [Relation],
    known: BTreeMap<Set, usize>,
}

/// How a relation divides a set. In the order of fewest touches, if every class of more than one needs one more.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Division {
    num_unidentified: u32,
    num_left: u32,
    number: usize,
    classes: Vec<Set>,
}

impl<'a> Ahead<'a> {
    /// The relation with which the fewest touches are expected; `None`: none divides the set.
    fn best(mut self, set: Set) -> Option<&'a Relation> {
        let mut divisions: Vec<Division> = self.divisions(set).collect();
        divisions.sort_unstable();
        divisions.truncate(NUM_FOLLOWED);
        let best = divisions.iter().min_by_key(|division| self.touches_with(set, division))?;
        Some(&self.relations[best.number])
    }

    fn divisions(&self, set: Set) -> impl Iterator<Item = Division> + use<'a> {
        self.relations.iter().enumerate().filter_map(move |(number, relation)| {
            let classes = relation.classes(set).filter(|classes| classes.len() > 1)?;
            let sizes = || classes.iter().map(|class| class.count_ones());
            let num_unidentified = sizes().filter(|size| *size > 1).sum();
            let num_left = sizes().map(|size| size * size).sum();
            Some(Division { num_unidentified, num_left, number, classes })
        })
    }

    /// Touches, summed over the members of a set, of the greedy tree.
    fn touches(&mut self, set: Set) -> usize {
        if let Some(known) = self.known.get(&set) {
            return *known;
        }
        let size = set.count_ones() as usize;
        let touches = match self.divisions(set).min() {
            Some(division) if size > 1 => self.touches_with(set, &division),
            _ => size * (size - 1),
        };
        self.known.insert(set, touches);
        touches
    }

    fn touches_with(&mut self, set: Set, division: &Division) -> usize {
        let below: usize = division.classes.iter().map(|class| self.touches(*class)).sum();
        set.count_ones() as usize + below
    }
}
