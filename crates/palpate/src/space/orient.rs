//! Triangles wound alike, their normals pointing out of the material.

use std::f64::consts::PI;

use glam::DVec3;

use super::mesh::{Mesh, Use, report};
use crate::part::Mend;

/// How much of the area of an open surface may be wound against the rest by an oversight: what is more is meant.
const OVERSIGHT: f64 = 0.25;

/// A closed surface about which an open one goes by more than this share of once may lie inside of it.
const AROUND: f64 = 0.1;

/// Triangles that hang together over edges.
struct Component {
    triangles: Vec<u32>,
    /// Each of its edges is used as often in one direction as in the other.
    closed: bool,
    low: DVec3,
    high: DVec3,
}

/// The half-edge on the other side of each, where just two triangles meet.
pub(super) fn twins(mesh: &Mesh) -> Vec<Option<u32>> {
    let mut twins = vec![None; 3 * mesh.triangles.len()];
    for group in mesh.uses().chunk_by(|a, b| a.ends == b.ends) {
        if let [a, b] = group {
            twins[a.half as usize] = Some(b.half);
            twins[b.half as usize] = Some(a.half);
        }
    }
    twins
}

/// The same, and where an even number of triangles meets, each with one next to it about the edge, so that surfaces which
/// touch come apart without crossing: across the void if the windings tell where it is.
fn mates(mesh: &Mesh) -> Vec<Option<u32>> {
    let mut mates = twins(mesh);
    for group in mesh.uses().chunk_by(|a, b| a.ends == b.ends) {
        if group.len() < 4 || group.len() % 2 == 1 {
            continue;
        }
        let [a, b] = group[0].ends.map(|k| mesh.points[k as usize]);
        let along = (b - a).normalize_or_zero();
        let right = along.any_orthonormal_vector();
        let up = along.cross(right);
        let angle = |each: &Use| {
            let corners = mesh.triangles[each.half as usize / 3];
            let apex = mesh.points[corners[(each.half as usize + 2) % 3] as usize] - a;
            apex.dot(up).atan2(apex.dot(right))
        };
        let mut around: Vec<(f64, Use)> = group.iter().map(|each| (angle(each), *each)).collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Counter-clockwise about the edge, the void begins at a triangle that runs forward.
        let num_voids = |around: &[(f64, Use)]| {
            around.chunks(2).filter(|pair| pair[0].1.forward && !pair[1].1.forward).count()
        };
        let mut shifted = around.clone();
        shifted.rotate_left(1);
        let best = if num_voids(&shifted) > num_voids(&around) { shifted } else { around };
        for pair in best.chunks(2) {
            mates[pair[0].1.half as usize] = Some(pair[1].1.half);
            mates[pair[1].1.half as usize] = Some(pair[0].1.half);
        }
    }
    mates
}

/// Winds the triangles of each component alike; outward if it is closed, which within another one means into the void.
///
/// Of what is not closed it is not known what is inside, nor of what an open surface may go around: it is wound as nearly all
/// of its area was given, or else left as it was given.
pub(super) fn orient(mesh: &mut Mesh, mends: &mut Vec<Mend>) {
    let mut is_turned = vec![false; mesh.triangles.len()];
    let (mut components, num_torn) = alike(mesh, &mut is_turned);
    for (triangle, _) in mesh.triangles.iter_mut().zip(&is_turned).filter(|(_, turned)| **turned) {
        triangle.swap(1, 2);
    }
    close(mesh, &mut components);

    let (mut num_inside_out, mut num_kept, mut num_sealed) = (0, 0, 0);
    for (k, component) in components.iter().enumerate() {
        let others = components.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, other)| other);
        let is_known = component.closed && !others.clone().any(|other| may_be_within(mesh, component, other));
        let mut turned: Vec<u32> = component.triangles.clone();
        turned.retain(|&t| is_turned[t as usize]);
        let reverse = if is_known {
            let num_around = others.filter(|other| other.closed && is_within(mesh, component, other)).count();
            num_sealed += usize::from(num_around > 0);
            (volume(mesh, &component.triangles) < 0.0) != (num_around % 2 == 1)
        } else {
            let share = area(mesh, &turned) / area(mesh, &component.triangles);
            if share.min(1.0 - share) > OVERSIGHT {
                for &t in &turned {
                    mesh.triangles[t as usize].swap(1, 2);
                    is_turned[t as usize] = false;
                }
                num_kept += turned.len();
            }
            share >= 1.0 - OVERSIGHT
        };
        if !reverse {
            continue;
        }
        let all_as_given = turned.is_empty();
        num_inside_out += usize::from(all_as_given);
        for &t in &component.triangles {
            mesh.triangles[t as usize].swap(1, 2);
            is_turned[t as usize] ^= !all_as_given;
        }
    }
    report(mends, num_inside_out, "closed surface(s) inside out: turned");
    let num_turned = is_turned.iter().filter(|turned| **turned).count();
    report(mends, num_turned, "triangle(s) wound against their neighbours or facing inward: turned");
    report(mends, num_kept, "triangle(s) of open surfaces wound against their neighbours: kept as given");
    report(
        mends,
        num_torn,
        "edge(s) where no winding agrees: the surface has one side only, and is kept as given",
    );
    let what = "closed surface(s) sealed within another: a probe gets there from inside only; name their triangles in \
                untouchable= if none does";
    report(mends, num_sealed, what);
}

