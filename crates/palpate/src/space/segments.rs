//! What a segment is from a triangle, and where it meets one.

use glam::DVec3;

use super::distance::{on_segment, orient, to_triangle};

/// The least distance between a segment and a triangle; 0 if they share a point.
pub(super) fn to_segment(a: DVec3, b: DVec3, corners: &[DVec3; 3]) -> f64 {
    if meets(a, b, corners) {
        return 0.0;
    }
    let ends = to_triangle(a, corners).0.min(to_triangle(b, corners).0);
    let sides = [[corners[0], corners[1]], [corners[1], corners[2]], [corners[2], corners[0]]];
    sides.into_iter().map(|[c, d]| between(a, b, c, d)).fold(ends, f64::min)
}

/// Whether a segment goes through a triangle; one in its plane does not. Exact.
pub(super) fn meets(a: DVec3, b: DVec3, &[c, d, e]: &[DVec3; 3]) -> bool {
    let (first, last) = (orient(c, d, e, a), orient(c, d, e, b));
    if first > 0.0 && last > 0.0 || first < 0.0 && last < 0.0 || first == 0.0 && last == 0.0 {
        return false;
    }
    let (one, other) = (orient(a, b, c, d), orient(a, b, d, e));
    if one > 0.0 && other < 0.0 || one < 0.0 && other > 0.0 {
        return false;
    }
    let third = orient(a, b, e, c);
    let around = [one, other, third];
    around.iter().all(|&side| side >= 0.0) || around.iter().all(|&side| side <= 0.0)
}

/// The least distance between two segments. All of its candidates are distances between points of them, so that it is
/// never too small; where the lines are nearly parallel the ends decide.
fn between(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)];
    let least = ends.map(|(end, from, to)| end.distance(on_segment(end, from, to))).into_iter();
    let least = least.fold(f64::INFINITY, f64::min);
    let normal = (b - a).cross(d - c);
    let place = (c - a).cross(d - c).dot(normal) / normal.length_squared();
    if !(0.0..=1.0).contains(&place) {
        return least;
    }
    let other = on_segment(a + place * (b - a), c, d);
    least.min(other.distance(on_segment(other, a, b)))
}

/// How far along a unit direction a ray meets a triangle, its rim included.
pub(super) fn along(origin: DVec3, direction: DVec3, reach: f64, corners: &[DVec3; 3]) -> Option<f64> {
    let end = origin + reach * direction;
    if !meets(origin, end, corners) {
        return None;
    }
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let place = normal.dot(corners[0] - origin) / normal.dot(direction);
    // What a plane that is nearly along the ray leaves open, the corners bound.
    let places = corners.map(|corner| (corner - origin).dot(direction));
    let (low, high) = (places[0].min(places[1]).min(places[2]), places[0].max(places[1]).max(places[2]));
    Some(if place.is_nan() { low.max(0.0) } else { place.max(low).min(high).max(0.0) })
}
