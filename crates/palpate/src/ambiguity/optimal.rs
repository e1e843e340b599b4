//! The best tree over all lines that a planner looks at (MATH 2.4).

use super::grow::{Grown, grow};
use super::pool::{Pool, set_of};
use super::relation::{Optimum, Relation, Set};
use crate::dimension::Dimension;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// The tree of fewest expected touches. Sets that it meets are planned for until it meets no new one.
pub(super) fn plan<V: Dimension>(
    scene: &Scene<V>,
    settings: &PlanSettings<V>,
    max_nodes: usize,
    late: &dyn Fn() -> bool,
) -> Grown<V> {
    let everyone = scene.everyone();
    let (n, root) = (everyone.len(), set_of(&everyone));
    let mut pool = Pool::new(scene, settings, late);
    // The greedy tree first, so that the best is never worse.
    grow(everyone.clone(), max_nodes, &mut |members| pool.plan(members));
    while explored(&mut pool, n, root) {}
    let mut optimum = Optimum::new(n, pool.relations());
    let nodes = grow(everyone, max_nodes, &mut |members| {
        let best = optimum.value(set_of(members)).relation;
        pool.choice(best.map(|number| &pool.relations()[number]), members)
    });
    let max_outcomes = pool.relations().iter().map(Relation::most_outcomes).max();
    Grown { nodes, bound: pool.bound(root), max_outcomes }
}

/// Explores the sets that the best tree meets, unless one touch identifies each of their members. Returns whether any is new.
fn explored<V: Dimension>(pool: &mut Pool<'_, V>, n: usize, root: Set) -> bool {
    let mut optimum = Optimum::new(n, pool.relations());
    let mut subsets = optimum.subsets(root);
    subsets.retain(|subset| {
        let value = optimum.value(*subset);
        subset.count_ones() > 1 && (value.worst > 1 || value.relation.is_none())
    });
    subsets.into_iter().fold(false, |any, subset| pool.explore(subset) | any)
}
