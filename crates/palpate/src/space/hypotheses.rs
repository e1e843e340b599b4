//! Interpretations of one model joined into hypotheses: one pose, up to the model's symmetry, satisfies both (DESIGN §1).

use std::ops::ControlFlow;
use std::sync::Arc as Shared;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::case::{Case, Datum, PivotPose};
use super::cell::{Cell, Conditions};
use super::model::Model;
use super::pose::{self, Pose};
use super::pose_set::{Piece, PoseSet};
use super::sensed::Sensed;
use super::solve::{self, Witness};
use super::subdivide::{self, MOST_CELLS};
use super::tables::{FeatureTables, Kinds};
use crate::contact::{Evidence, GRAZING};
use crate::feature::Feature;
use crate::groups::Groups;
use crate::recognize::{Explanations, Halt, Settings};
use crate::tree::{self, Counters};

/// Nodes of the interpretation tree after which pose cells are divided instead.
const MOST_NODES: u64 = 2_000_000;

/// Cells examined for each feasible assignment, before those that are undecided share what there is for one model.
const MOST_AT_FIRST: u64 = 500;

/// Feasible assignments after which pose cells are divided instead.
const MOST_FEASIBLE: usize = 512;

/// Every hypothesis of one model (thesis chapter 2, in its own order).
pub(crate) fn explain(
    model: &Shared<Model>,
    evidence: &Evidence<DVec3>,
    settings: &Settings,
    stop: &Halt,
) -> Explanations<DVec3> {
    let case = Shared::new(Case::new(model, evidence, settings, stop));
    if !case.data.iter().all(consistent) {
        return Explanations::nothing();
    }
    let kinds = Kinds {
        faces: settings.faces,
        edges: settings.edges(evidence),
        vertices: settings.vertices(evidence),
    };
    let tables = model.feature_tables_until(kinds, stop);
    if tables.features().is_empty() {
        return Explanations::nothing();
    }
    let candidates = subdivide::candidates(&case, &tables);
    let mut counters = Counters::default();
    let feasible = interpretation_tree(&case, &tables, &candidates, &mut counters);
    let (pieces, num_boxes) = if let Some(assignments) = feasible {
        (valid(&case, assignments), 0)
    } else {
        let division = subdivide::subdivide(&case, &tables, &candidates);
        (division.pieces, division.examined)
    };
    let hypotheses = pose_sets(&case, pieces);
    // What is undecided beside a pose that is known is no more than a loose enclosure of that hypothesis (theory, T20).
    let undecided = hypotheses.iter().filter_map(PoseSet::undecided).min();
    Explanations { hypotheses, counters, num_boxes, stopped_by: case.late().or(undecided) }
}

/// Whether a contact's normal and approach leave a normal.
fn consistent(datum: &Datum) -> bool {
    match (datum.reading.sensed, datum.reading.facing) {
        (Some((normal, error)), Some((back, slack))) => {
            let most = std::f64::consts::FRAC_PI_2 + error + slack + GRAZING;
            super::site::angle(normal, back) <= most
        }
        _ => true,
    }
}

/// The feasible assignments, or nothing if they are too many.
fn interpretation_tree(
    case: &Case,
    tables: &FeatureTables,
    of_each: &[Vec<usize>],
    counters: &mut Counters,
) -> Option<Vec<Vec<Feature>>> {
    let sensed: Vec<Sensed> = case.data.iter().map(|datum| sensed(case, datum)).collect();
    let order = order(&sensed);
    let in_order: Vec<Sensed> = order.iter().map(|&contact| sensed[contact]).collect();
    let candidates = order.iter().map(|&contact| of_each[contact].clone()).collect();
    let contacts = tables.contact_pairs(&in_order, candidates);
    let mut feasible = Vec::new();
    let mut keep = |assignment: &[usize]| {
        if feasible.len() >= MOST_FEASIBLE {
            return ControlFlow::Break(());
        }
        let mut of_contact = vec![Feature::Face(0); order.len()];
        for (&contact, &number) in order.iter().zip(assignment) {
            of_contact[contact] = tables.feature(number);
        }
        if canonical(case, &of_contact) {
            feasible.push(of_contact);
        }
        ControlFlow::Continue(())
    };
    let outcome = tree::search(tables, &contacts, MOST_NODES, case.halt(), counters, &mut keep);
    feasible.sort_unstable();
    outcome.is_continue().then_some(feasible)
}

