//! Pose cells that keep, for each contact, the set of features it may lie on (DESIGN §2).
//!
//! Where assignments explode (finely faceted parts, contacts without normals) the tree of assignments is not walked to
//! its leaves. Two contacts choose their features, which leaves a ball of rotations; the cells in it are divided until each
//! contact is left with features that hang together, or the cell is small against the sensor's bounds.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use glam::DMat3;
use rayon::prelude::*;

use super::case::Case;
use super::cell::{Cell, Conditions};
use super::first_cells::{first_cells, whole};
use super::hypotheses::{canonical, sensed};
use super::pose;
use super::pose_set::Piece;
use super::site::Sites;
use super::solve::{self, Witness};
use super::tables::FeatureTables;
use crate::feature::Feature;
use crate::groups::Groups;
use crate::recognize::Limit;
use crate::tree::FeaturePairs;

/// A cell is small when nothing in it moves by more than this share of the least bound.
const SMALL: f64 = 0.5;

/// Cells examined for one model, and first for each choice of features of two contacts.
pub(super) const MOST_CELLS: u64 = 20_000;
const LEAST_CELLS: u64 = 50;

/// Cells examined for a witness in a cell whose features hang together, before it is divided, and in a small cell.
const MOST_FOR_WITNESS: u32 = 16;
const MOST_IN_SMALL: u32 = 1_000;

/// Choices of features of two contacts; where there are more, all features are divided as one.
const MOST_CHOICES: usize = 20_000;

/// Cells of one choice that are narrowed before linear conditions are asked.
const MOST_NARROWED: usize = 64;

/// Cells that are looked at for which of them touch.
const MOST_TOGETHER: usize = 2_000;

/// What the division left: every pose is in a piece.
#[derive(Debug, Default)]
pub(crate) struct Subdivision {
    pub pieces: Vec<Piece>,
    /// Cells examined.
    pub examined: u64,
}

/// What each contact may lie on by itself: everything, but for the prior.
pub(crate) fn candidates(case: &Case, tables: &FeatureTables) -> Vec<Vec<usize>> {
    let features = tables.features();
    let all: Vec<usize> = (0..features.len()).collect();
    let Some(prior) = case.prior else { return vec![all; case.data.len()] };
    let tilt = prior.lying.map_or(0.0, |lying| lying.tilt);
    let radius = (prior.rotation + tilt).min(std::f64::consts::PI);
    let height = prior.lying.map_or(0.0, |lying| lying.height);
    let shift = if prior.lying.is_some() {
        prior.translation.hypot(height)
    } else {
        prior.translation * 3_f64.sqrt()
    };
    let placed = prior.world_from_model;
    let possible = |contact: usize, number: usize| {
        let datum = &case.data[contact];
        // Where there is no time to see, it may be.
        case.stopped()
            || case.sites(contact, features[number]).iter().any(|site| {
                let turn = 2.0 * (0.5 * radius).sin() * (site.middle.length() + site.reach);
                let near = turn + shift + datum.bound + case.length_tolerance;
                let place = placed.inverse().apply(case.pivot + datum.lever);
                let caps = datum
                    .reading
                    .caps(radius + case.angle_tolerance, |axis| placed.rotation.transpose() * axis);
                site.distance(place, &caps) <= near
            })
    };
    (0..case.data.len())
        .map(|contact| all.iter().copied().filter(|number| possible(contact, *number)).collect())
        .collect()
}

/// The features of each contact among which a choice of two leaves these.
type Choice = Vec<Vec<Feature>>;

/// Divides all poses in which each contact lies on a candidate.
pub(crate) fn subdivide(case: &Case, tables: &FeatureTables, candidates: &[Vec<usize>]) -> Subdivision {
    let of_contact = |numbers: &Vec<usize>| numbers.iter().map(|number| tables.feature(*number)).collect();
    let features: Choice = candidates.iter().map(of_contact).collect();
    if features.iter().any(Vec::is_empty) {
        return Subdivision::default();
    }
    let touching = Touching::new(case);
    let choices = best_pair(case).and_then(|pair| choices(case, tables, candidates, pair));
    divide_all(case, &touching, choices.as_deref().unwrap_or(std::slice::from_ref(&features)), &features)
}

