//! Space, discretized, with what Schneiter's planner derives from it (thesis 5.4.3): how many parts hold a cell, and which
//! extended faces run through it.
//!
//! A face's extended region is where its sensed points may lie: around its convex pieces at the pose with the largest slack,
//! by the sensor's errors and as far as other views move it. Cells are only where to look: whether a point could be
//! assigned to the faces of two hypotheses is decided by the distance of their planes along the normal, so that a blocking
//! boundary is as thin as the errors make it, however wide the cells are. Sets of faces that cover cells are kept, not their
//! overlaps, whose number grows with the square of that of the hypotheses. Of a loose model there is no inside; its
//! extended faces stand for it.

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::Scene;
use crate::space::Pose;
use crate::space::site::angle;

/// Half of a cell's diagonal, in its sides.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_6;

/// A cube of cells around all that the hypotheses may occupy.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub cells: usize,
    pub low: DVec3,
    pub step: f64,
}

/// A face with the region in which it must lie.
pub(super) struct Wall {
    /// A place among the members.
    pub member: usize,
    /// Convex polygons, counter-clockwise from outside, at the first view, moved out by the tip's radius.
    pub pieces: Vec<Vec<DVec3>>,
    pub normal: DVec3,
    /// Its plane is `normal · x = offset`.
    pub offset: f64,
    /// How far its normal may be turned, and its points be sensed from it.
    half: f64,
    reach: f64,
    pub touchable: bool,
}

/// Space with all that was derived.
pub(super) struct Volume<'a> {
    scene: &'a Scene<DVec3>,
    pub grid: Grid,
    pub walls: Vec<Wall>,
    /// Of each cell, the walls whose regions run through it.
    pub covers: Vec<Vec<u32>>,
    /// Some hypothesis may be there: the union.
    pub occupied: Vec<bool>,
    /// So many hypotheses are surely there.
    pub depth: Vec<u32>,
}

impl Grid {
    fn around(scene: &Scene<DVec3>, cells: usize) -> Self {
        // Room for the extended faces and an empty cell on every side.
        let reach = scene.sensor.position_error + scene.sensor.path_error;
        let grown = scene.radius + scene.sensor.tip_radius + reach;
        let step = 2.0 * grown / (cells as f64 - 4.0);
        Self { cells, low: scene.middle - 0.5 * cells as f64 * step, step }
    }

    pub fn center(&self, cell: usize) -> DVec3 {
        let n = self.cells;
        let at = DVec3::new((cell % n) as f64, (cell / n % n) as f64, (cell / (n * n)) as f64);
        self.low + self.step * (at + 0.5)
    }

    /// The cell of a point; `None` outside.
    pub fn cell(&self, point: DVec3) -> Option<usize> {
        let at = (point - self.low) / self.step;
        let inside = at.min_element() >= 0.0 && at.max_element() < self.cells as f64;
        inside.then(|| (whole(at.z) * self.cells + whole(at.y)) * self.cells + whole(at.x))
    }

    /// Numbers of cells along an axis, from `low` to `high`.
    fn span(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let place = |value: f64| (value / self.step).clamp(0.0, self.cells as f64);
        whole(place(low))..whole(place(high).ceil())
    }

    /// The cells that share a side with one.
    fn neighbors(&self, cell: usize) -> impl Iterator<Item = usize> {
        let n = self.cells;
        [1, n, n * n].into_iter().flat_map(move |stride| {
            let at = cell / stride % n;
            [(at > 0).then(|| cell - stride), (at + 1 < n).then(|| cell + stride)].into_iter().flatten()
        })
    }
}

impl<'a> Volume<'a> {
    /// `None`: time was up before it was laid out.
    pub fn new(
        scene: &'a Scene<DVec3>,
        members: &[usize],
        cells: usize,
        late: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let grid = Grid::around(scene, cells);
        let all = cells * cells * cells;
        let mut volume = Self {
            scene,
            grid,
            walls: Vec::new(),
            covers: vec![Vec::new(); all],
            occupied: vec![false; all],
            depth: vec![0; all],
        };
        for (place, member) in members.iter().enumerate() {
            if late() {
                return None;
            }
            volume.add(place, *member);
        }
        Some(volume)
    }

