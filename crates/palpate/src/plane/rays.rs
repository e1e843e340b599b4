//! Lines, and what a tip on one meets first at one pose.

use glam::DVec2;

use super::model::{Model, Surface};
use super::pose::Pose;

/// A directed line: the tip's centre is at `start + t·direction`, `t >= 0`. World frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Where `t` is zero.
    pub start: DVec2,
    /// Unit direction of travel.
    pub direction: DVec2,
}

impl Line {
    /// The place at `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec2 {
        self.start + t * self.direction
    }

    /// To the left of the direction of travel.
    #[must_use]
    pub fn left(&self) -> DVec2 {
        self.direction.perp()
    }

    /// How far along and how far to the left of the line a point is.
    #[must_use]
    pub fn coordinates(&self, point: DVec2) -> (f64, f64) {
        let offset = point - self.start;
        (self.direction.dot(offset), self.left().dot(offset))
    }
}
/// A contact at one pose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contacted {
    pub depth: f64,
    pub normal: DVec2,
}

/// What the tip meets first at one pose, on its line, from a start that is clear.
pub(crate) fn first_contact(model: &Model, pose: Pose, line: &Line, radius: f64) -> Option<Contacted> {
    let inverse = pose.inverse();
    let line = Line { start: inverse.apply(line.start), direction: inverse.rotation.rotate(line.direction) };
    let mut first: Option<Contacted> = None;
    let mut take = |depth: f64, normal: DVec2| {
        if depth >= 0.0 && first.as_ref().is_none_or(|known| depth < known.depth) {
            first = Some(Contacted { depth, normal });
        }
    };
    for face in model.faces.iter().filter(|face| face.surface != Surface::Seam) {
        let sides = if model.closed { 1 } else { 2 };
        for normal in [face.normal, -face.normal].into_iter().take(sides) {
            let speed = normal.dot(line.direction);
            let [start, end] = [face.start, face.end].map(|at| at + radius * normal);
            let (a, b) = (line.coordinates(start).1, line.coordinates(end).1);
            if speed < 0.0 && a.min(b) <= 0.0 && a.max(b) >= 0.0 {
                take(normal.dot(start - line.start) / speed, normal);
            }
        }
    }
    if radius > 0.0 {
        for vertex in &model.vertices {
            let (along, aside) = line.coordinates(vertex.point);
            if aside.abs() <= radius {
                let depth = along - (radius * radius - aside * aside).sqrt();
                let normal = (line.at(depth) - vertex.point) / radius;
                take(depth, normal);
            }
        }
    }
    first.map(|found| Contacted { normal: pose.rotation.rotate(found.normal), ..found })
}
