//! Where the centre of a tip may be when it rests on a feature, in the model's frame.
//!
//! A site is convex up to the roundness of its normals: a convex piece of a face, moved out by the radius; a part of
//! the cylinder around an edge; a part of the ball around a vertex (MATH 2.1, 2.3.4).

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2, TAU};
use std::sync::Arc as Shared;

use arrayvec::ArrayVec;
use glam::{DVec2, DVec3, dvec2};

use super::model::Model;
use super::sphere::{self, Cap};
use crate::feature::Feature;
use crate::part::Surface;

/// A place for the centre of a tip of one radius.
#[derive(Debug, Clone)]
pub(crate) struct Site {
    pub feature: Feature,
    radius: f64,
    shape: Shape,
    /// A ball around all of it.
    pub middle: DVec3,
    pub reach: f64,
    /// A box around all of it.
    pub low: DVec3,
    pub high: DVec3,
    /// A normal in the middle of its cone, unit.
    pub mean_normal: DVec3,
    /// The angle from its mean normal to the farthest of its cone, radians.
    pub spread: f64,
}

#[derive(Debug, Clone)]
enum Shape {
    /// A convex piece of a face, already moved outward; `sides` are outward in its plane, each with its bound.
    Piece { normal: DVec3, corners: Vec<DVec3>, sides: Vec<(DVec3, f64)> },
    /// An edge with the arc of its normals: from `first`, `width` radians towards `across`.
    Edge { start: DVec3, along: DVec3, length: f64, first: DVec3, across: DVec3, width: f64 },
    /// A vertex with its cone of normals, as the halves of the sphere that make it up.
    Vertex { point: DVec3, cone: Vec<Cap>, corners: Vec<DVec3> },
}

/// The sites of some features, shared by the contacts that have the same.
pub(crate) type Sites = Shared<[Site]>;

/// A normal counts as allowed if it misses by no more, radians.
const ROUNDING: f64 = 1e-11;

/// Angles, from the first normal of an edge.
type Intervals = ArrayVec<(f64, f64), 4>;

impl Site {
    /// The sites of a feature: of a face, one for each convex piece. None if it can't be touched.
    pub fn all(model: &Model, feature: Feature, radius: f64) -> Vec<Self> {
        match feature {
            Feature::Face(number) => {
                let face = &model.faces[number as usize];
                if face.surface != Surface::Touchable {
                    return Vec::new();
                }
                let piece = |piece: &Vec<u32>| {
                    let corner = |k: &u32| model.vertices[*k as usize].point + radius * face.normal;
                    Self::piece(feature, radius, face.normal, piece.iter().map(corner).collect())
                };
                face.pieces.iter().map(piece).collect()
            }
            Feature::Edge(number) => {
                let edge = &model.edges[number as usize];
                let [start, end] = edge.ends.map(|k| model.vertices[k as usize].point);
                edge.normals
                    .and_then(|normals| Self::edge(feature, radius, [start, end], normals))
                    .into_iter()
                    .collect()
            }
            Feature::Vertex(number) => {
                let vertex = &model.vertices[number as usize];
                let of_cone = |corners: &Vec<DVec3>| Self::vertex(feature, radius, vertex.point, corners);
                vertex.normals.as_ref().map(of_cone).into_iter().collect()
            }
        }
    }

