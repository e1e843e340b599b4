//! The rotations that map a planar model onto itself.
//!
//! They form a cyclic group of rotations by multiples of `2π/m` about the centroid of the faces. A rotation that maps
//! a face onto itself, start to start, is the identity; so each orbit of faces has `m` members, and `m` divides their
//! number. The divisors are tried from the largest down.

use crate::part::Surface;
use std::f64::consts::TAU;

use glam::DVec2;

use super::Pose;
use super::model::{Face, Symmetry, Vertex};

/// How far a mapped point may be from its image, as a share of the model's size: far below τ, as what holds for a pose
/// is taken to hold for its images.
const SYMMETRY_TOL: f64 = 1e-9;

/// The same as a share of the shortest face, whose normal must turn by far less than τ.
const SYMMETRY_TURN: f64 = 1e-7;

/// A face or a vertex, as far as a rotation must respect it.
struct Mark {
    start: DVec2,
    /// Of a vertex, the same as `start`.
    end: DVec2,
    kind: Kind,
}

#[derive(PartialEq)]
enum Kind {
    Face(Surface),
    Vertex { touchable: bool },
}

/// Marks that are to be mapped onto each other.
struct Marks {
    all: Vec<Mark>,
    /// Their numbers, by the x of their start.
    by_x: Vec<usize>,
    tol: f64,
}

/// All of them, the identity first, then by angle. A seam is not there: it has no say, and keeps its number.
pub(super) fn symmetries(faces: &[Face], vertices: &[Vertex], size: f64) -> Vec<Symmetry> {
    let there: Vec<usize> = (0..faces.len()).filter(|&k| faces[k].surface != Surface::Seam).collect();
    let face_marks = there.iter().map(|&k| {
        let Face { start, end, surface, .. } = faces[k];
        Mark { start, end, kind: Kind::Face(surface) }
    });
    let vertex_marks = vertices.iter().map(|vertex| {
        let kind = Kind::Vertex { touchable: vertex.normals.is_some() };
        Mark { start: vertex.point, end: vertex.point, kind }
    });
    let shortest = there.iter().map(|&k| faces[k].length()).fold(f64::INFINITY, f64::min);
    let tol = (SYMMETRY_TOL * size).min(SYMMETRY_TURN * shortest);
    let face_marks = Marks::new(face_marks.collect(), tol);
    let vertex_marks = Marks::new(vertex_marks.collect(), tol);

    let center = face_marks.centroid();
    let mut orders = (1..=there.len()).rev().filter(|order| there.len().is_multiple_of(*order));
    let group = orders.find_map(|order| {
        let motions: Vec<Pose> = (0..order).map(|k| rotation(center, k, order)).collect();
        let (face_maps, vertex_maps) = (face_marks.maps(&motions)?, vertex_marks.maps(&motions)?);
        Some(motions.into_iter().zip(face_maps).zip(vertex_maps).collect::<Vec<_>>())
    });
    let symmetry = |((motion, face_map), vertex_map): ((Pose, Vec<usize>), Vec<usize>)| {
        let mut of_face: Vec<usize> = (0..faces.len()).collect();
        for (&k, image) in there.iter().zip(face_map) {
            of_face[k] = there[image];
        }
        Symmetry { motion, faces: numbers(&of_face), vertices: numbers(&vertex_map) }
    };
    group.unwrap_or_default().into_iter().map(symmetry).collect()
}

/// By how much the symmetries miss: a corner its image, and the normal of a face, radians. What holds for a pose holds for
/// its images with bounds enlarged by it.
pub(super) fn asymmetry(faces: &[Face], vertices: &[Vertex], symmetries: &[Symmetry]) -> (f64, f64) {
    let (mut miss, mut turn) = (0.0_f64, 0.0_f64);
    for symmetry in symmetries.iter().skip(1) {
        for (vertex, image) in vertices.iter().zip(&symmetry.vertices) {
            miss = miss.max(symmetry.motion.apply(vertex.point).distance(vertices[*image as usize].point));
        }
        for (face, image) in
            faces.iter().zip(&symmetry.faces).filter(|(face, _)| face.surface != Surface::Seam)
        {
            let image = &faces[*image as usize];
            turn = turn.max(symmetry.motion.rotation.rotate(face.normal).angle_to(image.normal).abs());
        }
    }
    (miss, turn)
}

