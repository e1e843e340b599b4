//! A hypothesis over all its poses, made ready for lines (`docs/theory.md`, T11).

use crate::part::Surface;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops;

use glam::DVec2;

use super::arc::{Arc, wrap};
use super::cell::Cell;
use super::model::{Face, Model, Vertex};
use super::pose_set::PoseSet;
use crate::feature::Feature;

/// Where a vertex is over a cell of poses: within `pad` of the convex hull of some points.
#[derive(Debug, Clone)]
pub(crate) struct Spot {
    pub hull: ops::Range<usize>,
    pub pad: f64,
}

/// A cell of poses, made ready for lines.
#[derive(Debug)]
pub(crate) struct PlacedCell {
    pub half: f64,
    /// Normals of the faces as the middle of the cell turns them, and their angles.
    pub normals: Vec<(DVec2, f64)>,
    /// The rotation in the middle of the cell, and what it does to a vector.
    pub mid: f64,
    turn: DVec2,
    /// The middle of the pivot points, and how far they are from it.
    pub y_mid: DVec2,
    pub spread: f64,
    /// The corners of the cell as `(s, y)`.
    pub corners: Vec<(f64, DVec2)>,
    /// `cos d` over the cell is within `rho` of `mu`.
    pub mu: f64,
    pub rho: f64,
    pub spots: Vec<Spot>,
}

/// A hypothesis over all its poses, made ready for lines.
#[derive(Debug)]
pub struct Shadow {
    pub(super) model: std::sync::Arc<Model>,
    pub(super) pivot: DVec2,
    pub(super) cells: Vec<PlacedCell>,
    pub(super) points: Vec<DVec2>,
    /// Vertices at which each face starts and ends.
    pub(super) ends: Vec<[usize; 2]>,
    /// Faces of each closed outline.
    pub(super) loops: Vec<ops::Range<usize>>,
    /// Vertices that are on the part: ends of faces, seams aside.
    pub(super) solid: Vec<bool>,
    /// Cones of the vertices that stick out.
    pub(super) cones: Vec<Option<Arc>>,
    pub(super) assigned: Vec<bool>,
    /// A circle around every place of every vertex.
    pub(super) middle: DVec2,
    pub(super) radius: f64,
}

impl Shadow {
    pub fn new(poses: &PoseSet) -> Self {
        let model = std::sync::Arc::clone(poses.model());
        let (pivot, outward) = (poses.pivot(), poses.outward());
        let mut points = Vec::new();
        let cells: Vec<PlacedCell> =
            poses.cells().map(|cell| PlacedCell::new(cell, &model, pivot, outward, &mut points)).collect();
        let ends: Vec<[usize; 2]> =
            model.faces.iter().map(|face| [face.start, face.end].map(|at| vertex_at(&model, at))).collect();
        let mut solid = vec![false; model.vertices.len()];
        for (face, ends) in model.faces.iter().zip(&ends) {
            if face.surface != Surface::Seam {
                for end in ends {
                    solid[*end] = true;
                }
            }
        }
        let loops = loops(&model);
        let cones = cones(&model);
        let mut assigned = vec![false; model.faces.len()];
        for feature in poses.assigned_features() {
            if let Feature::Face(number) = feature {
                assigned[number as usize] = true;
            }
        }
        let pad = cells.iter().flat_map(|cell| &cell.spots).map(|spot| spot.pad).fold(0.0, f64::max);
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = points.iter().fold(start, |(low, high), at| (low.min(*at), high.max(*at)));
        let middle = 0.5 * (low + high);
        let radius = points.iter().map(|at| at.distance(middle)).fold(0.0, f64::max) + pad;
        Self { model, pivot, cells, points, ends, loops, solid, cones, assigned, middle, radius }
    }

    pub fn model(&self) -> &Model {
        &self.model
    }
}