/// Finds which components are closed, as they are wound.
fn close(mesh: &Mesh, components: &mut [Component]) {
    let mut of_triangle = vec![0; mesh.triangles.len()];
    for (k, component) in components.iter().enumerate() {
        for &t in &component.triangles {
            of_triangle[t as usize] = k;
        }
    }
    for group in mesh.uses().chunk_by(|a, b| a.ends == b.ends) {
        for k in group.iter().map(|each| of_triangle[each.half as usize / 3]) {
            let of_component = group.iter().filter(|other| of_triangle[other.half as usize / 3] == k);
            components[k].closed &=
                of_component.map(|each| if each.forward { 1 } else { -1 }).sum::<i32>() == 0;
        }
    }
}

/// Twice the area of triangles.
fn area(mesh: &Mesh, triangles: &[u32]) -> f64 {
    triangles.iter().map(|&t| mesh.area_vector(t as usize).length()).sum()
}

/// The components, with which triangles must turn to be wound as the first of theirs; and the number of edges where
/// that can't be.
fn alike(mesh: &Mesh, is_turned: &mut [bool]) -> (Vec<Component>, usize) {
    let mates = mates(mesh);
    let mut is_known = vec![false; mesh.triangles.len()];
    let (mut components, mut num_torn) = (Vec::new(), 0);
    for seed in 0..mesh.triangles.len() {
        if std::mem::replace(&mut is_known[seed], true) {
            continue;
        }
        let mut triangles = vec![seed as u32];
        let (mut next, mut torn) = (0, 0);
        while let Some(&t) = triangles.get(next) {
            next += 1;
            for half in 3 * t..3 * t + 3 {
                let Some(mate) = mates[half as usize] else { continue };
                let other = mate / 3;
                let opposed = mesh.ends(half)[0] == mesh.ends(mate)[1];
                let must_turn = is_turned[t as usize] == opposed;
                if !std::mem::replace(&mut is_known[other as usize], true) {
                    is_turned[other as usize] = must_turn;
                    triangles.push(other);
                } else if is_turned[other as usize] != must_turn {
                    torn += 1;
                }
            }
        }
        if torn > 0 {
            for &t in &triangles {
                is_turned[t as usize] = false;
            }
        }
        // Each was met from either side.
        num_torn += torn / 2;
        let corners = || triangles.iter().flat_map(|&t| mesh.corners(t as usize));
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        components.push(Component { triangles, closed: true, low, high });
    }
    (components, num_torn)
}

/// The volume that triangles bound, positive if they face outward.
fn volume(mesh: &Mesh, triangles: &[u32]) -> f64 {
    let origin = mesh.corners(triangles[0] as usize)[0];
    let of_triangle = |&t: &u32| {
        let [a, b, c] = mesh.corners(t as usize).map(|point| point - origin);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(of_triangle).sum()
}

/// Whether it is not known if a component lies inside of another, which is open.
fn may_be_within(mesh: &Mesh, inner: &Component, outer: &Component) -> bool {
    let point = mesh.corners(inner.triangles[0] as usize)[0];
    !outer.closed && has_box_around(inner, outer) && winding(mesh, &outer.triangles, point).abs() > AROUND
}

fn has_box_around(inner: &Component, outer: &Component) -> bool {
    inner.low.cmpge(outer.low).all() && inner.high.cmple(outer.high).all()
}

/// Whether a component lies inside of another, which it does not cross.
fn is_within(mesh: &Mesh, inner: &Component, outer: &Component) -> bool {
    if !has_box_around(inner, outer) {
        return false;
    }
    // Where the two touch, the winding number is a half: another triangle is asked.
    let middles = inner.triangles.iter().map(|&t| mesh.corners(t as usize).iter().sum::<DVec3>() / 3.0);
    let mut numbers = middles.map(|point| winding(mesh, &outer.triangles, point).abs());
    numbers.find(|number| (number - number.round()).abs() < 0.1).is_some_and(|number| number > 0.5)
}

/// How often triangles go around a point: the sum of their solid angles (van Oosterom and Strackee 1983), in spheres.
fn winding(mesh: &Mesh, triangles: &[u32], point: DVec3) -> f64 {
    let solid_angle = |&t: &u32| {
        let [a, b, c] = mesh.corners(t as usize).map(|corner| corner - point);
        let lengths = [a.length(), b.length(), c.length()];
        let below = lengths[0] * lengths[1] * lengths[2]
            + a.dot(b) * lengths[2]
            + b.dot(c) * lengths[0]
            + c.dot(a) * lengths[1];
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * PI)
}