    fn piece(feature: Feature, radius: f64, normal: DVec3, corners: Vec<DVec3>) -> Self {
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next).filter_map(|(from, to)| {
            let side = (*to - *from).cross(normal).try_normalize()?;
            // The bound of the farthest corner: rounding leaves none of them outside.
            let bound = corners.iter().map(|corner| side.dot(*corner)).fold(f64::NEG_INFINITY, f64::max);
            Some((side, bound))
        });
        let sides = sides.collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let reach = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let shape = Shape::Piece { normal, corners, sides };
        Self { feature, radius, shape, middle, reach, low, high, mean_normal: normal, spread: 0.0 }
    }

    fn edge(feature: Feature, radius: f64, [start, end]: [DVec3; 2], normals: [DVec3; 2]) -> Option<Self> {
        let along = (end - start).try_normalize()?;
        let [first, last] = normals;
        // In the plane across the edge, though the normals may miss it by rounding.
        let first = (first - along * first.dot(along)).try_normalize()?;
        let across = last - along * last.dot(along) - first * last.dot(first);
        let width = across.length().atan2(last.dot(first));
        let across = across.try_normalize()?;
        let length = start.distance(end);
        let shape = Shape::Edge { start, along, length, first, across, width };
        let (middle, reach) = (0.5 * (start + end), 0.5 * length + radius);
        let (sine, cosine) = (0.5 * width).sin_cos();
        let mean_normal = cosine * first + sine * across;
        let (low, high) = (start.min(end) - radius, start.max(end) + radius);
        Some(Self { feature, radius, shape, middle, reach, low, high, mean_normal, spread: 0.5 * width })
    }

    fn vertex(feature: Feature, radius: f64, point: DVec3, corners: &[DVec3]) -> Self {
        let next = corners.iter().cycle().skip(1);
        let halves = corners.iter().zip(next).filter_map(|(a, b)| a.cross(*b).try_normalize());
        let cone = halves.map(Cap::half).collect();
        let shape = Shape::Vertex { point, cone, corners: corners.to_vec() };
        let mean_normal = corners.iter().sum::<DVec3>().try_normalize().unwrap_or(corners[0]);
        let spread = corners.iter().map(|corner| angle(mean_normal, *corner)).fold(0.0, f64::max);
        // A cap holds what is between its corners only up to a half.
        let spread = if spread < FRAC_PI_2 { spread } else { PI };
        let (low, high) = (point - radius, point + radius);
        Self { feature, radius, shape, middle: point, reach: radius, low, high, mean_normal, spread }
    }

    /// How far its hull may be from it, where its normals are known to be within `angle` of one.
    pub fn hollow(&self, angle: f64) -> f64 {
        match self.shape {
            Shape::Piece { .. } => 0.0,
            _ => self.radius * (1.0 - self.spread.min(angle).min(FRAC_PI_2).cos()),
        }
    }

    /// Caps no wider than `fine` that hold all its normals.
    pub fn cover(&self, fine: f64, out: &mut Vec<Cap>) {
        match &self.shape {
            Shape::Piece { normal, .. } => out.push(Cap::around(*normal, 0.0)),
            Shape::Edge { first, across, width, .. } => {
                let mut count = 1_u32;
                while 0.5 * width > fine * f64::from(count) {
                    count += 1;
                }
                let half = 0.5 * width / f64::from(count);
                out.extend((0..count).map(|k| {
                    let (sine, cosine) = (f64::from(2 * k + 1) * half).sin_cos();
                    Cap::around(cosine * *first + sine * *across, half + ROUNDING)
                }));
            }
            Shape::Vertex { corners, .. } => {
                if self.spread <= fine || corners.len() < 3 {
                    out.push(Cap::around(self.mean_normal, self.spread + ROUNDING));
                    return;
                }
                let rest = corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]);
                let mut open: Vec<[DVec3; 3]> = rest.collect();
                while let Some([a, b, c]) = open.pop() {
                    let axis = (a + b + c).normalize_or(a);
                    let radius = [a, b, c].iter().map(|corner| angle(axis, *corner)).fold(0.0, f64::max);
                    if radius <= fine {
                        out.push(Cap::around(axis, radius + ROUNDING));
                        continue;
                    }
                    // Middles of sides of less than half a turn.
                    let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(a, b)| (a + b).normalize_or(a));
                    open.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
                }
            }
        }
    }

    /// The angle from a unit direction to the nearest of its normals, radians.
    pub fn normal_distance(&self, direction: DVec3) -> f64 {
        angle(self.nearest_normal(direction), direction)
    }

    /// The greatest `direction · x` over its places whose normals are in all of `allowed`; `-∞` if there are none. Unless it is
    /// to be `tight`, a vertex may be said to have more, which takes no crossings of rims.
    pub fn support(&self, direction: DVec3, allowed: &[Cap], tight: bool) -> f64 {
        match &self.shape {
            Shape::Piece { corners, normal, .. } => {
                if !allowed.iter().all(|cap| cap.holds(*normal)) {
                    return f64::NEG_INFINITY;
                }
                corners.iter().map(|corner| direction.dot(*corner)).fold(f64::NEG_INFINITY, f64::max)
            }
            Shape::Edge { start, along, length, first, across, .. } => {
                let intervals = self.intervals(allowed);
                let at = in_plane(*first, *across, direction);
                let toward = |interval: &(f64, f64)| {
                    let nearest = clamp_angle(at.to_angle(), *interval);
                    at.dot(DVec2::from_angle(nearest))
                };
                let farthest = intervals.iter().map(toward).fold(f64::NEG_INFINITY, f64::max);
                direction.dot(*start)
                    + (direction.dot(*along) * length).max(0.0)
                    + if intervals.is_empty() { f64::NEG_INFINITY } else { self.radius * farthest }
            }
            Shape::Vertex { point, cone, .. } => {
                let farthest = if tight {
                    let caps: Vec<Cap> = cone.iter().chain(allowed).copied().collect();
                    sphere::greatest(direction, &caps)
                } else {
                    let of_cone = sphere::greatest_in_each(direction, cone);
                    of_cone.min(sphere::greatest_in_each(direction, allowed))
                };
                let nothing = farthest == f64::NEG_INFINITY;
                direction.dot(*point) + if nothing { farthest } else { self.radius * farthest }
            }
        }
    }

    /// None of its places is farther from a point.
    pub fn farthest_from(&self, point: DVec3) -> f64 {
        let farthest = |corners: &[DVec3]| corners.iter().map(|at| at.distance(point)).fold(0.0, f64::max);
        match &self.shape {
            Shape::Piece { corners, .. } => farthest(corners),
            Shape::Edge { start, along, length, .. } => {
                farthest(&[*start, *start + *length * *along]) + self.radius
            }
            Shape::Vertex { point: corner, .. } => farthest(&[*corner]) + self.radius,
        }
    }

    /// Whether it has more than one normal.
    pub fn is_round(&self) -> bool {
        !matches!(self.shape, Shape::Piece { .. })
    }

    /// The greatest `direction · x` over the feature's own points.
    pub fn foot_support(&self, direction: DVec3) -> f64 {
        match &self.shape {
            Shape::Piece { normal, corners, .. } => {
                let farthest = corners.iter().map(|corner| direction.dot(*corner));
                farthest.fold(f64::NEG_INFINITY, f64::max) - self.radius * direction.dot(*normal)
            }
            Shape::Edge { start, along, length, .. } => {
                direction.dot(*start) + (direction.dot(*along) * length).max(0.0)
            }
            Shape::Vertex { point, .. } => direction.dot(*point),
        }
    }

    /// The distance from a point to its places whose normals are in all of `allowed`; infinite if there are none.
    pub fn distance(&self, point: DVec3, allowed: &[Cap]) -> f64 {
        self.nearest(point, allowed).map_or(f64::INFINITY, |nearest| nearest.distance(point))
    }

    /// Of its places whose normals are in all of `allowed`, the one nearest to a point; `None` if there are none.
    pub fn nearest(&self, point: DVec3, allowed: &[Cap]) -> Option<DVec3> {
        match &self.shape {
            Shape::Piece { normal, corners, .. } => {
                let all = allowed.iter().all(|cap| cap.holds(*normal));
                all.then(|| nearest_in_polygon(point, *normal, corners))
            }
            Shape::Edge { start, along, length, first, across, .. } => {
                let offset = point - *start;
                let foot = *start + offset.dot(*along).clamp(0.0, *length) * *along;
                let at = in_plane(*first, *across, offset);
                let nearest = |interval: (f64, f64)| {
                    let normal = DVec2::from_angle(clamp_angle(at.to_angle(), interval));
                    foot + self.radius * (normal.x * *first + normal.y * *across)
                };
                let places = self.intervals(allowed).into_iter().map(nearest);
                places.min_by(|a, b| a.distance_squared(point).total_cmp(&b.distance_squared(point)))
            }
            Shape::Vertex { point: corner, cone, .. } => {
                let caps: Vec<Cap> = cone.iter().chain(allowed).copied().collect();
                let direction = (point - *corner).try_normalize().unwrap_or(self.mean_normal);
                sphere::nearest(direction, &caps).map(|normal| *corner + self.radius * normal)
            }
        }
    }

    /// Of its normals, the one nearest to a unit direction.
    pub fn nearest_normal(&self, direction: DVec3) -> DVec3 {
        match &self.shape {
            Shape::Piece { normal, .. } => *normal,
            Shape::Edge { first, across, width, .. } => {
                let at = in_plane(*first, *across, direction);
                let normal = DVec2::from_angle(clamp_angle(at.to_angle(), (0.0, *width)));
                normal.x * *first + normal.y * *across
            }
            Shape::Vertex { cone, corners, .. } => sphere::nearest(direction, cone).unwrap_or_else(|| {
                let toward = |corner: &&DVec3| corner.dot(direction);
                *corners.iter().max_by(|a, b| toward(a).total_cmp(&toward(b))).unwrap_or(&corners[0])
            }),
        }
    }

    /// Directions in which its hull is bounded tightly.
    pub fn directions(&self, out: &mut Vec<DVec3>) {
        match &self.shape {
            Shape::Piece { normal, sides, .. } => {
                out.extend([*normal, -*normal]);
                out.extend(sides.iter().map(|(side, _)| *side));
            }
            Shape::Edge { along, first, across, .. } => {
                out.extend([*along, -*along]);
                let start = in_plane(*first, *across, self.mean_normal).normalize_or(DVec2::X);
                let side = start.perp();
                out.extend(around(start.x * *first + start.y * *across, side.x * *first + side.y * *across));
            }
            Shape::Vertex { .. } => {
                let mean = self.mean_normal;
                let (a, b) = mean.any_orthonormal_pair();
                out.extend([mean, -mean]);
                out.extend(around(a, b));
            }
        }
    }

    /// Directions in which its cone of normals is bounded tightly.
    pub fn normal_directions(&self, out: &mut Vec<DVec3>) {
        let mean = self.mean_normal;
        out.push(-mean);
        match &self.shape {
            Shape::Piece { .. } => {
                let (a, b) = mean.any_orthonormal_pair();
                out.extend(around(a, b));
            }
            Shape::Edge { along, first, across, width, .. } => {
                let (sine, cosine) = width.sin_cos();
                let ends = [-*across, cosine * *across - sine * *first];
                out.extend([*along, -*along].into_iter().chain(ends));
                out.extend(
                    ends.iter().flat_map(|end| [1.0, -1.0].map(|side| (*end + side * *along) * SQRT_2 * 0.5)),
                );
            }
            Shape::Vertex { cone, .. } => out.extend(cone.iter().map(|half| -half.axis)),
        }
    }

    /// The angles of an edge's arc that all of `allowed` allow.
    fn intervals(&self, allowed: &[Cap]) -> Intervals {
        let Shape::Edge { along, first, across, width, .. } = &self.shape else { return Intervals::new() };
        let mut left: Intervals = std::iter::once((0.0, *width)).collect();
        for cap in allowed {
            // The plane of the arc meets the cap in an arc about the axis's foot, if the cap reaches it.
            let at = in_plane(*first, *across, cap.axis);
            let off = cap.axis.dot(*along).abs().atan2(at.length());
            if cap.angle + off >= PI {
                continue;
            }
            if off > cap.angle + ROUNDING {
                return Intervals::new();
            }
            // sin²(half/2), by a difference that keeps its digits.
            let (sum, difference) = (0.5 * (cap.angle + off), 0.5 * (cap.angle - off).max(0.0));
            let square = sum.sin() * difference.sin() / off.cos();
            let (middle, half) = (at.to_angle(), 2.0 * square.min(1.0).sqrt().asin() + ROUNDING);
            let mut cut = Intervals::new();
            for (low, high) in left {
                for turn in [-TAU, 0.0, TAU] {
                    let part = (low.max(middle + turn - half), high.min(middle + turn + half));
                    if part.0 <= part.1 && !cut.is_full() {
                        cut.push(part);
                    }
                }
            }
            left = cut;
        }
        left
    }
}