/// By the share `k / order` of a turn, about `center`.
fn rotation(center: DVec2, k: usize, order: usize) -> Pose {
    if k == 0 {
        return Pose::IDENTITY;
    }
    let turn = Pose::new(TAU * k as f64 / order as f64, DVec2::ZERO);
    Pose { translation: center - turn.apply(center), ..turn }
}

fn numbers(map: &[usize]) -> Vec<u32> {
    map.iter().map(|&k| u32::try_from(k).expect("fewer than 2^32 features")).collect()
}

impl Marks {
    fn new(all: Vec<Mark>, tol: f64) -> Self {
        let mut by_x: Vec<usize> = (0..all.len()).collect();
        by_x.sort_by(|&a, &b| all[a].start.x.total_cmp(&all[b].start.x));
        Self { all, by_x, tol }
    }

    /// Mean of the faces' points: every symmetry keeps it.
    fn centroid(&self) -> DVec2 {
        // Relative to one of the points, so that a far origin costs no digits.
        let origin = self.all[0].start;
        let (mut sum, mut total) = (DVec2::ZERO, 0.0);
        for mark in &self.all {
            let length = mark.start.distance(mark.end);
            sum += length * 0.5 * ((mark.start - origin) + (mark.end - origin));
            total += length;
        }
        origin + sum / total
    }

    /// Where each of `motions`, the powers of the second, takes each mark; `None` if one of them is no symmetry.
    fn maps(&self, motions: &[Pose]) -> Option<Vec<Vec<usize>>> {
        let mut maps = vec![(0..self.all.len()).collect::<Vec<_>>()];
        let Some(&generator) = motions.get(1) else { return Some(maps) };
        let generator_map = self.generator_map(generator)?;
        for (k, &motion) in motions.iter().enumerate().skip(1) {
            let map: Vec<usize> = maps[k - 1].iter().map(|&image| generator_map[image]).collect();
            let holds = |(mark, &image): (&Mark, &usize)| self.agrees(mark, motion, &self.all[image]);
            if !self.all.iter().zip(&map).all(holds) {
                return None;
            }
            maps.push(map);
        }
        Some(maps)
    }

    /// The image of each mark; `None` if there is none or two have the same.
    fn generator_map(&self, generator: Pose) -> Option<Vec<usize>> {
        let mut taken = vec![false; self.all.len()];
        let mut map = Vec::with_capacity(self.all.len());
        for mark in &self.all {
            let image = self.nearest_image(mark, generator)?;
            if std::mem::replace(&mut taken[image], true) {
                return None;
            }
            map.push(image);
        }
        Some(map)
    }

    fn nearest_image(&self, mark: &Mark, motion: Pose) -> Option<usize> {
        let start = motion.apply(mark.start);
        let first = self.by_x.partition_point(|&k| self.all[k].start.x < start.x - self.tol);
        let near =
            self.by_x[first..].iter().copied().take_while(|&k| self.all[k].start.x <= start.x + self.tol);
        let distance_sq = |k: usize| self.all[k].start.distance_squared(start);
        near.filter(|&k| self.agrees(mark, motion, &self.all[k]))
            .min_by(|&a, &b| distance_sq(a).total_cmp(&distance_sq(b)))
    }

    fn agrees(&self, mark: &Mark, motion: Pose, image: &Mark) -> bool {
        mark.kind == image.kind
            && motion.apply(mark.start).distance(image.start) <= self.tol
            && motion.apply(mark.end).distance(image.end) <= self.tol
    }
}
