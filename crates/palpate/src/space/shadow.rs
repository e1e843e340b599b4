//! A hypothesis in space over all its poses, made ready for lines (`docs/theory.md`, T21).

use std::sync::Arc as Shared;

use glam::{DMat3, DVec3};

use super::cell::{Cell, Linearized, chord, most};
use super::linear::left_jacobian;
use super::model::{Edge, Model, Vertex};
use super::pose_set::PoseSet;
use super::rims::is_groove;
use super::site::angle;
use crate::feature::Feature;
use crate::line::Line;
use crate::part::Surface;
use crate::tree::Range;

/// A hypothesis over all its poses, made ready for lines.
#[derive(Debug)]
pub struct Shadow {
    pub(super) model: Shared<Model>,
    pub(super) cells: Vec<PlacedCell>,
    /// The world point at which the model point `y` of a pose is.
    pub(super) pivot: DVec3,
    /// Covers rounding.
    pub(super) outward: f64,
    /// What the model's symmetries miss, a length and an angle: one pose stands for all that they take it to.
    pub(super) asymmetry: (f64, f64),
    /// Faces that a contact is assigned to.
    pub(super) assigned: Vec<bool>,
    /// The edges of each face.
    pub(super) edges_of: Vec<Vec<u32>>,
    /// The cone of normals of each edge that sticks out: its two ends, and whether a tip may rest there.
    pub(super) edges: Vec<Option<Rim>>,
    /// The normals of each vertex that sticks out: around an axis, radians; and whether a tip may rest there.
    pub(super) vertices: Vec<Option<(DVec3, f64, bool)>>,
    /// A ball around every place of every vertex.
    pub(super) middle: DVec3,
    /// Its radius.
    pub(super) radius: f64,
}

/// Normals that a ball may meet an edge with: from one to the other the short way, or all across it where faces are loose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rim {
    pub normals: Option<[DVec3; 2]>,
    pub touchable: bool,
}

/// A cell of poses, made ready for lines.
#[derive(Debug)]
pub(super) struct PlacedCell {
    /// Turns world directions into the model's frame, at the middle of the cell.
    pub turn: DMat3,
    /// No rotation of the cell is further from that, radians.
    pub radius: f64,
    /// The model point at the pivot, at the middle.
    pub y: DVec3,
    v_half: DVec3,
    y_half: DVec3,
    looseness: f64,
    jacobian: DMat3,
    linearized: Option<Linearized>,
}

/// A line as a cell of poses sees it, in the model's frame: at the middle of the cell, and how far from there.
pub(super) struct Ray<'a> {
    pub cell: &'a PlacedCell,
    /// Where the line starts, and its direction.
    pub start: DVec3,
    pub direction: DVec3,
    /// The same start, from the pivot, in the world's frame turned by the middle of the cell.
    lever: DVec3,
    outward: f64,
    /// The cell's linear conditions, once they were asked.
    asked: Option<Linearized>,
    /// They were found to leave no pose.
    empty: bool,
}

impl Shadow {
    pub(super) fn new(poses: &PoseSet) -> Self {
        let model = Shared::clone(poses.model());
        let outward = poses.outward();
        let cells = poses.placed().into_iter().map(|(cell, linearized)| PlacedCell::new(&cell, linearized));
        let cells: Vec<PlacedCell> = cells.collect();
        let mut assigned = vec![false; model.faces.len()];
        for feature in poses.assigned_features() {
            if let Feature::Face(number) = feature {
                assigned[number as usize] = true;
            }
        }
        let mut edges_of = vec![Vec::new(); model.faces.len()];
        for (number, edge) in model.edges.iter().enumerate() {
            for face in edge.faces.into_iter().flatten() {
                edges_of[face as usize].push(number as u32);
            }
        }
        let pivot = poses.pivot();
        let (middle, radius) = ball(&model, pivot, outward, &cells);
        Self {
            edges: rims(&model),
            vertices: corners(&model),
            cells,
            pivot,
            outward,
            asymmetry: poses.asymmetry(),
            assigned,
            edges_of,
            middle,
            radius,
            model,
        }
    }

    pub(super) fn model(&self) -> &Model {
        &self.model
    }
}

/// A ball around all that the cells place.
fn ball(model: &Model, pivot: DVec3, outward: f64, cells: &[PlacedCell]) -> (DVec3, f64) {
    let points = || model.vertices.iter().map(|vertex| vertex.point);
    let low = points().fold(DVec3::INFINITY, DVec3::min);
    let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
    let center = 0.5 * (low + high);
    let reach = points().map(|point| point.distance(center)).fold(0.0, f64::max);
    let places: Vec<(DVec3, f64)> = cells
        .iter()
        .map(|cell| {
            let offset = center - cell.y;
            let moved = chord(cell.radius) * offset.length() + cell.y_half.length();
            (pivot + cell.turn.transpose() * offset, moved + reach + outward)
        })
        .collect();
    let low = places.iter().fold(DVec3::INFINITY, |low, (at, r)| low.min(*at - *r));
    let high = places.iter().fold(DVec3::NEG_INFINITY, |high, (at, r)| high.max(*at + *r));
    let middle = if places.is_empty() { pivot } else { 0.5 * (low + high) };
    (middle, places.iter().map(|(at, r)| at.distance(middle) + r).fold(0.0, f64::max))
}

