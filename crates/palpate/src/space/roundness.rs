//! Continuous symmetries within slacks: whether a part may be a body of revolution, or a ball, of which the faces are a
//! tessellation.
//!
//! **Criterion.** There is a surface `S` that every turn about the axis (the center) maps onto itself, and each point of
//! it has a point of a face within `position_slack` whose face's normal is within `normal_slack` of that of `S`. Slacks
//! grant that the true surface is `S`; what explains contacts at one pose then does so at each turned one. Only faces
//! that are made like the following are recognized, so that a part may be round without being known to be. Corners are
//! known to a precision only ([`Scale::precision`](super::scale::Scale::precision)), which is granted beside the slacks.
//!
//! **Bands.** A face with corners at azimuths `±β` about its own, two at radius `R₁` and height `z₁`, two at `R₂` and
//! `z₂` (or one on the axis, `R₂ = 0`); faces of the same radii and heights that fill all azimuths. `S` is the cone
//! through the corners. A point of `S` between the two circles, at radius `R`, has at its own azimuth and height the point
//! of the face's chord at radius `R cos β / cos θ`, `|θ| ≤ β`: no further than `R (1 − cos β)`. With `Δ` the differences of
//! the two circles, normals of `S` and of the face are along `(Δz, −ΔR)` and `(Δz, −ΔR cos β)`, radial before axial
//! parts, turned by `θ` about the axis; the angle between them is largest for `θ = β`.
//!
//! **Caps.** A face across the axis, each of whose loops has its corners on a circle about the axis, in the order of their
//! azimuths, less than half a turn apart. `S` is the disc or ring of these circles: no further from the face than
//! `R (1 − cos β)` for half of the largest step `2 β`, with the same normal.
//!
//! **Balls.** Every face of a closed part that goes once around the center is seen from it from behind, at a distance of
//! `h` or more, and no corner is further from it than `R`. `S` is the sphere of radius `R`. The ray to a point of `S`
//! meets a face at a distance of `h … R`, where the face's normal is at most `acos(h / R)` from the ray.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use super::model::{Face, Model, Roundness};
use super::motions::turn;
use super::spherical::angle;
use crate::part::Surface;

/// A whole turn is known to this, radians.
const SAME: f64 = 1e-9;

/// The continuous symmetry of a model, if it is certain.
pub(super) fn roundness(model: &Model) -> Option<Roundness> {
    if model.position_slack == 0.0 || model.normal_slack == 0.0 {
        return None;
    }
    let touchable = |face: &Face| face.surface == Surface::Touchable;
    if model.faces.iter().all(touchable)
        && let Some(center) = ball(model)
    {
        return Some(Roundness::Ball { center });
    }
    let is_round =
        |(point, direction): &(DVec3, DVec3)| Round { model, point: *point, direction: *direction }.holds();
    let (point, direction) = axes(model).into_iter().find(is_round)?;
    Some(Roundness::Axis { point, direction })
}

/// The center, if the model is a ball.
fn ball(model: &Model) -> Option<DVec3> {
    let center = center(model)?;
    let farthest = model.vertices.iter().map(|vertex| vertex.point.distance(center)).fold(0.0, f64::max);
    let height = |face: &Face| face.offset - face.normal.dot(center);
    let nearest = model.faces.iter().map(height).fold(f64::INFINITY, f64::min);
    let (farthest, nearest) = (farthest - model.precision, nearest + model.precision);
    let spread = (farthest * farthest - nearest * nearest).max(0.0).sqrt().atan2(nearest);
    let holds = model.closed
        && nearest > 0.0
        && farthest - nearest <= model.position_slack
        && spread <= model.normal_slack
        && model.winding_by_angle(center) == 1;
    holds.then_some(center)
}

/// The center of the sphere that is nearest to the vertices (in the sense of squares of squares).
fn center(model: &Model) -> Option<DVec3> {
    let origin = model.vertices[0].point;
    let offsets = || model.vertices.iter().map(|vertex| vertex.point - origin);
    let count = model.vertices.len() as f64;
    let mean = offsets().sum::<DVec3>() / count;
    let mean_sq = offsets().map(DVec3::length_squared).sum::<f64>() / count;
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for offset in offsets() {
        let off = offset - mean;
        matrix += DMat3::from_cols(off * off.x, off * off.y, off * off.z);
        right += 0.5 * (offset.length_squared() - mean_sq) * off;
    }
    let scale = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    let is_flat = matrix.determinant().abs() <= 1e-9 * scale.powi(3);
    (!is_flat).then(|| origin + matrix.inverse() * right)
}

