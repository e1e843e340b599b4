//! Distances of points and segments.

use glam::DVec2;

/// From a point to a segment, which may be a point itself.
pub(crate) fn to_segment(point: DVec2, [start, end]: [DVec2; 2]) -> f64 {
    let span = end - start;
    let length_sq = span.length_squared();
    let t = if length_sq > 0.0 { ((point - start).dot(span) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(start + t * span)
}

/// The least distance of two segments (erratum 11): from the four ends, and from where they cross. Of segments on one
/// line the crossing may be found anywhere; its distance is then no less than the true one.
pub(crate) fn segment_to_segment(a: [DVec2; 2], b: [DVec2; 2]) -> f64 {
    let crossing = crossing(a, b).map_or(f64::INFINITY, |t| to_segment(a[0].lerp(a[1], t), b));
    let from_a = a.map(|end| to_segment(end, b));
    let from_b = b.map(|end| to_segment(end, a));
    from_a.into_iter().chain(from_b).fold(crossing, f64::min)
}

/// Where `a` crosses or touches `b`, as the share of the way along `a`; not if they are parallel.
pub(crate) fn crossing(a: [DVec2; 2], b: [DVec2; 2]) -> Option<f64> {
    let side = |[p, q]: [DVec2; 2], r: DVec2| (q - p).perp_dot(r - p);
    let (first, second) = (side(b, a[0]), side(b, a[1]));
    let meets = first != second && first * second <= 0.0 && side(a, b[0]) * side(a, b[1]) <= 0.0;
    meets.then(|| first / (first - second))
}
