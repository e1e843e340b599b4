//! Space as a dimension.

use std::sync::Arc as Shared;

use arrayvec::ArrayVec;
use glam::DVec3;

use super::planners;
use super::scene::verifying_lines;
use super::{Cap, Model, Pose, PoseSet, Prior, Shadow, explain};
use crate::best::Best;
use crate::contact::Evidence;
use crate::dimension::Dimension;
use crate::line::{FirstContact, Line};
use crate::plan::{EllisCounters, PlanSettings};
use crate::planner::Grids;
use crate::recognize::{Explanations, Halt, Settings};
use crate::scene::{Proof, Scene};

impl Dimension for DVec3 {
    type Pose = Pose;
    type Prior = Prior;
    type Model = Model;
    type PoseSet = PoseSet;
    type Normals = Cap;
    type Shadow = Shadow;

    const NAME: &'static str = "space";
    const AXES: &'static [Self] = &[Self::X, Self::Y, Self::Z];
    const PLANNERS: &'static [&'static str] =
        &["auto", "grimson", "schneiter", "decoupled", "linearized", "optimized"];
    const GRIDS: Grids =
        Grids { grimson_cells: [32, 512], grimson_directions: [96, 7200], schneiter_cells: [48, 128] };

    fn splat(value: f64) -> Self {
        Self::splat(value)
    }

    fn coordinates(&self) -> &[f64] {
        AsRef::<[f64; 3]>::as_ref(self)
    }

    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }

    fn min(self, other: Self) -> Self {
        Self::min(self, other)
    }

    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }

    fn largest_coordinate(self) -> f64 {
        self.abs().max_element()
    }

    fn try_normalize(self) -> Option<Self> {
        Self::try_normalize(self)
    }

    fn dot(self, other: Self) -> f64 {
        Self::dot(self, other)
    }

    fn length(self) -> f64 {
        Self::length(self)
    }

    fn angle_between(self, other: Self) -> f64 {
        self.cross(other).length().atan2(self.dot(other))
    }

    fn angle(self) -> Option<f64> {
        None
    }

    fn across(self) -> ArrayVec<Self, 2> {
        let (one, other) = self.any_orthonormal_pair();
        ArrayVec::from([one, other])
    }

    fn name(model: &Model) -> &str {
        &model.name
    }

    fn size(model: &Model) -> f64 {
        model.size
    }

    fn position_slack(model: &Model) -> f64 {
        model.position_slack
    }

    fn normal_slack(model: &Model) -> f64 {
        model.normal_slack
    }

    fn same_part(one: &Model, other: &Model) -> bool {
        one.closed == other.closed && one.faces == other.faces && one.vertices == other.vertices
    }

    fn placed(world_from_model: Pose, point_model: Self) -> Self {
        world_from_model.apply(point_model)
    }

    fn first_contact(
        model: &Model,
        world_from_model: Pose,
        line: &Line<Self>,
        tip_radius: f64,
    ) -> Option<FirstContact<Self>> {
        model.first_contact(world_from_model, line, tip_radius)
    }

    fn explain(
        model: &Shared<Model>,
        evidence: &Evidence<Self>,
        settings: &Settings,
        stop: &Halt,
    ) -> Explanations<Self> {
        explain(model, evidence, settings, stop)
    }

    /// The shift is that of the line's place nearest to the middle.
    fn turn_and_shift(line: &Line<Self>, other: &Line<Self>, middle: Self) -> (f64, f64) {
        let foot = |line: &Line<Self>| line.at(line.direction.dot(middle - line.start));
        (Dimension::angle_between(line.direction, other.direction), foot(line).distance(foot(other)))
    }

    /// Said only if all of a ball around the corners is inside.
    fn surrounds(model: &Model, world_from_model: Pose, [low, high]: [Self; 2], clear: f64) -> bool {
        let middle_model = world_from_model.inverse().apply(low.midpoint(high));
        model.signed_distance(middle_model) < -(0.5 * low.distance(high) + clear)
    }

    fn verifying_lines(scene: &Scene<Self>) -> Box<dyn Iterator<Item = Line<Self>> + '_> {
        Box::new(verifying_lines(scene))
    }

    fn propose(
        best: &mut Best<'_, Self>,
        settings: &PlanSettings<Self>,
        late: &dyn Fn() -> bool,
    ) -> (Proof, Option<EllisCounters>) {
        planners::propose(best, settings, late);
        (Proof::NONE, None)
    }
}
