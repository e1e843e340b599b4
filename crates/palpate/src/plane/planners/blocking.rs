//! The plane, discretized, with what Schneiter's planner derives from it (thesis 5.4.3): how many parts hold a cell, and
//! which blocking boundaries run through it.
//!
//! A face's extended region is where its sensed points may lie: the convex hull of the places of its ends at several poses
//! of the hypothesis, grown by the sensor's errors and half a cell. Where such regions of two hypotheses overlap and the
//! normals can't be told apart, a point could be assigned to either: the cell is blocking. Normals count because the
//! sensor reads them. Of a loose model there is no inside; its extended faces stand for it.

use crate::part::Surface;
use std::collections::BTreeMap;

use glam::DVec2;

use super::whole;
use crate::plane::arc::wrap;
use crate::plane::distance::to_segment;
use crate::plane::shadow::convex_hull;
use crate::scene::Scene;

/// A square of cells around all that the hypotheses may occupy.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub cells: usize,
    pub low: DVec2,
    pub step: f64,
}

/// A face with the region in which it must lie.
pub(super) struct Wall {
    member: usize,
    /// Where its ends are at the first view, moved out by the tip's radius.
    pub ends: [DVec2; 2],
    /// The same, not moved.
    outline: [DVec2; 2],
    pub normal: f64,
    /// How far its normal may be turned.
    half: f64,
    touchable: bool,
    region: Vec<DVec2>,
    reach: f64,
}

/// Two walls of different members that a point may be assigned to.
#[derive(Debug, Clone, Copy)]
struct Block {
    members: [usize; 2],
    walls: [u32; 2],
    normal: f64,
}

/// The plane with all that was derived.
pub(super) struct Plane {
    pub grid: Grid,
    pub walls: Vec<Wall>,
    /// Of each cell, the number of a set of walls whose regions cover it.
    cover: Vec<u32>,
    /// Sets of walls.
    sets: Vec<Vec<u32>>,
    /// Of each set, the blocking boundaries.
    blocks: Vec<Vec<Block>>,
    /// Some hypothesis may be there: the union.
    pub occupied: Vec<bool>,
    /// So many hypotheses are surely there.
    pub depth: Vec<u32>,
}

impl Grid {
    fn around(scene: &Scene, cells: usize) -> Self {
        // Room for the extended faces and an empty cell on every side.
        let grown = scene.radius + scene.sensor.tip_radius + reach(scene);
        let step = 2.0 * grown / (cells as f64 - 4.0);
        Self { cells, low: scene.middle - 0.5 * cells as f64 * step, step }
    }

    pub fn center(&self, cell: usize) -> DVec2 {
        let at = DVec2::new((cell % self.cells) as f64, (cell / self.cells) as f64);
        self.low + self.step * (at + 0.5)
    }

    /// The cell of a point; `None` outside.
    pub fn cell(&self, point: DVec2) -> Option<usize> {
        let at = (point - self.low) / self.step;
        let inside = |value: f64| value >= 0.0 && value < self.cells as f64;
        (inside(at.x) && inside(at.y)).then(|| whole(at.y) * self.cells + whole(at.x))
    }

    /// Columns or rows from `low` to `high`, as far as there are any.
    fn span(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let place = |value: f64| (value / self.step).clamp(0.0, self.cells as f64);
        whole(place(low))..whole(place(high).ceil())
    }
}

/// How far from its face a sensed point may be.
fn reach(scene: &Scene) -> f64 {
    scene.sensor.position_error + scene.sensor.path_error
}