/// What each choice of features of two contacts leaves for the others. `None`: there are too many choices, or no time.
fn choices(
    case: &Case,
    tables: &FeatureTables,
    candidates: &[Vec<usize>],
    (a, b): (usize, usize),
) -> Option<Vec<Choice>> {
    let others = (0..case.data.len()).filter(|contact| *contact != a && *contact != b);
    let order: Vec<usize> = [a, b].into_iter().chain(others).collect();
    let readings: Vec<_> = order.iter().map(|&contact| sensed(case, &case.data[contact])).collect();
    let in_order = order.iter().map(|&contact| candidates[contact].clone()).collect();
    let contacts = tables.contact_pairs(&readings, in_order);
    let agree = |later: usize, earlier: usize, second: usize, first: usize| {
        contacts.pairs[later][earlier].meets(&tables.pair(first, second))
    };
    // What a later contact may lie on, given what the first does, in increasing order.
    let beside = |later: usize, first: usize| {
        let candidates = &contacts.candidates[later];
        let known = |feature: &usize| candidates.binary_search(feature).is_ok();
        let mut near = match tables.near_angle(first, contacts.pairs[later][0].angle) {
            Some(near) => near.filter(known).collect(),
            None => candidates.clone(),
        };
        near.retain(|&feature| agree(later, 0, feature, first));
        near.sort_unstable();
        near
    };
    let mut pairs = Vec::new();
    for &first in &contacts.candidates[0] {
        let chosen = |second: usize| [first, second].map(|number| tables.feature(number));
        let seconds = beside(1, first).into_iter().filter(|second| canonical(case, &chosen(*second)));
        pairs.extend(seconds.map(|second| (first, second)));
        if case.stopped() || pairs.len() > MOST_CHOICES {
            return None;
        }
    }
    let left = |&(first, second): &(usize, usize)| {
        let mut features = vec![Vec::new(); order.len()];
        features[a] = vec![tables.feature(first)];
        features[b] = vec![tables.feature(second)];
        for (later, &contact) in order.iter().enumerate().skip(2) {
            if case.stopped() {
                return None;
            }
            let both = beside(later, first).into_iter().filter(|&one| agree(later, 1, one, second));
            features[contact] = both.map(|one| tables.feature(one)).collect();
        }
        features.iter().all(|features| !features.is_empty()).then_some(features)
    };
    let choices = pairs.par_iter().filter_map(left).collect();
    (!case.stopped()).then_some(choices)
}

/// Divides each of the choices, within few cells first; those that need more share what is left, in rounds. They are choices
/// among `all`.
fn divide_all(case: &Case, touching: &Touching, choices: &[Choice], all: &Choice) -> Subdivision {
    let most = case.effort.unwrap_or(MOST_CELLS);
    let share = most / choices.len().max(1) as u64;
    let all_begun = AtomicBool::new(true);
    let begin = |choice: &Choice| {
        if case.stopped() {
            all_begun.store(false, Relaxed);
            return None;
        }
        Division::new(case, touching, choice, share)
    };
    let mut divisions: Vec<Division<'_>> = choices.par_iter().filter_map(begin).collect();
    let mut given = LEAST_CELLS;
    loop {
        divisions.par_iter_mut().for_each(|division| division.advance(given));
        let spent: u64 = divisions.iter().map(|division| division.left.examined).sum();
        let unfinished = divisions.iter().filter(|division| !division.open.is_empty()).count() as u64;
        if unfinished == 0 || spent >= most || case.stopped() {
            break;
        }
        // Twice as many as before, as long as there are as many.
        given = (given + (most - spent) / unfinished).min(2 * given).max(given + 1);
    }
    let unfinished = divisions.iter().filter(|division| !division.open.is_empty()).count() as u64;
    let budget = (most / unfinished.max(1)).min(u64::from(MOST_IN_SMALL)) as u32;
    divisions.par_iter_mut().for_each(|division| division.finish(budget));
    let mut left = Subdivision::default();
    for division in divisions {
        left.pieces.extend(division.left.pieces);
        left.examined += division.left.examined;
    }
    left.pieces.extend((!all_begun.into_inner()).then(|| untouched(case, all)));
    left
}

/// All that features leave, undecided: there was no time to look at it.
fn untouched(case: &Case, features: &Choice) -> Piece {
    let mut piece = Piece::new(case, features.clone(), None, Vec::new());
    let cell = whole(&piece.conditions(case));
    piece.witness = Some(Witness::guess(cell.middle(), Limit::Time));
    piece.bounds.push(cell);
    piece
}

