//! Corners that are one: those that coincide, and, where a surface ends, those that single precision may have made of one.
//!
//! **Where.** A surface whose edges all meet needs no wider tolerance, and its smallest details are left as they are. Of
//! triangles that were written each with corners of their own, each rounded by itself, edges are left over; the corners
//! at their ends are within a few roundings of their neighbours'.
//!
//! **What it costs.** Such corners go to their mean. A triangle is an affine image of its corners, so that none of its
//! points moves further than one of them does. No triangle or face loses a corner by it.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::report_on;
use crate::groups::Groups;
use crate::part::Mend;

/// Corners that become one.
#[derive(Debug)]
pub(super) struct Joint {
    /// Point numbers, in order; two or more.
    pub(super) points: Vec<u32>,
    /// Their mean.
    pub(super) place: DVec3,
    /// None of them is further from it.
    pub(super) moved: f64,
}

/// For each point the first one within `merge_tol` of it that stands for itself.
pub(super) fn welded(points: &[DVec3], merge_tol: f64) -> Vec<u32> {
    // Far wider than the tolerance, so that most points look into one cell only.
    let width = 64.0 * merge_tol;
    let cell = |point: DVec3| (point / width).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut of_point = Vec::with_capacity(points.len());
    for (k, &point) in points.iter().enumerate() {
        let mut found: Option<u32> = None;
        for cell in between(cell(point - merge_tol), cell(point + merge_tol)) {
            let near = cells.get(&cell).into_iter().flatten().copied();
            let within = near.filter(|&j| points[j as usize].distance(point) <= merge_tol);
            found = found.into_iter().chain(within).min();
        }
        if found.is_none() {
            cells.entry(cell(point)).or_default().push(k as u32);
        }
        of_point.push(found.unwrap_or(k as u32));
    }
    of_point
}

/// Chains of corners, each no further than `tol` from the next, as long as all are within twice of that of their mean, and
/// no outline has two of them: else they are a line of fine details. `corners` are distinct point numbers in order.
pub(super) fn joints<'a>(
    points: &[DVec3],
    corners: &[u32],
    outlines: impl Iterator<Item = &'a [u32]>,
    tol: f64,
) -> Vec<Joint> {
    let at = |k: usize| points[corners[k] as usize];
    let cell = |point: DVec3| (point / tol).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut groups = Groups::new(corners.len());
    for k in 0..corners.len() {
        for cell in between(cell(at(k) - tol), cell(at(k) + tol)) {
            for &j in cells.get(&cell).into_iter().flatten() {
                if at(j).distance(at(k)) <= tol {
                    groups.unite(j, k);
                }
            }
        }
        cells.entry(cell(at(k))).or_default().push(k);
    }
    let joint = |points_of: Vec<u32>| {
        let first = points[points_of[0] as usize];
        let offsets = || points_of.iter().map(|&k| points[k as usize] - first);
        let place = first + offsets().sum::<DVec3>() / points_of.len() as f64;
        let moved = points_of.iter().map(|&k| points[k as usize].distance(place)).fold(0.0, f64::max);
        (moved <= 2.0 * tol).then_some(Joint { points: points_of, place, moved })
    };
    let chains = groups.collect(corners.iter().copied()).into_iter();
    let mut joints: Vec<Joint> = chains.filter(|chain| chain.len() > 1).filter_map(joint).collect();
    let mut of_point: Vec<Option<usize>> = vec![None; if joints.is_empty() { 0 } else { points.len() }];
    for (number, joint) in joints.iter().enumerate() {
        joint.points.iter().for_each(|&k| of_point[k as usize] = Some(number));
    }
    let mut is_fine = vec![false; joints.len()];
    for outline in outlines.filter(|_| !of_point.is_empty()) {
        let mut met: Vec<(usize, u32)> =
            outline.iter().filter_map(|&k| of_point[k as usize].map(|number| (number, k))).collect();
        met.sort_unstable();
        met.dedup();
        met.windows(2).filter(|pair| pair[0].0 == pair[1].0).for_each(|pair| is_fine[pair[0].0] = true);
    }
    let mut fine = is_fine.into_iter();
    joints.retain(|_| !fine.next().unwrap_or(false));
    joints
}

/// Moves the first corner of each joint to its place, and says for each point which one stands for it.
pub(super) fn apply(points: &mut [DVec3], joints: &[Joint]) -> Vec<u32> {
    let mut of_point: Vec<u32> = (0..points.len() as u32).collect();
    for joint in joints {
        let first = joint.points[0];
        points[first as usize] = joint.place;
        joint.points.iter().for_each(|&k| of_point[k as usize] = first);
    }
    of_point
}

/// Says how many corners were welded, to how many, and what it costs.
pub(super) fn report_welded(mends: &mut Vec<Mend>, count: usize, places: usize, moved: f64, tol: f64) {
    let what = format!(
        "corners where the surface ended, no more than {tol:.1e} apart, welded to {places}: they moved by up to {moved:.1e}, \
         which is in the slacks"
    );
    report_on(mends, "vertices", count, &what);
}

/// The cells of a block.
pub(super) fn between(low: [i64; 3], high: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let along_z = move |x, y| (low[2]..=high[2]).map(move |z| [x, y, z]);
    (low[0]..=high[0]).flat_map(move |x| (low[1]..=high[1]).flat_map(move |y| along_z(x, y)))
}
