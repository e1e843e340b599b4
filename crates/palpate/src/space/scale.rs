//! The size of what is read, and at which distances points are one.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::Error;

/// Points closer than this share of the part's size are one point.
const MERGE_TOL: f64 = 1e-9;

/// A few roundings of single-precision coordinates, in which meshes are stored, as a share of the part's size or of its
/// distance from the origin. Two points that are off by one unit of the last place in each coordinate, in opposite senses,
/// are at most 4.2e-7 of the largest coordinate apart.
const SINGLE_TOL: f64 = 5e-7;

/// Single precision is coarser far from the origin. Beyond so many sizes it is not followed: no tolerance is more than
/// 5e-6 of the size, so that what is 1e-5 of it apart stays apart.
const FAR: f64 = 10.0;

/// How well corners are known that were rounded to single precision, as a share of [`SINGLE_TOL`]: two are off by half a unit of
/// the last place in each coordinate, together at most 2.1e-7 of the largest one; it is above that, and below half of τ.
const ROUNDED: f64 = 0.6;

/// What is further apart than this share of the size is not the same, however large the slacks.
const APART: f64 = 1e-5;

/// Coordinates may be this many times the part's size: beyond, they no longer resolve [`MERGE_TOL`].
const FARTHEST: f64 = 1e6;

/// Lengths outside of these, to the fourth power and more, would leave the range of numbers.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// Distances below which points are one, or on a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// The diagonal of the box around all points.
    pub(super) size: f64,
    /// Points this close are one.
    pub(super) merge_tol: f64,
    /// What single precision may make of one point. Corners where a surface ends that are no further apart, and points this
    /// close to a plane or a line, may be taken to be one, or to lie on it, if slacks say so.
    pub(super) single_tol: f64,
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
        let single_tol = SINGLE_TOL * farthest.clamp(size, FAR * size);
        Ok(Self { size, merge_tol: MERGE_TOL * size, single_tol })
    }
}

impl Scale {
    /// Whether the origin is so far that rounding to single precision may part points by more than is granted.
    pub(super) fn is_far(self) -> bool {
        self.single_tol >= SINGLE_TOL * FAR * self.size
    }

    /// How well corners are known: up to single precision, or to what was mended, if that is more.
    pub(super) fn precision(self, position_slack: f64) -> f64 {
        (ROUNDED * self.single_tol).max(position_slack.min(APART * self.size))
    }

    /// Which of the points `sorted` by x lie on the inside of a segment, in their order along it, and how far each is off.
    /// What may be an end of the segment, but for rounding, is not on its inside, unless it is known to be `apart` from it.
    pub(super) fn points_on(
        &self,
        points: &[DVec3],
        ends: [u32; 2],
        sorted: &[u32],
        apart: impl Fn(u32, u32) -> bool,
    ) -> Vec<(f64, u32)> {
        let [a, b] = ends.map(|k| points[k as usize]);
        let length = a.distance(b);
        let along = (b - a) / length;
        let (low, high) = (a.x.min(b.x) - self.single_tol, a.x.max(b.x) + self.single_tol);
        let first = sorted.partition_point(|&k| points[k as usize].x < low);
        let mut found = Vec::new();
        for &k in sorted[first..].iter().take_while(|&&k| points[k as usize].x <= high) {
            let offset = points[k as usize] - a;
            let place = offset.dot(along);
            let off = (offset - place * along).length();
            let is_inside = |from_end: f64, end: u32| {
                from_end > self.single_tol || from_end > self.merge_tol && apart(k, end)
            };
            if is_inside(place, ends[0]) && is_inside(length - place, ends[1]) && off <= self.single_tol {
                found.push((place, off, k));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, off, k)| (off, k)).collect()
    }
}

/// A point as it is shown in messages.
pub(super) fn at(point: DVec3) -> String {
    format!("({}, {}, {})", point.x, point.y, point.z)
}