/// The two contacts whose normals leave the least of the rotations.
fn best_pair(case: &Case) -> Option<(usize, usize)> {
    let mut best: Option<(f64, (usize, usize))> = None;
    for (k, a) in case.data.iter().enumerate() {
        for (j, b) in case.data[..k].iter().enumerate() {
            if let (Some((one, _)), Some((other, _))) = (a.reading.sensed, b.reading.sensed) {
                let across = one.cross(other).length();
                if across > 0.1 && best.is_none_or(|(most, _)| across > most) {
                    best = Some((across, (j, k)));
                }
            }
        }
    }
    best.map(|(_, pair)| pair)
}

/// A choice of features while it is divided.
struct Division<'a> {
    case: &'a Case,
    touching: &'a Touching,
    conditions: Conditions<'a>,
    /// Cells that are still to be examined.
    open: Vec<Cell>,
    left: Subdivision,
}

impl<'a> Division<'a> {
    /// Nothing, if a contact can't lie on any of its features. A first look at all of it examines so many cells.
    fn new(case: &'a Case, touching: &'a Touching, features: &[Vec<Feature>], most: u64) -> Option<Self> {
        let pairs = features.iter().enumerate().map(|(contact, features)| (contact, features.as_slice()));
        let conditions = Conditions::new(case, pairs)?;
        let left = Subdivision::default();
        let mut division = Self { case, touching, conditions, open: Vec::new(), left };
        let first = narrowed(&division.conditions);
        if first.len() > MOST_TOGETHER {
            division.open = first;
            return Some(division);
        }
        // Those that hang together are one piece, if what they leave does.
        for cells in together(first) {
            let narrow = cells.iter().all(Cell::is_narrow);
            let budget = (u64::from(MOST_FOR_WITNESS) + cells.len() as u64).min(most.max(4)) as u32;
            if !narrow || !division.settle(&cells, budget) {
                division.open.extend(cells);
            }
        }
        Some(division)
    }

    /// Divides until so many cells are examined in all.
    fn advance(&mut self, most: u64) {
        let case = self.case;
        let reach = self.conditions.reach();
        let least = case.data.iter().map(|datum| datum.bound).fold(f64::INFINITY, f64::min);
        let small = (SMALL * least).max(0.5 * case.length_tolerance);
        while self.left.examined < most && !case.stopped() {
            let Some(cell) = self.open.pop() else { break };
            self.left.examined += 1;
            let Some(cell) = self.shrunk(cell) else { continue };
            let settled = if cell.motion(reach) <= small {
                self.settle_small(&cell)
            } else {
                cell.is_narrow() && self.settle(std::slice::from_ref(&cell), MOST_FOR_WITNESS)
            };
            if !settled {
                self.open.extend(cell.split(reach, false));
            }
        }
    }

    /// What is left of a cell.
    fn shrunk(&self, mut cell: Cell) -> Option<Cell> {
        if cell.is_narrow() {
            solve::contracted(&self.conditions, cell)
        } else {
            cell.restrict(&self.conditions).then_some(cell)
        }
    }

    /// Cells that are still open are pieces where they touch, whatever their features: so what is true is in one.
    fn finish(&mut self, budget: u32) {
        let open = std::mem::take(&mut self.open);
        // There may be no time to see which of them touch.
        let all = self.case.stopped() || open.len() > MOST_TOGETHER;
        let groups = if all { vec![open] } else { together(open) };
        for cells in groups.into_iter().filter(|cells| !cells.is_empty()) {
            let piece = self.piece(of_cells(&self.conditions, &cells), &cells, budget);
            self.left.pieces.extend(piece.witness.is_some().then_some(piece));
        }
    }

    /// Whether it is settled what cells hold that hang together: nothing, or a piece whose features hang together.
    fn settle(&mut self, cells: &[Cell], budget: u32) -> bool {
        if self.case.stopped() {
            return false;
        }
        let features = of_cells(&self.conditions, cells);
        if !features.iter().all(|features| self.touching.hang_together(features)) {
            return false;
        }
        let piece = self.piece(features, cells, budget);
        let decided = piece.witness.is_none_or(|witness| witness.is_decided());
        if piece.witness.is_some() && decided {
            self.left.pieces.push(piece);
        }
        decided
    }

