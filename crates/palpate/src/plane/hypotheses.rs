//! Interpretations of one model joined into hypotheses: one pose, up to the model's symmetry, satisfies both (DESIGN §1).

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc as Shared;

use rayon::prelude::*;

use super::arc::Arc;
use super::case::Case;
use super::cell::{Cell, Conditions};
use super::model::Symmetry;
use super::pose_set::{Piece, PoseSet};
use super::solve::{self, Solution};
use super::subdivide::{self, Bundle};
use super::tables::FeatureTables;
use crate::feature::Feature;
use crate::tree::{self, Counters};

/// Nodes of the interpretation tree after which pose cells are divided instead.
const MOST_NODES: u64 = 100_000;

/// Feasible assignments after which pose cells are divided instead.
const MOST_FEASIBLE: usize = 1_000;

/// All that one model has to say to the evidence.
#[derive(Debug)]
pub(crate) struct Explanations {
    /// The pose sets of its hypotheses.
    pub hypotheses: Vec<PoseSet>,
    pub counters: Counters,
    /// Boxes of poses examined where the tree was given up.
    pub num_boxes: u64,
    /// Nothing was left out.
    pub complete: bool,
}

/// A valid assignment and its poses.
struct Valid {
    assignment: Vec<Feature>,
    solution: Solution,
}

/// Every hypothesis of one model (thesis chapter 2, in its own order).
pub(crate) fn explain(case: Case, tables: &FeatureTables) -> Explanations {
    let mut counters = Counters::default();
    let feasible = interpretation_tree(&case, tables, &mut counters);
    let case = Shared::new(case);
    match feasible {
        Some(assignments) => {
            let pieces = join(&case, valid(&case, assignments), Vec::new());
            Explanations { hypotheses: pose_sets(&case, pieces), counters, num_boxes: 0, complete: true }
        }
        None => explain_by_cells(&case, tables, counters),
    }
}

/// The feasible assignments, or nothing if they are too many.
fn interpretation_tree(
    case: &Case,
    tables: &FeatureTables,
    counters: &mut Counters,
) -> Option<Vec<Vec<Feature>>> {
    let contacts = tables.contact_pairs(case);
    let mut feasible = Vec::new();
    let mut keep = |assignment: &[usize]| {
        if feasible.len() >= MOST_FEASIBLE {
            return ControlFlow::Break(());
        }
        let assignment = assignment.iter().map(|number| tables.feature(*number)).collect();
        if canonical(case, &assignment) {
            feasible.push(assignment);
        }
        ControlFlow::Continue(())
    };
    let outcome = tree::search(tables, &contacts, MOST_NODES, counters, &mut keep);
    feasible.sort_unstable();
    outcome.is_continue().then_some(feasible)
}

/// Of assignments that a symmetry takes into each other the first stands for all. With a prior each stands for
/// itself, as the prior may allow one and not the other.
fn canonical(case: &Case, assignment: &Vec<Feature>) -> bool {
    case.prior.is_some()
        || case.model.symmetries.iter().skip(1).all(|symmetry| *assignment <= symmetry.features(assignment))
}

/// Decides each assignment (MATH 2.1): its pose set, if it is not empty.
fn valid(case: &Case, assignments: Vec<Vec<Feature>>) -> Vec<Valid> {
    let decide = |assignment: Vec<Feature>| {
        let conditions = Conditions::new(case, assignment.iter().copied().enumerate())?;
        let solution = solve::solve(&conditions)?;
        Some(Valid { assignment, solution })
    };
    if assignments.len() < 32 {
        assignments.into_iter().filter_map(decide).collect()
    } else {
        assignments.into_par_iter().filter_map(decide).collect()
    }
}

