//! Hypotheses and their interpretations (DESIGN §1).

use std::sync::Arc as Shared;

use glam::DVec2;

use crate::Feature;
use crate::dimension::{Dimension, Poses};

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
pub struct Hypothesis<V: Dimension = DVec2> {
    /// The model.
    pub model: Shared<V::Model>,
    /// Its number among those that were asked for.
    pub model_number: usize,
    /// All its poses.
    pub poses: V::PoseSet,
}

/// A model with one feature for each contact, and the poses that satisfy them.
#[derive(Debug, Clone)]
pub struct Interpretation<V: Dimension = DVec2> {
    /// The model.
    pub model: Shared<V::Model>,
    /// Its number among those that were asked for.
    pub model_number: usize,
    /// One feature for each contact, in their order.
    pub assignment: Vec<Feature>,
    /// All its poses.
    pub poses: V::PoseSet,
}

impl<V: Dimension> Hypothesis<V> {
    /// Whether it is kept only thanks to the tolerance τ.
    #[must_use]
    pub fn marginal(&self) -> bool {
        self.poses.marginal()
    }

    /// Whether a pose is known that explains every contact. If not, a search met its limit before it knew whether there is
    /// one: the hypothesis is kept, so that nothing true is lost, and the answer is not complete.
    #[must_use]
    pub fn proved(&self) -> bool {
        self.poses.proved()
    }

    /// The pose with the largest slack: the worst reading uses the smallest share of its bounds.
    #[must_use]
    pub fn world_from_model(&self) -> V::Pose {
        self.poses.largest_slack()
    }

    /// How many interpretations it has, one of each that the model's symmetries repeat.
    #[must_use]
    pub fn interpretation_count(&self) -> Count {
        self.poses.assignment_count()
    }

    /// Its interpretations one by one, found as they are asked for.
    pub fn interpretations(&self) -> impl Iterator<Item = Interpretation<V>> + use<V> {
        let hypothesis = self.clone();
        self.poses.assignments().map(move |assignment| Interpretation {
            model: Shared::clone(&hypothesis.model),
            model_number: hypothesis.model_number,
            poses: hypothesis.poses.of_assignment(&assignment),
            assignment,
        })
    }
}

/// Every choice of one member of each set, the last set varying fastest.
pub(crate) fn choices(sets: Vec<Vec<Feature>>) -> impl Iterator<Item = Vec<Feature>> {
    let mut at = (!sets.iter().any(Vec::is_empty)).then(|| vec![0; sets.len()]);
    std::iter::from_fn(move || {
        let choice = at.as_ref()?.iter().zip(&sets).map(|(k, set)| set[*k]).collect();
        let places = at.as_mut()?;
        let advanced = (0..sets.len()).rev().any(|slot| {
            places[slot] = (places[slot] + 1) % sets[slot].len();
            places[slot] != 0
        });
        if !advanced {
            at = None;
        }
        Some(choice)
    })
}
