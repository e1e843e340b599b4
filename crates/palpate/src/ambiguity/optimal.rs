//! The best tree over all lines that a planner looks at (MATH 2.4).

use std::collections::BTreeMap;

use super::Status;
use super::grow::{Choice, Grown, grow, planned};
use super::relation::{Optimum, Relation, Set, bit, members};
use crate::judge::Outcome;
use crate::plan::{Path, PlanSettings, judged};
use crate::plane::{Line, Scene};

/// Lines that tell the same; of each relation so many are kept, those that the planner offered first.
const KEPT_OF_A_KIND: usize = 4;

/// Lines, by what they tell of all hypotheses.
struct Pool<'a> {
    scene: &'a Scene,
    everyone: Vec<usize>,
    lines: BTreeMap<Relation, Vec<Line>>,
    /// Sets that were planned for: what the planner said, and pairs that any path leaves at least.
    planned: BTreeMap<Set, (Status, usize)>,
}

/// The tree of fewest expected touches. Sets that it meets are planned for until it meets no new one.
pub(super) fn plan(
    scene: &Scene,
    settings: &PlanSettings,
    max_nodes: usize,
    late: &dyn Fn() -> bool,
) -> Grown {
    let everyone = scene.everyone();
    let root = set_of(&everyone);
    let mut pool =
        Pool { scene, everyone: everyone.clone(), lines: BTreeMap::new(), planned: BTreeMap::new() };
    // The greedy tree first, so that the best is never worse.
    grow(everyone.clone(), max_nodes, &mut |members| pool.plan(members, settings, late));
    let relations = loop {
        let relations = pool.relations();
        let new: Vec<Set> = Optimum::new(everyone.len(), &relations)
            .subsets(root)
            .into_iter()
            .filter(|subset| subset.count_ones() > 1 && !pool.planned.contains_key(subset))
            .collect();
        if new.is_empty() || late() || pool.planned.len() >= max_nodes {
            break relations;
        }
        for subset in new {
            pool.plan(&members(subset).collect::<Vec<_>>(), settings, late);
        }
    };
    let mut optimum = Optimum::new(everyone.len(), &relations);
    let nodes = grow(everyone, max_nodes, &mut |members| {
        let subset = set_of(members);
        match optimum.value(subset).relation {
            Some(number) => Choice { path: pool.path(&relations[number], members), status: Status::Divided },
            None => Choice {
                path: None,
                status: pool.planned.get(&subset).map_or(Status::Unexpanded, |one| one.0),
            },
        }
    });
    let num_left = pool.planned.get(&root).map_or(0, |one| one.1);
    let max_outcomes = relations.iter().map(Relation::most_outcomes).max();
    Grown { nodes, num_left, max_outcomes }
}

impl Pool<'_> {
    /// Plans among the members; every line that the planner has judged is kept.
    fn plan(&mut self, members: &[usize], settings: &PlanSettings, late: &dyn Fn() -> bool) -> Choice {
        if late() {
            return Choice::unexpanded();
        }
        let Self { scene, everyone, lines, .. } = self;
        let mut keep = |line: &Line| {
            let kept = lines.entry(relation(scene, everyone, line)).or_default();
            if kept.len() < KEPT_OF_A_KIND {
                kept.push(*line);
            }
        };
        let (choice, num_left) = planned(scene, members, settings, late, Some(&mut keep));
        self.planned.insert(set_of(members), (choice.status, num_left));
        choice
    }

    /// Those that no other dominates.
    fn relations(&self) -> Vec<Relation> {
        let mut undominated: Vec<Relation> = Vec::new();
        for relation in self.lines.keys() {
            if !undominated.iter().any(|other| other.dominates(relation)) {
                undominated.retain(|other| !relation.dominates(other));
                undominated.push(relation.clone());
            }
        }
        undominated
    }

    /// The best path that tells what the relation says.
    fn path(&self, relation: &Relation, members: &[usize]) -> Option<Path> {
        let paths = self.lines[relation].iter().map(|line| judged(self.scene, members, line, None));
        paths.min_by(|a, b| a.order(b, self.scene.margin))
    }
}

/// What a line tells of everyone.
fn relation(scene: &Scene, everyone: &[usize], line: &Line) -> Relation {
    let outcomes: Vec<Outcome> = everyone
        .iter()
        .flat_map(|member| match scene.outcomes(line, &[*member], 0.0) {
            Ok(outcomes) | Err(outcomes) => outcomes,
        })
        .collect();
    let with = |test: &dyn Fn(usize) -> bool| (0..outcomes.len()).filter(|k| test(*k)).map(bit).sum::<Set>();
    let faults = with(&|k| outcomes[k].fault.is_some());
    let left =
        (0..outcomes.len()).map(|k| with(&|j| j != k && !outcomes[j].separated(&outcomes[k], &scene.sensor)));
    Relation::new(faults, &left.collect::<Vec<_>>())
}

fn set_of(members: &[usize]) -> Set {
    members.iter().map(|member| bit(*member)).sum()
}