/// A contact's surface point and normal with their bounds, τ included. The surface point is the tip's centre less the
/// radius along the normal; where the normal is known only within a cone, the chord of the cone adds to the bound.
pub(super) fn sensed(case: &Case, datum: &Datum) -> Sensed {
    let bound = datum.bound + case.length_tolerance;
    let normal = datum.reading.sensed.map(|(axis, error)| (axis, error + case.angle_tolerance));
    match normal {
        Some((axis, error)) if error < 1.0 => Sensed {
            point: datum.lever - datum.radius * axis,
            bound: bound + 2.0 * datum.radius * (0.5 * error).sin(),
            normal,
        },
        _ => Sensed { point: datum.lever, bound: bound + datum.radius, normal },
    }
}

/// Contacts in the order in which they tell most: first the two whose normals are most across each other, or that are
/// farthest apart, then those farthest from the ones before.
fn order(sensed: &[Sensed]) -> Vec<usize> {
    let across = |a: &Sensed, b: &Sensed| {
        let turn = match (a.normal, b.normal) {
            (Some((a, _)), Some((b, _))) => a.cross(b).length(),
            _ => 0.0,
        };
        (turn, a.point.distance(b.point))
    };
    let (mut first, mut best) = (vec![0], (-1.0, -1.0));
    for (k, a) in sensed.iter().enumerate() {
        for (j, b) in sensed[..k].iter().enumerate() {
            let value = across(a, b);
            if value.0 > best.0 + 1e-9 || ((value.0 - best.0).abs() <= 1e-9 && value.1 > best.1) {
                (first, best) = (vec![j, k], value);
            }
        }
    }
    while first.len() < sensed.len() {
        let apart = |k: &usize| {
            let nearest = first.iter().map(|j| sensed[*k].point.distance(sensed[*j].point));
            nearest.fold(f64::INFINITY, f64::min)
        };
        let rest = (0..sensed.len()).filter(|k| !first.contains(k));
        let Some(next) = rest.max_by(|a, b| apart(a).total_cmp(&apart(b)).then(b.cmp(a))) else { break };
        first.push(next);
    }
    first
}

/// Of assignments that a symmetry takes into each other the first stands for all. With a prior each stands for
/// itself, as the prior may allow one and not the other.
pub(super) fn canonical(case: &Case, assignment: &[Feature]) -> bool {
    case.prior.is_some()
        || case.model.symmetries.iter().skip(1).all(|symmetry| *assignment <= *symmetry.features(assignment))
}

/// Decides each assignment (MATH 2.1.2): a piece with a witness, if its pose set is not empty.
fn valid(case: &Case, assignments: Vec<Vec<Feature>>) -> Vec<Piece> {
    let unseen = PivotPose { rotation: DMat3::IDENTITY, y: DVec3::ZERO };
    let decide = |piece: &mut Piece, most: u64| {
        piece.witness = match case.late() {
            Some(limit) => piece.witness.or(Some(Witness::guess(unseen, limit))),
            None => solve::witness(&piece.conditions(case), u32::try_from(most).unwrap_or(u32::MAX)),
        };
    };
    let begin = |assignment: Vec<Feature>| {
        let features = assignment.into_iter().map(|feature| vec![feature]).collect();
        let mut piece = Piece::new(case, features, None, Vec::new());
        decide(&mut piece, MOST_AT_FIRST);
        piece.witness.is_some().then_some(piece)
    };
    let mut pieces: Vec<Piece> = if assignments.len() < 16 {
        assignments.into_iter().filter_map(begin).collect()
    } else {
        assignments.into_par_iter().filter_map(begin).collect()
    };
    // Those that need more share it.
    let is_undecided = |piece: &Piece| !piece.is_decided();
    let num_undecided = pieces.iter().filter(|piece| is_undecided(piece)).count() as u64;
    let most = case.effort.unwrap_or(MOST_CELLS) / num_undecided.max(1);
    if most > MOST_AT_FIRST {
        pieces.par_iter_mut().filter(|piece| is_undecided(piece)).for_each(|piece| decide(piece, most));
        pieces.retain(|piece| piece.witness.is_some());
    }
    pieces
}

