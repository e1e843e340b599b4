//! What a tip on a line meets first at one pose.
//!
//! A point meets triangles; whether it does is decided exactly, so that it slips through no edge. The centre of a ball is
//! within a radius of the part iff it is so of a triangle, an edge or a vertex. Those sets are convex: a line enters each
//! but once. No line gets through the part without being in one of the sets, and each is wider than it is by more than what
//! rounding takes.

use glam::DVec3;

use super::distance::{orient, ray_enters};
use super::model::Model;
use super::pose::Pose;
use super::segments::meets;
use crate::Feature;
use crate::line::{FirstContact, Line};

/// Contacts are told apart by more than this share of the scale: of those at one depth, a face goes first.
const ROUNDING: f64 = 1e-13;

/// Ranks among contacts at one depth, in units of what tells contacts apart: after the front of a face its back, then an
/// edge, then a vertex.
const BACK: f64 = 1.0;
const EDGE: f64 = 2.0;
const VERTEX: f64 = 3.0;
/// A face that was come upon from beside, which its edge should have prevented.
const FROM_BESIDE: f64 = 4.0;

/// A face is met this share of the radius beside it, too, where it and its edge are at the same depth: the two differ by
/// half of its square.
const BESIDE: f64 = 1e-9;

/// Tips are followed from so many sizes of the part away.
const NEAR: f64 = 8.0;

impl Model {
    /// What a tip of this radius meets first on its line, in the world frame. `None`: nothing. The direction of the line
    /// is a unit vector, and the tip is to be clear of the part at its start.
    ///
    /// A point that meets an edge or a corner meets one of its faces; a ball that touches a face where it ends touches the
    /// face. Loose faces are met from both sides. Depths are right to 1e-12 of the scale (which is the largest coordinate of
    /// what is given or of the model) over the cosine of the angle between the line and the normal.
    ///
    /// ```
    /// use glam::{DVec3, dvec3};
    /// use palpate::space::{Model, Pose};
    /// use palpate::{Feature, Line};
    ///
    /// let corners = [dvec3(0.0, 0.0, 0.0), dvec3(3.0, 0.0, 0.0), dvec3(0.0, 4.0, 0.0), dvec3(0.0, 0.0, 5.0)];
    /// let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let model = Model::mesh("corner", &corners, &triangles, &[], 0.0, 0.0).unwrap();
    /// let line = Line { start: dvec3(0.5, 0.5, -7.0), direction: DVec3::Z };
    /// let met = model.first_contact(Pose::IDENTITY, &line, 2.0).unwrap();
    /// assert_eq!((met.depth, met.normal, met.feature), (5.0, DVec3::NEG_Z, Feature::Face(0)));
    /// ```
    #[must_use]
    pub fn first_contact(
        &self,
        world_from_model: Pose,
        line: &Line<DVec3>,
        tip_radius: f64,
    ) -> Option<FirstContact<DVec3>> {
        let model_from_world = world_from_model.inverse();
        let line = Line {
            start: model_from_world.apply(line.start),
            direction: model_from_world.rotation * line.direction,
        };
        // From nearby, where rounding is that of the part, however far away the line begins.
        let skipped = self.free_way(&line, tip_radius)?;
        let tip = Tip::new(self, Line { start: line.at(skipped), ..line }, tip_radius);
        let first = if tip_radius > 0.0 { tip.first_of_ball() } else { tip.first_of_point() }?;
        Some(FirstContact {
            depth: skipped + first.depth.max(0.0),
            normal: world_from_model.rotation * first.normal,
            feature: first.feature,
            touchable: first.front && self.can_be_touched(first.feature),
        })
    }

    /// How far a tip goes without coming near; `None`: it never does.
    fn free_way(&self, line: &Line<DVec3>, radius: f64) -> Option<f64> {
        let (low, high) = self.bvh().around();
        let beside = radius + ROUNDING * (line.start.abs().max_element() + radius);
        let entered = ray_enters(line.start, line.direction, low - beside, high + beside);
        entered.is_finite().then(|| (entered - NEAR * (high - low).length()).max(0.0))
    }

    fn can_be_touched(&self, feature: Feature) -> bool {
        match feature {
            Feature::Face(number) => self.faces[number as usize].is_touchable(),
            Feature::Edge(number) => self.edges[number as usize].normals.is_some(),
            Feature::Vertex(number) => self.vertices[number as usize].normals.is_some(),
        }
    }
}

