//! Is there a pose that satisfies the conditions (MATH 2.1.2), and where are all of them?
//!
//! Cells of pose space are contracted by linear conditions that hold for every valid pose in them; an empty one is a
//! certificate. A pose that satisfies the conditions exactly, or within τ, is a witness. What is neither is divided.

use std::collections::BinaryHeap;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::case::PivotPose;
use super::cell::{Cell, Conditions};
use super::pose;
use super::site::{Site, angle};
use crate::nearest::Nearest;
use crate::witness;

/// A pose that satisfies the conditions.
pub(crate) type Witness = witness::Witness<PivotPose>;

/// Cells examined for a witness at most. A set that is neither found nor refuted by then is kept as marginal.
const MOST_EXAMINED: u32 = 20_000;

/// With a marginal witness in hand, cells examined for a better one.
const ENOUGH_MARGINAL: u32 = 32;

/// Cuts at the candidates before a cell is divided, in pairs.
const NUM_CUTS: usize = 3;

/// Steps from a witness towards the largest slack.
const NUM_STEPS: usize = 4;

/// The looseness that an enclosure may have, as a share of the size of what it encloses.
const RESOLUTION: f64 = 0.02;

/// Cells of an enclosure at most.
const MOST_CELLS: usize = 256;

/// Rotations about one normal are divided into so many cells.
const NUM_SPINS: u32 = 11;

/// Two normals that leave rotations within this angle, radians, are good for a chart.
const GOOD_BALL: f64 = 1.0;

/// A witness, or the certificate that there is none.
pub(crate) fn witness(conditions: &Conditions<'_>) -> Option<Witness> {
    search(conditions, first_cells(conditions), MOST_EXAMINED)
}

/// A witness within the cells, or the certificate that there is none. Sites that the cells have lost may come back.
pub(crate) fn witness_within(conditions: &Conditions<'_>, cells: &[Cell]) -> Option<Witness> {
    let cells = cells.iter().map(|cell| Cell { left: all_sites(conditions), ..cell.clone() });
    search(conditions, cells.collect(), MOST_EXAMINED)
}

/// Whether there may be a pose, within the cells if they are given: only a certificate that is soon found says no.
pub(crate) fn may_hold(conditions: &Conditions<'_>, cells: Option<&[Cell]>, most_examined: u32) -> bool {
    let cells = match cells {
        Some(cells) => {
            cells.iter().map(|cell| Cell { left: all_sites(conditions), ..cell.clone() }).collect()
        }
        None => first_cells(conditions),
    };
    search(conditions, cells, most_examined).is_some()
}

/// Best first: a certificate needs all cells in any order, a witness is found early.
fn search(conditions: &Conditions<'_>, cells: Vec<Cell>, most_examined: u32) -> Option<Witness> {
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
        add(&mut open, cell);
    }
    let mut fallback = None;
    for num_examined in 0_u32.. {
        let Some(Nearest { value: mut cell, .. }) = open.pop() else { break };
        let (loose, turn_only) = looseness(conditions, &cell, reach);
        let fine = loose <= 0.25 * case.length_tolerance;
        let mut left = Witness { pose: cell.middle(), marginal: true, undecided: true };
        if cell.is_narrow() {
            match probe(conditions, &mut cell, if fine { 50 * NUM_CUTS } else { NUM_CUTS }, &mut fallback) {
                Probe::Found(witness) => return Some(witness),
                Probe::Empty => continue,
                Probe::Left(pose) => left.pose = pose,
            }
        }
        let enough = num_examined >= most_examined || case.stopped();
        if fallback.is_none() && (fine || enough) {
            // Neither a witness nor a certificate: kept, so that nothing true is lost.
            fallback = Some(left);
        }
        if enough || (fallback.is_some() && num_examined > ENOUGH_MARGINAL) {
            break;
        }
        if !fine {
            if cell.is_narrow() {
                let rows = cell.rows(conditions, false);
                if !cell.contract(&rows) || !cell.restrict(conditions) {
                    continue;
                }
            }
            cell.split(reach, turn_only).into_iter().for_each(|half| add(&mut open, half));
        }
    }
    fallback
}

/// What a few cuts at its candidates make of a cell.
enum Probe {
    Found(Witness),
    Empty,
    Left(PivotPose),
}

