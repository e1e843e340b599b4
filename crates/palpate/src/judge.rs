//! What a path would tell: outcomes, what they leave of each hypothesis, classes, score (thesis 3.3, 3.4; DESIGN §2).
//!
//! The only judge: whatever a planner proposes is compared by it.

use std::fmt::Debug;

use glam::DVec2;

use crate::Feature;
use crate::dimension::Dimension;
use crate::line::Line;
use crate::sensor::Sensor;
use crate::tree::Range;

/// A set of unit normals, as a contact may have them: an arc of the circle, a cap of the sphere.
pub trait Normals<V>: Debug + Copy + PartialEq + Send + Sync {
    /// The smallest angle between a unit vector and a member; zero inside. Radians.
    fn angle_to(self, normal: V) -> f64;

    /// The smallest angle between members of the two; zero where they meet. Radians.
    fn apart(self, other: Self) -> f64;

    /// A unit vector, and the angle from it within which all of them are; radians, at most π.
    fn cap(self) -> (V, f64);
}

/// A first contact that a path may make with a hypothesis, somewhere in its pose set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch<V: Dimension = DVec2> {
    /// What is touched.
    pub feature: Feature,
    /// Of the tip's centre, along the path from its start.
    pub depth: Range,
    /// Outward normals at the contact, world frame.
    pub normals: V::Normals,
}

/// Why a path can't be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// It does not start clear of what the hypothesis may occupy.
    Start,
    /// It may be touched first at more than the largest reliable incidence.
    Skid,
    /// It may be touched first where it can't be: a face that is untouchable, or the back of a loose one.
    Untouchable,
    /// It may be touched first on a feature of a kind that recognition was not told to use.
    Kind,
    /// It may be touched first on a face that a contact is assigned to, which was to be avoided.
    Assigned,
    /// The stem of the probe may touch it before the tip does.
    Stem,
}

/// Which first contacts are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a rule by itself")]
pub struct Rules {
    /// Those on faces.
    pub faces: bool,
    /// Those on edges, in space.
    pub edges: bool,
    /// Those on vertices.
    pub vertices: bool,
    /// Faces that a contact is assigned to are not to be touched.
    pub avoid_assigned: bool,
}

impl Rules {
    /// Which rule a first contact on a feature breaks; `assigned`: whether a contact is assigned to it.
    pub(crate) fn broken_by(self, feature: Feature, assigned: impl FnOnce() -> bool) -> Option<Fault> {
        match feature {
            Feature::Face(_) if self.avoid_assigned && assigned() => Some(Fault::Assigned),
            Feature::Face(_) if !self.faces => Some(Fault::Kind),
            Feature::Edge(_) if !self.edges => Some(Fault::Kind),
            Feature::Vertex(_) if !self.vertices => Some(Fault::Kind),
            _ => None,
        }
    }
}

/// What a hypothesis can answer to a path over its whole pose set.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<V: Dimension = DVec2> {
    /// In order of features.
    pub touches: Vec<Touch<V>>,
    /// The path may pass it by.
    pub may_miss: bool,
    /// It makes the path unusable.
    pub fault: Option<Fault>,
}

impl<V: Dimension> Default for Outcome<V> {
    fn default() -> Self {
        Self { touches: Vec::new(), may_miss: false, fault: None }
    }
}

impl<V: Dimension> Outcome<V> {
    /// Whether no reading can come from both.
    #[must_use]
    pub fn separated(&self, other: &Self, sensor: &Sensor) -> bool {
        let apart = |a: &Touch<V>, b: &Touch<V>| {
            let gap = (a.depth.low - b.depth.high).max(b.depth.low - a.depth.high);
            gap > 2.0 * sensor.position_error
                || sensor.normal_error.is_some_and(|error| a.normals.apart(b.normals) > 2.0 * error)
        };
        !(self.may_miss && other.may_miss)
            && self.touches.iter().all(|a| other.touches.iter().all(|b| apart(a, b)))
    }

    /// Whether a reading, or a miss, may come from it.
    #[must_use]
    pub fn may_answer(&self, reading: Option<Reading<V>>, sensor: &Sensor) -> bool {
        let Some(reading) = reading else { return self.may_miss };
        let agrees = |touch: &Touch<V>| {
            let beyond = (touch.depth.low - reading.depth).max(reading.depth - touch.depth.high);
            let turned = match (reading.normal, sensor.normal_error) {
                (Some(normal), Some(error)) => touch.normals.angle_to(normal) <= error,
                _ => true,
            };
            beyond <= sensor.position_error && turned
        };
        reading.aside <= sensor.path_error + sensor.position_error && self.touches.iter().any(agrees)
    }
}

/// A contact as a path sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<V = DVec2> {
    /// Of the tip's centre along the path, from its start.
    pub depth: f64,
    /// How far from the path the tip's centre is.
    pub aside: f64,
    /// Unit outward normal, world frame.
    pub normal: Option<V>,
}

impl<V: Dimension> Reading<V> {
    /// A sensed centre and normal, in the world frame, as a line sees them.
    ///
    /// A centre that is off the line by no more than rounding is on it, whatever the errors.
    #[must_use]
    pub fn new(line: &Line<V>, center: V, normal: Option<V>) -> Self {
        let (depth, aside) = line.depth_and_aside(center);
        let rounding = 1e-12 * (center.length() + line.start.length());
        Self { depth, aside: (aside - rounding).max(0.0), normal }
    }
}

/// What a path tells hypotheses apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// `left[k]`: the hypotheses that it does not separate from `k`, `k` included, in order.
    pub left: Vec<Vec<usize>>,
    /// The first fault of a hypothesis, with its number: the path can't be used.
    pub fault: Option<(usize, Fault)>,
}

impl Verdict {
    /// Of the outcomes of all hypotheses.
    #[must_use]
    pub fn new<V: Dimension>(outcomes: &[Outcome<V>], sensor: &Sensor) -> Self {
        let fault = outcomes.iter().enumerate().find_map(|(k, outcome)| Some((k, outcome.fault?)));
        let mut left: Vec<Vec<usize>> = (0..outcomes.len()).map(|k| vec![k]).collect();
        for (k, outcome) in outcomes.iter().enumerate() {
            for j in 0..k {
                if !outcomes[j].separated(outcome, sensor) {
                    left[j].push(k);
                    left[k].push(j);
                }
            }
        }
        for members in &mut left {
            members.sort_unstable();
        }
        Self { left, fault }
    }

    /// The number of ordered pairs that are not separated, each hypothesis with itself included: the score times n, exact.
    #[must_use]
    pub fn num_left(&self) -> usize {
        self.left.iter().map(Vec::len).sum()
    }

    /// `(1/n) Σ_k (hypotheses not separated from k)`: smaller is better, 1 is perfect, n tells nothing.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.num_left() as f64 / self.left.len().max(1) as f64
    }

    /// Hypotheses joined by "not separated": the branches of the ambiguity tree, in order of their first member.
    #[must_use]
    pub fn classes(&self) -> Vec<Vec<usize>> {
        let mut class_of = vec![usize::MAX; self.left.len()];
        let mut classes: Vec<Vec<usize>> = Vec::new();
        for first in 0..self.left.len() {
            if class_of[first] != usize::MAX {
                continue;
            }
            class_of[first] = classes.len();
            let mut members = vec![first];
            let mut at = 0;
            while let Some(&member) = members.get(at) {
                for &other in &self.left[member] {
                    if class_of[other] == usize::MAX {
                        class_of[other] = classes.len();
                        members.push(other);
                    }
                }
                at += 1;
            }
            members.sort_unstable();
            classes.push(members);
        }
        classes
    }
}
