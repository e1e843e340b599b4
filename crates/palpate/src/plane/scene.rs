//! Lines of the plane among the hypotheses of a scene, by their numbers.

use std::f64::consts::PI;

use glam::DVec2;

use super::arc::wrap;
use super::pose::Pose;
use crate::line::Line;
use crate::scene::{Scene, spread};

/// Poses of each hypothesis from which `complete` looks, at most.
const MANY_VIEWS: usize = 12;

/// Evenly spaced directions in which a hypothesis is verified; those straight at a face come on top.
const NUM_VERIFYING: usize = 72;

impl Scene {
    /// The views of a member, and poses at the extremes of its set.
    pub fn many_views(&self, member: usize) -> Vec<Pose> {
        let views = &self.views[member];
        let mut others = self.poses[member].extremes();
        others.extend(&views[1..]);
        spread::<DVec2>(views[0], &others, self.shadows[member].model().size, MANY_VIEWS)
    }

    /// Lines are numbered by the angle of their direction and by how far they pass to the left of the middle. Each begins
    /// on the border of the workspace, or clear of everything; `None` if it does not enter the workspace or comes from a
    /// direction that is not allowed.
    pub fn line(&self, angle: f64, aside: f64) -> Option<Line> {
        if !self.allowed(angle) {
            return None;
        }
        let direction = DVec2::from_angle(angle);
        self.begun(direction, self.middle + aside * direction.perp())
    }

    fn allowed(&self, angle: f64) -> bool {
        self.directions.is_none_or(|(axis, cone)| wrap(angle - axis.to_angle()).abs() <= cone)
    }

    /// The middles of intervals that hold all allowed directions, as many as would be `count` all around, and half their
    /// width.
    pub fn directions(&self, count: usize) -> (impl Iterator<Item = f64> + use<>, f64) {
        let (axis, cone) = self.directions.map_or((0.0, PI), |(axis, cone)| (axis.to_angle(), cone));
        let count = (count as f64 * cone / PI).ceil().max(1.0);
        let half = cone / count;
        let middle = move |k: f64| axis - cone + (2.0 * k + 1.0) * half;
        (
            std::iter::successors(Some(0.0), |k| Some(k + 1.0)).take_while(move |k| *k < count).map(middle),
            half,
        )
    }

    /// The numbers of a line: angle, and how far it passes to the left of the middle.
    pub fn numbers(&self, line: &Line) -> (f64, f64) {
        numbers(line, self.middle)
    }
}

/// The angle of a line, and how far it passes to the left of a point.
pub(super) fn numbers(line: &Line, middle: DVec2) -> (f64, f64) {
    (line.direction.to_angle(), line.left().dot(line.start - middle))
}

/// At the pose with the largest slack: in each direction one line between every two vertices that follow one another across.
pub(super) fn verifying_lines(scene: &Scene) -> impl Iterator<Item = Line> + '_ {
    let (model, pose) = (scene.shadows[0].model(), scene.views[0][0]);
    let straight = model.faces.iter().map(move |face| (pose.rotation.rotate(face.normal)).to_angle() + PI);
    straight.chain(scene.directions(NUM_VERIFYING).0).flat_map(move |angle| {
        let aside = DVec2::from_angle(angle).perp();
        let place = |at: DVec2| aside.dot(pose.apply(at) - scene.middle);
        let mut places: Vec<f64> = model.vertices.iter().map(|vertex| place(vertex.point)).collect();
        places.sort_by(f64::total_cmp);
        let between: Vec<f64> = places.windows(2).map(|two| 0.5 * (two[0] + two[1])).collect();
        between.into_iter().filter_map(move |aside| scene.line(angle, aside))
    })
}