    /// Adds the faces of a member, and counts it in the cells that it surely holds: inside, clear of its extended faces.
    fn add(&mut self, place: usize, member: usize) {
        let (scene, grid) = (self.scene, self.grid);
        let walls = walls(scene, place, member);
        let covered: Vec<Vec<usize>> = walls.par_iter().map(|wall| wall.covered(&grid)).collect();
        let mut extended = vec![false; self.covers.len()];
        for (wall, cells) in walls.into_iter().zip(covered) {
            for cell in cells {
                extended[cell] = true;
                self.covers[cell].push(self.walls.len() as u32);
            }
            self.walls.push(wall);
        }
        let model = scene.shadows[member].model();
        let world_from_model = scene.views[member][0];
        let holds =
            |cell: usize| model.signed_distance(world_from_model.inverse().apply(grid.center(cell))) < 0.0;
        for (cell, is_extended) in extended.iter().enumerate() {
            self.occupied[cell] |= is_extended;
            self.depth[cell] += u32::from(*is_extended && !model.closed);
        }
        if model.closed {
            // Extended faces part what is inside from what is outside: one cell speaks for all that are connected with it.
            let mut seen = extended;
            for first in 0..seen.len() {
                if std::mem::replace(&mut seen[first], true) {
                    continue;
                }
                let inside = holds(first);
                let mut open = vec![first];
                while let Some(cell) = open.pop() {
                    self.occupied[cell] |= inside;
                    self.depth[cell] += u32::from(inside);
                    for next in grid.neighbors(cell) {
                        if !std::mem::replace(&mut seen[next], true) {
                            open.push(next);
                        }
                    }
                }
            }
        }
    }

    /// Whether a point of one wall, with its normal, could be assigned to another of another member, as far as their planes
    /// say.
    pub fn confused(&self, one: &Wall, other: &Wall, point: DVec3) -> bool {
        let apart = (other.normal.dot(point) - other.offset).abs();
        one.member != other.member && other.touchable && apart <= one.reach + other.reach && {
            let turned = angle(one.normal, other.normal) - one.half - other.half;
            self.scene.sensor.normal_error.is_none_or(|error| turned <= 2.0 * error)
        }
    }

    /// Whether a blocking boundary of this wall runs through a point of it.
    pub fn blocked(&self, wall: usize, point: DVec3) -> bool {
        let wall = &self.walls[wall];
        self.grid.cell(point).is_none_or(|cell| {
            self.covers[cell].iter().any(|other| self.confused(wall, &self.walls[*other as usize], point))
        })
    }

    /// Cells of a region that have a neighbor outside of it.
    pub fn boundary(&self, inside: impl Fn(usize) -> bool) -> Vec<usize> {
        let on_edge = |cell: &usize| inside(*cell) && self.grid.neighbors(*cell).any(|next| !inside(next));
        (0..self.depth.len()).filter(on_edge).collect()
    }
}

fn walls(scene: &Scene<DVec3>, place: usize, member: usize) -> Vec<Wall> {
    let model = scene.shadows[member].model();
    let views = &scene.views[member];
    let first = views[0];
    let errors = scene.sensor.position_error + scene.sensor.path_error + model.position_slack;
    let tip = scene.sensor.tip_radius;
    let wall = |(number, face): (usize, &crate::space::Face)| {
        let corner = |pose: &Pose, k: &u32| pose.apply(model.vertices[*k as usize].point + tip * face.normal);
        let normal = first.rotation * face.normal;
        let corners = || face.pieces.iter().flatten();
        let moved = |view: &Pose| {
            corners().map(|k| (corner(view, k) - corner(&first, k)).dot(normal).abs()).fold(0.0, f64::max)
        };
        let turned = |view: &Pose| angle(view.rotation * face.normal, normal);
        let unwanted = scene.unwanted(member, crate::Feature::Face(number as u32)).is_some();
        Wall {
            member: place,
            pieces: face
                .pieces
                .iter()
                .map(|piece| piece.iter().map(|k| corner(&first, k)).collect())
                .collect(),
            normal,
            offset: corners().next().map_or(0.0, |k| normal.dot(corner(&first, k))),
            half: views.iter().map(turned).fold(0.0, f64::max) + model.normal_slack,
            reach: views.iter().map(moved).fold(0.0, f64::max) + errors,
            touchable: face.is_touchable() && !unwanted,
        }
    };
    model.faces.iter().enumerate().map(wall).collect()
}

