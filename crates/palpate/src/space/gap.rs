//! The least distance between convex pieces of features.

use glam::DVec3;

/// A point, a segment or a convex polygon, with what bounds it.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    /// Of a polygon, counter-clockwise about its normal.
    points: Vec<DVec3>,
    /// Each side: where it begins, where it goes, its middle and half its length.
    sides: Vec<Side>,
    /// Of a polygon.
    normal: Option<DVec3>,
    center: DVec3,
    radius: f64,
}

#[derive(Debug, Clone, Copy)]
struct Side {
    start: DVec3,
    along: DVec3,
    middle: DVec3,
    half: f64,
    /// In the polygon's plane, to its inside; any length.
    inward: DVec3,
}

impl Piece {
    /// One point, two, or the corners of a convex polygon with its unit normal.
    pub fn new(points: Vec<DVec3>, normal: DVec3) -> Self {
        let count = if points.len() < 3 { 1 } else { points.len() };
        let sides = (0..count).map(|k| {
            let start = points[k];
            let along = points[(k + 1) % points.len()] - start;
            let (middle, half) = (start + 0.5 * along, 0.5 * along.length());
            Side { start, along, middle, half, inward: normal.cross(along) }
        });
        let sides = sides.collect();
        let center = points.iter().sum::<DVec3>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(center)).fold(0.0, f64::max);
        let normal = (points.len() > 2).then_some(normal);
        Self { points, sides, normal, center, radius }
    }

    /// The least of `bound` and its distance to the other: between two sides, from a corner to the inside of a
    /// polygon, or zero where a side passes through one (MATH 1.1, rows 7–13).
    ///
    /// Of nearly parallel sides, what is computed may exceed the least by 10⁻⁸ of their length.
    pub fn distance(&self, other: &Self, bound: f64) -> f64 {
        if beyond(self.center - other.center, self.radius + other.radius + bound) {
            return bound;
        }
        let mut best = bound;
        for a in &self.sides {
            for b in &other.sides {
                if !beyond(a.middle - b.middle, a.half + b.half + best) {
                    best = best.min(sides_apart(a, b));
                }
            }
        }
        self.to_inside(other, other.to_inside(self, best))
    }

    /// The least of `bound` and the distance of the other's corners and sides to the inside of this polygon.
    fn to_inside(&self, other: &Self, bound: f64) -> f64 {
        let Some(normal) = self.normal else { return bound };
        let inside = |point: DVec3| self.sides.iter().all(|side| side.inward.dot(point - side.start) >= 0.0);
        let mut best = bound;
        for point in &other.points {
            let height = normal.dot(*point - self.center).abs();
            if height < best && inside(*point) {
                best = height;
            }
        }
        for side in &other.sides {
            let height = normal.dot(side.start - self.center);
            let end = height + normal.dot(side.along);
            if best > 0.0 && height * end < 0.0 && inside(side.start + height / (height - end) * side.along) {
                best = 0.0;
            }
        }
        best
    }
}

/// The offset is longer.
fn beyond(offset: DVec3, length: f64) -> bool {
    offset.length_squared() > length * length
}

/// The distance between two segments: the best points of the two lines, moved to the ends one after the other
/// (Ericson, Real-Time Collision Detection, 5.1.9).
fn sides_apart(a: &Side, b: &Side) -> f64 {
    let offset = a.start - b.start;
    let (aa, bb, ab) = (a.along.length_squared(), b.along.length_squared(), a.along.dot(b.along));
    let (oa, ob) = (offset.dot(a.along), offset.dot(b.along));
    let share = |value: f64, whole: f64| if whole > 0.0 { (value / whole).clamp(0.0, 1.0) } else { 0.0 };
    let s = share(ab * ob - oa * bb, aa * bb - ab * ab);
    let free = share(ab * s + ob, bb);
    let s = share(ab * free - oa, aa);
    // Once more: no step of the three leads further away.
    let t = share(ab * s + ob, bb);
    (offset + s * a.along - t * b.along).length()
}
