//! How good a tree is (MATH 2.4).

use super::grow::Grown;
use super::{AmbiguityTree, Node, Status, TreeMethod};
use crate::dimension::Dimension;

impl<V: Dimension> AmbiguityTree<V> {
    pub(super) fn new(names: Vec<String>, method: TreeMethod, found: Grown<V>) -> Self {
        let Grown { nodes, bound, max_outcomes } = found;
        let n = nodes[0].members.len();
        let (total, worst_touches) = total_touches(&nodes);
        let own = nodes.iter().map(|node| node.branches.len().saturating_sub(1)).max().unwrap_or(0);
        let max_outcomes = max_outcomes.unwrap_or(0).max(own).max(2);
        let mut identified = vec![0; 1 + nodes.iter().map(|node| node.level).max().unwrap_or(0)];
        nodes
            .iter()
            .filter(|node| node.status == Status::Solved)
            .for_each(|leaf| identified[leaf.level] += 1);
        let expected_touches = total as f64 / n as f64;
        let lower_bound = lower_bound(&nodes[0], bound).min(expected_touches);
        Self {
            expected_touches,
            worst_touches,
            max_outcomes,
            entropy_bound: (n as f64).log2() / (max_outcomes as f64).log2(),
            worst_bound: worst_bound(n, max_outcomes),
            lower_bound,
            identified,
            nodes,
            names,
            method,
        }
    }
}

/// Touches summed over the hypotheses, and in the worst case.
pub(super) fn total_touches<V: Dimension>(nodes: &[Node<V>]) -> (usize, usize) {
    let leaves = || nodes.iter().filter(|node| node.branches.is_empty());
    let total = leaves().map(|leaf| leaf.members.len() * leaf.touches()).sum();
    (total, leaves().map(Node::touches).max().unwrap_or(0))
}

impl<V: Dimension> Node<V> {
    /// Until a hypothesis of this leaf is identified.
    fn touches(&self) -> usize {
        self.level + self.members.len() - 1
    }
}

/// `⌈log_b n⌉`, exact.
fn worst_bound(n: usize, b: usize) -> usize {
    let (mut touches, mut reached) = (0, 1_usize);
    while reached < n {
        touches += 1;
        reached = reached.saturating_mul(b);
    }
    touches
}

/// Expected touches of any tree whose first path has branches of this mean size at least (`Aim::Branches` over n).
///
/// If it leaves u hypotheses in classes of more than one, its classes hold at most `u² + n − u` pairs, so that
/// `u² + n − u ≥ n·bound`, and u is not 1; each of these u needs another touch at least. Half a pair is granted to rounding.
fn lower_bound<V: Dimension>(root: &Node<V>, bound: f64) -> f64 {
    let n = root.members.len();
    match root.status {
        Status::Solved => 0.0,
        Status::Inseparable | Status::NoUsablePath => (n - 1) as f64,
        _ => {
            let enough = |u: &usize| (u * u + n - u) as f64 > n as f64 * bound - 0.5;
            let unidentified = (0..n).filter(|u| *u != 1).find(enough).unwrap_or(n);
            (n + unidentified) as f64 / n as f64
        }
    }
}