impl Plane {
    /// `None`: time was up before it was laid out.
    pub fn new(scene: &Scene, members: &[usize], cells: usize, late: &dyn Fn() -> bool) -> Option<Self> {
        let grid = Grid::around(scene, cells);
        let walls: Vec<Wall> = members
            .iter()
            .enumerate()
            .flat_map(|(place, member)| walls(scene, place, *member, &grid))
            .collect();
        let mut covers: Vec<Vec<u32>> = vec![Vec::new(); cells * cells];
        for (number, wall) in walls.iter().enumerate() {
            if late() {
                return None;
            }
            wall.covered(&grid, &mut |cell| covers[cell].push(number as u32));
        }
        let mut plane = Self {
            grid,
            cover: Vec::with_capacity(covers.len()),
            sets: Vec::new(),
            blocks: Vec::new(),
            occupied: covers.iter().map(|cover| !cover.is_empty()).collect(),
            depth: vec![0; covers.len()],
            walls,
        };
        for (place, member) in members.iter().enumerate() {
            if late() {
                return None;
            }
            let closed = scene.shadows[*member].model().closed;
            plane.fill(place, closed, &covers);
        }
        plane.number(scene, covers, late).then_some(plane)
    }

    /// Numbers the sets of walls that cover cells, and derives the blocking boundaries of each; whether time was enough.
    fn number(&mut self, scene: &Scene, covers: Vec<Vec<u32>>, late: &dyn Fn() -> bool) -> bool {
        let mut numbers: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for cover in covers {
            let next = numbers.len() as u32;
            let number = *numbers.entry(cover.clone()).or_insert(next);
            if number == next {
                if late() {
                    return false;
                }
                self.blocks.push(blocks(scene, &self.walls, &cover));
                self.sets.push(cover);
            }
            self.cover.push(number);
        }
        true
    }

    /// Counts a member in the cells that it surely holds: inside its outline, outside of its extended faces.
    fn fill(&mut self, member: usize, closed: bool, covers: &[Vec<u32>]) {
        let grid = self.grid;
        let outline: Vec<[DVec2; 2]> =
            self.walls.iter().filter(|wall| wall.member == member).map(|wall| wall.outline).collect();
        for row in 0..grid.cells {
            let y = grid.center(row * grid.cells).y;
            let crosses = |[a, b]: &[DVec2; 2]| {
                ((a.y <= y) != (b.y <= y)).then(|| a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y))
            };
            let mut crossings: Vec<f64> = outline.iter().filter_map(crosses).collect();
            crossings.sort_by(f64::total_cmp);
            for column in 0..grid.cells {
                let cell = row * grid.cells + column;
                let x = grid.center(cell).x;
                let inside = closed && crossings.partition_point(|crossing| *crossing < x) % 2 == 1;
                let extended = covers[cell].iter().any(|wall| self.walls[*wall as usize].member == member);
                self.occupied[cell] |= inside;
                self.depth[cell] += u32::from(if closed { inside && !extended } else { extended });
            }
        }
    }

    /// The number of the set of walls that cover a cell.
    pub fn cover(&self, cell: usize) -> u32 {
        self.cover[cell]
    }

    /// The pairs of members whose blocking boundaries in a set block travel in a direction: their faces look toward it.
    pub fn blocking(&self, cover: u32, direction: DVec2) -> impl Iterator<Item = [usize; 2]> {
        let toward = move |block: &&Block| DVec2::from_angle(block.normal).dot(direction) < 0.0;
        self.blocks[cover as usize].iter().filter(toward).map(|block| block.members)
    }

    /// The members with a face in a set that looks toward travel in a direction.
    pub fn met(&self, cover: u32, direction: DVec2) -> impl Iterator<Item = usize> {
        let walls = self.sets[cover as usize].iter().map(|wall| &self.walls[*wall as usize]);
        let toward = move |wall: &&Wall| DVec2::from_angle(wall.normal).dot(direction) < 0.0;
        walls.filter(toward).map(|wall| wall.member)
    }

    /// Whether a blocking boundary of this wall runs through the point.
    pub fn blocked(&self, wall: usize, point: DVec2) -> bool {
        self.grid.cell(point).is_none_or(|cell| {
            self.blocks[self.cover[cell] as usize].iter().any(|block| block.walls.contains(&(wall as u32)))
        })
    }

    /// Cells of a region that have a neighbor outside of it, in order around the middle.
    pub fn boundary(&self, inside: impl Fn(usize) -> bool) -> Vec<usize> {
        let n = self.grid.cells;
        let on_edge = |cell: &usize| {
            let (column, row) = (cell % n, cell / n);
            let border = column == 0 || row == 0 || column == n - 1 || row == n - 1;
            inside(*cell)
                && (border || [cell - 1, cell + 1, cell - n, cell + n].iter().any(|at| !inside(*at)))
        };
        let mut cells: Vec<usize> = (0..n * n).filter(on_edge).collect();
        let sum: DVec2 = cells.iter().map(|cell| self.grid.center(*cell)).sum();
        let middle = sum / cells.len().max(1) as f64;
        let around = |cell: &usize| (self.grid.center(*cell) - middle).to_angle();
        cells.sort_by(|a, b| around(a).total_cmp(&around(b)).then(a.cmp(b)));
        cells
    }
}

