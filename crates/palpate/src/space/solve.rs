//! Is there a pose that satisfies the conditions (MATH 2.1.2), and where are all of them?
//!
//! Cells of pose space are contracted by linear conditions that hold for every valid pose in them; an empty one is a
//! certificate. A pose that satisfies the conditions exactly, or within τ, is a witness. What is neither is divided.

use std::collections::BinaryHeap;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::case::{Case, PivotPose};
use super::cell::{Cell, Conditions};
use super::first_cells::{first_cells, whole};
use super::linear::WIDTH;
use super::lp::Row;
use super::pose_set::Piece;
use super::site::Sites;
use crate::nearest::Nearest;
use crate::recognize::Limit;
use crate::witness;

/// A pose that satisfies the conditions.
pub(crate) type Witness = witness::Witness<PivotPose>;

/// Cells examined for a witness at most. A set that is neither found nor refuted by then is kept as marginal.
pub(super) const MOST_EXAMINED: u32 = 20_000;

/// With a marginal witness in hand, cells examined for a better one.
const ENOUGH_MARGINAL: u32 = 32;

/// Cuts at the candidates before a cell is divided, in pairs.
const NUM_CUTS: usize = 3;

/// Steps from a witness towards the largest slack.
const NUM_STEPS: usize = 4;

/// The looseness that an enclosure may have, as a share of the size of what it encloses.
const RESOLUTION: f64 = 0.02;

/// A witness, or the certificate that there is none, within so many cells.
pub(crate) fn witness(conditions: &Conditions<'_>, most_examined: u32) -> Option<Witness> {
    search(conditions, first_cells(conditions), None, &mut { most_examined })
}

/// A witness within the cells, or the certificate that there is none. Sites that the cells have lost may come back.
/// `budget` is how many cells may be examined, and what is left of it afterwards.
pub(crate) fn witness_within(
    conditions: &Conditions<'_>,
    cells: &[Cell],
    budget: &mut u32,
) -> Option<Witness> {
    let first = cells.iter().map(|cell| Cell { left: all_sites(conditions), ..cell.clone() });
    search(conditions, first, Some(cells), budget)
}

/// Whether there may be a pose, within the cells if they are given: only a certificate that is soon found says no.
pub(crate) fn may_hold(conditions: &Conditions<'_>, cells: Option<&[Cell]>, most_examined: u32) -> bool {
    let mut budget = most_examined;
    match cells {
        Some(cells) => witness_within(conditions, cells, &mut budget),
        None => search(conditions, first_cells(conditions), None, &mut budget),
    }
    .is_some()
}

/// Best first: a certificate needs all cells in any order, a witness is found early. A witness is in one of `bounds`.
fn search(
    conditions: &Conditions<'_>,
    cells: impl Iterator<Item = Cell>,
    bounds: Option<&[Cell]>,
    budget: &mut u32,
) -> Option<Witness> {
    let case = conditions.case;
    let reach = conditions.reach();
    let mut open = BinaryHeap::new();
    let mut num_opened = 0;
    let mut add = |open: &mut BinaryHeap<Nearest<Cell>>, mut cell: Cell| {
        if cell.restrict(conditions) {
            num_opened += 1;
            let miss = conditions.miss(cell.middle());
            open.push(Nearest { miss, number: num_opened, value: cell });
        }
    };
    for cell in cells {
        if let Some(limit) = case.late() {
            return Some(Witness::guess(cell.middle(), limit));
        }
        add(&mut open, cell);
    }
    let mut tried = Tried { conditions, bounds, fallback: None };
    for num_examined in 0_u32.. {
        let Some(Nearest { value: mut cell, .. }) = open.pop() else { break };
        let (loose, turn_only) = looseness(conditions, &cell, reach);
        let fine = loose <= 0.25 * case.length_tolerance;
        let mut left = cell.middle();
        let mut rows = None;
        if cell.is_narrow() {
            match probe(&mut tried, &mut cell, if fine { 50 * NUM_CUTS } else { NUM_CUTS }) {
                Probe::Found(witness) => return Some(witness),
                Probe::Empty => continue,
                Probe::Left(pose, left_rows) => {
                    left = pose;
                    rows = Some(left_rows);
                }
            }
        }
        let enough = case.late().or((*budget == 0).then_some(Limit::Effort));
        *budget = budget.saturating_sub(1);
        let limit = enough.or(fine.then_some(Limit::Tolerance));
        if let (None, Some(limit)) = (tried.fallback, limit) {
            // Neither a witness nor a certificate: kept, so that nothing true is lost.
            tried.fallback = Some(Witness::guess(left, limit));
        }
        if enough.is_some() || (tried.fallback.is_some() && num_examined > ENOUGH_MARGINAL) {
            break;
        }
        if !fine {
            if rows.is_some_and(|rows| !cell.contract(&rows) || !cell.restrict(conditions)) {
                continue;
            }
            cell.split(reach, turn_only).into_iter().for_each(|half| add(&mut open, half));
        }
    }
    tried.fallback
}