/// Eight directions around, in the plane of two orthogonal unit vectors, from the first on.
pub(super) fn around(first: DVec3, second: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let (sine, cosine) = (k as f64 * FRAC_PI_4).sin_cos();
        cosine * first + sine * second
    })
}

/// The lowest and the highest corner of a box around all of them.
pub(super) fn around_all<'a>(sites: impl Iterator<Item = &'a Site>) -> (DVec3, DVec3) {
    sites.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), site| {
        (low.min(site.low), high.max(site.high))
    })
}

fn in_plane(first: DVec3, across: DVec3, vector: DVec3) -> DVec2 {
    dvec2(vector.dot(first), vector.dot(across))
}

/// The angle of the interval that is nearest on the circle; the interval is at most a turn long.
fn clamp_angle(angle: f64, (low, high): (f64, f64)) -> f64 {
    let offset = (angle - low).rem_euclid(TAU);
    let width = high - low;
    if offset <= width {
        low + offset
    } else if offset - width < TAU - offset {
        high
    } else {
        low
    }
}

/// The angle between two vectors, radians.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The nearest point of a convex polygon with its corners counter-clockwise about `normal`.
fn nearest_in_polygon(point: DVec3, normal: DVec3, corners: &[DVec3]) -> DVec3 {
    let mut inside = true;
    let (mut best, mut least_sq) = (corners[0], f64::INFINITY);
    for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let way = *to - *from;
        let offset = point - *from;
        if normal.dot(way.cross(offset)) < 0.0 {
            inside = false;
        }
        let share = (offset.dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let at = *from + share * way;
        if at.distance_squared(point) < least_sq {
            (best, least_sq) = (at, at.distance_squared(point));
        }
    }
    if inside { point - normal * normal.dot(point - corners[0]) } else { best }
}

