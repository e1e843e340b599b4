//! Lines where faces meet, and whether a tip can rest on them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::DVec3;

use super::distance::orient;
use super::model::{Edge, Face};
use crate::part::Surface;

/// Faces whose normals differ by less are one plane to a tip, or two sides of a sheet; radians.
const FLAT: f64 = 1e-9;

/// Where normals differ by less, which way an edge bends is asked of the corners: normals of slivers are not known
/// better than to 1e-7.
const CLEAR: f64 = 1e-6;

/// How the material bends at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bend {
    /// Less than half of the space about it is material.
    Convex,
    /// More than half of it.
    Reflex,
    /// Just half of it.
    Flat,
    /// A face ends here, or is folded back on itself, or a seam begins.
    Open,
}

/// A face at an edge.
#[derive(Debug, Clone, Copy)]
struct Side {
    face: u32,
    /// Its loop runs from the lower vertex number to the higher.
    forward: bool,
    /// Its number in the order in which loops are gone through.
    place: usize,
    /// The corner of the face that follows, and the one before.
    next: u32,
}

/// The edges, how each bends, and whether all faces but seams meet two by two.
pub(super) fn edges(points: &[DVec3], faces: &[Face]) -> (Vec<Edge>, Vec<Bend>, bool) {
    let mut sides: BTreeMap<[u32; 2], Vec<Side>> = BTreeMap::new();
    let mut place = 0;
    for (face, loops) in (0..).zip(faces.iter().map(|face| &face.loops)) {
        for outline in loops {
            let n = outline.len();
            for k in 0..n {
                let (a, b) = (outline[k], outline[(k + 1) % n]);
                let side = Side { face, forward: a < b, place, next: outline[(k + 2) % n] };
                sides.entry([a.min(b), a.max(b)]).or_default().push(side);
                place += 1;
            }
        }
    }
    let mut found: Vec<(usize, Edge, Bend)> = Vec::new();
    let mut closed = true;
    for (ends, sides) in &sides {
        let (pairs, all_paired) = pairs(points, faces, *ends, sides);
        closed &= all_paired;
        for (first, second) in pairs {
            let (edge, bend) = edge(points, faces, *ends, first, second);
            found.push((first.place, edge, bend));
        }
    }
    found.sort_by_key(|entry| entry.0);
    let (edges, bends) = found.into_iter().map(|(_, edge, bend)| (edge, bend)).unzip();
    (edges, bends, closed)
}

/// Which sides bound one void between them; the one that comes first in the loops first. Whether all but seams do.
fn pairs(
    points: &[DVec3],
    faces: &[Face],
    ends: [u32; 2],
    sides: &[Side],
) -> (Vec<(Side, Option<Side>)>, bool) {
    let is_seam = |side: &&Side| faces[side.face as usize].surface == Surface::Seam;
    let (seams, there): (Vec<&Side>, Vec<&Side>) = sides.iter().partition(is_seam);
    let (mut pairs, mut alone) = (Vec::new(), Vec::new());
    match there.as_slice() {
        [a, b] if a.forward != b.forward => pairs.push((**a, Some(**b))),
        [] => {}
        [a] => alone.push(**a),
        _ => (pairs, alone) = around(points, faces, ends, &there),
    }
    let all_paired = alone.is_empty();
    // What is left may end at a seam.
    for seam in seams {
        match alone.iter().position(|side| side.forward != seam.forward) {
            Some(k) => pairs.push((alone.remove(k), Some(*seam))),
            None => alone.push(*seam),
        }
    }
    pairs.extend(alone.into_iter().map(|side| (side, None)));
    let ordered = pairs.into_iter().map(|(a, b)| match b {
        Some(b) if b.place < a.place => (b, Some(a)),
        b => (a, b),
    });
    (ordered.collect(), all_paired)
}

/// Pairs of many: counter-clockwise about the edge, the void begins at a side that runs forward and ends at the next
/// one, which must run backward.
fn around(
    points: &[DVec3],
    faces: &[Face],
    ends: [u32; 2],
    sides: &[&Side],
) -> (Vec<(Side, Option<Side>)>, Vec<Side>) {
    let [a, b] = ends.map(|k| points[k as usize]);
    let along = (b - a).normalize_or_zero();
    let right = along.any_orthonormal_vector();
    let up = along.cross(right);
    let angle = |side: &Side| {
        let inward = into_face(faces, side, along);
        inward.dot(up).atan2(inward.dot(right)).rem_euclid(TAU)
    };
    let mut order: Vec<(f64, Side)> = sides.iter().map(|side| (angle(side), **side)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = order.len();
    // Sides that lie on one another take the order that alternates.
    for k in 0..n {
        let (before, here, after) = ((k + n - 1) % n, k, (k + 1) % n);
        let gap = (order[after].0 - order[here].0).rem_euclid(TAU);
        if order[before].1.forward == order[here].1.forward
            && order[here].1.forward != order[after].1.forward
            && !(FLAT..=TAU - FLAT).contains(&gap)
        {
            order.swap(here, after);
        }
    }
    if (0..n).any(|k| order[k].1.forward == order[(k + 1) % n].1.forward) {
        return (Vec::new(), sides.iter().map(|side| **side).collect());
    }
    let begins = (0..n).filter(|&k| order[k].1.forward);
    (begins.map(|k| (order[k].1, Some(order[(k + 1) % n].1))).collect(), Vec::new())
}

/// From the edge into the face, in its plane.
fn into_face(faces: &[Face], side: &Side, along: DVec3) -> DVec3 {
    let inward = faces[side.face as usize].normal.cross(along);
    if side.forward { inward } else { -inward }
}

fn edge(points: &[DVec3], faces: &[Face], ends: [u32; 2], first: Side, second: Option<Side>) -> (Edge, Bend) {
    let ends = if first.forward { ends } else { [ends[1], ends[0]] };
    let faces_of = [Some(first.face), second.map(|side| side.face)];
    let open = Edge { ends, faces: faces_of, normals: None };
    let Some(second) = second else { return (open, Bend::Open) };
    let [left, right] = [first, second].map(|side| &faces[side.face as usize]);
    if left.surface == Surface::Seam || right.surface == Surface::Seam {
        return (open, Bend::Open);
    }
    let [from, to] = ends.map(|k| points[k as usize]);
    let along = (to - from).normalize_or_zero();
    let cross = left.normal.cross(right.normal);
    let bend = if cross.length() <= FLAT {
        if left.normal.dot(right.normal) > 0.0 { Bend::Flat } else { Bend::Open }
    } else if cross.length() > CLEAR {
        if cross.dot(along) > 0.0 { Bend::Convex } else { Bend::Reflex }
    } else {
        let [a, b] = [first, second].map(|side| points[side.next as usize]);
        // Which side of the plane the corner is on does not tell on which side of the line it is in its own face.
        let is_inside = |corner: DVec3, side: &Side| {
            into_face(faces, side, if first.forward == side.forward { along } else { -along })
                .dot(corner - from)
                > 0.0
        };
        let below = orient(from, to, a, b);
        let is_known = is_inside(a, &first) && is_inside(b, &second);
        match below {
            below if is_known && below > 0.0 => Bend::Convex,
            below if is_known && below < 0.0 => Bend::Reflex,
            _ if cross.dot(along) > 0.0 => Bend::Convex,
            _ => Bend::Reflex,
        }
    };
    let touchable = left.surface == Surface::Touchable && right.surface == Surface::Touchable;
    let normals = (bend == Bend::Convex && touchable).then_some([left.normal, right.normal]);
    (Edge { normals, ..open }, bend)
}