/// The candidate of the cell's conditions, and that of the conditions about it, are tried; each is cut off if it is not
/// valid, and the next is asked for.
fn probe(
    conditions: &Conditions<'_>,
    cell: &mut Cell,
    num_cuts: usize,
    fallback: &mut Option<Witness>,
) -> Probe {
    let case = conditions.case;
    let mut valid = |pose: PivotPose| {
        if conditions.satisfied(pose, case.rounding(), case.rounding() / case.scale) {
            return Some(Witness { pose, marginal: false, undecided: false });
        }
        let wanted = fallback.is_none_or(|known| known.undecided);
        if wanted && conditions.satisfied(pose, case.length_tolerance, case.angle_tolerance) {
            *fallback = Some(Witness { pose, marginal: true, undecided: false });
        }
        None
    };
    let mut last = cell.middle();
    for _ in 0..num_cuts {
        let Some(pose) = cell.candidate(&cell.rows(conditions, false)) else { return Probe::Empty };
        last = pose;
        if let Some(found) = valid(pose) {
            return Probe::Found(found);
        }
        cell.cut_at(conditions, pose);
        // Conditions of the first order about the candidate have none of the second order's looseness.
        let near = cell.around(pose, cell.coordinates(pose.rotation));
        if let Some(pose) = near.candidate(&near.rows(conditions, true)) {
            if let Some(found) = valid(pose) {
                return Probe::Found(found);
            }
            cell.cut_at(conditions, pose);
        }
    }
    Probe::Left(last)
}

