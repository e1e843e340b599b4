//! The outward normals at a corner.
//!
//! Let `e₁ … e_k` be the directions of the edges at a corner. Every face there spans less than half a turn between two
//! of them, so the hull of the surface near the corner is that of the `eᵢ`; its polar cone is `{n : n · eᵢ ≤ 0}`. If it
//! has an interior, all `eᵢ` lie in an open half-space, `m · eᵢ > 0`. As seen in the plane `m · x = 1` the hull is a
//! convex polygon, and the corners of the polar cone are the normals of its sides, in their order.
//!
//! Beyond the hull there is either void, and the polar cone is that of the part; or material, and no tip rests there.
//! The edges at the polygon's corners tell: about such an edge more than half of the space is beyond the hull, so that
//! the edge is convex in the first case and reflex in the second.

use glam::{DVec2, DVec3};
use robust::Coord;

use super::edges::Bend;
use super::model::{Edge, Face, Vertex};
use crate::part::Surface;

/// Directions that are closer to the rim of a half-space do not leave its normal any room, radians.
const NO_ROOM: f64 = 1e-9;

/// A corner of the cone closer to a face's normal than this is that normal, radians.
const SAME: f64 = 1e-8;

/// What meets at a corner.
#[derive(Default, Clone)]
struct Around {
    /// Away from it, along the edges.
    directions: Vec<DVec3>,
    /// How these bend.
    bends: Vec<Bend>,
    /// Normals of its faces.
    normals: Vec<DVec3>,
    /// No face can't be touched, none spans half a turn or more.
    is_pointed: bool,
    /// A face ends here.
    is_open: bool,
}

/// The vertices at `points`. If the surface is torn, which it is where triangles too low to be told from lines are left
/// out, faces that end are known to go on.
pub(super) fn vertices(
    points: &[DVec3],
    faces: &[Face],
    edges: &[Edge],
    bends: &[Bend],
    is_torn: bool,
) -> Vec<Vertex> {
    let around = around(points, faces, edges, bends);
    let vertex = |(&point, around): (&DVec3, &Around)| Vertex { point, normals: around.cone(is_torn) };
    points.iter().zip(&around).map(vertex).collect()
}

fn around(points: &[DVec3], faces: &[Face], edges: &[Edge], bends: &[Bend]) -> Vec<Around> {
    let mut all = vec![Around { is_pointed: true, ..Around::default() }; points.len()];
    let at = |k: u32| points[k as usize];
    for (edge, &bend) in edges.iter().zip(bends) {
        let is_there = |face: &u32| faces[*face as usize].surface != Surface::Seam;
        if edge.faces.iter().flatten().filter(|face| is_there(face)).count() == 0 {
            continue;
        }
        for [from, to] in [edge.ends, [edge.ends[1], edge.ends[0]]] {
            let here = &mut all[from as usize];
            here.directions.push((at(to) - at(from)).normalize_or_zero());
            here.bends.push(bend);
            here.is_open |= bend == Bend::Open;
        }
    }
    for face in faces.iter().filter(|face| face.surface != Surface::Seam) {
        for outline in &face.loops {
            let n = outline.len();
            for k in 0..n {
                let [before, here, after] = [outline[(k + n - 1) % n], outline[k], outline[(k + 1) % n]];
                let turn = (at(here) - at(before)).cross(at(after) - at(here)).dot(face.normal);
                let here = &mut all[here as usize];
                here.normals.push(face.normal);
                here.is_pointed &= turn > 0.0 && face.surface == Surface::Touchable;
            }
        }
    }
    all
}