fn walls<'a>(scene: &'a Scene, place: usize, member: usize, grid: &Grid) -> impl Iterator<Item = Wall> + 'a {
    let model = scene.shadows[member].model();
    let views = &scene.views[member];
    let first = views[0];
    let half = views.iter().map(|view| wrap(view.angle() - first.angle()).abs()).fold(0.0, f64::max);
    // Half a cell: a cell is covered if any point of it may be.
    let reach = reach(scene) + model.position_slack + 0.5 * grid.step;
    model.faces.iter().filter(|face| face.surface != Surface::Seam).map(move |face| {
        let moved = |end: DVec2| end + scene.sensor.tip_radius * face.normal;
        let ends = [face.start, face.end].map(moved);
        let placed = views.iter().flat_map(|view| ends.map(|end| view.apply(end)));
        Wall {
            member: place,
            ends: ends.map(|end| first.apply(end)),
            outline: [face.start, face.end].map(|end| first.apply(end)),
            normal: first.rotation.rotate(face.normal).to_angle(),
            half: half + model.normal_slack,
            touchable: face.is_touchable(),
            region: convex_hull(placed.collect()),
            reach,
        }
    })
}

impl Wall {
    /// Tells each cell of its extended region.
    fn covered(&self, grid: &Grid, take: &mut dyn FnMut(usize)) {
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = self.region.iter().fold(start, |(low, high), at| (low.min(*at), high.max(*at)));
        let (low, high) = (low - self.reach - grid.low, high + self.reach - grid.low);
        for row in grid.span(low.y, high.y) {
            for column in grid.span(low.x, high.x) {
                let cell = row * grid.cells + column;
                if distance(&self.region, grid.center(cell)) <= self.reach {
                    take(cell);
                }
            }
        }
    }
}

/// The pairs of walls among some that a point may be assigned to.
fn blocks(scene: &Scene, walls: &[Wall], cover: &[u32]) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (k, &a) in cover.iter().enumerate() {
        for &b in &cover[..k] {
            let [first, second] = [&walls[b as usize], &walls[a as usize]];
            let turned = wrap(first.normal - second.normal).abs() - first.half - second.half;
            let alike = scene.sensor.normal_error.is_none_or(|error| turned <= 2.0 * error);
            if alike && first.member != second.member && first.touchable && second.touchable {
                let members = [first.member, second.member];
                blocks.push(Block { members, walls: [b, a], normal: first.normal });
            }
        }
    }
    blocks
}

/// From a convex polygon, counter-clockwise, to a point; zero inside. It may be a segment or a point.
fn distance(polygon: &[DVec2], point: DVec2) -> f64 {
    let mut inside = polygon.len() > 2;
    let mut nearest = f64::INFINITY;
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        inside &= (b - a).perp_dot(point - a) >= 0.0;
        nearest = nearest.min(to_segment(point, [a, b]));
    }
    if inside { 0.0 } else { nearest }
}