/// What a few cuts at its candidates make of a cell.
enum Probe {
    Found(Witness),
    Empty,
    /// The last candidate, and the rows that are left.
    Left(PivotPose, Vec<Row<WIDTH>>),
}

/// Poses are tried, and the best that is not quite valid is kept.
struct Tried<'a> {
    conditions: &'a Conditions<'a>,
    bounds: Option<&'a [Cell]>,
    fallback: Option<Witness>,
}

impl Tried<'_> {
    /// The pose as a witness, if it is one without the tolerance.
    fn valid(&mut self, pose: PivotPose) -> Option<Witness> {
        let case = self.conditions.case;
        let (length, turn) = (case.length_tolerance, case.angle_tolerance);
        let within = |bounds: &[Cell]| bounds.iter().any(|cell| cell.holds(pose, length, turn));
        if self.bounds.is_some_and(|bounds| !within(bounds)) {
            return None;
        }
        if self.conditions.satisfied(pose, case.rounding(), case.rounding() / case.scale) {
            return Some(Witness { pose, marginal: false, undecided: None });
        }
        let wanted = self.fallback.is_none_or(|known| !known.is_decided());
        if wanted && self.conditions.satisfied(pose, length, turn) {
            self.fallback = Some(Witness { pose, marginal: true, undecided: None });
        }
        None
    }
}

/// The candidate of the cell's conditions, and that of the conditions about it, are tried; each is cut off if it is not
/// valid, and the next is asked for.
fn probe(tried: &mut Tried<'_>, cell: &mut Cell, num_cuts: usize) -> Probe {
    let conditions = tried.conditions;
    let mut last = cell.middle();
    let mut rows = cell.rows(conditions, false);
    for _ in 0..num_cuts {
        let Some(pose) = cell.candidate(&rows) else { return Probe::Empty };
        last = pose;
        if let Some(found) = tried.valid(pose) {
            return Probe::Found(found);
        }
        cell.cut_at(conditions, pose, &mut rows);
        // Conditions of the first order about the candidate have none of the second order's looseness.
        let near = cell.around(pose, cell.coordinates(pose.rotation));
        if let Some(pose) = near.candidate(&near.rows(conditions, true)) {
            if let Some(found) = tried.valid(pose) {
                return Probe::Found(found);
            }
            cell.cut_at(conditions, pose, &mut rows);
        }
    }
    Probe::Left(last, rows)
}

/// How far what is valid may be from convex at one rotation: nothing where each contact is left one piece of a face.
fn hollow(conditions: &Conditions<'_>, cell: &Cell) -> f64 {
    let case = conditions.case;
    if !cell.is_narrow() || !case.sweeps.is_empty() || case.prior.is_some() {
        return f64::INFINITY;
    }
    let of_condition = |((contact, sites), left): (&(usize, Sites), &Vec<u32>)| {
        let known = case.data[*contact].reading.sensed.map_or(PI, |(_, error)| error + cell.radius());
        match left.as_slice() {
            [only] => sites[*only as usize].hollow(known),
            _ => f64::INFINITY,
        }
    };
    conditions.sites.iter().zip(&cell.left).map(of_condition).fold(0.0, f64::max)
}

/// How loose the linear conditions of a cell are, a length, and whether dividing its rotations is what makes them
/// tighter.
fn looseness(conditions: &Conditions<'_>, cell: &Cell, reach: f64) -> (f64, bool) {
    let hollow = hollow(conditions, cell);
    let turning = cell.looseness() * reach;
    if hollow <= turning {
        (turning + hollow, true)
    } else {
        (cell.motion(reach).min(turning + hollow), false)
    }
}

pub(super) fn all_sites(conditions: &Conditions<'_>) -> Vec<Vec<u32>> {
    conditions.sites.iter().map(|(_, sites)| (0..sites.len() as u32).collect()).collect()
}

