//! Algorithm R2 (MATH 2.1.1), second order: is there a pose that satisfies the conditions, and where are all of them?
//!
//! Cells of pose space are contracted; an empty one is a certificate that no pose lies there. A pose that satisfies
//! the conditions exactly, or within τ, is a witness. What is neither is divided.

use std::collections::{BinaryHeap, VecDeque};

use super::arc::Arc;
use super::case::PivotPose;
use super::cell::{Cell, Conditions};
use crate::nearest::Nearest;
use crate::recognize::Limit;
use crate::witness;

/// A pose that satisfies the conditions.
pub(crate) type Witness = witness::Witness<PivotPose>;

/// Rotations are first divided into cells of at most this half width, radians.
const FIRST_HALF: f64 = 0.08;

/// No arc of rotations is divided into more cells at once.
const MOST_CELLS: u32 = 1 << 16;

/// Cells examined for a witness at most. A set that is neither found nor refuted by then is kept as marginal.
const MOST_EXAMINED: u32 = 200_000;

/// Cells examined for a witness that is welcome but not needed.
const SOON: u32 = 100;

/// With a marginal witness in hand, cells examined for a better one.
const ENOUGH_MARGINAL: u32 = 64;

/// Cuts at the candidate before a cell is divided.
const NUM_CUTS: usize = 6;

/// The looseness that an enclosure may have, as a share of the size of what it encloses.
const RESOLUTION: f64 = 0.01;

/// Cells that hold every pose that satisfies the conditions, and one such pose.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub cells: Vec<Cell>,
    pub witness: Witness,
}

/// A witness, or the certificate that there is none.
pub(crate) fn witness(conditions: &Conditions<'_>) -> Option<Witness> {
    search(conditions, first_cells(conditions), MOST_EXAMINED)
}

/// A witness that is soon found; `None` says nothing.
pub(crate) fn quick_witness(conditions: &Conditions<'_>) -> Option<Witness> {
    search(conditions, first_cells(conditions), SOON).filter(|witness| !witness.marginal)
}

/// A witness within the cells, or the certificate that there is none.
pub(crate) fn witness_within(conditions: &Conditions<'_>, cells: &[Cell]) -> Option<Witness> {
    let cells = cells.iter().filter_map(|cell| contracted(conditions, cell.clone()));
    search(conditions, cells.collect(), MOST_EXAMINED)
}

/// All poses.
pub(crate) fn solve(conditions: &Conditions<'_>) -> Option<Solution> {
    let witness = witness(conditions)?;
    let cells = cells(conditions);
    // Nothing is left of the enclosure: that is a certificate, though the search was undecided.
    let refuted = !witness.is_decided() && cells.is_empty();
    (!refuted).then_some(Solution { cells, witness })
}

/// Cells that hold every pose that satisfies the conditions, up to τ.
pub(crate) fn cells(conditions: &Conditions<'_>) -> Vec<Cell> {
    conditions.relaxed().map(|relaxed| enclose(&relaxed, first_cells(&relaxed))).unwrap_or_default()
}

/// The rotations that are left, in cells, contracted.
fn first_cells(conditions: &Conditions<'_>) -> Vec<Cell> {
    let pieces = conditions.rotations.iter().flat_map(|arc| divide(*arc, FIRST_HALF));
    pieces.filter_map(|cell| contracted(conditions, cell)).collect()
}

fn contracted(conditions: &Conditions<'_>, mut cell: Cell) -> Option<Cell> {
    cell.contract(conditions).then_some(cell)
}

fn divide(arc: Arc, largest_half: f64) -> impl Iterator<Item = Cell> {
    let num_pieces = (1..=MOST_CELLS)
        .find(|count| arc.half_width() <= largest_half * f64::from(*count))
        .unwrap_or(MOST_CELLS);
    let half = arc.half_width() / f64::from(num_pieces);
    let outward = f64::EPSILON * std::f64::consts::TAU;
    (0..num_pieces).map(move |k| Cell::whole(arc.start + f64::from(2 * k + 1) * half, half + outward))
}

/// Best first: a certificate needs all cells in any order, a witness is found early.
fn search(conditions: &Conditions<'_>, cells: Vec<Cell>, most_examined: u32) -> Option<Witness> {
    let reach = conditions.reach();
    let mut open = BinaryHeap::new();
    let mut num_opened = 0;
    let mut add = |open: &mut BinaryHeap<Nearest<Cell>>, cell: Cell| {
        if !excluded(conditions, &cell) {
            num_opened += 1;
            open.push(Nearest { miss: conditions.miss(cell.candidate()), number: num_opened, value: cell });
        }
    };
    for cell in cells {
        add(&mut open, cell);
    }
    let mut fallback = None;
    for num_examined in 0_u32.. {
        let Some(Nearest { value: mut cell, .. }) = open.pop() else { break };
        let fine = if conditions.convex() { cell.looseness(reach) } else { cell.motion(reach) }
            <= finest(conditions);
        let left =
            match probe(conditions, &mut cell, if fine { 50 * NUM_CUTS } else { NUM_CUTS }, &mut fallback) {
                Probe::Found(witness) => return Some(witness),
                Probe::Empty => continue,
                Probe::Left => cell.candidate(),
            };
        let spent = (num_examined >= most_examined).then_some(Limit::Effort);
        let enough = conditions.case.late().or(spent);
        let limit = enough.or(fine.then_some(Limit::Tolerance));
        if let (None, Some(limit)) = (fallback, limit) {
            // Neither a witness nor a certificate: kept, so that nothing true is lost.
            fallback = Some(Witness::guess(left, limit));
        }
        if enough.is_some() || (fallback.is_some() && num_examined > ENOUGH_MARGINAL) {
            break;
        }
        if !fine {
            let parts = cell.split_by_escapes(conditions, cell.candidate());
            let halves = || split(conditions, &cell, reach).into_iter();
            let parts =
                parts.unwrap_or_else(|| halves().filter_map(|part| contracted(conditions, part)).collect());
            for part in parts {
                add(&mut open, part);
            }
        }
    }
    fallback
}