/// What a contact's normals must be in, in some frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reading {
    /// The sensed normal and its bound, at most a quarter turn.
    pub sensed: Option<(DVec3, f64)>,
    /// Against the direction of travel: normals are within a quarter turn of it, and a slack more.
    pub facing: Option<(DVec3, f64)>,
}

impl Reading {
    /// As caps, each wider by `slack` radians, turned by `turn`.
    pub fn caps(&self, slack: f64, turn: impl Fn(DVec3) -> DVec3) -> ArrayVec<Cap, 2> {
        let sensed = self.sensed.map(|(axis, error)| Cap::around(turn(axis), error + slack));
        let facing = self.facing.map(|(axis, error)| Cap::around(turn(axis), FRAC_PI_2 + error + slack));
        sensed.into_iter().chain(facing).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{Cells, Random, hull, mesh};
    use super::{Shape, Site, angle};
    use crate::feature::Feature;
    use glam::DVec3;

    /// The mean is where most corners are: of two that are more than a right angle from it, the arc between them goes further.
    #[test]
    fn many_normals_on_one_side_leave_the_others_bounded() {
        // The apex of a blade: a rounded front of nine faces, two faces behind.
        let unit = |degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            DVec3::new(cosine, sine, 0.4).normalize()
        };
        let front = (-4..5).map(|k| unit(f64::from(k)));
        let corners: Vec<DVec3> = front.chain([unit(150.0), unit(210.0)]).collect();
        let site = Site::vertex(Feature::Vertex(0), 1.0, DVec3::ZERO, &corners);
        let between = (corners[9] + corners[10]).normalize();
        assert!(site.normal_distance(between) < 1e-9);
        assert!(angle(site.mean_normal, between) <= site.spread + 1e-9);
    }