/// A ball or a point on its way, in the model's frame.
struct Tip<'a> {
    model: &'a Model,
    line: Line<DVec3>,
    radius: f64,
    /// Nothing is met further along.
    reach: f64,
    /// Depths that differ by less are the same.
    rounding: f64,
}

/// A contact, by what it counts among others.
struct Met {
    /// Its depth, and more for what gives way to others at the same depth.
    order: f64,
    depth: f64,
    normal: DVec3,
    feature: Feature,
    /// Not the back of a loose face.
    front: bool,
}

impl<'a> Tip<'a> {
    fn new(model: &'a Model, line: Line<DVec3>, radius: f64) -> Self {
        let (low, high) = model.bvh().around();
        let largest = low.abs().max(high.abs()).max(line.start.abs()).max_element();
        let reach = (model.bvh().reach(line.start) + radius) * (1.0 + ROUNDING);
        Self { model, line, radius, reach, rounding: ROUNDING * (largest + radius) }
    }

    /// What a point meets.
    fn first_of_point(&self) -> Option<Met> {
        let Line { start, direction } = self.line;
        let end = self.line.at(2.0 * self.reach);
        let mut first: Option<Met> = None;
        let bound = |low: DVec3, high: DVec3| ray_enters(start, direction, low, high);
        self.model.bvh().descend(self.reach, bound, |corners, face| {
            let [a, b, c] = *corners;
            let from = orient(a, b, c, start);
            // Of a closed model only fronts count.
            if !(from > 0.0 && self.model.closed) && meets(start, end, corners) {
                let front = from < 0.0 || orient(a, b, c, end) > 0.0;
                // What a plane that is nearly along the line leaves open, the corners bound.
                let normal = self.model.faces[face as usize].normal;
                let [x, y, z] = corners.map(|corner| direction.dot(corner - start));
                let (low, high) = (x.min(y).min(z), x.max(y).max(z));
                let depth = normal.dot(a - start) / normal.dot(direction);
                let depth = if depth.is_nan() { low } else { depth.max(low).min(high) };
                self.take_face(&mut first, (depth, 0.0), face, front);
            }
            self.least(first.as_ref())
        });
        first
    }

    /// What a ball meets.
    fn first_of_ball(&self) -> Option<Met> {
        let bvh = self.model.bvh();
        let rims = bvh.rims(self.model);
        let mut first: Option<Met> = None;
        let bound = |low: DVec3, high: DVec3| self.enters_around(low, high);
        bvh.descend_placed(self.reach, bound, |corners, face, place| {
            let normal = self.model.faces[face as usize].normal;
            let front = normal.dot(self.line.direction) < 0.0;
            if (front || !self.model.closed)
                && let Some(entered) = self.enters_slab(corners, normal)
            {
                self.take_face(&mut first, entered, face, front);
            }
            for &feature in rims.at(place) {
                self.take_rim(&mut first, feature);
            }
            self.least(first.as_ref())
        });
        first
    }

    /// No contact further along comes before the first.
    fn least(&self, first: Option<&Met>) -> f64 {
        first.map_or(self.reach, |first| first.order)
    }

    /// A face, if it is met before the first so far.
    fn take_face(&self, first: &mut Option<Met>, (depth, rank): (f64, f64), face: u32, front: bool) {
        if !front && self.model.closed {
            return;
        }
        let normal = self.model.faces[face as usize].normal;
        // Of two sides of a sheet the front goes first.
        let (normal, rank) = if front { (normal, rank) } else { (-normal, rank + BACK) };
        let order = depth + rank * self.rounding;
        self.take(first, Met { order, depth, normal, feature: Feature::Face(face), front });
    }

    /// An edge or a vertex, if it is met before the first so far.
    fn take_rim(&self, first: &mut Option<Met>, feature: Feature) {
        let at = |end: u32| self.model.vertices[end as usize].point;
        let found = match feature {
            Feature::Edge(number) => {
                // From the lower number, so that edges with the same ends are at the same depth.
                let [a, b] = self.model.edges[number as usize].ends;
                self.enters_pipe(at(a.min(b)), at(a.max(b))).map(|found| (found, EDGE))
            }
            Feature::Vertex(number) => {
                let from = self.line.start - at(number);
                enters(from, self.line.direction, self.radius).map(|depth| ((depth, at(number)), VERTEX))
            }
            Feature::Face(_) => None,
        };
        if let Some(((depth, nearest), rank)) = found {
            let normal = (self.line.at(depth) - nearest).try_normalize().unwrap_or(-self.line.direction);
            let order = depth + rank * self.rounding;
            self.take(first, Met { order, depth, normal, feature, front: true });
        }
    }

