//! Convex sets of unit normals: a point of the sphere (a face), an arc (an edge), a convex polygon (a vertex).

use std::f64::consts::PI;

use glam::DVec3;

use crate::tree::Range;

/// Angles are rounded outward by so much: two nearly opposite directions tell their angle only to the root of the
/// rounding of a number.
pub(crate) const ANGLE_ROUNDING: f64 = 1e-7;

/// A set with a corner this near to a right angle from its axis (the cosine) is taken for the whole sphere.
const WIDEST: f64 = 1e-6;

/// Great circles at no more than this angle are not crossed: well below the rounding of angles.
const SAME_CIRCLE: f64 = 1e-8;

/// Of so many corners the least cap is found by trying all that may determine it.
const MANY_CORNERS: usize = 12;

/// Of more, by so many steps.
const MIDDLE_STEPS: usize = 64;

/// The normals with which a tip may rest on a feature.
#[derive(Debug, Clone)]
pub(crate) struct Cone {
    /// Unit, counter-clockwise about the axis; none if it is taken for the whole sphere.
    corners: Vec<DVec3>,
    /// Unit normal of the great circle from each corner to the next: one of an arc, inward ones of a polygon.
    walls: Vec<DVec3>,
    /// A direction in its middle.
    pub axis: DVec3,
    /// No normal is further from the axis; π if it is taken for the whole sphere.
    pub half_angle: f64,
}

impl Cone {
    /// The least convex set that holds the corners of a convex spherical polygon, given in order, in either sense.
    ///
    /// What reaches (nearly) as far as a hemisphere becomes the whole sphere, which is sound.
    pub fn new(corners: &[DVec3]) -> Self {
        let mut distinct: Vec<DVec3> = Vec::with_capacity(corners.len());
        for corner in corners.iter().filter_map(|corner| corner.try_normalize()) {
            if distinct.last() != Some(&corner) && (distinct.len() < 2 || distinct[0] != corner) {
                distinct.push(corner);
            }
        }
        let axis = middle(&distinct);
        let Some(axis) = axis.filter(|axis| distinct.iter().all(|corner| corner.dot(*axis) > WIDEST)) else {
            return Self { corners: Vec::new(), walls: Vec::new(), axis: DVec3::Z, half_angle: PI };
        };
        let pairs = |corners: &[DVec3]| -> Vec<(DVec3, DVec3)> {
            let next = corners.iter().cycle().skip(1);
            let count = if corners.len() < 3 { corners.len() - 1 } else { corners.len() };
            corners.iter().copied().zip(next.copied()).take(count).collect()
        };
        let turn: f64 = pairs(&distinct).iter().map(|(a, b)| a.cross(*b).dot(axis)).sum();
        if distinct.len() > 2 && turn < 0.0 {
            distinct.reverse();
        }
        let walls = pairs(&distinct).iter().map(|(a, b)| wall(*a, *b)).collect();
        let half_angle = distinct.iter().map(|corner| angle(axis, *corner)).fold(0.0, f64::max);
        Self { corners: distinct, walls, axis, half_angle }
    }

    /// Its one normal, if there is but one.
    pub fn single(&self) -> Option<DVec3> {
        if let [normal] = self.corners[..] { Some(normal) } else { None }
    }

    /// Least and greatest angle between a normal of this and one of the other, radians, exact to
    /// [`ANGLE_ROUNDING`] and rounded outward by it.
    ///
    /// The least is 0 or between a corner of one and the boundary of the other: where neither holds the other and
    /// no arcs cross, two points inside arcs are critical only as a saddle. The greatest is π less the least to the
    /// opposite of the other.
    pub fn angle(&self, other: &Self) -> Range {
        if self.corners.is_empty() || other.corners.is_empty() {
            return Range { low: 0.0, high: PI };
        }
        Range {
            low: (self.least_angle(other, 1.0) - ANGLE_ROUNDING).max(0.0),
            high: (PI - self.least_angle(other, -1.0) + ANGLE_ROUNDING).min(PI),
        }
    }

