//! Distances to the surface of a model, and on which side of it a point is.
//!
//! Distances are right to 1e-12 of the scale, which is the largest coordinate of what is given or of the model. That holds
//! for slivers, too: a distance is that to an edge, or to a plane from a point that lies before the triangle's inside.

use glam::DVec3;

use super::bvh::Nearest;
use super::model::{Face, Model};
use super::segments::{along, to_segment};

/// Directions in which rays are cast, one after another until one meets no edge.
const DIRECTIONS: [[f64; 3]; 6] = [
    [0.312_309, 0.587_215, 0.746_741],
    [-0.662_743, 0.414_213, 0.623_817],
    [0.141_592, -0.871_828, 0.468_731],
    [0.683_147, 0.311_029, -0.660_677],
    [-0.567_143, -0.739_085, -0.363_317],
    [0.915_965, -0.261_497, 0.304_342],
];

impl Model {
    /// The point of the surface that is nearest to `point` (model frame); to 1e-12 of the scale.
    #[must_use]
    pub fn nearest(&self, point: DVec3) -> Nearest {
        self.bvh().nearest(point)
    }

    /// The distance from the surface to `point` (model frame), negative inside. Of a model that is not closed, it is
    /// never negative. To 1e-12 of the scale; that close to the surface, the sign may be either.
    ///
    /// Inside is where the surface goes around a point, the right way: the crossings of a ray are counted, each by its
    /// direction. All are decided exactly, and a ray that meets an edge or a corner gives way to another.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        let distance = self.nearest(point).distance;
        if self.closed && self.winding(point) > 0 { -distance } else { distance }
    }

    /// The least distance between the surface and the segment from `a` to `b` (model frame), 0 if it crosses the
    /// surface; to 1e-12 of the scale.
    #[must_use]
    pub fn segment_distance(&self, a: DVec3, b: DVec3) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        let gap = |from: DVec3, to: DVec3| (from - high).max(low - to).max(DVec3::ZERO).length();
        let across = (b - a).try_normalize();
        let bound = |low: DVec3, high: DVec3| {
            let beside = across.map_or(0.0, |along| beside_box(a, along, low, high));
            gap(low, high).max(beside)
        };
        let mut least = f64::INFINITY;
        self.bvh().descend(least, bound, |corners, _| {
            least = least.min(to_segment(a, b, corners));
            least
        });
        least
    }

    /// What a ray from `origin` along `direction` (model frame, any length but 0) meets first, and how far it is; from
    /// either side of a face, and the rim of a face counts. To 1e-12 of the scale, over the cosine of the angle between
    /// the ray and the face's normal.
    #[must_use]
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<Nearest> {
        let direction = direction.try_normalize()?;
        let reach = 2.0 * self.bvh().reach(origin);
        let mut best: Option<Nearest> = None;
        let bound = |low: DVec3, high: DVec3| ray_enters(origin, direction, low, high);
        self.bvh().descend(reach, bound, |corners, face| {
            if let Some(distance) = along(origin, direction, reach, corners)
                && best.is_none_or(|best| (distance, face) < (best.distance, best.face))
            {
                best = Some(Nearest { distance, face, point: origin + distance * direction });
            }
            best.map_or(reach, |best| best.distance)
        });
        best
    }

    /// Adds the numbers of the faces that are no further than `distance` from `point` (model frame), in order; right for
    /// those whose distance differs from it by more than 1e-12 of the scale.
    pub fn faces_within(&self, point: DVec3, distance: f64, faces: &mut Vec<u32>) {
        let first = faces.len();
        let bound = |low: DVec3, high: DVec3| (low - point).max(point - high).max(DVec3::ZERO).length();
        self.bvh().descend(distance, bound, |corners, face| {
            if to_triangle(point, corners).0 <= distance {
                faces.push(face);
            }
            distance
        });
        faces[first..].sort_unstable();
        let mut last = None;
        let mut k = 0;
        faces.retain(|&face| {
            k += 1;
            k <= first || last.replace(face) != Some(face)
        });
    }

    /// How often the surface goes around a point that is not on it.
    pub(super) fn winding(&self, point: DVec3) -> i32 {
        let reach = self.bvh().reach(point);
        let rays = DIRECTIONS.iter().map(|&direction| {
            let end = point + 4.0 * reach * DVec3::from(direction);
            self.crossings(point, end)
        });
        rays.flatten().next().unwrap_or_else(|| self.winding_by_angle(point))
    }

    /// How often the way from one point to another leaves the material, less how often it enters; `None` if it meets an
    /// edge or a corner.
    fn crossings(&self, from: DVec3, to: DVec3) -> Option<i32> {
        let (mut sum, mut exact) = (0, true);
        self.along_segment(from, to, |corners, _| {
            match crosses(from, to, corners) {
                Some(crossing) => sum += crossing,
                None => exact = false,
            }
            exact
        });
        exact.then_some(sum)
    }

    /// Visits the triangles, and the face of each, whose boxes the way from one point to another may meet, until told
    /// to stop.
    pub(super) fn along_segment(
        &self,
        from: DVec3,
        to: DVec3,
        mut visit: impl FnMut(&[DVec3; 3], u32) -> bool,
    ) {
        let direction = to - from;
        let bound =
            |low: DVec3, high: DVec3| if ray_enters(from, direction, low, high) <= 1.0 { 0.0 } else { 1.0 };
        self.bvh().descend(0.5, bound, |corners, face| if visit(corners, face) { 0.5 } else { -1.0 });
    }

    /// The same by the sum of the triangles' solid angles (van Oosterom and Strackee 1983).
    pub(super) fn winding_by_angle(&self, point: DVec3) -> i32 {
        let solid_angle = |(triangle, _): &([u32; 3], u32)| {
            let [a, b, c] = triangle.map(|k| self.vertices[k as usize].point - point);
            let lengths = [a.length(), b.length(), c.length()];
            let below = lengths[0] * lengths[1] * lengths[2]
                + a.dot(b) * lengths[2]
                + b.dot(c) * lengths[0]
                + c.dot(a) * lengths[1];
            2.0 * a.dot(b.cross(c)).atan2(below)
        };
        let sum: f64 = self.triangles.iter().map(solid_angle).sum();
        (sum / (4.0 * std::f64::consts::PI)).round() as i32
    }
}

