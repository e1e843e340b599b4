//! Loose faces given by their loops: checked, and their corners joined.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::mesh::report_on;
use super::outlines::area_vector;
use super::regions::Plane;
use super::scale::{Scale, welded};
use super::solid::{Draft, Solid, of_drafts};
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
        drafts.push(Draft { plane, surface, loops: numbered, given: Vec::new() });
    }
    let joint = welded(&points, scale.merge_tol);
    for corner in drafts.iter_mut().flat_map(|draft| draft.loops.iter_mut().flatten()) {
        *corner = joint[*corner as usize];
    }
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
    of_drafts(&points, drafts, scale, off)
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
    if plane.deviation > scale.planar_tol {
        let problem = format!("is not planar: corners are off its plane by {:e}", plane.deviation);
        let remedy = format!("mend the corners to {:e}, or give the face as triangles", scale.planar_tol);
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
    let mut worst = 0.0_f64;
    for outline in drafts.iter_mut().flat_map(|draft| &mut draft.loops) {
        let mut split = Vec::with_capacity(outline.len());
        for [a, b] in sides(outline) {
            split.push(a);
            for (off, k) in scale.points_on(points, [a, b], &corners) {
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
