//! Lines, and what a tip on one meets first at one pose.

use glam::DVec3;

use super::model::Model;
use super::pose::Pose;
use crate::Feature;
use crate::line::{FirstContact, Line};

impl Model {
    /// What a point on its line meets first. `None`: nothing. The direction of the line is a unit vector, and the tip is to be
    /// clear of the part at its start.
    #[must_use]
    pub fn first_contact(
        &self,
        world_from_model: Pose,
        line: &Line<DVec3>,
        _tip_radius: f64,
    ) -> Option<FirstContact<DVec3>> {
        let model_from_world = world_from_model.inverse();
        let direction = model_from_world.rotation * line.direction;
        let hit = self.first_hit(model_from_world.apply(line.start), direction)?;
        let face = &self.faces[hit.face as usize];
        let front = face.normal.dot(direction) < 0.0;
        let normal = world_from_model.rotation * if front { face.normal } else { -face.normal };
        let touchable = front && face.is_touchable();
        Some(FirstContact { depth: hit.distance, normal, feature: Feature::Face(hit.face), touchable })
    }
}
