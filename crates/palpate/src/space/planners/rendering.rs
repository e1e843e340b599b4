//! Renderings of placed parts, on a grid: what lines of one direction meet first, or lines through one point (thesis 5.4.2).
//!
//! They propose lines and decide nothing: places between grid points, edges and vertices that a ball meets, and all poses but
//! the rendered one are left to the judge.

use glam::{DVec2, DVec3, dvec2};

use crate::Feature;
use crate::line::Line;
use crate::scene::Scene;
use crate::space::{Face, Model, Pose};

/// A grid of lines of one direction, or of lines through a focal point.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    /// Unit, world frame; of lines through a focal point, that of the middle one.
    pub direction: DVec3,
    /// Unit, across it, at a right angle to each other.
    pub right: DVec3,
    pub up: DVec3,
    /// The middle of the grid.
    middle: DVec3,
    /// Lines along each side, and how far apart they are.
    pub count: usize,
    pub step: f64,
    /// How far the focal point is before the middle; `None`: lines of one direction, an orthographic rendering.
    focus: Option<f64>,
}

/// What the lines of a grid meet first of one placed part.
#[derive(Debug, Clone)]
pub(super) struct Rendering {
    /// How far along its line; infinite: nothing.
    pub depth: Vec<f64>,
    /// Face numbers.
    pub face: Vec<u32>,
}

impl Grid {
    /// All around a ball.
    pub fn new(direction: DVec3, middle: DVec3, radius: f64, count: usize) -> Self {
        let (right, up) = direction.any_orthonormal_pair();
        Self { direction, right, up, middle, count, step: 2.0 * radius / count as f64, focus: None }
    }

    /// All around a ball, seen from a focal point so far before its middle; it is outside.
    pub fn perspective(direction: DVec3, middle: DVec3, radius: f64, count: usize, focus: f64) -> Self {
        // A cone around the ball is wider at its middle than the ball.
        let seen = radius * focus / (focus * focus - radius * radius).sqrt();
        Self { focus: Some(focus), ..Self::new(direction, middle, seen, count) }
    }

    /// The line with a number: from the focal point, or from the plane through the middle.
    pub fn line(&self, number: usize) -> Line<DVec3> {
        let place = self.point(number);
        match self.focus {
            None => Line { start: place, direction: self.direction },
            Some(focus) => {
                let start = self.middle - focus * self.direction;
                Line { start, direction: (place - start).normalize() }
            }
        }
    }

    /// Along the line through a place, seen from the middle.
    fn toward(&self, place: DVec3) -> DVec3 {
        self.focus.map_or(self.direction, |focus| (place + focus * self.direction).normalize_or_zero())
    }

    /// Where the line through a place, seen from the middle, is among rows and columns; not finite: behind the focal point.
    fn project(&self, place: DVec3) -> DVec2 {
        let scale = self.focus.map_or(1.0, |focus| {
            let before = focus + place.dot(self.direction);
            if before > 0.0 { focus / before } else { f64::NAN }
        });
        let seen = scale * dvec2(place.dot(self.right), place.dot(self.up));
        seen / self.step + (0.5 * self.count as f64 - 0.5)
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
            let toward = -normal.dot(self.toward(places[corners[0] as usize]));
            let normal = if toward > 0.0 || model.closed { normal } else { -normal };
            if toward.abs() > 1e-6 && (toward > 0.0 || !model.closed) {
                let corners = corners.map(|k| places[k as usize] + tip_radius * normal);
                self.fill(&mut rendering, corners, normal, *face);
            }
        }
        rendering
    }

    fn fill(&self, rendering: &mut Rendering, corners: [DVec3; 3], normal: DVec3, face: u32) {
        let [a, b, c] = corners.map(|corner| self.project(corner));
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let last = self.count as f64 - 1.0;
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
                    let number = row * self.count + column;
                    let line = self.line(number);
                    let from = line.start - self.middle;
                    let depth = normal.dot(corners[0] - from) / normal.dot(line.direction);
                    if depth < rendering.depth[number] {
                        rendering.depth[number] = depth;
                        rendering.face[number] = face;
                    }
                }
            }
        }
    }
}

/// The normals of a member's faces as a pose has them; `None`: must not be touched.
pub(super) fn usable_normals(scene: &Scene<DVec3>, member: usize, pose: Pose) -> Vec<Option<DVec3>> {
    let faces = scene.shadows[member].model().faces.iter().enumerate();
    let normal = |(number, face): (usize, &Face)| {
        let usable = face.is_touchable() && scene.unwanted(member, Feature::Face(number as u32)).is_none();
        usable.then(|| pose.rotation * face.normal)
    };
    faces.map(normal).collect()
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
    use crate::Feature;
    use crate::line::Line;
    use crate::space::shapes::{Cells, Random, mesh};

    /// What is rendered is what rays meet, of one direction and through one point.
    #[test]
    fn a_rendering_is_what_rays_meet() {
        let mut random = Random(3);
        let mut met = [0, 0];
        for round in 0..40 {
            let model = mesh(&Cells::random(&mut random, 4, 0.5).shape());
            let pose = random.pose();
            let middle = pose.apply(dvec3(0.0, 5.0, 10.0));
            let direction = random.direction();
            let grid = match round % 2 {
                0 => Grid::new(direction, middle, 60.0, 24),
                _ => Grid::perspective(direction, middle, 60.0, 24, 200.0),
            };
            let rendering = grid.render(&model, pose, 0.0);
            for number in 0..24 * 24 {
                let line = grid.line(number);
                let line = Line { start: line.at(-300.0), ..line };
                let found = model.first_contact(pose, &line, 0.0);
                let depth = found.map_or(f64::INFINITY, |found| found.depth - 300.0);
                assert!(
                    depth == rendering.depth[number] || (depth - rendering.depth[number]).abs() < 1e-9,
                    "{depth} {} {}",
                    rendering.depth[number],
                    model.closed
                );
                if let Some(found) = found {
                    assert_eq!(found.feature, Feature::Face(rendering.face[number]));
                    met[round % 2] += 1;
                }
            }
        }
        assert!(met[0] > 1_000 && met[1] > 1_000, "{met:?}");
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