/// Lines that may be axes: those of the smallest turns that map the model onto itself, and those through the middle of
/// the face with the most corners and across it.
fn axes(model: &Model) -> Vec<(DVec3, DVec3)> {
    let mut axes = Vec::new();
    let turns = model.symmetries.iter().skip(1).map(|symmetry| symmetry.motion);
    if let Some(least) = turns.min_by(|a, b| a.angle().total_cmp(&b.angle())) {
        let m = least.rotation;
        let axis = DVec3::new(m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
        let middle =
            model.vertices.iter().map(|vertex| vertex.point).sum::<DVec3>() / model.vertices.len() as f64;
        axes.extend(axis.try_normalize().map(|direction| (middle, direction)));
    }
    let by_corners = model.faces.iter().rev().max_by_key(|face| face.loops[0].len());
    axes.extend(by_corners.map(|face| {
        let corners = face.loops[0].iter().map(|&k| model.vertices[k as usize].point);
        (corners.sum::<DVec3>() / face.loops[0].len() as f64, face.normal)
    }));
    axes
}

/// A model and what may be its axis.
struct Round<'a> {
    model: &'a Model,
    point: DVec3,
    direction: DVec3,
}

/// A face of a band: what must be the same all around, and which azimuths it spans.
struct Band {
    surface: Surface,
    /// Radius and height of its two circles.
    shape: [f64; 4],
    /// The height of its outer normal, and how well it is known.
    rise: (f64, f64),
    middle: f64,
    half: f64,
}