    /// A cell so small is a piece, whatever its features.
    fn settle_small(&mut self, cell: &Cell) -> bool {
        let cells = std::slice::from_ref(cell);
        let piece = self.piece(of_cells(&self.conditions, cells), cells, MOST_IN_SMALL);
        if piece.witness.is_some() {
            self.left.pieces.push(piece);
        }
        true
    }

    fn piece(&mut self, features: Vec<Vec<Feature>>, cells: &[Cell], budget: u32) -> Piece {
        let mut piece = Piece::new(self.case, features, None, cells.to_vec());
        if let Some(limit) = self.case.late() {
            piece.witness = Some(Witness::guess(cells[0].middle(), limit));
            return piece;
        }
        let mut left = budget;
        piece.witness = solve::witness_within(&piece.conditions(self.case), &piece.bounds, &mut left);
        self.left.examined += u64::from(budget - left);
        piece
    }
}

/// Wide cells divided until linear conditions are of use in each, as long as they are few: what normals and boxes exclude
/// costs little.
fn narrowed(conditions: &Conditions<'_>) -> Vec<Cell> {
    let reach = conditions.reach();
    let possible = |mut cell: Cell| cell.restrict(conditions).then_some(cell);
    let mut narrow = Vec::new();
    let mut wide = VecDeque::new();
    for cell in first_cells(conditions) {
        if conditions.case.stopped() {
            return vec![whole(conditions)];
        }
        wide.extend(possible(cell));
    }
    while let Some(cell) = wide.pop_front() {
        if conditions.case.stopped() || cell.is_narrow() || narrow.len() + wide.len() >= MOST_NARROWED {
            narrow.push(cell);
        } else {
            wide.extend(cell.split(reach, true).into_iter().filter_map(possible));
        }
    }
    narrow
}

/// Cells in groups that touch.
fn together(cells: Vec<Cell>) -> Vec<Vec<Cell>> {
    let turns: Vec<DMat3> = cells.iter().map(Cell::rotation).collect();
    let mut groups = Groups::new(cells.len());
    for (k, a) in cells.iter().enumerate() {
        for (j, b) in cells[..k].iter().enumerate() {
            let near = || {
                (a.y - b.y).abs().cmple(a.y_half + b.y_half).all()
                    && pose::within(turns[k] * turns[j].transpose(), a.radius() + b.radius())
            };
            if groups.root(j) != groups.root(k) && near() {
                groups.unite(j, k);
            }
        }
    }
    groups.collect(cells.into_iter())
}

/// The features whose sites are left in some cell, in increasing order.
fn of_cells(conditions: &Conditions<'_>, cells: &[Cell]) -> Vec<Vec<Feature>> {
    let of_condition = |(condition, (_, sites)): (usize, &(usize, Sites))| {
        let left = cells.iter().flat_map(|cell| &cell.left[condition]);
        let mut features: Vec<Feature> = left.map(|number| sites[*number as usize].feature).collect();
        features.sort_unstable();
        features.dedup();
        features
    };
    conditions.sites.iter().enumerate().map(of_condition).collect()
}

/// Which features have a corner in common.
struct Touching {
    /// The corners of each face, edge and vertex.
    faces: Vec<Vec<u32>>,
    edges: Vec<[u32; 2]>,
}

impl Touching {
    fn new(case: &Case) -> Self {
        let faces = case.model.faces.iter().map(|face| face.loops.concat());
        Self { faces: faces.collect(), edges: case.model.edges.iter().map(|edge| edge.ends).collect() }
    }

    fn corners(&self, feature: Feature) -> Vec<u32> {
        match feature {
            Feature::Face(number) => self.faces[number as usize].clone(),
            Feature::Edge(number) => self.edges[number as usize].to_vec(),
            Feature::Vertex(number) => vec![number],
        }
    }

    /// Whether one can go from each of the features to any other over corners.
    fn hang_together(&self, features: &[Feature]) -> bool {
        if features.len() == 1 {
            return true;
        }
        let mut corners: Vec<(u32, usize)> = features
            .iter()
            .enumerate()
            .flat_map(|(k, feature)| self.corners(*feature).into_iter().map(move |corner| (corner, k)))
            .collect();
        corners.sort_unstable();
        let mut groups = Groups::new(features.len());
        for pair in corners.windows(2) {
            if pair[0].0 == pair[1].0 {
                groups.unite(pair[0].1, pair[1].1);
            }
        }
        (1..features.len()).all(|k| groups.root(k) == 0)
    }
}