/// Where assignments are too many for the tree.
fn explain_by_cells(case: &Shared<Case>, tables: &FeatureTables, counters: Counters) -> Explanations {
    let features = tables.features();
    let rotations = fundamental_rotations(case);
    let mut division = subdivide::subdivide(case, &features, rotations);
    let mut num_boxes = division.examined;
    let mut complete = division.complete;
    let mut dense = Vec::new();
    let mut small = f64::INFINITY;
    // Boxes without a witness that touch none with one are divided on, down to τ.
    loop {
        dense.append(&mut division.dense);
        let (attached, alone) = separate(case, dense);
        dense = attached;
        small = small.min(case.data.iter().map(|datum| datum.bound).fold(f64::INFINITY, f64::min)) / 8.0;
        if alone.is_empty() {
            break;
        }
        for bundle in alone {
            if small < 0.25 * case.length_tolerance {
                dense.push(bundle.settled());
                continue;
            }
            let finer = subdivide::divide(case, bundle.cell, &bundle.features, small);
            num_boxes += finer.examined;
            complete &= finer.complete;
            division.sparse.extend(finer.sparse);
            division.dense.extend(finer.dense);
        }
    }
    let assignments: BTreeSet<Vec<Feature>> =
        division.sparse.iter().flat_map(|bundle| bundle.assignments(usize::MAX)).collect();
    let stands_for_itself = case.prior.is_some();
    let assignments = assignments
        .into_iter()
        .map(|assignment| if stands_for_itself { assignment } else { case.model.representative(assignment) });
    let assignments: BTreeSet<Vec<Feature>> = assignments.collect();
    let pieces = join(case, valid(case, assignments.into_iter().collect()), dense);
    Explanations { hypotheses: pose_sets(case, pieces), counters, num_boxes, complete }
}

/// One turn, or, without a prior, the part of it that the model's symmetries repeat.
fn fundamental_rotations(case: &Case) -> Arc {
    match case.prior {
        Some(prior) => {
            Arc::around(prior.world_from_model.angle(), prior.rotation).widen(case.angle_tolerance)
        }
        None => Arc { start: 0.0, width: std::f64::consts::TAU / case.model.symmetries.len() as f64 }
            .widen(case.angle_tolerance),
    }
}

/// Bundles in a group that has a witness, and the others.
fn separate(case: &Case, bundles: Vec<Bundle>) -> (Vec<Bundle>, Vec<Bundle>) {
    let mut groups = Groups::new(bundles.len());
    join_bundles(case, &bundles, &mut groups);
    let mut witnessed = BTreeSet::new();
    for (k, bundle) in bundles.iter().enumerate() {
        if bundle.witness.is_some() {
            witnessed.insert(groups.root(k));
        }
    }
    let (mut attached, mut alone) = (Vec::new(), Vec::new());
    for (k, bundle) in bundles.into_iter().enumerate() {
        if witnessed.contains(&groups.root(k)) { attached.push(bundle) } else { alone.push(bundle) }
    }
    (attached, alone)
}

/// Pieces of each hypothesis, in the order of their first piece.
fn join(case: &Case, valid: Vec<Valid>, bundles: Vec<Bundle>) -> Vec<Vec<Piece>> {
    let mut groups = Groups::new(valid.len() + bundles.len());
    // symmetry[k]: the one that takes valid[k] to where it meets the first of its group.
    join_valid(case, &valid, &mut groups);
    let first_bundle = valid.len();
    let mut bundle_groups = Groups::new(bundles.len());
    join_bundles(case, &bundles, &mut bundle_groups);
    for k in 0..bundles.len() {
        groups.unite(first_bundle + bundle_groups.root(k), first_bundle + k);
    }
    for (v, one) in valid.iter().enumerate() {
        let single: Vec<Vec<Feature>> = one.assignment.iter().map(|feature| vec![*feature]).collect();
        for (b, bundle) in bundles.iter().enumerate() {
            let near = |symmetry: &Symmetry| {
                let moved: Vec<Vec<Feature>> =
                    single.iter().map(|feature| symmetry.features(feature)).collect();
                bundle.compatible(&moved)
                    && one.solution.cells.iter().any(|cell| {
                        bundle.cell.meets(cell, symmetry.motion, case.length_tolerance, case.angle_tolerance)
                    })
            };
            if groups.root(v) != groups.root(first_bundle + b) && case.model.symmetries.iter().any(near) {
                groups.unite(v, first_bundle + b);
            }
        }
    }
    let pieces = valid.into_iter().map(|one| Piece {
        features: one.assignment.into_iter().map(|feature| vec![feature]).collect(),
        cells: one.solution.cells,
        witness: Some(one.solution.witness),
        bounded: false,
    });
    let dense = bundles.into_iter().map(|bundle| Piece {
        features: bundle.features,
        cells: vec![bundle.cell],
        witness: bundle.witness,
        bounded: true,
    });
    groups.collect(pieces.chain(dense))
}

