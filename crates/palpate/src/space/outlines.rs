//! The loops around regions, without points on straight runs.

use std::collections::BTreeSet;

use glam::DVec3;

use super::mesh::Mesh;
use super::regions::Region;

/// The loops of each region, as point numbers: material on the left. The loop of the largest area first.
pub(super) fn loops(mesh: &Mesh, twins: &[Option<u32>], regions: &[Region]) -> Vec<Vec<Vec<u32>>> {
    let mut of_triangle = vec![0; mesh.triangles.len()];
    for (k, region) in regions.iter().enumerate() {
        for &t in &region.triangles {
            of_triangle[t as usize] = k;
        }
    }
    let crossed = |half: u32| {
        let twin = twins[half as usize]?;
        let opposed = mesh.ends(half)[0] == mesh.ends(twin)[1];
        (opposed && of_triangle[twin as usize / 3] == of_triangle[half as usize / 3]).then_some(twin)
    };
    let mut is_done = vec![false; twins.len()];
    let of_region = |region: &Region| {
        let mut loops = Vec::new();
        for first in region.triangles.iter().flat_map(|&t| 3 * t..3 * t + 3) {
            if crossed(first).is_some() || is_done[first as usize] {
                continue;
            }
            let (mut half, mut outline) = (first, Vec::new());
            while !std::mem::replace(&mut is_done[half as usize], true) {
                outline.push(mesh.ends(half)[0]);
                half = following(half);
                // Around the corner, through the region, to the next half-edge of its rim.
                while let Some(twin) = crossed(half) {
                    half = following(twin);
                }
            }
            loops.push(outline);
        }
        let area = |outline: &[u32]| area_vector(&mesh.points, outline).dot(region.plane.normal);
        loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
        loops
    };
    regions.iter().map(of_region).collect()
}

fn following(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

/// Half of the sum of cross products (Newell): along the normal, as long as the area.
pub(super) fn area_vector(points: &[DVec3], outline: &[u32]) -> DVec3 {
    let origin = points[outline[0] as usize];
    let corner = |k: usize| points[outline[k % outline.len()] as usize] - origin;
    (0..outline.len()).map(|k| 0.5 * corner(k).cross(corner(k + 1))).sum()
}

/// Drops points on straight runs where nothing else meets, from all loops alike, but those to `keep`; returns by how
/// much they were off at most. Loops of which no area is left are dropped.
pub(super) fn drop_straight(points: &[DVec3], faces: &mut [Vec<Vec<u32>>], keep: &[bool], tol: f64) -> f64 {
    let neighbours = neighbours(points.len(), faces);
    let is_plain = |k: u32| !keep[k as usize] && neighbours[k as usize].len() == 2;
    let mut is_known = vec![false; points.len()];
    let mut dropped = BTreeSet::new();
    let mut off = 0.0_f64;
    for outline in faces.iter().flatten() {
        let n = outline.len();
        let at = |k: usize| points[outline[k % n] as usize];
        let bent = |k: usize| distance_between(at(k + n - 1), at(k), at(k + 1)).is_none_or(|off| off > tol);
        let Some(first) = (0..n).find(|&k| !is_plain(outline[k])).or_else(|| (0..n).find(|&k| bent(k)))
        else {
            continue;
        };
        let (mut from, mut run) = (at(first), Vec::new());
        for k in first + 1..first + n {
            let number = outline[k % n];
            if !is_plain(number) || std::mem::replace(&mut is_known[number as usize], true) {
                (from, run) = (at(k), Vec::new());
                continue;
            }
            run.push(at(k));
            let mut each = run.iter().map(|&point| distance_between(from, point, at(k + 1)));
            let worst = each.try_fold(0.0_f64, |worst, off| Some(worst.max(off?)));
            if let Some(worst) = worst.filter(|&worst| worst <= tol) {
                dropped.insert(number);
                off = off.max(worst);
            } else {
                (from, run) = (at(k), Vec::new());
            }
        }
    }
    for loops in faces.iter_mut() {
        for outline in loops.iter_mut() {
            outline.retain(|k| !dropped.contains(k));
        }
        loops.retain(|outline| outline.len() >= 3);
    }
    off
}

/// The points next to each in all loops: of one on a plain edge there are two.
fn neighbours(num_points: usize, faces: &[Vec<Vec<u32>>]) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); num_points];
    let mut join = |a: u32, b: u32| {
        // More than two are as good as three.
        let known: &mut Vec<u32> = &mut neighbours[a as usize];
        if known.len() < 3 && !known.contains(&b) {
            known.push(b);
        }
    };
    for outline in faces.iter().flatten() {
        for (k, &a) in outline.iter().enumerate() {
            let b = outline[(k + 1) % outline.len()];
            join(a, b);
            join(b, a);
        }
    }
    neighbours
}

/// How far a point is from the way between two others, if it is beside its inside.
fn distance_between(a: DVec3, point: DVec3, b: DVec3) -> Option<f64> {
    let along = (b - a).try_normalize()?;
    let place = (point - a).dot(along);
    let is_inside = place > 0.0 && (point - b).dot(along) < 0.0;
    is_inside.then(|| (point - a - place * along).length())
}
