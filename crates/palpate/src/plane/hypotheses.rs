//! Interpretations of one model joined into hypotheses: one pose, up to the model's symmetry, satisfies both (DESIGN §1).

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc as Shared;

use rayon::prelude::*;

use super::arc::{Arc, wrap};
use super::case::Case;
use super::cell::Conditions;
use super::model::Symmetry;
use super::pose::Pose;
use super::pose_set::{Piece, PoseSet};
use super::solve::{self, Solution};
use super::subdivide::{self, Bundle};
use super::tables::FeatureTables;
use crate::feature::Feature;
use crate::groups::Groups;
use crate::recognize::Explanations;
use crate::tree::{self, Counters};

/// Nodes of the interpretation tree after which pose cells are divided instead.
const MOST_NODES: u64 = 100_000;

/// Feasible assignments after which pose cells are divided instead.
const MOST_FEASIBLE: usize = 256;

/// A valid assignment and its poses.
struct Valid {
    assignment: Vec<Feature>,
    solution: Solution,
}

/// Every hypothesis of one model (thesis chapter 2, in its own order).
pub(crate) fn explain(case: Case, tables: &FeatureTables) -> Explanations {
    if !case.consistent() {
        return Explanations::nothing();
    }
    let mut counters = Counters::default();
    let feasible = interpretation_tree(&case, tables, &mut counters);
    let case = Shared::new(case);
    match feasible {
        Some(assignments) => {
            let hypotheses = pose_sets(&case, join(&case, valid(&case, assignments), Vec::new()));
            let stopped_by = hypotheses.iter().filter_map(PoseSet::undecided).min();
            Explanations { hypotheses, counters, num_boxes: 0, stopped_by }
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
    let outcome = tree::search(tables, &contacts, MOST_NODES, case.halt(), counters, &mut keep);
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
    let division = subdivide::subdivide(case, &features, rotations);
    let dense = witnessed(case, division.dense);
    let assignments: BTreeSet<Vec<Feature>> = division.sparse.iter().flat_map(Bundle::assignments).collect();
    let stands_for_itself = case.prior.is_some();
    let assignments = assignments
        .into_iter()
        .map(|assignment| if stands_for_itself { assignment } else { case.model.representative(assignment) });
    let assignments: BTreeSet<Vec<Feature>> = assignments.collect();
    let hypotheses = pose_sets(case, join(case, valid(case, assignments.into_iter().collect()), dense));
    let undecided = hypotheses.iter().filter_map(PoseSet::undecided);
    let stopped_by = undecided.chain(division.stopped_by).min();
    Explanations { hypotheses, counters, num_boxes: division.examined, stopped_by }
}

/// One turn, or, without a prior, the part of it that the model's symmetries repeat.
fn fundamental_rotations(case: &Case) -> Arc {
    match case.prior {
        Some(prior) => {
            Arc::around(prior.world_from_model.angle(), prior.rotation).widen(case.angle_tolerance)
        }
        None => {
            Arc { start: 0.0, width: TAU / case.model.symmetries.len() as f64 }.widen(case.angle_tolerance)
        }
    }
}

/// Bundles in groups that have a witness. Groups without one are searched for it, and left out if there is none.
fn witnessed(case: &Case, bundles: Vec<Bundle>) -> Vec<Bundle> {
    let mut groups = Groups::new(bundles.len());
    join_bundles(case, &bundles, &mut groups);
    let mut kept = Vec::new();
    for mut group in groups.collect(bundles.into_iter()) {
        if group.iter().all(|bundle| bundle.witness.is_none()) {
            let Some(found) = subdivide::seek(case, &group) else { continue };
            group.push(found);
        }
        kept.append(&mut group);
    }
    kept
}

/// Pieces of each hypothesis, in the order of their first piece.
fn join(case: &Case, valid: Vec<Valid>, bundles: Vec<Bundle>) -> Vec<Vec<Piece>> {
    let mut groups = Groups::new(valid.len() + bundles.len());
    join_valid(case, &valid, &mut groups);
    let mut of_bundles = Groups::new(bundles.len());
    join_bundles(case, &bundles, &mut of_bundles);
    for k in 0..bundles.len() {
        groups.unite(valid.len() + of_bundles.root(k), valid.len() + k);
    }
    join_mixed(case, &valid, &bundles, &mut groups);
    let pieces = valid.into_iter().map(|one| Piece {
        features: singles(&one.assignment),
        cells: one.solution.cells,
        witness: Some(one.solution.witness),
        bounded: false,
    });
    let dense = bundles.into_iter().map(|bundle| Piece {
        features: bundle.features,
        // Poses valid up to τ count, so its bounds hold for these.
        cells: vec![bundle.cell.widened(2.0 * case.length_tolerance, 2.0 * case.angle_tolerance)],
        witness: bundle.witness,
        bounded: true,
    });
    groups.collect(pieces.chain(dense))
}

fn singles(assignment: &[Feature]) -> Vec<Vec<Feature>> {
    assignment.iter().map(|feature| vec![*feature]).collect()
}

/// An assignment and a bundle are joined if the bundle may hold it and their cells touch.
fn join_mixed(case: &Case, valid: &[Valid], bundles: &[Bundle], groups: &mut Groups) {
    let (length, angle) = (case.length_tolerance, case.angle_tolerance);
    for (v, one) in valid.iter().enumerate() {
        let single = singles(&one.assignment);
        for (b, bundle) in bundles.iter().enumerate() {
            let near = |symmetry: &Symmetry| {
                let cells = &mut one.solution.cells.iter();
                cells.any(|cell| bundle.cell.meets(cell, symmetry.motion, length, angle))
                    && bundle.compatible(&images(&single, symmetry))
            };
            if groups.root(v) != groups.root(valid.len() + b) && case.model.symmetries.iter().any(near) {
                groups.unite(v, valid.len() + b);
            }
        }
    }
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

/// Two bundles are joined if their boxes touch, or do so when a symmetry moves one, and they may share an assignment.
fn join_bundles(case: &Case, bundles: &[Bundle], groups: &mut Groups) {
    let (length, angle) = (case.length_tolerance, case.angle_tolerance);
    let mut order: Vec<usize> = (0..bundles.len()).collect();
    order.sort_by(|a, b| bundles[*a].cell.mid.total_cmp(&bundles[*b].cell.mid));
    let widest = bundles.iter().map(|bundle| bundle.cell.half).fold(0.0, f64::max) + angle;
    // Fundamental rotations meet their images only where they end; with a prior, others may meet.
    let num_symmetries = if case.prior.is_some() { usize::MAX } else { 2 };
    for symmetry in case.model.symmetries.iter().take(num_symmetries) {
        for &k in &order {
            let cell = &bundles[k].cell;
            let around = cell.mid + symmetry.motion.angle();
            for turn in [-TAU, 0.0, TAU] {
                let near = |j: &usize| bundles[*j].cell.mid - around - turn;
                let from = order.partition_point(|j| near(j) < -(cell.half + widest));
                for &j in order[from..].iter().take_while(|j| near(j) <= cell.half + widest) {
                    if groups.root(j) != groups.root(k)
                        && cell.meets(&bundles[j].cell, symmetry.motion, length, angle)
                        && bundles[k].compatible(&images(&bundles[j].features, symmetry))
                    {
                        groups.unite(j, k);
                    }
                }
            }
        }
    }
}

/// Where a symmetry takes each contact's features, in order.
fn images(features: &[Vec<Feature>], symmetry: &Symmetry) -> Vec<Vec<Feature>> {
    let image = |features: &Vec<Feature>| {
        let mut image = symmetry.features(features);
        image.sort_unstable();
        image
    };
    features.iter().map(image).collect()
}

fn pose_sets(case: &Shared<Case>, groups: Vec<Vec<Piece>>) -> Vec<PoseSet> {
    let set = |pieces| PoseSet::new(Shared::clone(case), aligned(case, pieces), true);
    groups.into_iter().map(set).collect()
}

/// Pieces that meet through a symmetry, moved to where they meet: each to the image whose rotation is nearest to the
/// first one's. With a prior they stay, as it may exclude their images.
fn aligned(case: &Case, pieces: Vec<Piece>) -> Vec<Piece> {
    let middle = |piece: &Piece| piece.cells.first().map(|cell| cell.rotations().middle());
    let Some(first) = pieces.first().and_then(middle).filter(|_| case.prior.is_none()) else { return pieces };
    let align = |piece: Piece| {
        let turn = middle(&piece).unwrap_or(first) - first;
        let away = |symmetry: &&Symmetry| wrap(turn - symmetry.motion.angle()).abs();
        let nearest = case.model.symmetries.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        match nearest.filter(|symmetry| symmetry.motion != Pose::IDENTITY) {
            Some(symmetry) => piece.moved(symmetry),
            None => piece,
        }
    };
    pieces.into_iter().map(align).collect()
}
