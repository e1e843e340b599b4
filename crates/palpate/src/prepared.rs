//! Hypotheses made ready for many lines of the caller's.

use glam::{DVec2, DVec3};

use crate::Error;
use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::line::Line;
use crate::path::{Path, judged};
use crate::plan::{PlanSettings, check};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// Hypotheses made ready for many lines.
#[derive(Debug)]
pub struct Prepared<V: Dimension = DVec2> {
    scene: Scene<V>,
    members: Vec<usize>,
}

impl<V: Dimension> Prepared<V> {
    /// For lines through all that the hypotheses may occupy.
    ///
    /// # Errors
    /// As [`crate::plan()`].
    pub fn new(
        hypotheses: &[Hypothesis<V>],
        sensor: &Sensor,
        settings: &PlanSettings<V>,
    ) -> Result<Self, Error> {
        check(hypotheses, sensor, settings)?;
        let scene = Scene::new(hypotheses, sensor, settings);
        let members = scene.everyone();
        Ok(Self { scene, members })
    }

    /// The radius of a circle around everything, or of a ball.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.scene.radius
    }

    /// The middle of that circle or ball.
    #[must_use]
    pub fn middle(&self) -> V {
        self.scene.middle
    }

    /// The score of a line; `None` if it can't be used.
    #[must_use]
    pub fn score(&self, line: &Line<V>) -> Option<f64> {
        self.scene.verdict(line, &self.members, 0.0).map(|verdict| verdict.score())
    }

    /// All that is to say of a line.
    #[must_use]
    pub fn judge(&self, line: &Line<V>) -> Path<V> {
        judged(&self.scene, &self.members, line, None)
    }
}

impl Prepared {
    /// The line of a direction that passes `aside` to the left of the middle of that circle; `None` if it is not allowed.
    #[must_use]
    pub fn line(&self, angle: f64, aside: f64) -> Option<Line> {
        self.scene.line(angle, aside)
    }

    /// No judgement of a line gives a score below this: what it leaves at one pose of each hypothesis. Quick.
    #[must_use]
    pub fn least_score(&self, line: &Line) -> f64 {
        let seen = |k: &usize| self.scene.contact(*k, self.scene.views[*k][0], line);
        let readings = self.members.iter().map(|k| seen(k).map(|at| (at.depth, at.normal.to_angle())));
        self.scene.num_alike(&readings.collect::<Vec<_>>()) as f64 / self.members.len() as f64
    }
}

impl Prepared<DVec3> {
    /// The line of a direction through a point; `None` if it is not allowed.
    #[must_use]
    pub fn along(&self, direction: DVec3, through: DVec3) -> Option<Line<DVec3>> {
        self.scene.line(direction, through)
    }

    /// No judgement of a line gives a score below this, if each hypothesis is proved: what it leaves at one pose of each; `None`
    /// if one of these makes it unusable. Quick.
    #[must_use]
    pub fn least_score(&self, line: &Line<DVec3>) -> Option<f64> {
        let left = self.scene.glance(line, &self.members, 1)?;
        Some(left as f64 / self.members.len() as f64)
    }
}
