//! The ambiguity tree: the next path, whatever the last one met (thesis 3.4, 4.1; MATH 2.4).
//!
//! Its nodes are sets of hypotheses with a path, its branches are the classes of that path, its leaves are hypotheses that
//! are identified, or sets that no path divides. Pose sets are not shrunk within the tree, as the loop shrinks them after
//! each touch, so that the tree is an upper bound on what the loop needs.

mod ahead;
mod grow;
mod metrics;
mod optimal;
mod pool;
mod relation;
mod text;
mod verify;

use glam::DVec2;

use crate::Error;
use crate::best::Best;
use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::path::Path;
use crate::plan::{PlanSettings, check};
use crate::scene::Scene;
use crate::sensor::Sensor;

pub use relation::{MOST_HYPOTHESES, Optimum, Relation, Set, Value};
pub use verify::{Verification, verification_along, verification_path, verification_until};

/// How paths are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TreeMethod {
    /// At each node the path whose branches are smallest, in the mean over hypotheses.
    #[default]
    Greedy,
    /// At each node the path with which the fewest touches are expected, if greedy ones follow it; never more than the greedy
    /// tree. For up to 128 hypotheses; above that it is the greedy one.
    Ahead,
    /// Of all trees over the paths that were found, the one with the fewest expected touches, and of these the one with the
    /// fewest in the worst case. For up to [`MOST_HYPOTHESES`]; above that it looks ahead.
    Optimal,
}

/// How to build a tree. The defaults are stated here and nowhere else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TreeSettings {
    /// How paths are chosen.
    pub method: TreeMethod,
    /// So many nodes are given a path at most; the most ambiguous come first, the rest are left unexpanded.
    pub max_nodes: usize,
}

impl Default for TreeSettings {
    fn default() -> Self {
        Self { method: TreeMethod::default(), max_nodes: usize::MAX }
    }
}

/// What becomes of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// One hypothesis is left.
    Solved,
    /// Its path divides it.
    Divided,
    /// Proved: there are usable paths, but none of margin ≥ m divides it.
    Inseparable,
    /// Proved: no path of margin ≥ m can be used.
    NoUsablePath,
    /// The search was cut short before one was found.
    Effort,
    /// Not planned for: the tree was to be no larger, or time was up.
    Unexpanded,
}

/// Which answers of a path lead to a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answers {
    /// Only contacts.
    Contact,
    /// Only a miss.
    NoContact,
    /// A miss, and some contacts.
    Either,
    /// Whatever fits no hypothesis of the node: recognize again (thesis 3.4).
    Unexpected,
}

/// A class of a path, or the unexpected.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Which answers lead here.
    pub answers: Answers,
    /// The class, in order; empty for the unexpected.
    pub members: Vec<usize>,
    /// Where it leads, as a place in [`AmbiguityTree::nodes`]; `None` for the unexpected.
    pub node: Option<usize>,
}

/// Hypotheses that are left after some touches, and how to go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Node<V: Dimension = DVec2> {
    /// Numbers of the hypotheses, in order.
    pub members: Vec<usize>,
    /// Touches before.
    pub level: usize,
    /// How to go on. Its numbers are places in `members`.
    pub path: Option<Path<V>>,
    /// The classes of the path, in order of their first members, and the unexpected; empty without a path.
    pub branches: Vec<Branch>,
    /// What becomes of it.
    pub status: Status,
}

