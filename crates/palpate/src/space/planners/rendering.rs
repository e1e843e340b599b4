//! Orthographic renderings of placed parts: what lines of one direction meet first, on a grid (thesis 5.4.2).
//!
//! They propose lines and decide nothing: places between grid points, edges and vertices that a ball meets, and all poses but
//! the rendered one are left to the judge.

use glam::{DVec3, dvec2};

use crate::space::{Model, Pose};

/// A grid of lines of one direction.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    /// Unit, world frame.
    pub direction: DVec3,
    /// Unit, across it, at a right angle to each other.
    pub right: DVec3,
    pub up: DVec3,
    /// The middle of the grid.
    middle: DVec3,
    /// Lines along each side, and how far apart they are.
    pub count: usize,
    pub step: f64,
}

/// What the lines of a grid meet first of one placed part.
#[derive(Debug, Clone)]
pub(super) struct Rendering {
    /// How far along the direction from the plane through the middle; infinite: nothing.
    pub depth: Vec<f64>,
    /// Face numbers.
    pub face: Vec<u32>,
}

impl Grid {
    /// All around a ball.
    pub fn new(direction: DVec3, middle: DVec3, radius: f64, count: usize) -> Self {
        let (right, up) = direction.any_orthonormal_pair();
        Self { direction, right, up, middle, count, step: 2.0 * radius / count as f64 }
    }

    /// A point of the line with a number, in the plane through the middle.
    pub fn point(&self, number: usize) -> DVec3 {
        let at = |k: usize| self.step * (k as f64 + 0.5 - 0.5 * self.count as f64);
        self.middle + at(number % self.count) * self.right + at(number / self.count) * self.up
    }

    /// Renders the faces that look toward the lines, moved out by the radius of the tip.
    pub fn render(&self, model: &Model, pose: Pose, tip_radius: f64) -> Rendering {
        let all = self.count * self.count;
        let mut rendering = Rendering { depth: vec![f64::INFINITY; all], face: vec![u32::MAX; all] };
        let places: Vec<DVec3> =
            model.vertices.iter().map(|vertex| pose.apply(vertex.point) - self.middle).collect();
        let turned: Vec<DVec3> = model.faces.iter().map(|face| pose.rotation * face.normal).collect();
        for (corners, face) in &model.triangles {
            let normal = turned[*face as usize];
            let toward = -normal.dot(self.direction);
            let normal = if toward > 0.0 || model.closed { normal } else { -normal };
            if toward.abs() > 1e-6 && (toward > 0.0 || !model.closed) {
                let corners = corners.map(|k| places[k as usize] + tip_radius * normal);
                self.fill(&mut rendering, corners, normal, *face);
            }
        }
        rendering
    }

    fn fill(&self, rendering: &mut Rendering, corners: [DVec3; 3], normal: DVec3, face: u32) {
        let half = 0.5 * self.count as f64;
        let seen = corners
            .map(|corner| dvec2(corner.dot(self.right), corner.dot(self.up)) / self.step + (half - 0.5));
        let [a, b, c] = seen;
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let last = self.count as f64 - 1.0;
        let speed = normal.dot(self.direction);
        let offset = normal.dot(corners[0]);
        let rows = (low.y.ceil().max(0.0), high.y.floor().min(last));
        let columns = (low.x.ceil().max(0.0), high.x.floor().min(last));
        let mut y = rows.0;
        while y <= rows.1 {
            let mut x = columns.0;
            while x <= columns.1 {
                let at = dvec2(x, y);
                let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| {
                    let side = (*q - *p).perp_dot(at - *p);
                    if area > 0.0 { side >= 0.0 } else { side <= 0.0 }
                });
                if inside {
                    let place = (at - (half - 0.5)) * self.step;
                    let depth = (offset - normal.dot(place.x * self.right + place.y * self.up)) / speed;
                    let number = y as usize * self.count + x as usize;
                    if depth < rendering.depth[number] {
                        rendering.depth[number] = depth;
                        rendering.face[number] = face;
                    }
                }
                x += 1.0;
            }
            y += 1.0;
        }
    }
}

/// How many steps each marked place of a square grid is from the nearest that is not marked, or from beyond its rim; in
/// steps along rows, columns and diagonals.
pub(super) fn clearances(marked: &[bool], count: usize) -> Vec<u16> {
    let mut steps: Vec<u16> = marked.iter().map(|marked| if *marked { u16::MAX - 1 } else { 0 }).collect();
    let at = |x: isize, y: isize| -> Option<usize> {
        let inside = (0..count as isize).contains(&x) && (0..count as isize).contains(&y);
        inside.then(|| y as usize * count + x as usize)
    };
    let mut sweep = |backward: bool| {
        for k in 0..count * count {
            let k = if backward { count * count - 1 - k } else { k };
            if steps[k] == 0 {
                continue;
            }
            let (x, y) = ((k % count) as isize, (k / count) as isize);
            let by = if backward { 1 } else { -1 };
            let beside = [(by, 0), (0, by), (-1, by), (1, by)];
            let least = beside.iter().map(|(dx, dy)| at(x + dx, y + dy).map_or(0, |j| steps[j]));
            let least = least.min().unwrap_or(0);
            steps[k] = steps[k].min(least + 1);
        }
    };
    sweep(false);
    sweep(true);
    steps
}