/// Pieces of each hypothesis, in the order of their first piece.
fn pose_sets(case: &Shared<Case>, pieces: Vec<Piece>) -> Vec<PoseSet> {
    let groups = joined(case, &pieces).collect(pieces.into_iter()).into_iter();
    let (proved, rest): (Vec<_>, Vec<_>) = groups.partition(|pieces| pieces.iter().any(Piece::is_decided));
    // What is asked of a set later is not stopped by what stopped this search, and pieces may be moved to their images.
    let case = Shared::new(case.of_answers());
    let set = |pieces: Vec<Piece>| PoseSet::new(Shared::clone(&case), pieces, true);
    let without_guesses = |mut pieces: Vec<Piece>| {
        // A pose that a search had at its limit is no witness beside others.
        for piece in &mut pieces {
            piece.witness = piece.witness.filter(Witness::is_decided);
        }
        set(pieces)
    };
    let mut sets: Vec<PoseSet> = proved.into_iter().map(without_guesses).collect();
    // All of which it is not known whether there is a pose is one set, the last: so much is not decided.
    let undecided: Vec<Piece> = rest.into_iter().flatten().collect();
    sets.extend(undecided.iter().any(|piece| piece.witness.is_some()).then(|| set(undecided)));
    sets
}

/// Which pieces have a pose in common, up to a symmetry of the model. Where the search is stopped, what is undecided stays
/// apart; if there was no time to see which of the others touch, they are one group.
fn joined(case: &Case, pieces: &[Piece]) -> Groups {
    let joins = |piece: &Piece| piece.is_decided() || !case.stopped();
    let around: Vec<Around> = pieces.par_iter().map(|piece| Around::new(case, piece, joins(piece))).collect();
    let mut groups = Groups::new(pieces.len());
    // Where a pose of one explains the other: that costs little.
    for exact in [false, true] {
        // The first piece of each group.
        let mut firsts: Vec<usize> = Vec::new();
        for (k, one) in pieces.iter().enumerate() {
            firsts.push(k);
            for symmetry in &case.model.symmetries {
                firsts.retain(|first| groups.root(*first) == *first);
                if firsts.len() == 1 {
                    break;
                }
                let mut image = None;
                let moved = around[k].moved(case, symmetry.motion);
                for (j, other) in pieces[..k].iter().enumerate() {
                    if case.stopped() {
                        if !exact {
                            unite_decided(pieces, &mut groups);
                        }
                        return groups;
                    }
                    if !moved.near(case, &around[j]) || groups.root(j) == groups.root(k) {
                        continue;
                    }
                    let image = image.get_or_insert_with(|| one.moved(case, symmetry));
                    if image.meets(case, other, exact) {
                        groups.unite(j, k);
                    }
                }
            }
        }
    }
    groups
}

fn unite_decided(pieces: &[Piece], groups: &mut Groups) {
    let decided: Vec<usize> = (0..pieces.len()).filter(|k| pieces[*k].is_decided()).collect();
    decided.windows(2).for_each(|pair| groups.unite(pair[0], pair[1]));
}

/// Where the poses of a piece are: in cells around them.
struct Around {
    cells: Vec<Place>,
    /// Model points at the pivot, in a box: most pairs of pieces are apart by these alone.
    low: DVec3,
    high: DVec3,
    /// The motion of the model after which it is there.
    motion: Pose,
}

