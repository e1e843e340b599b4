//! Faces made of triangles: the way from what is given to what a model is made of.

use glam::DVec3;

use super::corners::as_given;
use super::mesh::Mesh;
use super::model::{Face, Vertex};
use super::orient::{orient, twins};
use super::outlines::{drop_straight, loops};
use super::pieces::View;
use super::regions::{Plane, Region, regions};
use super::scale::Scale;
use crate::Error;
use crate::part::{Mend, Surface};

/// Turns of planes below this need no slack, radians: far below what decides between poses.
const NO_TURN: f64 = 1e-7;

/// What a model is made of.
pub(super) struct Solid {
    /// The corners; all are used.
    pub(super) points: Vec<DVec3>,
    /// Their loops and pieces number the corners.
    pub(super) faces: Vec<Face>,
    /// The triangles of all faces but seams, and the face of each.
    pub(super) triangles: Vec<([u32; 3], u32)>,
    /// The corners on which a tip may rest, before triangles were merged into faces.
    pub(super) given: Vec<Vertex>,
    /// By how much it may differ from what was given: lengths, and normals in radians.
    pub(super) slacks: (f64, f64),
    /// What was read, and how well its coordinates are known.
    pub(super) scale: Scale,
}

/// Triangles whose corners are welded where they may be, and what that costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Sewn {
    /// The corners; all are used, and no two are the same.
    pub vertices: Vec<DVec3>,
    /// Numbers of `vertices`, wound as given.
    pub triangles: Vec<[u32; 3]>,
    /// How far the triangles may be from those that were given.
    pub position_slack: f64,
    /// By how much the planes that they make may be turned against those that were given, radians.
    pub normal_slack: f64,
    /// What was mended.
    pub mends: Vec<Mend>,
}