impl Face {
    /// The distance from `point` (model frame) to the face of `model`, and the nearest point of it; to 1e-12 of the scale,
    /// if the corners lie in one plane.
    #[must_use]
    pub fn nearest(&self, model: &Model, point: DVec3) -> (f64, DVec3) {
        let at = |&k: &u32| model.vertices[k as usize].point;
        let of_piece = |piece: &Vec<u32>| to_polygon(point, piece.iter().map(at), self.normal);
        let nearer = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 < a.0 { b } else { a };
        self.pieces.iter().map(of_piece).fold((f64::INFINITY, point), nearer)
    }

    /// The distance from `point` (model frame) to the face of `model`; to 1e-12 of the scale.
    #[must_use]
    pub fn distance(&self, model: &Model, point: DVec3) -> f64 {
        self.nearest(model, point).0
    }

    /// Whether the point of the face's plane that is nearest to `point` (model frame) lies on the face, its rim included:
    /// right but for points within 1e-12 of the scale from the rim.
    #[must_use]
    pub fn is_before(&self, model: &Model, point: DVec3) -> bool {
        let at = |&k: &u32| model.vertices[k as usize].point;
        let is_left = |(a, b): (DVec3, DVec3)| self.normal.cross(b - a).dot(point - a) >= 0.0;
        self.pieces.iter().any(|piece| {
            let corners = piece.iter().map(at);
            corners.clone().zip(corners.cycle().skip(1)).all(is_left)
        })
    }
}

/// The distance from a point to a triangle, and the nearest point.
pub(super) fn to_triangle(point: DVec3, corners: &[DVec3; 3]) -> (f64, DVec3) {
    to_polygon(point, corners.iter().copied(), (corners[1] - corners[0]).cross(corners[2] - corners[0]))
}

/// The distance from a point to a convex polygon that is counter-clockwise about `normal`, and the nearest point.
pub(super) fn to_polygon(
    point: DVec3,
    corners: impl Iterator<Item = DVec3> + Clone,
    normal: DVec3,
) -> (f64, DVec3) {
    let sides = corners.clone().zip(corners.cycle().skip(1));
    let mut best = (f64::INFINITY, point);
    let mut is_before = true;
    let mut corner = point;
    for (a, b) in sides {
        let nearest = on_segment(point, a, b);
        let distance = point.distance(nearest);
        if distance < best.0 {
            best = (distance, nearest);
            corner = a;
        }
        is_before &= normal.cross(b - a).dot(point - a) >= 0.0;
    }
    if is_before && let Some(normal) = normal.try_normalize() {
        // From the nearest corner, so that what the normal is off by counts least.
        let height = normal.dot(point - corner);
        if height.abs() < best.0 {
            best = (height.abs(), point - height * normal);
        }
    }
    best
}

/// The point of a segment that is nearest to a point.
pub(super) fn on_segment(point: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let along = b - a;
    let place = (point - a).dot(along) / along.length_squared();
    if place.is_nan() || place <= 0.0 {
        a
    } else if place >= 1.0 {
        b
    } else if place <= 0.5 {
        a + place * along
    } else {
        b - (1.0 - place) * along
    }
}

/// `+1` if the way from one point to another leaves the material through a triangle, `-1` if it enters, `0` if it does
/// not cross it; `None` if it meets its rim. Exact.
fn crosses(from: DVec3, to: DVec3, &[a, b, c]: &[DVec3; 3]) -> Option<i32> {
    let (above, below) = (orient(a, b, c, from), orient(a, b, c, to));
    if above > 0.0 && below > 0.0 || above < 0.0 && below < 0.0 {
        return Some(0);
    }
    let around = [orient(from, to, a, b), orient(from, to, b, c), orient(from, to, c, a)];
    if around.iter().any(|&side| side > 0.0) && around.iter().any(|&side| side < 0.0) {
        return Some(0);
    }
    if around.contains(&0.0) || above == 0.0 || below == 0.0 {
        return None;
    }
    Some(if above > 0.0 { 1 } else { -1 })
}

/// Positive if `d` is below the plane of `a`, `b` and `c`, which are counter-clockwise from above. The sign is exact.
pub(super) fn orient(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |p: DVec3| robust::Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// No point of a box is closer to a line along a unit direction.
pub(super) fn beside_box(from: DVec3, along: DVec3, low: DVec3, high: DVec3) -> f64 {
    let (middle, half) = (0.5 * (low + high) - from, 0.5 * (high - low));
    let across =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().filter_map(|axis| along.cross(axis).try_normalize());
    // In each direction across the line the box covers a range.
    across.map(|axis| middle.dot(axis).abs() - half.dot(axis.abs())).fold(0.0, f64::max)
}

/// How far along a ray a box begins, rounded down; infinity if the ray passes it.
pub(super) fn ray_enters(from: DVec3, direction: DVec3, low: DVec3, high: DVec3) -> f64 {
    let (mut first, mut last) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (low[axis] - from[axis], high[axis] - from[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return f64::INFINITY;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        first = first.max(a.min(b) * (1.0 - 1e-15));
        last = last.min(a.max(b) * (1.0 + 1e-15));
    }
    if first <= last { first } else { f64::INFINITY }
}