    /// Greatest `n · offset` over its normals `n`: the length of the offset times the cosine of the angle from it
    /// to the cone.
    pub fn most(&self, offset: DVec3) -> f64 {
        if self.corners.is_empty() || self.holds(offset) {
            return offset.length();
        }
        let at_corners = self.corners.iter().map(|corner| corner.dot(offset));
        let inside_arcs = (0..self.walls.len()).filter_map(|k| self.foot(k, offset).map(DVec3::length));
        at_corners.chain(inside_arcs).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Least angle between this and the other times `sign`.
    fn least_angle(&self, other: &Self, sign: f64) -> f64 {
        if self.holds(sign * other.corners[0])
            || other.holds(sign * self.corners[0])
            || self.crosses(other, sign)
        {
            return 0.0;
        }
        let mut best = (f64::INFINITY, DVec3::X, DVec3::X);
        let mut offer = |p: DVec3, q: DVec3| {
            let chord_sq = p.distance_squared(q);
            if chord_sq < best.0 {
                best = (chord_sq, p, q);
            }
        };
        for (points, set) in [(self, other), (other, self)] {
            for corner in points.corners.iter().map(|corner| sign * *corner) {
                set.corners.iter().for_each(|near| offer(corner, *near));
                // Where there is hardly a foot, all of the arc is at a right angle, and so are its ends.
                let feet = (0..set.walls.len()).filter_map(|k| set.foot(k, corner));
                let feet = feet.filter(|foot| foot.length() > SAME_CIRCLE).map(DVec3::normalize_or_zero);
                feet.for_each(|foot| offer(corner, foot));
            }
        }
        angle(best.1, best.2)
    }

    /// A polygon holds the direction.
    fn holds(&self, direction: DVec3) -> bool {
        self.walls.len() > 2 && self.walls.iter().all(|wall| wall.dot(direction) >= 0.0)
    }

    /// An arc of this crosses an arc of the other times `sign`.
    fn crosses(&self, other: &Self, sign: f64) -> bool {
        (0..self.walls.len()).any(|k| {
            (0..other.walls.len()).any(|l| {
                let across = self.walls[k].cross(other.walls[l]);
                // Of arcs on (nearly) one circle that overlap, an end of one is beside the other.
                across.length_squared() > SAME_CIRCLE * SAME_CIRCLE
                    && [across, -across]
                        .iter()
                        .any(|&common| self.beside_arc(k, common) && other.beside_arc(l, sign * common))
            })
        })
    }

    /// The projection to the plane of arc `k`, if it is in the arc's sector.
    fn foot(&self, k: usize, direction: DVec3) -> Option<DVec3> {
        let wall = self.walls[k];
        self.beside_arc(k, direction).then(|| direction - direction.dot(wall) * wall)
    }

    /// The projection to the plane of arc `k` is strictly inside the arc's sector.
    fn beside_arc(&self, k: usize, direction: DVec3) -> bool {
        let (start, end, wall) = (self.corners[k], self.corners[(k + 1) % self.corners.len()], self.walls[k]);
        wall.cross(start).dot(direction) > 0.0 && end.cross(wall).dot(direction) > 0.0
    }
}

/// A direction about which the least cap holds all: two corners or three determine it. Of many corners, one about which
/// a nearly least cap does, that of the point of their hull nearest to the origin (Gilbert 1966); any is sound.
fn middle(corners: &[DVec3]) -> Option<DVec3> {
    let lowest = |axis: DVec3| corners.iter().map(|corner| corner.dot(axis)).fold(f64::INFINITY, f64::min);
    let mut best = corners.iter().sum::<DVec3>().try_normalize().map(|axis| (lowest(axis), axis));
    let mut offer = |toward: DVec3| {
        if let Some(axis) =
            toward.try_normalize().filter(|axis| best.is_none_or(|best| lowest(*axis) > best.0))
        {
            best = Some((lowest(axis), axis));
        }
    };
    if corners.len() > MANY_CORNERS {
        let mut at = corners.iter().sum::<DVec3>() / corners.len() as f64;
        for _ in 0..MIDDLE_STEPS {
            let furthest = corners.iter().min_by(|a, b| a.dot(at).total_cmp(&b.dot(at)))?;
            let along = *furthest - at;
            at += (-at.dot(along) / along.length_squared()).clamp(0.0, 1.0) * along;
            offer(at);
        }
    } else {
        for (k, a) in corners.iter().enumerate() {
            for (l, b) in corners[..k].iter().enumerate() {
                offer(*a + *b);
                for c in &corners[..l] {
                    let across = (*b - *a).cross(*c - *a);
                    offer(across);
                    offer(-across);
                }
            }
        }
    }
    best.map(|(_, axis)| axis)
}

/// The unit normal of the great circle from `a` to `b`: `a × b`, with no digits lost where they are nearly the same, or
/// nearly opposite.
fn wall(a: DVec3, b: DVec3) -> DVec3 {
    let across = if a.dot(b) > 0.0 { a.cross(b - a) } else { a.cross(b + a) };
    across.normalize_or_zero()
}

/// The angle between two unit vectors, radians, `[0, π]`: accurate at either end.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}