impl PlacedCell {
    fn new(cell: &Cell, model: &Model, pivot: DVec2, outward: f64, points: &mut Vec<DVec2>) -> Self {
        let rotations = cell.rotations();
        let half = wrap(rotations.middle() - cell.mid).abs() + rotations.half_width();
        let cosine = half.min(PI).cos();
        let (mu, rho) = (0.5 * (1.0 + cosine), 0.5 * (1.0 - cosine));
        let mut corners: Vec<(f64, DVec2)> = cell.corners().collect();
        if corners.is_empty() {
            let sine = half.min(FRAC_PI_2).sin();
            let (low, high) = (cell.y_low, cell.y_high);
            let ys = [low, DVec2::new(low.x, high.y), high, DVec2::new(high.x, low.y)];
            corners = ys.into_iter().flat_map(|y| [(-sine, y), (sine, y)]).collect();
        }
        let y_mid = middle_of(&corners);
        let spread = corners.iter().map(|(_, y)| y.distance(y_mid)).fold(0.0, f64::max);
        let turn = DVec2::from_angle(cell.mid);
        let normal = |face: &Face| (turn.rotate(face.normal), cell.mid + face.normal.to_angle());
        let normals = model.faces.iter().map(normal).collect();
        let (mid, spots) = (cell.mid, Vec::new());
        let mut placed = Self { half, normals, mid, turn, y_mid, spread, corners, mu, rho, spots };
        let sine = half.min(FRAC_PI_2).sin();
        for vertex in &model.vertices {
            let at = |(s, y): &(f64, DVec2)| {
                let model_offset = mu * (vertex.point - *y) + *s * (vertex.point - y_mid).perp();
                pivot + placed.turned(model_offset)
            };
            let hull = convex_hull(placed.corners.iter().map(at).collect());
            let first = points.len();
            points.extend(hull);
            let arm = vertex.point.distance(y_mid) + spread;
            placed.spots.push(Spot { hull: first..points.len(), pad: rho * arm + sine * spread + outward });
        }
        placed
    }

    /// A model direction as the middle of the cell turns it.
    pub fn turned(&self, direction: DVec2) -> DVec2 {
        self.turn.rotate(direction)
    }

    /// A world direction in the model's frame, at the middle of the cell.
    pub fn turned_back(&self, direction: DVec2) -> DVec2 {
        DVec2::new(self.turn.x, -self.turn.y).rotate(direction)
    }
}

/// The middle of a box around the pivot points of some corners.
fn middle_of(corners: &[(f64, DVec2)]) -> DVec2 {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = corners.iter().fold(start, |(low, high), (_, y)| (low.min(*y), high.max(*y)));
    0.5 * (low + high)
}

/// Corners of the convex hull (Andrew's chains). Rounding may keep a point too many, or leave one out by a rounding
/// error, which `outward` covers.
pub(crate) fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

fn vertex_at(model: &Model, point: DVec2) -> usize {
    let distance = |k: &usize| model.vertices[*k].point.distance_squared(point);
    (0..model.vertices.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// The faces of each outline of a closed model: they follow one another.
fn loops(model: &Model) -> Vec<ops::Range<usize>> {
    let mut loops = Vec::new();
    let mut first = 0;
    for (number, face) in model.faces.iter().enumerate() {
        if model.closed && face.end == model.faces[first].start {
            loops.push(first..number + 1);
            first = number + 1;
        }
    }
    loops
}

/// Of each vertex, the normals that a ball may meet it with: those of a corner that sticks out; all, where faces are loose.
fn cones(model: &Model) -> Vec<Option<Arc>> {
    let cone = |vertex: &Vertex| {
        let near = |at: fn(&Face) -> DVec2| model.faces.iter().find(move |face| at(face) == vertex.point);
        match (near(|face| face.end), near(|face| face.start)) {
            (Some(before), Some(after)) if model.closed => {
                let sticks_out = before.normal.perp_dot(after.normal) > 0.0;
                sticks_out.then(|| Vertex::cone(before, after))
            }
            _ => Some(vertex.normals.unwrap_or(Arc::FULL)),
        }
    };
    model.vertices.iter().map(cone).collect()
}
