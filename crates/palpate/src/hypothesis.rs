//! Hypotheses and their interpretations (DESIGN §1).

use std::sync::Arc as Shared;

use crate::Feature;
use crate::plane::{Model, Pose, PoseSet};

/// A number that was counted, or of which only a lower bound is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// There are at least so many.
    pub at_least: u64,
    /// There are no more.
    pub exact: bool,
}

impl std::ops::Add for Count {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { at_least: self.at_least.saturating_add(other.at_least), exact: self.exact && other.exact }
    }
}

/// One answer: interpretations of one model whose poses run into each other.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// The model.
    pub model: Shared<Model>,
    /// Its number among those that were asked for.
    pub model_number: usize,
    /// All its poses.
    pub poses: PoseSet,
}

/// A model with one feature for each contact, and the poses that satisfy them.
#[derive(Debug, Clone)]
pub struct Interpretation {
    /// The model.
    pub model: Shared<Model>,
    /// Its number among those that were asked for.
    pub model_number: usize,
    /// One feature for each contact, in their order.
    pub assignment: Vec<Feature>,
    /// All its poses.
    pub poses: PoseSet,
}

impl Hypothesis {
    /// Whether it is kept only thanks to the tolerance τ.
    #[must_use]
    pub fn marginal(&self) -> bool {
        self.poses.marginal()
    }

    /// The pose with the largest slack: the worst reading uses the smallest share of its bounds.
    #[must_use]
    pub fn world_from_model(&self) -> Pose {
        self.poses.largest_slack()
    }

    /// How many interpretations it has, one of each that the model's symmetries repeat.
    #[must_use]
    pub fn interpretation_count(&self) -> Count {
        self.poses.assignment_count()
    }

    /// Its interpretations one by one, found as they are asked for.
    pub fn interpretations(&self) -> impl Iterator<Item = Interpretation> + use<> {
        let hypothesis = self.clone();
        self.poses.assignments().map(move |assignment| Interpretation {
            model: Shared::clone(&hypothesis.model),
            model_number: hypothesis.model_number,
            poses: hypothesis.poses.of_assignment(&assignment),
            assignment,
        })
    }
}
