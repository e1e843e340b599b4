//! What recognition asks of the plane and of space.

use std::fmt::{Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc as Shared;

use glam::{DVec2, DVec3};

use crate::contact::Evidence;
use crate::feature::Feature;
use crate::hypothesis::Count;
use crate::judge::Normals;
use crate::recognize::{Explanations, Halt, Settings};
use crate::{plane, space};

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

    /// Whether every coordinate is finite.
    fn is_finite(self) -> bool;
    /// Along it, of length 1; `None` if it is zero or not finite.
    fn try_normalize(self) -> Option<Self>;
    /// The inner product.
    fn dot(self, other: Self) -> f64;
    /// Its length.
    fn length(self) -> f64;
    /// The angle between the two, radians, `[0, π]`.
    fn angle_between(self, other: Self) -> f64;
    /// The largest of its coordinates, without their signs.
    fn largest_coordinate(self) -> f64;

    /// The size of a model: the largest distance between two of its vertices.
    fn size(model: &Self::Model) -> f64;
    /// How far the true normals of a model may be from its faces', radians.
    fn normal_slack(model: &Self::Model) -> f64;
    /// Every hypothesis of one model.
    fn explain(
        model: &Shared<Self::Model>,
        evidence: &Evidence<Self>,
        settings: &Settings,
        stop: &Halt,
    ) -> Explanations<Self>;
}

/// What a hypothesis asks of its poses.
pub trait Poses<V: Dimension>: Debug + Clone + Send + Sync {
    /// Whether every witness needs the tolerance τ.
    fn marginal(&self) -> bool;
    /// Whether a pose is known that explains every contact: not if the search met its limit before it was decided.
    fn proved(&self) -> bool;
    /// The pose at which the worst reading uses the smallest share of its bounds.
    fn largest_slack(&self) -> V::Pose;
    /// How many assignments it has.
    fn assignment_count(&self) -> Count;
    /// Its assignments, found as they are asked for.
    fn assignments(&self) -> Box<dyn Iterator<Item = Vec<Feature>> + Send>;
    /// The poses of one of its assignments.
    #[must_use]
    fn of_assignment(&self, assignment: &[Feature]) -> Self;
}

impl Dimension for DVec2 {
    type Pose = plane::Pose;
    type Prior = crate::contact::Prior;
    type Model = plane::Model;
    type PoseSet = plane::PoseSet;
    type Normals = plane::Arc;

    fn is_finite(self) -> bool {
        Self::is_finite(self)
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

    fn largest_coordinate(self) -> f64 {
        self.abs().max_element()
    }

    fn size(model: &plane::Model) -> f64 {
        model.size
    }

    fn normal_slack(model: &plane::Model) -> f64 {
        model.normal_slack
    }

    fn explain(
        model: &Shared<plane::Model>,
        evidence: &Evidence,
        settings: &Settings,
        stop: &Halt,
    ) -> Explanations {
        let tables = model.feature_tables(settings.faces, settings.vertices(evidence));
        let case = plane::Case::new(model, evidence, settings.tolerance).until(stop, settings.effort);
        plane::explain(case, tables)
    }
}

impl Dimension for DVec3 {
    type Pose = space::Pose;
    type Prior = space::Prior;
    type Model = space::Model;
    type PoseSet = space::PoseSet;
    type Normals = space::Cap;

    fn is_finite(self) -> bool {
        Self::is_finite(self)
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

    fn largest_coordinate(self) -> f64 {
        self.abs().max_element()
    }

    fn size(model: &space::Model) -> f64 {
        model.size
    }

    fn normal_slack(model: &space::Model) -> f64 {
        model.normal_slack
    }

    fn explain(
        model: &Shared<space::Model>,
        evidence: &Evidence<Self>,
        settings: &Settings,
        stop: &Halt,
    ) -> Explanations<Self> {
        space::explain(model, evidence, settings, stop)
    }
}
