//! Lines, and what a tip on one meets first at one pose.

use arrayvec::ArrayVec;
use glam::DVec2;

use super::distance::to_segment;
use super::free::{inside, solid};
use super::model::{Face, Model, Surface};
use super::pose::Pose;
use crate::Feature;

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

/// What a tip on a line meets first, the part being at one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstContact {
    /// Of the tip's centre, along the line from its start.
    pub depth: f64,
    /// Unit outward normal of what is touched, world frame.
    pub normal: DVec2,
    /// What is touched.
    pub feature: Feature,
    /// It is touched where a reading may come from it: neither an untouchable face nor the back of a loose one, nor a
    /// corner of these.
    pub touchable: bool,
}

impl Model {
    /// What a tip of this radius meets first on its line. `None`: nothing. The direction of the line is a unit vector, and
    /// the tip is to be clear of the part at its start.
    ///
    /// A point that meets a corner meets one of its faces.
    #[must_use]
    pub fn first_contact(
        &self,
        world_from_model: Pose,
        line: &Line,
        tip_radius: f64,
    ) -> Option<FirstContact> {
        let model_from_world = world_from_model.inverse();
        let line = Line {
            start: model_from_world.apply(line.start),
            direction: model_from_world.rotation.rotate(line.direction),
        };
        let of_faces = self.faces.iter().enumerate().flat_map(|(k, face)| {
            let met = self.first_on_face(face, &line, tip_radius);
            met.into_iter()
                .map(move |(depth, normal)| (depth, normal, Feature::Face(k as u32), normal == face.normal))
        });
        // A point meets no vertex by itself.
        let vertices = if tip_radius > 0.0 { self.vertices.as_slice() } else { &[] };
        let of_vertices = vertices.iter().enumerate().filter_map(|(k, vertex)| {
            let (depth, normal) = first_on_vertex(vertex.point, &line, tip_radius)?;
            Some((depth, normal, Feature::Vertex(k as u32), true))
        });
        let mut first: Option<(f64, DVec2, Feature, bool)> = None;
        for met in of_faces.chain(of_vertices).filter(|met| met.0 >= 0.0) {
            if first.is_none_or(|known| met.0 < known.0) {
                first = Some(met);
            }
        }
        first.map(|(depth, normal, feature, front)| FirstContact {
            depth,
            normal: world_from_model.rotation.rotate(normal),
            feature,
            touchable: front && self.can_be_touched(feature),
        })
    }

    /// The distance of a point from the part: negative inside, if it is closed.
    #[must_use]
    pub fn distance(&self, world_from_model: Pose, point_world: DVec2) -> f64 {
        let point = world_from_model.inverse().apply(point_world);
        let distances = solid(self).map(|face| to_segment(point, [face.start, face.end]));
        let distance = distances.fold(f64::INFINITY, f64::min);
        if inside(self, point) { -distance } else { distance }
    }

    /// Depth and normal; two where both sides of a loose face are met, which is at its ends.
    fn first_on_face(&self, face: &Face, line: &Line, radius: f64) -> ArrayVec<(f64, DVec2), 2> {
        let mut met = ArrayVec::new();
        if face.surface == Surface::Seam {
            return met;
        }
        let sides = if self.closed { 1 } else { 2 };
        for normal in [face.normal, -face.normal].into_iter().take(sides) {
            let speed = normal.dot(line.direction);
            if speed >= 0.0 {
                continue;
            }
            let [start, end] = [face.start, face.end].map(|at| at + radius * normal);
            let (a, b) = (line.coordinates(start).1, line.coordinates(end).1);
            if a.min(b) <= 0.0 && a.max(b) >= 0.0 {
                met.push((normal.dot(start - line.start) / speed, normal));
            }
        }
        met
    }

    fn can_be_touched(&self, feature: Feature) -> bool {
        match feature {
            Feature::Face(number) => self.faces[number as usize].surface == Surface::Touchable,
            Feature::Vertex(number) => self.vertices[number as usize].normals.is_some(),
        }
    }
}

/// Depth and normal of a round tip at a corner.
fn first_on_vertex(point: DVec2, line: &Line, radius: f64) -> Option<(f64, DVec2)> {
    let (along, aside) = line.coordinates(point);
    (radius > 0.0 && aside.abs() <= radius).then(|| {
        let depth = along - (radius * radius - aside * aside).sqrt();
        (depth, (line.at(depth) - point) / radius)
    })
}
