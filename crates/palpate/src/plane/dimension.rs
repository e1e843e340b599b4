//! The plane as a dimension.

use std::sync::Arc as Shared;

use arrayvec::ArrayVec;
use glam::DVec2;

use super::arc::wrap;
use super::distance::segment_to_segment;
use super::free::{inside, solid};
use super::model::Face;
use super::planners;
use super::scene::{numbers, verifying_lines};
use super::{Arc, Case, Model, Pose, PoseSet, Shadow, explain};
use crate::best::Best;
use crate::contact::{Evidence, Prior};
use crate::dimension::Dimension;
use crate::line::{FirstContact, Line};
use crate::plan::{EllisCounters, PlanSettings, Planner};
use crate::planner::Grids;
use crate::recognize::{Explanations, Halt, Settings};
use crate::scene::{Proof, Scene};

impl Dimension for DVec2 {
    type Pose = Pose;
    type Prior = Prior;
    type Model = Model;
    type PoseSet = PoseSet;
    type Normals = Arc;
    type Shadow = Shadow;

    const NAME: &'static str = "the plane";
    const AXES: &'static [Self] = &[Self::X, Self::Y];
    const PLANNERS: &'static [&'static str] = &["auto", "complete", "ellis", "grimson", "schneiter"];
    const GRIDS: Grids = Grids {
        grimson_cells: [Planner::USUAL_GRID[0], 16384],
        grimson_directions: [Planner::USUAL_GRID[1], 7200],
        schneiter_cells: [256, 2048],
    };

    fn splat(value: f64) -> Self {
        Self::splat(value)
    }

    fn coordinates(&self) -> &[f64] {
        AsRef::<[f64; 2]>::as_ref(self)
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
        self.angle_to(other).abs()
    }

    fn angle(self) -> Option<f64> {
        Some(self.to_angle())
    }

    fn across(self) -> ArrayVec<Self, 2> {
        std::iter::once(self.perp()).collect()
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
        one.closed == other.closed && one.faces == other.faces
    }

    fn placed(world_from_model: Pose, point_model: Self) -> Self {
        world_from_model.apply(point_model)
    }

    fn first_contact(
        model: &Model,
        world_from_model: Pose,
        line: &Line,
        tip_radius: f64,
    ) -> Option<FirstContact> {
        model.first_contact(world_from_model, line, tip_radius)
    }

    fn explain(model: &Shared<Model>, evidence: &Evidence, settings: &Settings, stop: &Halt) -> Explanations {
        let tables = model.feature_tables(settings.faces, settings.vertices(evidence));
        let case = Case::new(model, evidence, settings.tolerance).until(stop, settings.effort);
        explain(case, tables)
    }

    fn turn_and_shift(line: &Line, other: &Line, middle: Self) -> (f64, f64) {
        let ((angle, aside), (other, place)) = (numbers(line, middle), numbers(other, middle));
        (wrap(angle - other).abs(), (aside - place).abs())
    }

    fn surrounds(model: &Model, world_from_model: Pose, [low, high]: [Self; 2], clear: f64) -> bool {
        let inverse = world_from_model.inverse();
        let corners = [low, Self::new(high.x, low.y), high, Self::new(low.x, high.y)];
        let corners = corners.map(|corner| inverse.apply(corner));
        let border = |k: usize| [corners[k], corners[(k + 1) % 4]];
        let clear_of = |face: &Face| {
            let distance = |k| segment_to_segment([face.start, face.end], border(k));
            (0..4).all(|k| distance(k) > clear)
        };
        inside(model, corners[0]) && solid(model).all(clear_of)
    }

    fn verifying_lines(scene: &Scene) -> Box<dyn Iterator<Item = Line> + '_> {
        Box::new(verifying_lines(scene))
    }

    fn propose(
        best: &mut Best<'_>,
        settings: &PlanSettings,
        late: &dyn Fn() -> bool,
    ) -> (Proof, Option<EllisCounters>) {
        planners::propose(best, settings, late)
    }
}