/// Below this looseness a cell is not divided further: what is left of it is valid up to τ/2.
fn finest(conditions: &Conditions<'_>) -> f64 {
    0.25 * conditions.case.length_tolerance
}

/// What a few cuts at its candidates make of a cell.
enum Probe {
    Found(Witness),
    Empty,
    Left,
}

fn probe(
    conditions: &Conditions<'_>,
    cell: &mut Cell,
    num_cuts: usize,
    fallback: &mut Option<Witness>,
) -> Probe {
    let case = conditions.case;
    for _ in 0..num_cuts {
        let pose = cell.candidate();
        if conditions.satisfied(pose, case.rounding(), case.rounding() / case.scale) {
            return Probe::Found(Witness { pose, marginal: false, undecided: None });
        }
        let wanted = fallback.is_none_or(|known| !known.is_decided());
        if wanted && conditions.satisfied(pose, case.length_tolerance, case.angle_tolerance) {
            *fallback = Some(Witness { pose, marginal: true, undecided: None });
        }
        if !cell.cut_at(conditions, pose) {
            return Probe::Empty;
        }
    }
    Probe::Left
}

/// Across rotations, unless the box is what is large and dividing it helps.
fn split(conditions: &Conditions<'_>, cell: &Cell, reach: f64) -> [Cell; 2] {
    let turning = cell.rotations().half_width() * reach;
    if conditions.convex() || turning > cell.y_half().max_element() {
        cell.split_rotations()
    } else {
        cell.split_box()
    }
}

/// Whether free space excludes every pose of the cell.
fn excluded(conditions: &Conditions<'_>, cell: &Cell) -> bool {
    conditions.case.sweeps.iter().any(|sweep| {
        let motion = cell.motion(sweep.reach()) + conditions.slack;
        let middle = PivotPose { angle: cell.mid, y: cell.y_mid() };
        sweep.intrudes(&conditions.case.model, middle, -motion)
    })
}

/// Whether free space allows every pose of the cell.
fn all_free(conditions: &Conditions<'_>, cell: &Cell) -> bool {
    conditions.case.sweeps.iter().all(|sweep| {
        let motion = cell.motion(sweep.reach());
        let middle = PivotPose { angle: cell.mid, y: cell.y_mid() };
        sweep.free(&conditions.case.model, middle, -motion)
    })
}

/// Divides cells until their looseness is a small share of the set's size, twice: the set shrinks as they do.
fn enclose(conditions: &Conditions<'_>, mut cells: Vec<Cell>) -> Vec<Cell> {
    let reach = conditions.reach();
    for _ in 0..2 {
        let Some(span) = span(&cells) else { break };
        let bound = conditions.sites.iter().map(|(contact, _)| conditions.case.data[*contact].bound);
        let size = 2.0 * bound.fold(f64::INFINITY, f64::min) + span * 0.5 * conditions.case.model.size;
        let finest = (RESOLUTION * size).max(conditions.case.length_tolerance);
        // looseness = h²·reach / 2
        let half = (2.0 * finest / reach.max(finest)).sqrt().min(FIRST_HALF);
        let pieces = cells.iter().flat_map(|cell| {
            let left = cell.rotations();
            let (low, high) = (cell.y_low, cell.y_high);
            divide(left, half).map(move |part| part.within(low, high))
        });
        cells = pieces
            .filter_map(|part| contracted(conditions, part))
            .filter_map(|mut cell| cell.trim(conditions, 0.02).then_some(cell))
            .collect();
    }
    if conditions.case.sweeps.is_empty() { cells } else { carve(conditions, cells) }
}

/// The width of all rotations that the cells leave, at most.
fn span(cells: &[Cell]) -> Option<f64> {
    let widths: f64 = cells.iter().map(|cell| cell.rotations().width).sum();
    (!cells.is_empty()).then_some(widths)
}

/// Cells that free space neither excludes nor allows whole are divided this often, at most.
const NUM_CARVED: usize = 256;

/// Takes out what free space excludes.
fn carve(conditions: &Conditions<'_>, cells: Vec<Cell>) -> Vec<Cell> {
    let reach = conditions.reach();
    let bound = conditions.sites.iter().map(|(contact, _)| conditions.case.data[*contact].bound);
    let finest = (0.125 * bound.fold(f64::INFINITY, f64::min)).max(conditions.case.length_tolerance);
    let mut queue = VecDeque::from(cells);
    let mut kept = Vec::new();
    let mut num_divided = 0;
    while let Some(cell) = queue.pop_front() {
        if excluded(conditions, &cell) {
            continue;
        }
        if cell.motion(reach) <= finest || num_divided >= NUM_CARVED || all_free(conditions, &cell) {
            kept.push(cell);
            continue;
        }
        num_divided += 1;
        let halves = split(conditions, &cell, reach);
        queue.extend(halves.into_iter().filter_map(|part| contracted(conditions, part)));
    }
    kept
}
