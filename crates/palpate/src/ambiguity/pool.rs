//! The lines that a planner has judged, kept by what they tell (MATH 2.4).

use std::collections::{BTreeMap, BTreeSet};

use super::Status;
use super::grow::{Choice, planned};
use super::relation::{Relation, Set, bit, members};
use crate::best::Best;
use crate::dimension::Dimension;
use crate::judge::Outcome;
use crate::line::Line;
use crate::path::judged;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Lines that tell the same; of each relation so many are kept, those that the planner offered first.
const KEPT_OF_A_KIND: usize = 4;

/// Lines, by what they tell of all hypotheses, and what the planner said of some sets.
pub(super) struct Pool<'a, V: Dimension> {
    scene: &'a Scene<V>,
    settings: &'a PlanSettings<V>,
    late: &'a dyn Fn() -> bool,
    everyone: Vec<usize>,
    lines: Lines<V>,
    planned: BTreeMap<Set, (Status, f64)>,
    /// Sets for which the planner was asked to look at more than it needs.
    thorough: BTreeSet<Set>,
}

struct Lines<V> {
    of_relation: BTreeMap<Relation, Vec<Line<V>>>,
    undominated: Vec<Relation>,
}

impl<'a, V: Dimension> Pool<'a, V> {
    /// An empty one.
    pub fn new(scene: &'a Scene<V>, settings: &'a PlanSettings<V>, late: &'a dyn Fn() -> bool) -> Self {
        let everyone = scene.everyone();
        let lines = Lines { of_relation: BTreeMap::new(), undominated: Vec::new() };
        let (planned, thorough) = (BTreeMap::new(), BTreeSet::new());
        Self { scene, settings, late, everyone, lines, planned, thorough }
    }

    /// Plans among the members, as without a pool; every line that the planner judges is kept.
    pub fn plan(&mut self, members: &[usize]) -> Choice<V> {
        if (self.late)() {
            return Choice::unexpanded();
        }
        let (choice, bound) = self.ask(members, self.settings, false);
        self.planned.insert(set_of(members), (choice.status, bound));
        choice
    }

    /// Looks for all that may tell something of a set, unless that was done, or it was proved that nothing does. Returns
    /// whether it was done now.
    pub fn explore(&mut self, set: Set) -> bool {
        let proved =
            |(status, _): &(Status, f64)| matches!(status, Status::Inseparable | Status::NoUsablePath);
        if (self.late)() || self.planned.get(&set).is_some_and(proved) || !self.thorough.insert(set) {
            return false;
        }
        let members: Vec<usize> = members(set).collect();
        if self.planned.contains_key(&set) {
            // What is only found with effort is known already.
            self.ask(&members, &PlanSettings { effort: 0, ..self.settings.clone() }, true);
        } else {
            let (choice, bound) = self.ask(&members, self.settings, true);
            self.planned.insert(set, (choice.status, bound));
        }
        true
    }

    fn ask(&mut self, members: &[usize], settings: &PlanSettings<V>, thorough: bool) -> (Choice<V>, f64) {
        let (scene, everyone, lines) = (self.scene, &self.everyone, &mut self.lines);
        let mut keep = |line: &Line<V>| lines.add(relation(scene, everyone, line), line);
        let mut best = Best::new(scene, members);
        best.listener = Some(&mut keep);
        best.thorough = thorough;
        planned(best, settings, self.late)
    }

    /// The mean size of branches that no path among a set is below, as far as it was proved.
    pub fn bound(&self, set: Set) -> f64 {
        self.planned.get(&set).map_or(1.0, |(_, bound)| *bound)
    }

    /// What is told, but for what is dominated.
    pub fn relations(&self) -> &[Relation] {
        &self.lines.undominated
    }

    /// The best path that tells what the relation says; without one, what the planner said.
    pub fn choice(&self, relation: Option<&Relation>, members: &[usize]) -> Choice<V> {
        let Some(relation) = relation else {
            let status = self.planned.get(&set_of(members)).map_or(Status::Unexpanded, |(status, _)| *status);
            return Choice { path: None, status };
        };
        let lines = self.lines.of_relation.get(relation).into_iter().flatten();
        let paths = lines.map(|line| judged(self.scene, members, line, None));
        Choice { path: paths.min_by(|a, b| a.order(b, self.scene.margin)), status: Status::Divided }
    }
}

impl<V: Dimension> Lines<V> {
    fn add(&mut self, relation: Relation, line: &Line<V>) {
        if let Some(kept) = self.of_relation.get_mut(&relation) {
            if kept.len() < KEPT_OF_A_KIND {
                kept.push(*line);
            }
            return;
        }
        if !self.undominated.iter().any(|other| other.dominates(&relation)) {
            self.undominated.retain(|other| !relation.dominates(other));
            self.undominated.push(relation.clone());
        }
        self.of_relation.insert(relation, vec![*line]);
    }
}

/// What a line tells of everyone.
fn relation<V: Dimension>(scene: &Scene<V>, everyone: &[usize], line: &Line<V>) -> Relation {
    let outcomes: Vec<Outcome<V>> =
        everyone.iter().map(|member| scene.outcome(line, *member, 0.0, f64::INFINITY)).collect();
    let with = |test: &dyn Fn(usize) -> bool| (0..outcomes.len()).filter(|k| test(*k)).map(bit).sum::<Set>();
    let faults = with(&|k| outcomes[k].fault.is_some());
    let left =
        (0..outcomes.len()).map(|k| with(&|j| j != k && !outcomes[j].separated(&outcomes[k], &scene.sensor)));
    Relation::new(faults, &left.collect::<Vec<_>>())
}

/// Hypotheses as bits.
pub(super) fn set_of(members: &[usize]) -> Set {
    members.iter().map(|member| bit(*member)).sum()
}
