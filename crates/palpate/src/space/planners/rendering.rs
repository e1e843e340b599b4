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
        let between = |low: f64, high: f64| (low.ceil().max(0.0), high.floor().min(last));
        let (first_row, last_row) = between(low.y, high.y);
        let (first_column, last_column) = between(low.x, high.x);
        if first_row > last_row || first_column > last_column {
            return;
        }
        for row in index(first_row)..=index(last_row) {
            for column in index(first_column)..=index(last_column) {
                let at = dvec2(column as f64, row as f64);
                let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| {
                    let side = (*q - *p).perp_dot(at - *p);
                    if area > 0.0 { side >= 0.0 } else { side <= 0.0 }
                });
                if inside {
                    let place = (at - (half - 0.5)) * self.step;
                    let depth = (offset - normal.dot(place.x * self.right + place.y * self.up)) / speed;
                    let number = row * self.count + column;
                    if depth < rendering.depth[number] {
                        rendering.depth[number] = depth;
                        rendering.face[number] = face;
                    }
                }
            }
        }
    }
}

#[expect(clippy::cast_sign_loss, reason = "rows and columns of a grid are not negative")]
fn index(at: f64) -> usize {
    at as usize
}

/// How many steps each marked place of a square grid is from the nearest that is not marked, or from beyond its rim; in
/// steps along rows, columns and diagonals.
pub(super) fn clearances(marked: &[bool], count: usize) -> Vec<u16> {
    // With a rim of places that are not marked.
    let wide = count + 2;
    let mut steps = vec![0_u16; wide * wide];
    let place = |k: usize| (k / count + 1) * wide + k % count + 1;
    for (k, _) in marked.iter().enumerate().filter(|(_, marked)| **marked) {
        steps[place(k)] = u16::MAX - 1;
    }
    for k in 0..count * count {
        let at = place(k);
        let least = [at - 1, at - wide - 1, at - wide, at - wide + 1].map(|k| steps[k]).into_iter().min();
        steps[at] = steps[at].min(least.unwrap_or(0) + 1);
    }
    for k in (0..count * count).rev() {
        let at = place(k);
        let least = [at + 1, at + wide - 1, at + wide, at + wide + 1].map(|k| steps[k]).into_iter().min();
        steps[at] = steps[at].min(least.unwrap_or(0) + 1);
    }
    (0..count * count).map(|k| steps[place(k)]).collect()
}

#[cfg(test)]
mod tests {
    use glam::dvec3;

    use super::{Grid, clearances};
    use crate::line::Line;
    use crate::space::shapes::{Cells, Random, mesh};

    /// What is rendered is what rays meet.
    #[test]
    fn a_rendering_is_what_rays_meet() {
        let mut random = Random(3);
        let mut met = 0;
        for _ in 0..20 {
            let model = mesh(&Cells::random(&mut random, 4, 0.5).shape());
            let pose = random.pose();
            let middle = pose.apply(dvec3(0.0, 5.0, 10.0));
            let direction = random.direction();
            let grid = Grid::new(direction, middle, 60.0, 24);
            let rendering = grid.render(&model, pose, 0.0);
            for number in 0..24 * 24 {
                let line = Line { start: grid.point(number) - 300.0 * direction, direction };
                let found = model.first_contact(pose, &line, 0.0);
                let depth = found.map_or(f64::INFINITY, |found| found.depth - 300.0);
                assert!(
                    depth == rendering.depth[number] || (depth - rendering.depth[number]).abs() < 1e-9,
                    "{depth} {} {}",
                    rendering.depth[number],
                    model.closed
                );
                met += usize::from(found.is_some());
            }
        }
        assert!(met > 1_000);
    }

    /// Against the least of all distances.
    #[test]
    fn clearances_are_those_to_the_nearest() {
        let mut random = Random(4);
        let count = 12;
        let marked: Vec<bool> = (0..count * count).map(|_| random.next() < 0.9).collect();
        let found = clearances(&marked, count);
        let apart = |a: usize, b: usize| (a % count).abs_diff(b % count).max((a / count).abs_diff(b / count));
        for (at, found) in found.into_iter().enumerate() {
            let rim =
                (at % count).min(count - 1 - at % count).min(at / count).min(count - 1 - at / count) + 1;
            let least =
                (0..count * count).filter(|k| !marked[*k]).map(|k| apart(at, k)).fold(rim, usize::min);
            assert_eq!(usize::from(found), least);
        }
    }
}