/// Poses on the way from one to where the worst bound is left the most of.
pub(crate) fn centred(conditions: &Conditions<'_>, start: PivotPose) -> Vec<PivotPose> {
    let small = 0.05;
    let near = Cell {
        base: start.rotation,
        v: DVec3::ZERO,
        v_half: DVec3::splat(small),
        y: start.y,
        y_half: DVec3::splat(small * conditions.case.scale),
        left: all_sites(conditions),
        cuts: Vec::new(),
    };
    let mut poses = vec![start];
    for _ in 0..NUM_STEPS {
        let last = poses[poses.len() - 1];
        let mut cell = near.around(last, near.coordinates(last.rotation));
        // The sites that are nearest where it is.
        cell.keep_nearest(conditions, last);
        let Some(next) = cell.candidate(&cell.rows(conditions, true)) else { break };
        poses.push(next);
    }
    poses
}

/// Cells around all poses of a piece, as they are known.
pub(super) fn boxes(case: &Case, piece: &Piece) -> Vec<Cell> {
    if !piece.bounds.is_empty() {
        return piece.bounds.clone();
    }
    let conditions = piece.conditions(case);
    let mut left = Vec::new();
    for cell in first_cells(&conditions) {
        if case.stopped() {
            return vec![whole(&conditions)];
        }
        left.extend(contracted(&conditions, cell));
    }
    left
}

/// Cells that hold every pose that satisfies the conditions, in the chart of `base` where that can be, within `bounds` if
/// there are any. They are divided no more where they are `most`.
pub(crate) fn cells(
    conditions: &Conditions<'_>,
    base: Option<DMat3>,
    bounds: &[Cell],
    most: usize,
) -> Vec<Cell> {
    let reach = conditions.reach();
    let within = |cell: &Cell| cell.widened(conditions.slack, conditions.angle, all_sites(conditions));
    let anywhere = bounds.is_empty().then(|| first_cells(conditions));
    let first = anywhere.into_iter().flatten().chain(bounds.iter().map(within));
    let rebased = |cell: Cell| match base.filter(|base| cell.base != *base) {
        Some(base) => cell.rebased(base).unwrap_or(cell),
        None => cell,
    };
    let contracted = |cell: Cell| {
        let cell = shrunk(conditions, rebased(cell))?;
        // In a chart of its own a wide cell is contracted before it fits into the common one.
        if base.is_none_or(|base| cell.base == base) { Some(cell) } else { shrunk(conditions, rebased(cell)) }
    };
    let mut open: Vec<Cell> = first.filter_map(contracted).collect();
    let bound = conditions.sites.iter().map(|(contact, _)| conditions.case.data[*contact].bound);
    let least = bound.fold(f64::INFINITY, f64::min);
    loop {
        let widest = open.iter().map(Cell::radius).fold(0.0, f64::max);
        let size = 2.0 * least + widest * 0.5 * conditions.case.model.size;
        let finest = (RESOLUTION * size).max(conditions.case.length_tolerance);
        let coarse = |cell: &Cell| {
            let (loose, turn_only) = looseness(conditions, cell, reach);
            loose > if turn_only { finest } else { 0.5 * size }
        };
        let count = open.len();
        if count >= most || conditions.case.stopped() || !open.iter().any(&coarse) {
            return open;
        }
        let parts = open.into_iter().flat_map(|cell| {
            if coarse(&cell) {
                cell.split(reach, looseness(conditions, &cell, reach).1).to_vec()
            } else {
                vec![cell]
            }
        });
        open = parts.filter_map(contracted).collect();
    }
}

/// What is left of the halves of a cell of an enclosure.
pub(super) fn halved(conditions: &Conditions<'_>, cell: &Cell) -> impl Iterator<Item = Cell> {
    let reach = conditions.reach();
    let halves = cell.split(reach, looseness(conditions, cell, reach).1);
    halves.into_iter().filter_map(|half| shrunk(conditions, half))
}

/// Contracted until that gains little.
fn shrunk(conditions: &Conditions<'_>, mut cell: Cell) -> Option<Cell> {
    loop {
        let before = cell.radius();
        cell = contracted(conditions, cell)?;
        if !cell.is_linear() || cell.radius() > 0.9 * before {
            return Some(cell);
        }
    }
}

/// Shrunk to what its linear conditions leave.
pub(super) fn contracted(conditions: &Conditions<'_>, mut cell: Cell) -> Option<Cell> {
    for _ in 0..2 {
        if !cell.restrict(conditions) {
            return None;
        }
        if !cell.is_linear() {
            return Some(cell);
        }
        let rows = cell.rows(conditions, false);
        let before = cell.radius();
        if !cell.contract(&rows) {
            return None;
        }
        if cell.radius() > 0.7 * before {
            break;
        }
    }
    Some(cell)
}
