//! A tree grows from its root, the most ambiguous node first (thesis 3.4).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Answers, Branch, Node, Status};
use crate::best::{Aim, Best};
use crate::dimension::Dimension;
use crate::path::Path;
use crate::plan::{Plan, PlanSettings, plan_with};

/// A tree, and what was learned on the way.
pub(super) struct Grown<V: Dimension> {
    pub nodes: Vec<Node<V>>,
    /// No first path has branches of a smaller mean size (`Aim::Branches` over n).
    pub bound: f64,
    /// The most classes of any path that was found; `None`: of those in the tree.
    pub max_outcomes: Option<usize>,
}

/// How to go on from a node.
pub(super) struct Choice<V: Dimension> {
    pub path: Option<Path<V>>,
    pub status: Status,
}

impl<V: Dimension> Choice<V> {
    pub fn unexpanded() -> Self {
        Self { path: None, status: Status::Unexpanded }
    }

    /// The planner's path, if it divides, or why there is none.
    fn of_plan(plan: Plan<V>) -> Self {
        let status = match &plan.path {
            Some(path) if path.classes.len() > 1 => return Self { path: plan.path, status: Status::Divided },
            _ if !plan.proved => Status::Effort,
            Some(_) => Status::Inseparable,
            None => Status::NoUsablePath,
        };
        Self { path: None, status }
    }
}

/// What the planner finds, and the mean size of branches that no path is below, as far as it was proved.
pub(super) fn planned<V: Dimension>(
    mut best: Best<'_, V>,
    settings: &PlanSettings<V>,
    late: &dyn Fn() -> bool,
) -> (Choice<V>, f64) {
    best.aim = Aim::Branches;
    let plan = plan_with(best, settings, late);
    let bound = plan.bound;
    (Choice::of_plan(plan), bound)
}

/// The tree whose paths are chosen by `choose`, which is asked at most `max_nodes` times.
pub(super) fn grow<V: Dimension>(
    everyone: Vec<usize>,
    max_nodes: usize,
    choose: &mut dyn FnMut(&[usize]) -> Choice<V>,
) -> Vec<Node<V>> {
    let mut nodes = vec![Node::new(everyone, 0)];
    let mut open = BinaryHeap::from([(nodes[0].members.len(), Reverse(0))]);
    let mut num_planned = 0;
    while let Some((size, Reverse(number))) = open.pop() {
        // The largest comes first: all that follow are solved.
        if size < 2 || num_planned >= max_nodes {
            break;
        }
        num_planned += 1;
        let Choice { path, status } = choose(&nodes[number].members);
        let classes = path.as_ref().map(|path| branches(path, &nodes[number].members)).unwrap_or_default();
        nodes[number].path = path;
        nodes[number].status = status;
        for mut branch in classes {
            if branch.answers != Answers::Unexpected {
                branch.node = Some(nodes.len());
                open.push((branch.members.len(), Reverse(nodes.len())));
                nodes.push(Node::new(branch.members.clone(), nodes[number].level + 1));
            }
            nodes[number].branches.push(branch);
        }
    }
    nodes
}

impl<V: Dimension> Node<V> {
    fn new(members: Vec<usize>, level: usize) -> Self {
        let status = if members.len() > 1 { Status::Unexpanded } else { Status::Solved };
        Self { members, level, path: None, branches: Vec::new(), status }
    }
}

/// The classes of a path among the members, and the unexpected.
fn branches<V: Dimension>(path: &Path<V>, members: &[usize]) -> Vec<Branch> {
    let of_class = |class: &Vec<usize>| {
        let contact = class.iter().any(|place| !path.outcomes[*place].touches.is_empty());
        let miss = class.iter().any(|place| path.outcomes[*place].may_miss);
        let answers = match (contact, miss) {
            (true, true) => Answers::Either,
            (false, true) => Answers::NoContact,
            _ => Answers::Contact,
        };
        Branch { answers, members: class.iter().map(|place| members[*place]).collect(), node: None }
    };
    let unexpected = Branch { answers: Answers::Unexpected, members: Vec::new(), node: None };
    path.classes.iter().map(of_class).chain([unexpected]).collect()
}
