//! Paths, what they would tell, and their order (DESIGN §2).

use std::cmp::Ordering;

use glam::DVec2;

use crate::dimension::Dimension;
use crate::judge::{Fault, Outcome, Reading, Verdict};
use crate::line::Line;
use crate::plan::Stop;
use crate::scene::Scene;
use crate::sensor::Sensor;

/// A straight guarded move and what it would tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Path<V: Dimension = DVec2> {
    /// Where it starts and how it goes, world frame.
    pub line: Line<V>,
    /// How far, past the last possible contact.
    pub length: f64,
    /// All that it separates stays separated, and it stays usable, for shifts by this; to an eighth of m, at most 64 m.
    pub margin: f64,
    /// `(1/n) Σ_k (hypotheses not separated from k)`.
    pub score: f64,
    /// The mean over poses of how many hypotheses their exact readings leave.
    pub expected_score: f64,
    /// Branches of the ambiguity tree.
    pub classes: Vec<Vec<usize>>,
    /// Hypotheses that it may pass by.
    pub no_contact: Vec<usize>,
    /// What each hypothesis can answer.
    pub outcomes: Vec<Outcome<V>>,
    /// Why it can't be used, and because of which hypothesis.
    pub fault: Option<(usize, Fault)>,
    sensor: Sensor,
}

impl<V: Dimension> Path<V> {
    /// Whether it is certain to tell something: some pair is separated.
    #[must_use]
    pub fn guaranteed(&self) -> bool {
        self.fault.is_none() && self.score < self.outcomes.len() as f64
    }

    /// The hypotheses that could have given a reading, or, with `None`, a miss.
    #[must_use]
    pub fn outcome_of(&self, reading: Option<Reading<V>>) -> Vec<usize> {
        let answers = |k: &usize| self.outcomes[*k].may_answer(reading, &self.sensor);
        (0..self.outcomes.len()).filter(answers).collect()
    }

    /// A sensed centre and normal as the path sees them.
    #[must_use]
    pub fn reading(&self, center: V, normal: Option<V>) -> Reading<V> {
        Reading::new(&self.line, center, normal)
    }

    /// Hypotheses that it identifies, whichever reading they give.
    #[must_use]
    pub fn num_unique(&self) -> usize {
        self.classes.iter().filter(|class| class.len() == 1).count()
    }

    /// Whether it is good enough to stop, and keeps what it tells under shifts by m.
    pub(crate) fn enough(&self, stop: Stop, m: f64) -> bool {
        let n = self.outcomes.len();
        let tells = match stop {
            Stop::Perfect => self.score <= 1.0,
            Stop::Unique(count) => self.num_unique() >= count.min(n),
            Stop::Share(share) => self.num_unique() as f64 >= share * n as f64,
        };
        tells && self.margin >= m
    }

    /// The order of paths, best first (DESIGN §2).
    pub(crate) fn order(&self, other: &Self, m: f64) -> Ordering {
        let expected = |path: &Self| rounded_score(path.expected_score, self.outcomes.len());
        self.score
            .total_cmp(&other.score)
            .then(expected(self).total_cmp(&expected(other)))
            .then(rounded_margin(other.margin, m).total_cmp(&rounded_margin(self.margin, m)))
            .then(self.length.total_cmp(&other.length))
            .then(self.line.order(&other.line))
    }
}

/// An expected score among so many, as paths are ordered: in hundredths of their number.
pub(crate) fn rounded_score(score: f64, count: usize) -> f64 {
    (score / (0.01 * count.max(1) as f64)).round()
}

/// A margin as paths are ordered: in m.
pub(crate) fn rounded_margin(margin: f64, m: f64) -> f64 {
    if m > 0.0 { (margin / m).round() } else { margin }
}

/// The path along a line among the members.
///
/// It is so long that it passes the last possible contact also when shifted by its margin. One of a given length that is
/// shorter has no margin, and may end before a contact.
pub(crate) fn judged<V: Dimension>(
    scene: &Scene<V>,
    members: &[usize],
    line: &Line<V>,
    length: Option<f64>,
) -> Path<V> {
    let within = |length: f64| -> Vec<Outcome<V>> {
        members.iter().map(|member| scene.outcome(line, *member, 0.0, length)).collect()
    };
    let endless = within(f64::INFINITY);
    let verdict = Verdict::new(&endless, &scene.sensor);
    let kept = if verdict.fault.is_none() { scene.margin_of(line, members, &verdict) } else { 0.0 };
    let at_margin = scene.outcomes(line, members, kept);
    let needed = last_contact(at_margin.as_ref().unwrap_or(&endless))
        + scene.sensor.position_error
        + scene.sensor.path_error
        + scene.margin;
    let (length, margin) = match length {
        Some(length) if length < needed => (length, 0.0),
        given => (given.unwrap_or(needed), kept),
    };
    let (outcomes, verdict) = if length < needed {
        let outcomes = within(length);
        let verdict = Verdict::new(&outcomes, &scene.sensor);
        (outcomes, verdict)
    } else {
        (endless, verdict)
    };
    Path {
        line: *line,
        length,
        margin,
        score: verdict.score(),
        expected_score: scene.expected_score(line, members, &outcomes, length),
        classes: verdict.classes(),
        no_contact: (0..outcomes.len()).filter(|k| outcomes[*k].may_miss).collect(),
        fault: verdict.fault,
        outcomes,
        sensor: scene.sensor,
    }
}

/// The largest depth at which anything may be touched first.
fn last_contact<V: Dimension>(outcomes: &[Outcome<V>]) -> f64 {
    let depths = outcomes.iter().flat_map(|outcome| &outcome.touches).map(|touch| touch.depth.high);
    depths.fold(0.0, f64::max)
}