impl Wall {
    /// The cells of its extended region.
    fn covered(&self, grid: &Grid) -> Vec<usize> {
        let grown = self.reach + HALF_DIAGONAL * grid.step;
        let mut cells = Vec::new();
        for piece in &self.pieces {
            let low = piece.iter().fold(DVec3::INFINITY, |low, at| low.min(*at)) - grown - grid.low;
            let high = piece.iter().fold(DVec3::NEG_INFINITY, |high, at| high.max(*at)) + grown - grid.low;
            for layer in grid.span(low.z, high.z) {
                for row in grid.span(low.y, high.y) {
                    for column in grid.span(low.x, high.x) {
                        let cell = (layer * grid.cells + row) * grid.cells + column;
                        if self.is_near(piece, grid.center(cell), grown) {
                            cells.push(cell);
                        }
                    }
                }
            }
        }
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// Whether a point is so near to a convex piece's plane and sides.
    fn is_near(&self, piece: &[DVec3], at: DVec3, grown: f64) -> bool {
        (self.normal.dot(at) - self.offset).abs() <= grown && self.least_inside(piece, at) >= -grown
    }

    /// How far inside of the nearest side of a convex piece.
    fn least_inside(&self, piece: &[DVec3], at: DVec3) -> f64 {
        let sides = piece.iter().zip(piece.iter().cycle().skip(1));
        let inside = |(a, b): (&DVec3, &DVec3)| {
            self.normal.cross(*b - *a).try_normalize().map_or(f64::INFINITY, |inward| inward.dot(at - *a))
        };
        sides.map(inside).fold(f64::INFINITY, f64::min)
    }

    /// Whether a point of its plane is on it.
    pub fn holds(&self, at: DVec3) -> bool {
        self.pieces.iter().any(|piece| self.least_inside(piece, at) >= 0.0)
    }
}

/// The largest whole number up to a value; zero if there is none.
#[expect(clippy::cast_sign_loss, reason = "below zero it saturates at zero, as is meant")]
pub(super) fn whole(value: f64) -> usize {
    value as usize
}

#[cfg(test)]
mod tests {
    use super::super::tests::{blocks, sensor};
    use super::*;
    use crate::PlanSettings;

    /// Cells clear of the faces are held by exactly those parts that hold their middles, and what a part holds is occupied.
    #[test]
    fn cells_are_held_by_what_goes_around_them() {
        let hypotheses = blocks();
        let scene = Scene::new(&hypotheses, &sensor(), &PlanSettings::default());
        let members = scene.everyone();
        let volume = Volume::new(&scene, &members, 24, &|| false).expect("time is not limited");
        let (mut num_held, mut num_empty) = (0, 0);
        for cell in 0..volume.depth.len() {
            let clearance = |member: &usize| {
                let model = scene.shadows[*member].model();
                model.signed_distance(scene.views[*member][0].inverse().apply(volume.grid.center(cell)))
            };
            let clearances: Vec<f64> = members.iter().map(clearance).collect();
            let inside = clearances.iter().filter(|one| **one < 0.0).count();
            assert!(volume.depth[cell] as usize <= inside);
            assert!(inside == 0 || volume.occupied[cell]);
            // Regions reach no farther than this from their faces, with room for the corners.
            let far = 4.0 * (HALF_DIAGONAL * volume.grid.step + 1.0);
            if clearances.iter().all(|one| one.abs() > far) {
                assert!(inside == 0 && !volume.occupied[cell]);
                num_empty += 1;
            }
            if volume.covers[cell].is_empty() {
                assert_eq!(volume.depth[cell] as usize, inside);
                assert_eq!(volume.occupied[cell], inside > 0);
                num_held += usize::from(inside > 0);
            }
        }
        assert!(num_held > 0 && num_empty > 100, "{num_held} {num_empty}");
    }

    /// Every place of a face, at every view, is in a cell that the face covers.
    #[test]
    fn faces_are_in_the_cells_that_they_cover() {
        let hypotheses = blocks();
        let scene = Scene::new(&hypotheses, &sensor(), &PlanSettings::default());
        let members = scene.everyone();
        let volume = Volume::new(&scene, &members, 32, &|| false).expect("time is not limited");
        let mut random = crate::space::shapes::Random(5);
        let mut number = 0;
        for member in members {
            let model = scene.shadows[member].model();
            for face in &model.faces {
                for view in &scene.views[member] {
                    let [a, b, c] = [0, 1, 2].map(|k| model.vertices[face.pieces[0][k] as usize].point);
                    for _ in 0..40 {
                        let (u, v) = (random.next(), random.next());
                        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                        let at = view.apply(a + u * (b - a) + v * (c - a));
                        let cell = volume.grid.cell(at).expect("all is in the grid");
                        assert!(volume.covers[cell].contains(&number));
                    }
                }
                number += 1;
            }
        }
        assert_eq!(number as usize, volume.walls.len());
    }
}