    /// Of contacts at the same depth that which can be touched goes first, then the lower number.
    fn take(&self, first: &mut Option<Met>, met: Met) {
        let rank = |met: &Met| (!self.model.can_be_touched(met.feature), met.feature);
        let is_first = first.as_ref().is_none_or(|first| {
            met.order < first.order || met.order == first.order && rank(&met) < rank(first)
        });
        if met.depth >= -self.rounding && is_first {
            *first = Some(met);
        }
    }

    /// How far along the centre comes within a radius of a box, rounded down; infinity if it never does.
    fn enters_around(&self, low: DVec3, high: DVec3) -> f64 {
        let beside = self.radius + self.rounding;
        let depth = ray_enters(self.line.start, self.line.direction, low - beside, high + beside);
        if depth > self.reach {
            return f64::INFINITY;
        }
        // Around what is small beside the ball, a ball is closer than a box.
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low).length());
        let (along, aside) = self.line.depth_and_aside(middle);
        let around = half + beside;
        if aside > around {
            return f64::INFINITY;
        }
        depth.max(along - ((around - aside) * (around + aside)).sqrt() - self.rounding)
    }

    /// How far along the centre comes into the slab over a triangle of a face, as thick as the radius; and its rank among
    /// contacts at the same depth: the last, if it comes in from beside, where an edge is met.
    fn enters_slab(&self, corners: &[DVec3; 3], normal: DVec3) -> Option<(f64, f64)> {
        let Line { start, direction } = self.line;
        let speed = normal.dot(direction);
        if speed == 0.0 {
            return None;
        }
        // Against the way; all corners are within the slab, though they may be off their plane.
        let against = if speed < 0.0 { normal } else { -normal };
        let [a, b, c] = corners.map(|corner| against.dot(corner - start));
        let above = -(a.max(b).max(c) + self.radius) / speed.abs();
        let (mut first, mut last) = (above, -a.min(b).min(c) / speed.abs());
        let beside = 0.1 * self.rounding + BESIDE * self.radius;
        for k in 0..3 {
            let (from, side) = (corners[k], corners[(k + 1) % 3] - corners[k]);
            let inward = normal.cross(side);
            let (inside, rate) = (inward.dot(start - from) + beside * side.length(), inward.dot(direction));
            if rate > 0.0 {
                first = first.max(-inside / rate);
            } else if rate < 0.0 {
                last = last.min(-inside / rate);
            } else if inside < 0.0 {
                return None;
            }
        }
        (first <= last).then_some((first, if first > above { FROM_BESIDE } else { 0.0 }))
    }

    /// How far along the centre comes within a radius of the line through two points, and the point on it that is then
    /// nearest, if it is between the two.
    fn enters_pipe(&self, a: DVec3, b: DVec3) -> Option<(f64, DVec3)> {
        let length = a.distance(b);
        let along = (b - a) / length;
        let across = |vector: DVec3| vector.reject_from_normalized(along);
        let depth = enters(across(self.line.start - a), across(self.line.direction), self.radius)?;
        let place = along.dot(self.line.at(depth) - a);
        let beside = 0.1 * self.rounding + BESIDE * self.radius;
        (place >= -beside && place <= length + beside).then(|| (depth, a + place.clamp(0.0, length) * along))
    }
}

/// When a point that is at `from` and moves so fast comes within a radius of the origin, from outside. A moment ago, if it
/// is within by rounding.
fn enters(from: DVec3, speed: DVec3, radius: f64) -> Option<f64> {
    // |from + t·speed| = radius, its lower root without loss of digits.
    let (speed_sq, toward) = (speed.length_squared(), -from.dot(speed));
    if toward <= 0.0 {
        return None;
    }
    let aside = (from + toward / speed_sq * speed).length();
    if aside > radius {
        return None;
    }
    let root = (speed_sq * (radius - aside) * (radius + aside)).sqrt();
    let distance = from.length();
    Some((distance - radius) * (distance + radius) / (toward + root))
}
