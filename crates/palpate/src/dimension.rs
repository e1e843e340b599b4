//! What recognition and planning ask of the plane and of space.

use std::fmt::{Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc as Shared;

use arrayvec::ArrayVec;

use crate::best::Best;
use crate::contact::Evidence;
use crate::feature::Feature;
use crate::hypothesis::Count;
use crate::judge::Normals;
use crate::line::{FirstContact, Line};
use crate::plan::{EllisCounters, PlanSettings};
use crate::planner::Grids;
use crate::recognize::{Explanations, Halt, Settings};
use crate::scene::{Proof, Scene, Shadow};

/// The plane or space, named by its vectors.
pub trait Dimension:
    Copy
    + Debug
    + Display
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + 'static
{
    /// Rigid motions.
    type Pose: Copy + Debug + PartialEq + Send + Sync;
    /// What may be known of a pose beforehand.
    type Prior: Copy + Debug + PartialEq + Send + Sync;
    /// Parts.
    type Model: Debug + Clone + Send + Sync;
    /// All poses of an answer.
    type PoseSet: Poses<Self>;
    /// What a path may find of a surface's normal.
    type Normals: Normals<Self>;
    /// A hypothesis over all its poses, made ready for lines.
    type Shadow: Shadow<Self>;

    /// As one speaks of it.
    const NAME: &'static str;
    /// Unit vectors, one for each coordinate.
    const AXES: &'static [Self];
    /// Names of the planners that there are.
    const PLANNERS: &'static [&'static str];
    /// Grids of those that have one.
    const GRIDS: Grids;

    /// Every coordinate the same.
    fn splat(value: f64) -> Self;
    /// Its coordinates.
    fn coordinates(&self) -> &[f64];
    /// Whether every coordinate is finite.
    fn is_finite(self) -> bool;
    /// The lesser of each coordinate.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The greater of each coordinate.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The largest of its coordinates, without their signs.
    fn largest_coordinate(self) -> f64;
    /// Along it, of length 1; `None` if it is zero or not finite.
    fn try_normalize(self) -> Option<Self>;
    /// The inner product.
    fn dot(self, other: Self) -> f64;
    /// Its length.
    fn length(self) -> f64;
    /// The angle between the two, radians, `[0, π]`.
    fn angle_between(self, other: Self) -> f64;
    /// The angle of a direction of the plane, radians; a direction of space has none.
    fn angle(self) -> Option<f64>;
    /// Unit vectors across a unit vector: the one to its left in the plane, two at a right angle in space.
    fn across(self) -> ArrayVec<Self, 2>;

    /// A part's name.
    fn name(model: &Self::Model) -> &str;
    /// The size of a model: the largest distance between two of its vertices.
    fn size(model: &Self::Model) -> f64;
    /// How far the true surface of a model may be from its faces.
    fn position_slack(model: &Self::Model) -> f64;
    /// How far the true normals of a model may be from its faces', radians.
    fn normal_slack(model: &Self::Model) -> f64;
    /// Whether two are one part, named differently or not.
    fn same_part(one: &Self::Model, other: &Self::Model) -> bool;
    /// Where a pose puts a point of its model.
    fn placed(world_from_model: Self::Pose, point_model: Self) -> Self;
    /// What a tip of this radius meets first on its line, if the model is at this pose.
    fn first_contact(
        model: &Self::Model,
        world_from_model: Self::Pose,
        line: &Line<Self>,
        tip_radius: f64,
    ) -> Option<FirstContact<Self>>;

    /// Every hypothesis of one model.
    fn explain(
        model: &Shared<Self::Model>,
        evidence: &Evidence<Self>,
        settings: &Settings,
        stop: &Halt,
    ) -> Explanations<Self>;

    /// By which angle a line is turned from another, and by which length it is shifted, seen from `middle`.
    fn turn_and_shift(line: &Line<Self>, other: &Line<Self>, middle: Self) -> (f64, f64);
    /// Whether all of the border of the area between two corners is surely inside of a part, so far from its surface.
    fn surrounds(model: &Self::Model, world_from_model: Self::Pose, corners: [Self; 2], clear: f64) -> bool;
    /// Lines of which some may touch the first hypothesis wherever it is.
    fn verifying_lines(scene: &Scene<Self>) -> Box<dyn Iterator<Item = Line<Self>> + '_>;
    /// Offers lines to `best`, as the planner of the settings chooses them, and says what it has proved.
    fn propose(
        best: &mut Best<'_, Self>,
        settings: &PlanSettings<Self>,
        late: &dyn Fn() -> bool,
    ) -> (Proof, Option<EllisCounters>);
}

/// What a hypothesis asks of its poses, and a planner.
pub trait Poses<V: Dimension>: Debug + Clone + Send + Sync {
    /// Whether every witness needs the tolerance τ.
    fn marginal(&self) -> bool;
    /// Whether a pose is known that explains every contact: not if the search met its limit before it was decided.
    fn proved(&self) -> bool;
    /// The proof that it is not empty.
    fn witness(&self) -> V::Pose;
    /// So many poses, spread over it; the same for the same seed.
    fn sample(&self, count: usize, seed: u64) -> Vec<V::Pose>;
    /// The pose at which the worst reading uses the smallest share of its bounds.
    fn largest_slack(&self) -> V::Pose;
    /// How many assignments it has.
    fn assignment_count(&self) -> Count;
    /// Its assignments, found as they are asked for.
    fn assignments(&self) -> Box<dyn Iterator<Item = Vec<Feature>> + Send>;
    /// Every feature that a contact may be assigned to; some may be named more than once.
    fn assigned_features(&self) -> Vec<Feature>;
    /// The poses of one of its assignments.
    #[must_use]
    fn of_assignment(&self, assignment: &[Feature]) -> Self;
}
