//! All poses of one assignment, sampled densely: plain geometry, no part of what is measured against it.
//!
//! At one rotation the translations that put a contact on its face within its bound form a stadium; those of all
//! contacts are the intersection, a convex region. Round ends are inscribed polygons, so that every sample is valid.

#![allow(dead_code, reason = "each file uses its own part")]

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use palpate::plane::{Face, Pose};
use palpate::{Contact, Feature};

use crate::common::Problem;

/// Sides of the polygon that stands for a disc, and the same where a region is too thin for that.
const NUM_SIDES: usize = 64;
const NUM_SIDES_THIN: usize = 2048;

/// Rotations tried to find the ends of the range, and then within it.
const NUM_SCANNED: usize = 200;
const NUM_SAMPLED: usize = 160;

/// Directions in which a cloud of places is measured, over half a turn.
const NUM_WIDTHS: usize = 90;

/// The poses that satisfy one assignment of contacts to faces.
pub struct TrueSet {
    matches: Vec<(Contact, Face)>,
    /// Added to each bound: a length and an angle.
    slack: (f64, f64),
    num_sides: usize,
}

/// A range of rotations about an anchor.
#[derive(Debug, Clone, Copy)]
pub struct Rotations {
    pub low: f64,
    pub high: f64,
}

impl Rotations {
    pub fn width(self) -> f64 {
        self.high - self.low
    }
}

impl TrueSet {
    /// `tolerance` as a share of the part's size; `None` if a contact has no normal or is not on a face.
    pub fn new(problem: &Problem, assignment: &[Feature], tolerance: f64) -> Option<Self> {
        let one_match = |(contact, feature): (&Contact, &Feature)| match feature {
            Feature::Face(number) if contact.normal.is_some() => {
                Some((*contact, problem.model.faces[*number as usize]))
            }
            _ => None,
        };
        let matches: Option<Vec<_>> =
            problem.evidence.contacts.iter().zip(assignment).map(one_match).collect();
        Some(Self {
            matches: matches?,
            slack: (tolerance * problem.model.size, tolerance),
            num_sides: NUM_SIDES,
        })
    }

    /// The translations that are valid at a rotation, a convex polygon.
    pub fn translations(&self, angle: f64) -> Vec<DVec2> {
        let turn = DVec2::from_angle(angle);
        let mut region = Vec::new();
        for (number, (contact, face)) in self.matches.iter().enumerate() {
            let normal = turn.rotate(face.normal);
            let bound = contact.position_error + self.slack.0;
            let ends = [face.start, face.end]
                .map(|end| contact.center - turn.rotate(end + contact.tip_radius * face.normal));
            if number == 0 {
                region = square_around(ends, bound);
            }
            // Both long sides, then the sides of the polygons at the ends, which have corners on the long sides.
            let apothem = bound * (PI / self.num_sides as f64).cos();
            let sides = (0..self.num_sides).map(|k| {
                (DVec2::from_angle(TAU * (k as f64 + 0.5) / self.num_sides as f64).rotate(normal), apothem)
            });
            for (direction, reach) in [(normal, bound), (-normal, bound)].into_iter().chain(sides) {
                let farthest = ends[0].dot(direction).max(ends[1].dot(direction));
                clip(&mut region, direction, farthest + reach);
            }
            if region.is_empty() {
                break;
            }
        }
        region
    }

    /// The rotations near `anchor` that the normals leave; may be empty, low above high.
    pub fn normal_rotations(&self, anchor: f64) -> Rotations {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (contact, face) in &self.matches {
            let normal = contact.normal.expect("checked when it was made");
            let middle = wrap(normal.direction.to_angle() - face.normal.to_angle() - anchor);
            low = low.max(middle - normal.error - self.slack.1);
            high = high.min(middle + normal.error + self.slack.1);
        }
        Rotations { low: anchor + low, high: anchor + high }
    }

    /// The outermost rotations found within `reach` of `anchor` at which a translation is valid.
    pub fn rotations(&mut self, anchor: f64, reach: f64) -> Option<Rotations> {
        let found = self.scan(anchor, reach);
        if found.is_some() {
            return found;
        }
        self.num_sides = NUM_SIDES_THIN;
        self.scan(anchor, reach)
    }

    fn scan(&self, anchor: f64, reach: f64) -> Option<Rotations> {
        let allowed = self.normal_rotations(anchor);
        let (low, high) = (allowed.low.max(anchor - reach), allowed.high.min(anchor + reach));
        let step = (high - low) / NUM_SCANNED as f64;
        let mut tried: Vec<f64> = (0..NUM_SCANNED).map(|k| low + step * k as f64).collect();
        tried.extend([high, anchor.clamp(low.min(high), high)]);
        tried.sort_by(f64::total_cmp);
        let valid = |angle: &f64| low <= high && !self.translations(*angle).is_empty();
        let first = tried.iter().position(valid)?;
        let last = tried.iter().rposition(valid)?;
        let before = first.checked_sub(1).map(|k| tried[k]);
        let after = tried.get(last + 1).copied();
        Some(Rotations {
            low: before.map_or(tried[first], |outside| bisect(outside, tried[first], valid)),
            high: after.map_or(tried[last], |outside| bisect(outside, tried[last], valid)),
        })
    }

    /// Places of a model point over the poses with these rotations.
    pub fn places(&self, rotations: Rotations, point_model: DVec2) -> Vec<DVec2> {
        let angles =
            (0..=NUM_SAMPLED).map(|k| rotations.low + rotations.width() * k as f64 / NUM_SAMPLED as f64);
        angles
            .flat_map(|angle| {
                let region = self.translations(angle);
                region.into_iter().map(move |translation| Pose::new(angle, translation).apply(point_model))
            })
            .collect()
    }
}

/// The last place on the way from `inside` to `outside` that is valid.
fn bisect(mut outside: f64, mut inside: f64, valid: impl Fn(&f64) -> bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (outside + inside);
        if valid(&middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// The largest width of a cloud of points: no more than its diameter, and short of it by 1.5e-4 at most.
pub fn width(points: &[DVec2]) -> f64 {
    let widths = (0..NUM_WIDTHS).map(|k| {
        let direction = DVec2::from_angle(PI * k as f64 / NUM_WIDTHS as f64);
        let along = points.iter().map(|point| direction.dot(*point));
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    });
    widths.fold(0.0, f64::max)
}

/// An angle brought into `[-π, π)`.
fn wrap(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn square_around(ends: [DVec2; 2], bound: f64) -> Vec<DVec2> {
    let low = ends[0].min(ends[1]) - 2.0 * bound;
    let high = ends[0].max(ends[1]) + 2.0 * bound;
    vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
}

/// Keeps the part of a convex polygon with `direction·p <= offset`.
fn clip(polygon: &mut Vec<DVec2>, direction: DVec2, offset: f64) {
    let heights: Vec<f64> = polygon.iter().map(|corner| direction.dot(*corner) - offset).collect();
    if heights.iter().all(|height| *height <= 0.0) {
        return;
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &here) in polygon.iter().enumerate() {
        let next = (k + 1) % polygon.len();
        let (a, b) = (heights[k], heights[next]);
        if a <= 0.0 {
            kept.push(here);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            kept.push(here.lerp(polygon[next], a / (a - b)));
        }
    }
    *polygon = kept;
}