/// Triangles made into a clean mesh as [`Model::mesh`](super::Model::mesh) makes them, but for how they are wound: for
/// readers of files, which have to know which of them hang together.
///
/// # Errors
/// Numbers that are not finite, a vertex number out of range, a size or a distance from the origin that leaves no digits.
pub fn sewn(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Sewn, Error> {
    let mut mends = Vec::new();
    let surfaces = vec![Surface::Touchable; triangles.len()];
    let mesh = Mesh::cleaned(vertices, triangles, surfaces, &mut mends)?;
    let mut number = vec![None; mesh.points.len()];
    let mut corners = Vec::new();
    let numbered = mesh.triangles.iter().map(|triangle| {
        triangle.map(|k| {
            *number[k as usize].get_or_insert_with(|| {
                corners.push(mesh.points[k as usize]);
                corners.len() as u32 - 1
            })
        })
    });
    let triangles = numbered.collect();
    let moved = mesh.moved.iter().copied().fold(0.0, f64::max);
    let mut turn = 0.0_f64;
    let scale = mesh.scale;
    let deviation = mesh.deviation;
    if moved > 0.0 {
        let mut oriented = mesh;
        orient(&mut oriented, &mut Vec::new());
        for region in regions(&oriented, &twins(&oriented)) {
            turn = turn.max(turned(&region.plane, region.moved(&oriented), scale));
        }
    }
    let (position_slack, normal_slack) = slacks(moved + deviation, turn, scale);
    Ok(Sewn { vertices: corners, triangles, position_slack, normal_slack, mends })
}

/// By how much a plane may be turned: by what its corners are off it, and how far they were moved; of slivers the latter
/// says nothing, whether they were welded or not.
fn turned(plane: &Plane, moved: f64, scale: Scale) -> f64 {
    plane.turn(if plane.is_narrow(scale) { 0.0 } else { moved })
}

/// What differs by less than decides between poses needs no slack.
pub(super) fn slacks(deviation: f64, turn: f64, scale: Scale) -> (f64, f64) {
    (if deviation > scale.merge_tol { deviation } else { 0.0 }, if turn > NO_TURN { turn } else { 0.0 })
}

/// A face to be.
pub(super) struct Draft {
    pub(super) plane: Plane,
    pub(super) surface: Surface,
    pub(super) loops: Vec<Vec<u32>>,
    /// The triangles that make it up, before anything is dropped.
    pub(super) given: Vec<[u32; 3]>,
    /// How far its corners are from those as given, at most.
    pub(super) moved: f64,
}

/// A solid bounded by triangles.
pub(super) fn of_triangles(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    surfaces: Vec<Surface>,
    mends: &mut Vec<Mend>,
) -> Result<Solid, Error> {
    let mut mesh = Mesh::new(vertices, triangles, surfaces, mends)?;
    orient(&mut mesh, mends);
    let twins = twins(&mesh);
    let regions = regions(&mesh, &twins);
    let loops = loops(&mesh, &twins, &regions);
    let draft = |(region, loops): (&Region, Vec<Vec<u32>>)| Draft {
        plane: region.plane,
        surface: region.surface,
        loops,
        given: region.triangles.iter().map(|&t| mesh.triangles[t as usize]).collect(),
        moved: region.moved(&mesh),
    };
    let drafts = regions.iter().zip(loops).map(draft).collect();
    of_drafts(&mesh.points, drafts, mesh.scale, mesh.deviation, mesh.is_torn)
}

/// A solid of faces over common points; `deviation` is how far points are from edges that were split there; `is_torn`: faces
/// end only where what is too low was left out.
pub(super) fn of_drafts(
    points: &[DVec3],
    drafts: Vec<Draft>,
    scale: Scale,
    deviation: f64,
    is_torn: bool,
) -> Result<Solid, Error> {
    let given = as_given(points, &drafts, is_torn);
    let mut keep = vec![false; points.len()];
    let mut rest = Vec::new();
    let (loops, off, cuts) = loop {
        let mut loops: Vec<Vec<Vec<u32>>> = drafts.iter().map(|draft| draft.loops.clone()).collect();
        let off = drop_straight(points, &mut loops, &keep, scale.single_tol);
        let cuts: Vec<Option<Vec<[u32; 3]>>> = drafts
            .iter()
            .zip(&loops)
            .map(|(draft, loops)| {
                if loops.is_empty() {
                    Some(Vec::new())
                } else {
                    View::new(points, draft.plane.normal).triangles(loops)
                }
            })
            .collect();
        // Where a face can't be cut its own triangles serve, and all of their corners stay.
        let failed: Vec<usize> = (0..drafts.len()).filter(|&k| cuts[k].is_none()).collect();
        if failed == rest {
            break (loops, off, cuts);
        }
        for corner in failed.iter().flat_map(|&k| drafts[k].loops.iter().flatten()) {
            keep[*corner as usize] = true;
        }
        rest = failed;
    };
    let mut number = vec![None; points.len()];
    let mut corners = Vec::new();
    let mut numbered = |outline: &[u32]| -> Vec<u32> {
        let of_corner = outline.iter().map(|&k| {
            *number[k as usize].get_or_insert_with(|| {
                corners.push(points[k as usize]);
                corners.len() as u32 - 1
            })
        });
        of_corner.collect()
    };
    let (mut faces, mut triangles) = (Vec::new(), Vec::new());
    let (mut worst, mut turn) = (0.0_f64, 0.0_f64);
    for ((draft, loops), cut) in drafts.into_iter().zip(loops).zip(cuts) {
        if loops.is_empty() {
            continue;
        }
        worst = worst.max(draft.plane.deviation + draft.moved);
        turn = turn.max(turned(&draft.plane, draft.moved, scale));
        let cut = cut.unwrap_or(draft.given);
        if cut.is_empty() {
            let problem = format!("the loops of face {} touch or cross", faces.len());
            let remedy = "give disjoint loops, or the face as triangles";
            return Err(Error::new("loops", problem, format!("{} loops", loops.len()), remedy));
        }
        let pieces = View::new(points, draft.plane.normal).pieces(&cut);
        let face = Face {
            normal: draft.plane.normal,
            offset: draft.plane.offset,
            loops: loops.iter().map(|outline| numbered(outline)).collect(),
            pieces: pieces.iter().map(|piece| numbered(piece)).collect(),
            surface: draft.surface,
        };
        if face.surface != Surface::Seam {
            let of_face = cut.iter().map(|corners| {
                let corners = numbered(corners);
                ([corners[0], corners[1], corners[2]], faces.len() as u32)
            });
            triangles.extend(of_face);
        }
        faces.push(face);
    }
    if triangles.is_empty() {
        let remedy = "give faces that are wider than 5e-7 of the size";
        return Err(Error::new("triangles", "leave no face once cleaned", triangles.len(), remedy));
    }
    // A point may go from where its edge was split or lost a corner, to its corners' new places, and onto the plane.
    let slacks = slacks(worst + deviation + off, turn, scale);
    Ok(Solid { points: corners, faces, triangles, given, slacks, scale })
}