/// Two assignments are joined iff a pose satisfies both: decided exactly, as any other conjunction.
fn join_valid(case: &Case, valid: &[Valid], groups: &mut Groups) {
    let (length, angle) = (case.length_tolerance, case.angle_tolerance);
    for (k, one) in valid.iter().enumerate() {
        for (j, other) in valid[..k].iter().enumerate() {
            for symmetry in &case.model.symmetries {
                if groups.root(j) == groups.root(k) {
                    break;
                }
                let near =
                    other.solution.cells.iter().any(|a| {
                        one.solution.cells.iter().any(|b| a.meets(b, symmetry.motion, length, angle))
                    });
                if !near {
                    continue;
                }
                let image = symmetry.features(&one.assignment);
                let pairs = other.assignment.iter().zip(&image).enumerate().flat_map(|(contact, (a, b))| {
                    let second = (a != b).then_some((contact, *b));
                    std::iter::once((contact, *a)).chain(second)
                });
                if Conditions::new(case, pairs).is_some_and(|both| solve::witness(&both).is_some()) {
                    groups.unite(j, k);
                }
            }
        }
    }
}

/// Two bundles are joined if their boxes touch and they may share an assignment.
fn join_bundles(case: &Case, bundles: &[Bundle], groups: &mut Groups) {
    let (length, angle) = (case.length_tolerance, case.angle_tolerance);
    let mut order: Vec<usize> = (0..bundles.len()).collect();
    let start = |k: &usize| bundles[*k].cell.mid - bundles[*k].cell.half;
    order.sort_by(|a, b| start(a).total_cmp(&start(b)));
    // Itself, and over the seam of the fundamental rotations.
    for symmetry in case.model.symmetries.iter().take(2) {
        let seam = symmetry.motion.angle() != 0.0 || case.model.symmetries.len() == 1;
        for (at, &k) in order.iter().enumerate() {
            let cell: &Cell = &bundles[k].cell;
            for &j in &order[at + 1..] {
                if !seam && start(&j) > cell.mid + cell.half + angle {
                    break;
                }
                if groups.root(j) == groups.root(k) {
                    continue;
                }
                let touches = cell.meets(&bundles[j].cell, symmetry.motion, length, angle);
                let image: Vec<Vec<Feature>> =
                    bundles[j].features.iter().map(|f| sorted(symmetry.features(f))).collect();
                if touches && bundles[k].compatible(&image) {
                    groups.unite(j, k);
                }
            }
        }
    }
}

fn sorted(mut features: Vec<Feature>) -> Vec<Feature> {
    features.sort_unstable();
    features
}

fn pose_sets(case: &Shared<Case>, groups: Vec<Vec<Piece>>) -> Vec<PoseSet> {
    groups.into_iter().map(|pieces| PoseSet::new(Shared::clone(case), pieces, true)).collect()
}

/// Sets of numbers that are united step by step.
struct Groups {
    parents: Vec<usize>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self { parents: (0..count).collect() }
    }

    /// The least member of the group.
    fn root(&mut self, mut member: usize) -> usize {
        while self.parents[member] != member {
            self.parents[member] = self.parents[self.parents[member]];
            member = self.parents[member];
        }
        member
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b);
    }

    /// The members of each group, groups in the order of their least member.
    fn collect<T>(mut self, members: impl Iterator<Item = T>) -> Vec<Vec<T>> {
        let mut places = vec![usize::MAX; self.parents.len()];
        let mut collected: Vec<Vec<T>> = Vec::new();
        for (k, member) in members.enumerate() {
            let root = self.root(k);
            if root == k {
                places[k] = collected.len();
                collected.push(Vec::new());
            }
            collected[places[root]].push(member);
        }
        collected
    }
}
