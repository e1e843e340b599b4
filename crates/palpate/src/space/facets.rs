//! Loose faces given by their loops: checked, and their corners joined.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use super::mesh::report_on;
use super::outlines::area_vector;
use super::pieces::View;
use super::regions::Plane;
use super::scale::Scale;
use super::solid::{Draft, Solid, of_drafts};
use super::weld::{apply, joints, report_welded, welded};
use crate::Error;
use crate::part::{Mend, Surface};
use crate::plane::outline;

/// A solid, or a part of its surface, of faces each given by an outer loop and those of its holes.
pub(super) fn of_loops(
    faces: &[Vec<Vec<DVec3>>],
    surfaces: &[Surface],
    mends: &mut Vec<Mend>,
) -> Result<Solid, Error> {
    if surfaces.iter().all(|&surface| surface == Surface::Seam) {
        let value = format!("{} faces, all of them seams", faces.len());
        return Err(Error::new("loops", "has no face", value, "give at least one face that is not a seam"));
    }
    let scale = Scale::new("loops", faces.iter().flatten().flatten().copied())?;
    let mut points = Vec::new();
    let mut drafts = Vec::new();
    for (k, (loops, &surface)) in faces.iter().zip(surfaces).enumerate() {
        let (plane, loops) = checked(k, loops, scale, mends)?;
        let mut numbered = Vec::new();
        for outline in loops {
            let first = points.len() as u32;
            points.extend(outline);
            numbered.push((first..points.len() as u32).collect());
        }
        drafts.push(Draft { plane, surface, loops: numbered, given: Vec::new(), moved: 0.0 });
    }
    renumber(&mut drafts, &welded(&points, scale.merge_tol));
    weld_ends(&mut points, &mut drafts, scale, mends);
    let given = drafts.len();
    let mut known = BTreeSet::new();
    drafts.retain(|draft| {
        let mut sides: Vec<[u32; 2]> =
            draft.loops.iter().flat_map(|outline| sides(outline).collect::<Vec<_>>()).collect();
        sides.sort_unstable();
        known.insert((sides, draft.surface == Surface::Seam))
    });
    report_on(
        mends,
        "loops",
        given - drafts.len(),
        "face(s) given twice dropped, those after are renumbered",
    );
    let off = split_sides(&points, &mut drafts, scale);
    for draft in &mut drafts {
        draft.given = View::new(&points, draft.plane.normal).triangles(&draft.loops).unwrap_or_default();
    }
    of_drafts(&points, drafts, scale, off, false)
}

/// The plane of a face, and its loops, the outer one counter-clockwise about the normal.
fn checked(
    number: usize,
    loops: &[Vec<DVec3>],
    scale: Scale,
    mends: &mut Vec<Mend>,
) -> Result<(Plane, Vec<Vec<DVec3>>), Error> {
    let argument = format!("loops[{number}]");
    let Some((outer, holes)) = loops.split_first().filter(|(outer, _)| outer.len() >= 3) else {
        let value = format!("{} loops, {} points", loops.len(), loops.first().map_or(0, Vec::len));
        return Err(Error::new(argument, "has no outer loop", value, "give at least three corners"));
    };
    let numbers: Vec<u32> = (0..outer.len() as u32).collect();
    let area = area_vector(outer, &numbers);
    if area.length() <= scale.merge_tol * scale.merge_tol {
        let problem = "has an outer loop without area";
        return Err(Error::new(argument, problem, area.length(), "give corners that are not in line"));
    }
    let plane = Plane::new(area, loops.iter().flatten().copied());
    if plane.deviation > scale.single_tol {
        let problem = format!("is not planar: corners are off its plane by {:e}", plane.deviation);
        let remedy = format!("mend the corners to {:e}, or give the face as triangles", scale.single_tol);
        return Err(Error::new(argument, problem, plane.deviation, remedy));
    }
    let right = plane.normal.any_orthonormal_vector();
    let up = plane.normal.cross(right);
    let flat = |outline: &Vec<DVec3>| -> Vec<DVec2> {
        let offsets = outline.iter().map(|point| *point - outer[0]);
        offsets.map(|offset| DVec2::new(offset.dot(right), offset.dot(up))).collect()
    };
    let holes_flat: Vec<Vec<DVec2>> = holes.iter().map(flat).collect();
    let count = loops.iter().map(Vec::len).sum();
    let mut of_face = Vec::new();
    // In the plane the outer loop is "vertices" and the holes are "holes[k]".
    let rename = |text: &str| match text.strip_prefix("vertices") {
        Some(rest) => format!("{argument}[0]{rest}"),
        None => format!("{argument}, {text}"),
    };
    let cleaned = outline::clean(&flat(outer), &holes_flat, &vec![Surface::Touchable; count], &mut of_face)
        .map_err(|error| Error { argument: rename(&error.argument), ..error })?;
    mends.extend(of_face.iter().map(|Mend(text)| Mend(rename(text))));
    let given: Vec<DVec3> = loops.iter().flatten().copied().collect();
    let kept = |outline: outline::Outline| outline.corners.iter().map(|corner| given[corner.given]).collect();
    Ok((plane, cleaned.into_iter().map(kept).collect()))
}