/// Which path to take, whatever the paths before have met.
///
/// The figures take all hypotheses as equally likely; a leaf of s hypotheses that is not solved counts s − 1 further
/// touches.
#[derive(Debug, Clone, PartialEq)]
pub struct AmbiguityTree<V: Dimension = DVec2> {
    /// The root first; then in the order in which their branches were made.
    pub nodes: Vec<Node<V>>,
    /// Names of the hypotheses' models.
    pub names: Vec<String>,
    /// How the paths were in fact chosen.
    pub method: TreeMethod,
    /// The mean over hypotheses of the touches until they are identified.
    pub expected_touches: f64,
    /// The most touches until a hypothesis is identified.
    pub worst_touches: usize,
    /// b, at least 2: the most classes that a path has; of a greedy tree those of its own paths at their nodes, of an
    /// optimal one those of all paths that were found, in any set of hypotheses.
    pub max_outcomes: usize,
    /// `log2 n / log2 b`: no tree whose paths have at most b classes has fewer expected touches.
    pub entropy_bound: f64,
    /// `⌈log_b n⌉`: nor fewer touches in the worst case.
    pub worst_bound: usize,
    /// No tree at all whose paths are usable, with margin ≥ m, has fewer expected touches, as far as the planner proved it.
    /// The gap of this tree to the best is at most `expected_touches − lower_bound`.
    pub lower_bound: f64,
    /// `identified[k]`: hypotheses that are identified after k touches.
    pub identified: Vec<usize>,
}

impl<V: Dimension> AmbiguityTree<V> {
    /// All hypotheses, and the first path.
    #[must_use]
    pub fn root(&self) -> &Node<V> {
        &self.nodes[0]
    }

    /// The number of nodes, leaves included.
    #[must_use]
    pub fn num_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// The most paths on the way to a leaf.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.nodes.iter().map(|node| node.level).max().unwrap_or(0)
    }

    /// Whether every leaf is a single hypothesis.
    #[must_use]
    pub fn solved(&self) -> bool {
        self.nodes.iter().all(|node| matches!(node.status, Status::Solved | Status::Divided))
    }
}

/// The ambiguity tree of the hypotheses.
///
/// # Errors
/// As [`crate::plan()`].
pub fn plan_tree<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    settings: &PlanSettings<V>,
    tree_settings: &TreeSettings,
) -> Result<AmbiguityTree<V>, Error> {
    plan_tree_until(hypotheses, sensor, settings, tree_settings, &|| false)
}

/// The ambiguity tree, as far as it is known when `late` says that time is up.
///
/// # Errors
/// As [`crate::plan()`].
pub fn plan_tree_until<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    sensor: &Sensor,
    settings: &PlanSettings<V>,
    tree_settings: &TreeSettings,
    late: &dyn Fn() -> bool,
) -> Result<AmbiguityTree<V>, Error> {
    check(hypotheses, sensor, settings)?;
    let scene = Scene::new(hypotheses, sensor, settings);
    let names = hypotheses.iter().map(|one| V::name(&one.model).to_owned()).collect();
    let max_nodes = tree_settings.max_nodes;
    let n = hypotheses.len();
    let method = match tree_settings.method {
        TreeMethod::Optimal if n <= MOST_HYPOTHESES => TreeMethod::Optimal,
        TreeMethod::Ahead | TreeMethod::Optimal if n <= Set::BITS as usize => TreeMethod::Ahead,
        _ => TreeMethod::Greedy,
    };
    let found = match method {
        TreeMethod::Greedy => greedy(&scene, settings, max_nodes, late),
        TreeMethod::Ahead => ahead::plan(&scene, settings, max_nodes, late),
        TreeMethod::Optimal => optimal::plan(&scene, settings, max_nodes, late),
    };
    Ok(AmbiguityTree::new(names, method, found))
}

/// At each node what the planner says is best.
fn greedy<V: Dimension>(
    scene: &Scene<V>,
    settings: &PlanSettings<V>,
    max_nodes: usize,
    late: &dyn Fn() -> bool,
) -> grow::Grown<V> {
    let mut first = None;
    let nodes = grow::grow(scene.everyone(), max_nodes, &mut |members| {
        if late() {
            return grow::Choice::unexpanded();
        }
        let (choice, bound) = grow::planned(Best::new(scene, members), settings, late);
        first = first.or(Some(bound));
        choice
    });
    grow::Grown { nodes, bound: first.unwrap_or(1.0), max_outcomes: None }
}
