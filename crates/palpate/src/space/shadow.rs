//! A hypothesis over all its poses, made ready for lines.

use std::f64::consts::PI;
use std::sync::Arc as Shared;

use glam::DVec3;

use super::model::Model;
use super::pose_set::PoseSet;
use super::sphere::Cap;
use crate::Feature;
use crate::judge::{Fault, Outcome, Rules, Touch};
use crate::line::Line;
use crate::sensor::Sensor;
use crate::tree::Range;

/// A hypothesis over all its poses, made ready for lines.
#[derive(Debug)]
pub struct Shadow {
    model: Shared<Model>,
    /// The middle of a ball around every place of every vertex.
    pub middle: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Shadow {
    /// Of these poses.
    pub fn new(poses: &PoseSet) -> Self {
        let model = Shared::clone(poses.model());
        let points = || model.vertices.iter().map(|vertex| vertex.point);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        let center = low.midpoint(high);
        let reach = points().map(|point| point.distance(center)).fold(0.0, f64::max);
        let radius = reach + poses.excursion(center);
        let middle = poses.witness().apply(center);
        Self { model, middle, radius }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Nothing is claimed but that all is in the ball.
    pub fn outcome(
        &self,
        line: &Line<DVec3>,
        sensor: &Sensor,
        _rules: Rules,
        margin: f64,
        _angle_margin: f64,
        _length: f64,
    ) -> Outcome<DVec3> {
        let reach = self.radius + sensor.tip_radius + sensor.path_error + self.model.position_slack + margin;
        let along = line.depth_and_aside(self.middle).0;
        let depth = Range { low: along - reach, high: along + reach };
        let touch = Touch { feature: Feature::Face(0), depth, normals: Cap::around(DVec3::Z, PI) };
        Outcome { touches: vec![touch], may_miss: true, fault: Some(Fault::Start) }
    }
}