fn renumber(drafts: &mut [Draft], of_point: &[u32]) {
    for corner in drafts.iter_mut().flat_map(|draft| draft.loops.iter_mut().flatten()) {
        *corner = of_point[*corner as usize];
    }
}

/// Welds corners of sides that no other face has which are within a few roundings of one another.
fn weld_ends(points: &mut [DVec3], drafts: &mut [Draft], scale: Scale, mends: &mut Vec<Mend>) {
    let mut uses: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for [a, b] in drafts.iter().flat_map(|draft| draft.loops.iter().flat_map(|outline| sides(outline))) {
        *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    let ends: BTreeSet<u32> =
        uses.into_iter().filter(|(_, count)| count % 2 == 1).flat_map(|(k, _)| k).collect();
    let ends: Vec<u32> = ends.into_iter().collect();
    let outlines = drafts.iter().flat_map(|draft| draft.loops.iter().map(Vec::as_slice));
    let joints = joints(points, &ends, outlines, scale.single_tol);
    let moved: BTreeMap<u32, f64> = joints.iter().map(|joint| (joint.points[0], joint.moved)).collect();
    renumber(drafts, &apply(points, &joints));
    for draft in drafts {
        let of_corners = draft.loops.iter().flatten().filter_map(|k| moved.get(k).copied());
        draft.moved = of_corners.fold(0.0, f64::max);
    }
    let count = joints.iter().map(|joint| joint.points.len()).sum();
    let most = moved.values().copied().fold(0.0, f64::max);
    report_welded(mends, count, joints.len(), most, scale.single_tol);
}

fn sides(outline: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    outline.iter().zip(outline.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// Puts corners that lie on the inside of a side into the loop, so that faces share whole sides; by how much they are
/// off at most.
fn split_sides(points: &[DVec3], drafts: &mut [Draft], scale: Scale) -> f64 {
    let mut corners: Vec<u32> =
        drafts.iter().flat_map(|draft| draft.loops.iter().flatten().copied()).collect();
    corners.sort_unstable();
    corners.dedup();
    corners.sort_by(|&a, &b| points[a as usize].x.total_cmp(&points[b as usize].x));
    let loops = drafts.iter().flat_map(|draft| &draft.loops);
    let joined: BTreeSet<[u32; 2]> = loops.flat_map(|outline| sides(outline)).collect();
    let apart = |a: u32, b: u32| joined.contains(&[a, b]) || joined.contains(&[b, a]);
    let mut worst = 0.0_f64;
    for outline in drafts.iter_mut().flat_map(|draft| &mut draft.loops) {
        let mut split = Vec::with_capacity(outline.len());
        for [a, b] in sides(outline) {
            split.push(a);
            for (off, k) in scale.points_on(points, [a, b], &corners, apart) {
                if !outline.contains(&k) {
                    worst = worst.max(off);
                    split.push(k);
                }
            }
        }
        *outline = split;
    }
    worst
}