/// How far what is valid may be from convex at one rotation: nothing where each contact is left one piece of a face.
fn hollow(conditions: &Conditions<'_>, cell: &Cell) -> f64 {
    let case = conditions.case;
    if !cell.is_narrow() || !case.sweeps.is_empty() || case.prior.is_some() {
        return f64::INFINITY;
    }
    let of_condition = |((contact, sites), left): (&(usize, Vec<Site>), &Vec<u32>)| {
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

fn all_sites(conditions: &Conditions<'_>) -> Vec<Vec<u32>> {
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

/// Cells that hold every pose that satisfies the conditions, in the chart of `base` where that can be, within `bounds` if
/// there are any.
pub(crate) fn cells(conditions: &Conditions<'_>, base: Option<DMat3>, bounds: &[Cell]) -> Vec<Cell> {
    let reach = conditions.reach();
    let first = if bounds.is_empty() {
        first_cells(conditions)
    } else {
        let within = |cell: &Cell| cell.widened(conditions.slack, conditions.angle, all_sites(conditions));
        bounds.iter().map(within).collect()
    };
    let rebased = |cell: Cell| base.and_then(|base| cell.rebased(base)).unwrap_or(cell);
    let mut open: Vec<Cell> =
        first.into_iter().map(rebased).filter_map(|cell| contracted(conditions, cell)).collect();
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
        if count >= MOST_CELLS || conditions.case.stopped() || !open.iter().any(&coarse) {
            return open;
        }
        let parts = open.into_iter().flat_map(|cell| {
            if coarse(&cell) {
                cell.split(reach, looseness(conditions, &cell, reach).1).to_vec()
            } else {
                vec![cell]
            }
        });
        open = parts.filter_map(|cell| contracted(conditions, cell)).collect();
    }
}

/// Shrunk to what its linear conditions leave.
pub(super) fn contracted(conditions: &Conditions<'_>, mut cell: Cell) -> Option<Cell> {
    for _ in 0..2 {
        if !cell.restrict(conditions) {
            return None;
        }
        if !cell.is_narrow() {
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

/// What two contacts' normals leave of the rotations.
#[derive(Clone, Copy)]
struct Sensed {
    /// World frame.
    reading: DVec3,
    /// Model frame.
    normal: DVec3,
    /// The sensed normal, turned, is this near to `normal`, radians.
    error: f64,
}

/// Cells that hold every pose that satisfies the conditions, before these are looked at together.
///
/// Two sensed normals that are not parallel leave a ball of rotations (MATH row 47): with errors `a`, `b`, residuals `e`
/// of the rotation that fits both best, and the acute angle θ between their lines,
/// `sin(Φ/2) ≤ sin((a + e)/2) / sin(θ/2)`. One alone leaves the turns about it; none, all rotations.
pub(super) fn first_cells(conditions: &Conditions<'_>) -> Vec<Cell> {
    let sensed: Vec<Sensed> = conditions.sites.iter().filter_map(|one| of_contact(conditions, one)).collect();
    let mut best: Option<(f64, DMat3)> = None;
    for (k, a) in sensed.iter().enumerate() {
        for b in &sensed[..k] {
            if let Some((turn, radius)) = ball(a, b)
                && best.is_none_or(|(least, _)| radius < least)
            {
                best = Some((radius, turn));
            }
        }
    }
    let prior = conditions.case.prior.map(|prior| {
        let tilt = prior.lying.map_or(0.0, |lying| lying.tilt);
        let radius = (prior.rotation + tilt + conditions.angle).min(PI);
        (radius, prior.world_from_model.rotation.transpose())
    });
    let narrowest =
        [best.filter(|(radius, _)| *radius <= GOOD_BALL), prior.filter(|(radius, _)| *radius < PI)];
    let narrowest = narrowest.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((radius, turn)) = narrowest {
        return vec![first_cell(conditions, turn, DVec3::splat(radius))];
    }
    let surest = sensed.iter().filter(|one| one.error < 1.0).min_by(|a, b| a.error.total_cmp(&b.error));
    match surest {
        Some(one) => spins(conditions, one),
        None => vec![first_cell(conditions, DMat3::IDENTITY, DVec3::splat(PI))],
    }
}

fn of_contact(conditions: &Conditions<'_>, (contact, sites): &(usize, Vec<Site>)) -> Option<Sensed> {
    let (sensed, error) = conditions.case.data[*contact].reading.sensed?;
    let normal = sites.iter().map(Site::mean_normal).sum::<DVec3>().try_normalize()?;
    let spread = sites.iter().map(|site| angle(normal, site.mean_normal()) + site.spread());
    let spread = spread.fold(0.0, f64::max);
    Some(Sensed { reading: sensed, normal, error: error + spread + conditions.angle + 1e-9 })
}

/// The rotation that fits both best, and the radius around it that holds all that both allow.
fn ball(a: &Sensed, b: &Sensed) -> Option<(DMat3, f64)> {
    let frame = |first: DVec3, second: DVec3| {
        let middle = (first + second).try_normalize()?;
        let across = first.cross(second).try_normalize()?;
        Some(DMat3::from_cols(middle, across, middle.cross(across)))
    };
    let turn = frame(a.normal, b.normal)? * frame(a.reading, b.reading)?.transpose();
    // Nearly parallel normals span a frame that is orthogonal only roughly; what is used is a rotation.
    let turn = pose::proper(turn);
    let residual = |one: &Sensed| angle(turn * one.reading, one.normal);
    let worst = (a.error + residual(a)).max(b.error + residual(b));
    let apart = angle(a.reading, b.reading);
    let acute = apart.min(PI - apart);
    let sine = (0.5 * worst).sin() / (0.5 * acute).sin();
    (worst < PI && sine < 1.0).then(|| (turn, 2.0 * sine.asin() + 1e-9))
}

/// Turns about a normal that is known, in cells: each is a tilt `t` by at most the error, after a turn `s` about the
/// normal within the half width. Of the product, the rotation vector is at most `(θ/2)/sin(θ/2)` times `2 sin(t/2)`
/// across, and `2 sin(s/2)` along the normal, where θ is its length, at most `s + t`.
fn spins(conditions: &Conditions<'_>, one: &Sensed) -> Vec<Cell> {
    let half = PI / f64::from(NUM_SPINS);
    let longest = 0.5 * (half + one.error);
    let stretch = longest / longest.sin();
    let across = stretch * 2.0 * (0.5 * one.error).sin() + 1e-9;
    let along = stretch * 2.0 * (0.5 * half).sin() + 1e-9;
    // The chart is turned so that its first axis is the normal.
    let align = DMat3::from_quat(glam::DQuat::from_rotation_arc(one.reading, one.normal));
    let size = one.normal.abs() * along + (DVec3::ONE - one.normal * one.normal).map(f64::sqrt) * across;
    (0..NUM_SPINS)
        .map(|k| {
            let turn = pose::rotation(one.normal * (f64::from(2 * k) * half)) * align;
            first_cell(conditions, turn, size)
        })
        .collect()
}

/// The cell of such rotations, with all model points that may be at the pivot.
fn first_cell(conditions: &Conditions<'_>, base: DMat3, v_half: DVec3) -> Cell {
    let case = conditions.case;
    let radius = v_half.length().min(PI);
    let around = conditions.sites.iter().map(|(contact, sites)| {
        let datum = &case.data[*contact];
        let lever = base * datum.lever;
        let (low, high) = sites.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), site| {
            (low.min(site.middle - site.reach), high.max(site.middle + site.reach))
        });
        let near = datum.bound
            + conditions.slack
            + 2.0 * (0.5 * radius).sin() * datum.lever.length()
            + case.outward();
        (low - lever - near, high - lever + near)
    });
    let (low, high) =
        around.fold((DVec3::NEG_INFINITY, DVec3::INFINITY), |(low, high), (l, h)| (low.max(l), high.min(h)));
    // No overlap: a cell of no size, which its own conditions refute.
    let high = high.max(low);
    Cell {
        base,
        v: DVec3::ZERO,
        v_half,
        y: 0.5 * (low + high),
        y_half: 0.5 * (high - low) + case.outward(),
        left: all_sites(conditions),
        cuts: Vec::new(),
    }
}