impl Round<'_> {
    fn holds(&self) -> bool {
        let mut bands: Vec<Band> = Vec::new();
        for face in self.model.faces.iter().filter(|face| face.surface != Surface::Seam) {
            if self.is_cap(face) {
                continue;
            }
            match self.band(face) {
                Some(band) => bands.push(band),
                None => return false,
            }
        }
        while let Some(first) = bands.pop() {
            let alike = |band: &Band| {
                let same = |k: usize| (band.shape[k] - first.shape[k]).abs() <= self.tol();
                let risen = (band.rise.0 - first.rise.0).abs() <= band.rise.1 + first.rise.1;
                band.surface == first.surface && (0..4).all(same) && risen
            };
            let (mut same, others): (Vec<Band>, Vec<Band>) = bands.into_iter().partition(alike);
            bands = others;
            same.push(first);
            if !fills(&mut same, self.tol()) {
                return false;
            }
        }
        true
    }

    /// What two corners may be off, one against the other.
    fn tol(&self) -> f64 {
        2.0 * self.model.precision
    }

    fn turn(&self, face: &Face) -> f64 {
        turn(face, &self.model.vertices, self.model.precision)
    }

    /// Radius, height and azimuth of a corner.
    fn cylindrical(&self, number: u32) -> (f64, f64, f64) {
        let offset = self.model.vertices[number as usize].point - self.point;
        let right = self.direction.any_orthonormal_vector();
        let (x, y) = (offset.dot(right), offset.dot(self.direction.cross(right)));
        (x.hypot(y), offset.dot(self.direction), y.atan2(x))
    }

    /// Whether chords over `2 half` of a circle of this radius are within the slack of it.
    fn is_near(&self, radius: f64, half: f64) -> bool {
        let sagitta = 2.0 * radius * (0.5 * half).sin().powi(2);
        sagitta <= self.model.position_slack + self.model.precision
    }

    fn is_cap(&self, face: &Face) -> bool {
        let across = angle(face.normal, self.direction);
        let farthest = face.loops.iter().flatten().map(|&k| self.cylindrical(k).0).fold(0.0, f64::max);
        let is_across = across.min(PI - across) * farthest <= self.tol().max(self.turn(face) * farthest);
        let sign = face.normal.dot(self.direction).signum();
        is_across
            && face.loops.len() <= 2
            && face.loops.iter().enumerate().all(|(k, outline)| {
                let corners: Vec<(f64, f64, f64)> = outline.iter().map(|&k| self.cylindrical(k)).collect();
                let onward = if k == 0 { sign } else { -sign };
                let steps = (0..corners.len()).map(|k| {
                    let (from, to) = (corners[k].2, corners[(k + 1) % corners.len()].2);
                    (onward * (to - from)).rem_euclid(TAU)
                });
                let (sum, largest) =
                    steps.fold((0.0, 0.0_f64), |(sum, most), step| (sum + step, most.max(step)));
                let radius = corners[0].0;
                (sum - TAU).abs() < SAME
                    && largest < PI
                    && corners.iter().all(|corner| (corner.0 - radius).abs() <= self.tol())
                    && self.is_near(radius, 0.5 * largest)
            })
    }

    /// A face as part of a band, if it is within slacks of the cone through its corners.
    fn band(&self, face: &Face) -> Option<Band> {
        let [outline] = face.loops.as_slice() else { return None };
        let radial = face.normal.reject_from_normalized(self.direction);
        let right = self.direction.any_orthonormal_vector();
        let middle = radial.dot(self.direction.cross(right)).atan2(radial.dot(right));
        // The normals of a bore point to the axis.
        let beside = |&k: &u32| radial.dot(self.model.vertices[k as usize].point - self.point);
        let is_bore = outline.iter().map(beside).sum::<f64>() < 0.0;
        let middle = if is_bore { middle + PI } else { middle };
        let turn = self.turn(face);
        // Of each corner radius, height, and azimuth from the middle.
        let of_corner = |&k: &u32| {
            let (radius, height, azimuth) = self.cylindrical(k);
            let from_middle = (azimuth - middle + PI).rem_euclid(TAU) - PI;
            if radius <= self.tol() { (0.0, height, 0.0) } else { (radius, height, from_middle) }
        };
        let mut corners: Vec<(f64, f64, f64)> = outline.iter().map(of_corner).collect();
        // Corners tell the middle better than the normal does.
        let beside_axis = corners.iter().filter(|c| c.0 > 0.0);
        let off = beside_axis.clone().map(|c| c.2).sum::<f64>() / beside_axis.count().max(1) as f64;
        corners.iter_mut().filter(|c| c.0 > 0.0).for_each(|c| c.2 -= off);
        let middle = middle + off;
        let outward = corners.iter().all(|c| c.0 == 0.0 || c.2.abs() < 0.5 * PI);
        let [first, second] = self.circles(&corners)?;
        let half = if first.2 > 0.0 { first.2 } else { second.2 };
        let (rise, run) = (second.1 - first.1, second.0 - first.0);
        // Normals of the cone and of the face, where they differ most.
        let of_cone = DVec3::new(rise * half.cos(), rise * half.sin(), -run).try_normalize()?;
        let of_face = DVec3::new(rise, 0.0, -run * half.cos()).try_normalize()?;
        let holds = outward
            && off.abs() * radial.length() <= turn
            && angle(of_cone, of_face) <= self.model.normal_slack + turn
            && self.is_near(first.0.max(second.0), half);
        let shape = [first.0, first.1, second.0, second.1];
        let rise = (face.normal.dot(self.direction), turn);
        holds.then_some(Band { surface: face.surface, shape, rise, middle, half })
    }

    /// The two circles on which the corners lie, as radius, height and half of the azimuths spanned; the lower one first,
    /// or the narrower one if both are as high.
    fn circles(&self, corners: &[(f64, f64, f64)]) -> Option<[(f64, f64, f64); 2]> {
        let tol = self.tol();
        let spread = |of: fn(&(f64, f64, f64)) -> f64| {
            let values = || corners.iter().map(of);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let by_height = spread(|c| c.1) >= spread(|c| c.0);
        let mut sorted = corners.to_vec();
        sorted.sort_by(|a, b| if by_height { a.1.total_cmp(&b.1) } else { a.0.total_cmp(&b.0) });
        // The corners of one circle by their azimuths: a lone one is the apex.
        let first = if sorted.len() == 3 && sorted[0].0 == 0.0 { 1 } else { 2.min(sorted.len()) };
        let (lower, upper) = sorted.split_at_mut(first);
        lower.sort_by(|a, b| a.2.total_cmp(&b.2));
        upper.sort_by(|a, b| a.2.total_cmp(&b.2));
        let circle = |a: (f64, f64, f64), b: (f64, f64, f64)| {
            let same = (a.0 - b.0).abs() <= tol && (a.1 - b.1).abs() <= tol;
            (same && (a.2 + b.2).abs() * a.0 <= tol && b.2 > 0.0).then_some((a.0, a.1, b.2))
        };
        let [first, second] = match *sorted.as_slice() {
            [a, b, c, d] => [circle(a, b)?, circle(c, d)?],
            [a, b, c] if a.0 == 0.0 => [a, circle(b, c)?],
            [a, b, c] if c.0 == 0.0 => [circle(a, b)?, c],
            _ => return None,
        };
        let alike =
            first.0 == 0.0 || second.0 == 0.0 || (first.2 - second.2).abs() * first.0.max(second.0) <= tol;
        let is_lower = if (first.1 - second.1).abs() > tol { first.1 < second.1 } else { first.0 < second.0 };
        alike.then_some(if is_lower { [first, second] } else { [second, first] })
    }
}

/// Whether faces of one band follow one another all around the axis, to within a length.
fn fills(bands: &mut [Band], tol: f64) -> bool {
    for band in bands.iter_mut() {
        band.middle = band.middle.rem_euclid(TAU);
    }
    bands.sort_by(|a, b| a.middle.total_cmp(&b.middle));
    let n = bands.len();
    n >= 2
        && (0..n).all(|k| {
            let (here, next) = (&bands[k], &bands[(k + 1) % n]);
            let step = (next.middle - here.middle).rem_euclid(TAU);
            (step - here.half - next.half).abs() * here.shape[0].max(here.shape[2]) <= 2.0 * tol
        })
}
