//! The size of what is read, and at which distances points are one.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use glam::DVec3;

use crate::Error;

/// Points closer than this share of the part's size are one point.
const MERGE_TOL: f64 = 1e-9;

/// Corners closer to a plane than this share of the part's size or of its distance from the origin lie on it: a few
/// roundings of single-precision coordinates, in which meshes are stored. What they deviate by is a slack.
const PLANAR_TOL: f64 = 5e-7;

/// Coordinates may be this many times the part's size: beyond, they no longer resolve [`MERGE_TOL`].
const FARTHEST: f64 = 1e6;

/// Lengths outside of these, to the fourth power and more, would leave the range of numbers.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// Distances below which points are one, or on a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Points this close are one.
    pub(super) merge_tol: f64,
    /// Points this close to a plane or a line may be taken to lie on it, if slacks say so.
    pub(super) planar_tol: f64,
}

impl Scale {
    /// Of points, of which there must be some; refuses those that can't be told apart reliably.
    pub(super) fn new(argument: &str, points: impl Iterator<Item = DVec3>) -> Result<Self, Error> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            if !point.is_finite() {
                let problem = "has a coordinate that is not finite";
                return Err(Error::new(argument, problem, at(point), "give finite coordinates"));
            }
            (low, high) = (low.min(point), high.max(point));
        }
        let size = low.distance(high);
        if size.is_nan() || size == 0.0 {
            let problem = "has no extent: all points are the same";
            return Err(Error::new(argument, problem, at(low), "give distinct points"));
        }
        if !SIZES.contains(&size) {
            let problem = format!("its size must be between {:e} and {:e}", SIZES.start(), SIZES.end());
            return Err(Error::new(argument, problem, size, "choose another unit of length"));
        }
        let farthest = low.abs().max(high.abs()).max_element();
        if farthest > FARTHEST * size {
            let problem = format!("lies more than {FARTHEST:e} times its size from the origin");
            return Err(Error::new(argument, problem, farthest, "move the origin close to the part"));
        }
        // Single precision is coarser far from the origin; beyond ten sizes the part itself would be too coarse.
        let planar_tol = PLANAR_TOL * farthest.clamp(size, 10.0 * size);
        Ok(Self { merge_tol: MERGE_TOL * size, planar_tol })
    }
}

impl Scale {
    /// Which of the points `sorted` by x lie on the inside of a segment, in their order along it, and how far each is off.
    pub(super) fn points_on(&self, points: &[DVec3], ends: [u32; 2], sorted: &[u32]) -> Vec<(f64, u32)> {
        let [a, b] = ends.map(|k| points[k as usize]);
        let length = a.distance(b);
        let along = (b - a) / length;
        let (low, high) = (a.x.min(b.x) - self.planar_tol, a.x.max(b.x) + self.planar_tol);
        let first = sorted.partition_point(|&k| points[k as usize].x < low);
        let mut found = Vec::new();
        for &k in sorted[first..].iter().take_while(|&&k| points[k as usize].x <= high) {
            let offset = points[k as usize] - a;
            let place = offset.dot(along);
            let off = (offset - place * along).length();
            if place > self.merge_tol && place < length - self.merge_tol && off <= self.planar_tol {
                found.push((place, off, k));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, off, k)| (off, k)).collect()
    }
}

/// For each point the first one within `merge_tol` of it that stands for itself.
pub(super) fn welded(points: &[DVec3], merge_tol: f64) -> Vec<u32> {
    // Far wider than the tolerance, so that most points look into one cell only.
    let width = 64.0 * merge_tol;
    let cell = |point: DVec3| (point / width).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut of_point = Vec::with_capacity(points.len());
    for (k, &point) in points.iter().enumerate() {
        let (low, high) = (cell(point - merge_tol), cell(point + merge_tol));
        let mut found: Option<u32> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).into_iter().flatten().copied();
                    let within = near.filter(|&j| points[j as usize].distance(point) <= merge_tol);
                    found = found.into_iter().chain(within).min();
                }
            }
        }
        if found.is_none() {
            cells.entry(cell(point)).or_default().push(k as u32);
        }
        of_point.push(found.unwrap_or(k as u32));
    }
    of_point
}

/// A point as it is shown in messages.
pub(super) fn at(point: DVec3) -> String {
    format!("({}, {}, {})", point.x, point.y, point.z)
}