    /// What covers a site's normals holds them, and nothing of them is beyond what bounds them.
    #[test]
    fn normals_are_covered_and_bounded() {
        let mut random = Random(21);
        let (mut fine, mut tried) = (Vec::new(), 0);
        for k in 0..60 {
            let shape = if k % 2 == 0 {
                hull(&mut random, 8 + k)
            } else {
                Cells::random(&mut random, 3, 0.5).shape()
            };
            let model = mesh(&shape);
            let edges = (0..model.edges.len() as u32).map(Feature::Edge);
            let vertices = (0..model.vertices.len() as u32).map(Feature::Vertex);
            for site in edges.chain(vertices).flat_map(|feature| Site::all(&model, feature, 1.0)) {
                fine.clear();
                site.cover(0.15, &mut fine);
                assert!(fine.iter().all(|cap| cap.angle <= 0.15 + 1e-9));
                let mut directions = Vec::new();
                site.normal_directions(&mut directions);
                for _ in 0..40 {
                    let normal = match &site.shape {
                        Shape::Piece { normal, .. } => *normal,
                        Shape::Edge { first, across, width, .. } => {
                            let (sine, cosine) = (random.next() * width).sin_cos();
                            cosine * *first + sine * *across
                        }
                        Shape::Vertex { corners, .. } => {
                            let mixed: DVec3 =
                                corners.iter().map(|corner| random.next().powi(3) * *corner).sum();
                            mixed.normalize()
                        }
                    };
                    tried += 1;
                    assert!(fine.iter().any(|cap| angle(cap.axis, normal) <= cap.angle + 1e-9));
                    assert!(angle(site.mean_normal, normal) <= site.spread + 1e-9);
                    for direction in &directions {
                        assert!(angle(*direction, normal) >= site.normal_distance(*direction) - 1e-9);
                    }
                }
            }
        }
        assert!(tried > 100_000);
    }
}