fn rims(model: &Model) -> Vec<Option<Rim>> {
    let rim = |edge: &Edge| {
        let touchable = edge.normals.is_some();
        let beside = edge.faces.map(|face| face.map(|face| &model.faces[face as usize]));
        let normals = match beside {
            [Some(first), Some(second)]
                if model.closed && first.surface != Surface::Seam && second.surface != Surface::Seam =>
            {
                Some([first.normal, second.normal])
            }
            _ => edge.normals,
        };
        (!is_groove(model, edge)).then_some(Rim { normals, touchable })
    };
    model.edges.iter().map(rim).collect()
}

/// Of vertices that can't be touched all normals are said to be possible.
fn corners(model: &Model) -> Vec<Option<(DVec3, f64, bool)>> {
    let mut sticks_out = vec![!model.closed; model.vertices.len()];
    for (edge, rim) in model.edges.iter().zip(rims(model)) {
        for end in edge.ends {
            sticks_out[end as usize] |= rim.is_some();
        }
    }
    let corner = |(vertex, sticks_out): (&Vertex, bool)| {
        let around = |normals: &Vec<DVec3>| {
            let axis = normals.iter().sum::<DVec3>().try_normalize()?;
            Some((axis, normals.iter().map(|normal| angle(axis, *normal)).fold(0.0, f64::max)))
        };
        let Some(normals) = &vertex.normals else {
            return sticks_out.then_some((DVec3::Z, std::f64::consts::PI, false));
        };
        // Around normals that are wide apart no cap need be narrow.
        let (axis, spread) = around(normals)
            .filter(|(_, spread)| *spread < std::f64::consts::FRAC_PI_2)
            .unwrap_or((DVec3::Z, std::f64::consts::PI));
        Some((axis, spread, true))
    };
    model.vertices.iter().zip(sticks_out).map(corner).collect()
}

impl PlacedCell {
    fn new(cell: &Cell, linearized: Option<Linearized>) -> Self {
        Self {
            turn: cell.rotation(),
            radius: cell.radius(),
            y: cell.y,
            v_half: cell.v_half,
            y_half: cell.y_half,
            looseness: cell.looseness(),
            jacobian: left_jacobian(cell.v).transpose(),
            linearized,
        }
    }

    /// No pose of the cell moves a point at such a lever further from where its middle does.
    pub fn motion(&self, lever: f64) -> f64 {
        chord(self.radius) * lever + self.y_half.length()
    }
}

impl<'a> Ray<'a> {
    pub fn new(shadow: &Shadow, cell: &'a PlacedCell, line: &Line<DVec3>) -> Self {
        let lever = cell.turn * (line.start - shadow.pivot);
        let direction = cell.turn * line.direction;
        Self {
            cell,
            start: cell.y + lever,
            direction,
            lever,
            outward: shadow.outward,
            asked: None,
            empty: false,
        }
    }

    /// Where the line is at a depth, at the middle of the cell.
    pub fn at(&self, depth: f64) -> DVec3 {
        self.start + depth * self.direction
    }

    /// Whether the cell was found to hold no pose.
    pub fn is_empty(&self) -> bool {
        self.empty
    }

    /// How far the pivot is from the line's point at a depth.
    fn arm(&self, depth: f64) -> DVec3 {
        self.lever + depth * self.direction
    }

    /// No pose of the cell has the line's point at a depth further from where its middle has it.
    pub fn motion(&self, depth: f64) -> f64 {
        self.cell.motion(self.arm(depth).length()) + self.outward
    }

    /// No pose of the cell has the points of the line within `reach` of a model point further from where its middle has
    /// them. What is there is no further from `y` than the point, but for the reach and `y` itself.
    pub fn motion_near(&self, point: DVec3, reach: f64) -> f64 {
        let cell = self.cell;
        cell.motion(point.distance(cell.y) + reach + cell.y_half.length()) + self.outward
    }

    /// How far the poses of the cell move the line's point at a depth along a direction of the model's frame, from where its
    /// middle has it: by the box of the cell, or, `closely`, by its linear conditions.
    ///
    /// The point is `y + S c`; along n, `n·(y + S c)` is linear but for `½ (1 + |v|/6) |d|² |c|` (theory, T17).
    pub fn range(&mut self, direction: DVec3, depth: f64, closely: bool) -> Range {
        let cell = self.cell;
        let arm = self.arm(depth);
        let about = cell.jacobian * arm.cross(direction);
        let loose = cell.looseness * arm.length() * direction.length() + self.outward * direction.length();
        let half = about.abs().dot(cell.v_half) + direction.abs().dot(cell.y_half);
        let (mut low, mut high) = (-half, half);
        if closely && let Some(made) = &cell.linearized {
            let asked = self.asked.get_or_insert_with(|| made.clone());
            high = high.min(most(asked, about, direction));
            low = low.max(-most(asked, -about, -direction));
            self.empty |= low > high;
        }
        Range { low: low - loose, high: high + loose }
    }
}
