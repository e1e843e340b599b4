//! Loose faces: their ends joined to vertices.

use crate::part::{Mend, Surface};
use std::collections::BTreeSet;

use glam::DVec2;

use super::model::{Face, Vertex};
use super::outline::{merge_distance, turn};
use crate::Error;

/// Faces that meet in a point.
#[derive(Default)]
struct Joint {
    point: DVec2,
    ending: Vec<usize>,
    starting: Vec<usize>,
}

/// The faces, and the vertices where their ends lie. Segments without length and repeated ones are dropped.
pub(super) fn join(
    segments: &[[DVec2; 2]],
    surfaces: &[Surface],
    mends: &mut Vec<Mend>,
) -> Result<(Vec<Face>, Vec<Vertex>), Error> {
    if surfaces.iter().all(|&surface| surface == Surface::Seam) {
        let value = format!("{} segments, all of them seams", segments.len());
        return Err(Error::new(
            "segments",
            "has no face",
            value,
            "give at least one segment that is not a seam",
        ));
    }
    let merge_tol = merge_distance("segments", segments.iter().flatten().copied())?;
    let mut joints = Vec::new();
    let mut faces = Vec::new();
    let (mut known, mut num_empty, mut num_repeated) = (BTreeSet::new(), 0, 0);
    for (&ends, &surface) in segments.iter().zip(surfaces) {
        let [start, end] = ends.map(|point| joint_at(&mut joints, point, merge_tol));
        if start == end {
            num_empty += 1;
        } else if !known.insert((start, end, surface == Surface::Seam)) {
            num_repeated += 1;
        } else {
            if surface != Surface::Seam {
                joints[start].starting.push(faces.len());
                joints[end].ending.push(faces.len());
            }
            faces.push(Face::new(joints[start].point, joints[end].point, surface));
        }
    }
    report(mends, num_empty, "without length");
    report(mends, num_repeated, "given twice");
    if faces.iter().all(|face| face.surface == Surface::Seam) {
        let value = format!("{} segments, those that are no seams without length", segments.len());
        return Err(Error::new("segments", "has no face", value, "give the segments distinct ends"));
    }
    let vertices = joints.iter().filter_map(|joint| vertex(joint, &faces)).collect();
    Ok((faces, vertices))
}

fn joint_at(joints: &mut Vec<Joint>, point: DVec2, merge_tol: f64) -> usize {
    let near = joints.iter().position(|joint: &Joint| joint.point.distance(point) <= merge_tol);
    near.unwrap_or_else(|| {
        joints.push(Joint { point, ..Joint::default() });
        joints.len() - 1
    })
}

/// Can be touched if just two touchable faces meet there and turn left, or back: the edge of a plate without thickness.
/// Where only seams meet there is no vertex.
fn vertex(joint: &Joint, faces: &[Face]) -> Option<Vertex> {
    let point = joint.point;
    match (&*joint.ending, &*joint.starting) {
        ([], []) => None,
        (&[before], &[after]) => {
            let (before, after) = (&faces[before], &faces[after]);
            let back = turn(before.start, point, after.end) == 0.0
                && (point - before.start).dot(after.end - point) < 0.0;
            let touchable = before.is_touchable() && after.is_touchable();
            let mut vertex = Vertex::between(before, after);
            if back && touchable {
                vertex.normals = Some(Vertex::cone(before, after));
            }
            Some(vertex)
        }
        _ => Some(Vertex { point, normals: None }),
    }
}

fn report(mends: &mut Vec<Mend>, count: usize, what: &str) {
    if count > 0 {
        mends.push(Mend(format!("segments: {count} {what} dropped, those after are renumbered")));
    }
}