impl Around {
    /// The corners of the cone of outward normals, if there is one.
    fn cone(&self, is_torn: bool) -> Option<Vec<DVec3>> {
        if !self.is_pointed || self.is_open && !is_torn || self.directions.len() < 3 {
            return None;
        }
        let middle = middle(&self.directions);
        if self.directions.iter().any(|direction| direction.dot(middle) <= NO_ROOM) {
            return None;
        }
        let hull = hull(&self.directions, middle);
        // Where solids touch along an edge, one of the voids about it may be the larger half.
        let is_reflex = |&k: &usize| {
            let mut same = self.directions.iter().zip(&self.bends);
            same.all(|(other, bend)| *bend == Bend::Reflex || other.distance(self.directions[k]) > NO_ROOM)
        };
        let is_inner = if is_torn { hull.iter().all(is_reflex) } else { hull.iter().any(is_reflex) };
        if hull.len() < 3 || is_inner {
            return None;
        }
        let mut corners: Vec<DVec3> = Vec::with_capacity(hull.len());
        for (k, &first) in hull.iter().enumerate() {
            let second = hull[(k + 1) % hull.len()];
            let normal = self.directions[second].cross(self.directions[first]).try_normalize()?;
            let near = self.normals.iter().filter(|face| face.distance(normal) <= SAME);
            let nearest = near.min_by(|a, b| a.distance(normal).total_cmp(&b.distance(normal)));
            let corner = nearest.copied().unwrap_or(normal);
            if corners.last() != Some(&corner) && corners.first() != Some(&corner) {
                corners.push(corner);
            }
        }
        // As seen from the apex's side the hull goes around the other way.
        corners.reverse();
        (corners.len() >= 3).then_some(corners)
    }
}

/// The least cone that holds the corners of two, if it is within a half-space.
pub(super) fn joined(one: &[DVec3], other: &[DVec3]) -> Option<Vec<DVec3>> {
    let corners = [one, other].concat();
    let middle = middle(&corners);
    if corners.iter().any(|corner| corner.dot(middle) <= NO_ROOM) {
        return None;
    }
    let mut hull: Vec<DVec3> = hull(&corners, middle).into_iter().map(|k| corners[k]).collect();
    hull.dedup_by(|a, b| a.distance(*b) <= SAME);
    if hull.len() > 1 && hull[0].distance(hull[hull.len() - 1]) <= SAME {
        hull.pop();
    }
    Some(hull)
}

/// The middle of the narrowest circular cone around directions, if they fit into an open half-space; else anything.
fn middle(directions: &[DVec3]) -> DVec3 {
    // Each prefix's cone is made by two or three of its directions, the last of which is the one that the cone of the
    // shorter prefix did not hold (Welzl 1991, as loops).
    let two = |a: DVec3, b: DVec3| (a + b).normalize_or_zero();
    let three = |a: DVec3, b: DVec3, c: DVec3| {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        normal * normal.dot(a).signum()
    };
    let holds = |middle: DVec3, rim: DVec3, other: DVec3| middle.dot(other) >= middle.dot(rim) - 1e-12;
    let mut middle = directions[0];
    let mut rim = directions[0];
    for (i, &a) in directions.iter().enumerate() {
        if holds(middle, rim, a) {
            continue;
        }
        (middle, rim) = (a, a);
        for (j, &b) in directions[..i].iter().enumerate() {
            if holds(middle, rim, b) {
                continue;
            }
            middle = two(a, b);
            for &c in &directions[..j] {
                if !holds(middle, rim, c) {
                    middle = three(a, b, c);
                }
            }
        }
    }
    middle
}

/// The numbers of the directions at the corners of the convex hull, counter-clockwise as seen against `middle`.
fn hull(directions: &[DVec3], middle: DVec3) -> Vec<usize> {
    let right = middle.any_orthonormal_vector();
    let up = middle.cross(right);
    let seen: Vec<DVec2> =
        directions.iter().map(|e| DVec2::new(e.dot(right), e.dot(up)) / e.dot(middle)).collect();
    let turn = |a: usize, b: usize, c: usize| {
        let coord = |k: usize| Coord { x: seen[k].x, y: seen[k].y };
        robust::orient2d(coord(a), coord(b), coord(c))
    };
    let mut order: Vec<usize> = (0..seen.len()).collect();
    order.sort_by(|&a, &b| seen[a].x.total_cmp(&seen[b].x).then(seen[a].y.total_cmp(&seen[b].y)));
    let chain = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for k in order {
            while let [.., a, b] = chain[..] {
                if turn(a, b, k) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(k);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut order.iter().copied());
    hull.extend(chain(&mut order.iter().rev().copied()));
    hull
}
