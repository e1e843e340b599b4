//! Lines, and what a tip on one meets first at one pose.

use crate::part::Surface;
use glam::DVec2;

use super::model::{Face, Model};
use super::pose::Pose;
use crate::Feature;
use crate::line::{FirstContact, Line};

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
        let mut first: Option<(f64, DVec2, Feature, bool)> = None;
        let mut take = |depth: f64, normal: DVec2, feature: Feature, front: bool| {
            if depth >= 0.0 && first.is_none_or(|known| depth < known.0) {
                first = Some((depth, normal, feature, front));
            }
        };
        for (k, face) in self.faces.iter().enumerate().filter(|(_, face)| face.surface != Surface::Seam) {
            // Both sides of a loose face can be met.
            for (normal, front) in [(face.normal, true), (-face.normal, false)] {
                if (front || !self.closed)
                    && let Some(depth) = depth_on_face(face, normal, &line, tip_radius)
                {
                    take(depth, normal, Feature::Face(k as u32), front);
                }
            }
        }
        // A point meets no vertex by itself.
        let vertices = if tip_radius > 0.0 { self.vertices.as_slice() } else { &[] };
        for (k, vertex) in vertices.iter().enumerate() {
            if let Some((depth, normal)) = first_on_vertex(vertex.point, &line, tip_radius) {
                take(depth, normal, Feature::Vertex(k as u32), true);
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
        self.signed_distance(world_from_model.inverse().apply(point_world))
    }

    fn can_be_touched(&self, feature: Feature) -> bool {
        match feature {
            Feature::Face(number) => self.faces[number as usize].surface == Surface::Touchable,
            Feature::Vertex(number) => self.vertices[number as usize].normals.is_some(),
            Feature::Edge(_) => false,
        }
    }
}

/// How deep a round tip meets a face from the side of this normal.
fn depth_on_face(face: &Face, normal: DVec2, line: &Line, radius: f64) -> Option<f64> {
    let speed = normal.dot(line.direction);
    if speed >= 0.0 {
        return None;
    }
    let [start, end] = [face.start, face.end].map(|at| at + radius * normal);
    let (a, b) = (line.coordinates(start).1, line.coordinates(end).1);
    (a.min(b) <= 0.0 && a.max(b) >= 0.0).then(|| normal.dot(start - line.start) / speed)
}

/// Depth and normal of a round tip at a corner.
fn first_on_vertex(point: DVec2, line: &Line, radius: f64) -> Option<(f64, DVec2)> {
    let (along, aside) = line.coordinates(point);
    (aside.abs() <= radius).then(|| {
        let depth = along - (radius * radius - aside * aside).sqrt();
        (depth, (line.at(depth) - point) / radius)
    })
}
