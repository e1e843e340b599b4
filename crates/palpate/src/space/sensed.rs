//! Ranges of pairs of contacts in space (thesis 2.2.2, corrected by MATH 2.2).

use std::f64::consts::PI;

use glam::DVec3;

use super::spherical::{ANGLE_ROUNDING, angle};
use crate::tree::{PairRange, Range};

/// Lengths are rounded outward by so much of the longest that they are computed from.
const ROUNDING: f64 = 1e-12;

/// What a contact says of the surface, tolerances and slacks included.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sensed {
    /// The surface point, in any frame that the contacts share.
    pub point: DVec3,
    /// The true surface point is no further from it.
    pub bound: f64,
    /// A unit normal, and the largest angle between it and the true one, radians.
    pub normal: Option<(DVec3, f64)>,
}

/// What the true points and normals of two contacts can have between them: tight where errors are independent.
pub(crate) fn sensed_range(first: &Sensed, second: &Sensed) -> PairRange {
    let offset = second.point - first.point;
    let rounding = ROUNDING * (first.point.length() + second.point.length());
    let error = (first.bound + second.bound) * (1.0 + ROUNDING) + rounding;
    let length = offset.length();
    let angles = match (first.normal, second.normal) {
        (Some((a, a_bound)), Some((b, b_bound))) => about(angle(a, b), a_bound + b_bound),
        _ => Range { low: 0.0, high: PI },
    };
    PairRange {
        distance: Range { low: (length - error).max(0.0), high: length + error },
        angle: angles,
        direction: along(first.normal, offset, error),
        direction_back: along(second.normal, -offset, error),
    }
}

/// What is within `bound` of an angle, of what an angle can be.
fn about(angle: f64, bound: f64) -> Range {
    Range { low: (angle - bound - ANGLE_ROUNDING).max(0.0), high: (angle + bound + ANGLE_ROUNDING).min(PI) }
}

/// `U · (offset + e)` over normals `U` of the cone and `‖e‖ ≤ error` (MATH 1.1, rows 5, 18, 19).
fn along(normal: Option<(DVec3, f64)>, offset: DVec3, error: f64) -> Range {
    let Some((normal, bound)) = normal else {
        return Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    };
    let length = offset.length();
    let angles =
        offset.try_normalize().map_or(Range { low: 0.0, high: PI }, |to| about(angle(normal, to), bound));
    Range { low: length * angles.high.cos(), high: length * angles.low.cos() }.widened(error)
}
