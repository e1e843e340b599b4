//! Where a placed model point may be: supports over pose cells, and the polygon that they bound.

use std::f64::consts::TAU;

use glam::{DVec2, dvec2};

use super::cell::Cell;

/// Directions in which a region is measured.
pub(crate) const DIRECTIONS: usize = 64;

fn direction(k: usize) -> DVec2 {
    DVec2::from_angle(TAU * k as f64 / DIRECTIONS as f64)
}

/// Raises the supports to those of the model point over one cell, from the pivot, world frame.
///
/// The placed point is `R(θ)(V − y)` from the pivot. With θ = mid + d, `w = V − y` and `w̄` at the middle of the box,
/// `v·R(θ)w = cos d (v'·w) + sin d (v'·Jw̄) + sin d (v'·J(w − w̄))`, v' = R(−mid)v: linear in (s, y) but for `cos d`,
/// which is within ρ of μ, and for the last product, which is bounded over the box.
pub(crate) fn grow(supports: &mut [f64; DIRECTIONS], cell: &Cell, point_model: DVec2, outward: f64) {
    let turn = DVec2::from_angle(-cell.mid);
    let arm = point_model - cell.y_mid();
    let half = cell.y_half();
    let largest_sine = cell.half.min(std::f64::consts::FRAC_PI_2).sin();
    let lowest_cosine = cell.half.cos();
    let (mu, rho) = (0.5 * (1.0 + lowest_cosine), 0.5 * (1.0 - lowest_cosine));
    for (k, support) in supports.iter_mut().enumerate() {
        let v = turn.rotate(direction(k));
        // v·Jw = −(Jv)·w
        let across = -v.perp();
        let slack = rho * (v.dot(arm).abs() + v.abs().dot(half)) + largest_sine * across.abs().dot(half);
        let place = |(s, y): (f64, DVec2)| mu * v.dot(point_model - y) + s * across.dot(arm);
        let most = if cell.corners().len() > 0 {
            cell.corners().map(place).fold(f64::NEG_INFINITY, f64::max)
        } else {
            mu * v.dot(arm) + v.abs().dot(half) + largest_sine * across.dot(arm).abs()
        };
        *support = support.max(most + slack + outward);
    }
}

/// The intersection of the half-planes `direction(k)·p <= supports[k]`, counter-clockwise.
pub(crate) fn polygon(supports: &[f64; DIRECTIONS]) -> Vec<DVec2> {
    let reach = supports.iter().fold(0.0_f64, |most, support| most.max(support.abs())) * 2.0;
    let mut corners =
        vec![dvec2(-reach, -reach), dvec2(reach, -reach), dvec2(reach, reach), dvec2(-reach, reach)];
    for (k, support) in supports.iter().enumerate() {
        corners = clip(&corners, direction(k), *support);
    }
    corners
}

/// The part of a convex polygon in which `normal·p <= offset`.
pub(crate) fn clip(corners: &[DVec2], normal: DVec2, offset: f64) -> Vec<DVec2> {
    let height = |corner: DVec2| normal.dot(corner) - offset;
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (at, &corner) in corners.iter().enumerate() {
        let next = corners[(at + 1) % corners.len()];
        let (here, there) = (height(corner), height(next));
        if here <= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
            kept.push(corner + (next - corner) * (here / (here - there)));
        }
    }
    kept
}
