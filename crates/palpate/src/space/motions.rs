//! The motion that fits best where corners go, and by how much it misses.

use glam::{DMat3, DVec3};

use super::model::{Face, Symmetry, Vertex};
use super::outlines::area_vector;
use super::pose;
use super::regions::TURN_TOL;
use super::spherical::angle;
use crate::part::Surface;

/// Steps of a fit: each squares the error.
const STEPS: usize = 3;

/// Corners that are this close to one line, as a share of the cube of their extent, determine no rotation about it.
const IN_LINE: f64 = 1e-12;

/// What a motion misses by: a corner its image; a normal of a face, or of a corner's cone, where it should be, radians.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Miss {
    pub(super) length: f64,
    pub(super) turn: f64,
}

impl Miss {
    pub(super) fn or(self, other: Self) -> Self {
        Self { length: self.length.max(other.length), turn: self.turn.max(other.turn) }
    }
}

/// By how much a face's normal may be turned if its corners are off by so much, radians (see the module on regions).
pub(super) fn turn(face: &Face, vertices: &[Vertex], off: f64) -> f64 {
    let corners: Vec<DVec3> = face.loops[0].iter().map(|&k| vertices[k as usize].point).collect();
    let numbers: Vec<u32> = (0..corners.len() as u32).collect();
    let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let area = area_vector(&corners, &numbers).length();
    (4.0 * off * low.distance(high) / area).min(TURN_TOL)
}

/// The rotation that takes points nearest to their images in the sense of squares, near a given one; both from a center
/// that it keeps.
///
/// With `u` a turned point and `d` what it misses by, a further turn δ, to first order, leaves `Σ |δ × u − d|²` least where
/// `Σ (|u|² − u uᵀ) δ = Σ u × d` (Gauss and Newton).
pub(super) fn fitted(pairs: &[(DVec3, DVec3)], near: DMat3) -> DMat3 {
    let mut rotation = near;
    for _ in 0..STEPS {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for &(point, image) in pairs {
            let u = rotation * point;
            let outer = DMat3::from_cols(u * u.x, u * u.y, u * u.z);
            matrix += DMat3::from_diagonal(DVec3::splat(u.length_squared())) - outer;
            right += u.cross(image - u);
        }
        let scale = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        if matrix.determinant() <= IN_LINE * scale.powi(3) {
            return rotation;
        }
        rotation = pose::proper(pose::rotation(matrix.inverse() * right) * rotation);
    }
    rotation
}

/// By how much a symmetry misses; vertices that only seams have, and seams, don't count.
pub(super) fn miss(faces: &[Face], vertices: &[Vertex], is_there: &[bool], symmetry: &Symmetry) -> Miss {
    let Symmetry { motion, .. } = symmetry;
    let mut worst = Miss::default();
    for (k, vertex) in vertices.iter().enumerate().filter(|(k, _)| is_there[*k]) {
        let image = &vertices[symmetry.vertices[k] as usize];
        let length = motion.apply(vertex.point).distance(image.point);
        let (Some(cone), Some(of_image)) = (&vertex.normals, &image.normals) else {
            worst = worst.or(Miss { length, turn: 0.0 });
            continue;
        };
        // What is near a convex cone is convex: where the corners are, all of the cone is.
        let turns = cone.iter().map(|corner| beyond(of_image, motion.rotation * *corner));
        worst = worst.or(Miss { length, turn: turns.fold(0.0, f64::max) });
    }
    for (face, &image) in faces.iter().zip(&symmetry.faces).filter(|(face, _)| face.surface != Surface::Seam)
    {
        let turn = angle(motion.rotation * face.normal, faces[image as usize].normal);
        worst.turn = worst.turn.max(turn);
    }
    worst
}

/// The angle from a direction to a convex spherical polygon, counter-clockwise as seen from outside; 0 inside.
pub(super) fn beyond(corners: &[DVec3], direction: DVec3) -> f64 {
    let sides = || corners.iter().zip(corners.iter().cycle().skip(1));
    if sides().all(|(a, b)| a.cross(*b).dot(direction) >= 0.0) {
        return 0.0;
    }
    let at_corners = corners.iter().map(|corner| angle(*corner, direction));
    let at_sides = sides().filter_map(|(&a, &b)| {
        let wall = a.cross(b);
        let is_beside = wall.cross(a).dot(direction) > 0.0 && b.cross(wall).dot(direction) > 0.0;
        let foot = direction.reject_from_normalized(wall.try_normalize()?).try_normalize()?;
        is_beside.then(|| angle(foot, direction))
    });
    at_corners.chain(at_sides).fold(f64::INFINITY, f64::min)
}