/// A cell: the rotation at its middle, how far others are from it, radians, and model points at the pivot.
struct Place {
    turn: DMat3,
    radius: f64,
    y: DVec3,
    y_half: DVec3,
}

impl Around {
    /// Nothing, unless it `joins` others.
    fn new(case: &Case, piece: &Piece, joins: bool) -> Self {
        let cells = if joins { solve::boxes(case, piece) } else { Vec::new() };
        let place = |cell: &Cell| Place {
            turn: cell.rotation(),
            radius: cell.radius(),
            y: cell.y,
            y_half: cell.y_half,
        };
        Self::of(case, cells.iter().map(place).collect(), Pose::IDENTITY)
    }

    fn of(case: &Case, cells: Vec<Place>, motion: Pose) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for cell in &cells {
            // All that cells may share within the tolerance included.
            let half = DVec3::splat(cell.y_half.length() + case.length_tolerance + case.outward());
            (low, high) = (low.min(cell.y - half), high.max(cell.y + half));
        }
        Self { cells, low, high, motion }
    }

    fn moved(&self, case: &Case, motion: Pose) -> Self {
        let place =
            |cell: &Place| Place { turn: motion.rotation * cell.turn, y: motion.apply(cell.y), ..*cell };
        Self::of(case, self.cells.iter().map(place).collect(), motion)
    }

    /// Whether it may have a pose in common with another, which is not moved.
    fn near(&self, case: &Case, other: &Self) -> bool {
        let boxes = self.low.cmple(other.high).all() && other.low.cmple(self.high).all();
        boxes && self.cells.iter().any(|a| other.cells.iter().any(|b| self.meet(case, a, b)))
    }

    fn meet(&self, case: &Case, a: &Place, b: &Place) -> bool {
        let length = case.length_tolerance;
        let touch = if self.motion == Pose::IDENTITY {
            (a.y - b.y).abs().cmple(a.y_half + b.y_half + length).all()
        } else {
            // Boxes turned against each other: the balls around them.
            a.y.distance(b.y) <= a.y_half.length() + b.y_half.length() + length
        };
        touch && pose::within(a.turn * b.turn.transpose(), a.radius + b.radius + case.angle_tolerance)
    }
}

/// Cells examined for a pose that satisfies two assignments; those that are not told apart by then are joined.
const MOST_FOR_BOTH: u32 = 200;

impl Piece {
    /// Whether a pose satisfies both; unless `exact`, only if a witness does.
    fn meets(&self, case: &Case, other: &Self, exact: bool) -> bool {
        let holds =
            |piece: &Self, pose| piece.satisfied(case, pose, case.length_tolerance, case.angle_tolerance);
        let both_bounded = !self.bounds.is_empty() && !other.bounds.is_empty();
        // Boxes that touch and share features: they are parts of one set.
        let share = |(a, b): (&Vec<Feature>, &Vec<Feature>)| a.iter().any(|one| b.binary_search(one).is_ok());
        if both_bounded && (exact || self.features.iter().zip(&other.features).all(share)) {
            return !exact;
        }
        if !exact {
            return self.witness.is_some_and(|witness| holds(other, witness.pose))
                || other.witness.is_some_and(|witness| holds(self, witness.pose));
        }
        // Features that differ are both to be touched.
        let mut both: Vec<(usize, &[Feature])> = Vec::new();
        for (contact, (a, b)) in self.features.iter().zip(&other.features).enumerate() {
            both.push((contact, a.as_slice()));
            if a != b {
                both.push((contact, b.as_slice()));
            }
        }
        let cells = [&self.bounds, &other.bounds].into_iter().find(|bounds| !bounds.is_empty());
        Conditions::new(case, both.into_iter())
            .is_some_and(|both| solve::may_hold(&both, cells.map(Vec::as_slice), MOST_FOR_BOTH))
    }
}
