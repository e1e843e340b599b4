//! The hypotheses among which a path is to tell, made ready for lines.

use std::fmt::Debug;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec2;
use rayon::prelude::*;

use crate::dimension::{Dimension, Poses};
use crate::feature::Feature;
use crate::hypothesis::Hypothesis;
use crate::judge::{Fault, Outcome, Reading, Rules, Verdict};
use crate::line::{FirstContact, Line};
use crate::plan::PlanSettings;
use crate::recognize::Halt;
use crate::sensor::Sensor;

/// Poses of each hypothesis from which planners look, the one with the largest slack first.
const NUM_VIEWS: usize = 8;

/// They are chosen, far from each other, among so many samples.
const NUM_SAMPLED: usize = 48;

/// The border of a workspace is inside of a part if it is so far from its faces, as a share of the size: more than τ.
const CLEAR: f64 = 1e-5;

/// Poses of each hypothesis over which a path's expected score is taken.
const NUM_EXPECTED: usize = 16;

/// Margins are looked for up to so many eighths of m.
const MOST_STEPS: u32 = 512;

/// A hypothesis over all its poses, made ready for lines.
pub trait Shadow<V: Dimension>: Debug + Send + Sync {
    /// Whether an outcome takes long: several threads are better asked for those of a line, and a halt cuts it short.
    const SLOW: bool;

    /// Of these poses.
    fn new(poses: &V::PoseSet) -> Self;
    /// The model.
    fn model(&self) -> &V::Model;
    /// Middle and radius of a ball around every place of every vertex.
    fn ball(&self) -> (V, f64);
    /// What may be met first, over all poses. With a larger margin it only grows (`docs/theory.md`, T12).
    fn outcome(&self, ask: &Question<'_, V>) -> Outcome<V>;

    /// The same, if there is no fault in it.
    fn usable_outcome(&self, ask: &Question<'_, V>) -> Option<Outcome<V>> {
        let outcome = self.outcome(ask);
        outcome.fault.is_none().then_some(outcome)
    }

    /// Whether the line is usable and surely touches, at all poses.
    fn surely_touched(&self, ask: &Question<'_, V>) -> bool {
        let outcome = self.outcome(ask);
        outcome.fault.is_none() && !outcome.may_miss
    }
}

/// What is asked of a hypothesis: what this line may meet first, with this sensor.
#[derive(Debug, Clone, Copy)]
pub struct Question<'a, V = DVec2> {
    /// The line.
    pub line: &'a Line<V>,
    /// The sensor.
    pub sensor: &'a Sensor,
    /// Which contacts are wanted.
    pub rules: Rules,
    /// μ: everything is widened by it.
    pub margin: f64,
    /// The same as an angle, radians.
    pub angle_margin: f64,
    /// How far the tip goes.
    pub length: f64,
    /// Once it is set nobody waits for the answer: a slow one is cut short, and is then that the line can't be used.
    pub halt: &'a AtomicBool,
}

/// What a planner has proved.
#[derive(Debug)]
pub struct Proof {
    /// No usable path of margin ≥ m has a score below this.
    pub bound: f64,
    /// No usable path of margin ≥ m is better than the best that was offered.
    pub proved: bool,
    /// Boxes of lines examined.
    pub num_boxes: u64,
}

impl Proof {
    /// Nothing was proved.
    pub(crate) const NONE: Self = Self { bound: 1.0, proved: false, num_boxes: 0 };
}

/// Hypotheses with all their poses, the sensor, and what is asked of a path.
#[derive(Debug)]
pub struct Scene<V: Dimension = DVec2> {
    /// The hypotheses.
    pub shadows: Vec<V::Shadow>,
    /// Valid poses of each hypothesis, spread over its set.
    pub views: Vec<Vec<V::Pose>>,
    pub(crate) samples: Vec<Vec<V::Pose>>,
    pub(crate) poses: Vec<V::PoseSet>,
    /// Faces of each hypothesis that a contact is assigned to, in order, if they are not to be touched.
    avoided: Vec<Vec<Feature>>,
    /// The sensor.
    pub sensor: Sensor,
    /// Which contacts are wanted.
    pub rules: Rules,
    /// m: paths that keep what they tell under shifts by it are wanted.
    pub margin: f64,
    /// The largest of the parts.
    pub size: f64,
    /// The middle of a ball around all that any hypothesis may occupy.
    pub middle: V,
    /// Its radius.
    pub radius: f64,
    workspace: Option<[V; 2]>,
    pub(crate) directions: Option<(V, f64)>,
    tried: Vec<Line<V>>,
    /// Once it is set, lines that are being judged count as unusable where that is slow.
    halt: Halt,
}

impl<V: Dimension> Scene<V> {
    /// Of the hypotheses; they may be none.
    pub fn new(hypotheses: &[Hypothesis<V>], sensor: &Sensor, settings: &PlanSettings<V>) -> Self {
        let parts: Vec<(V::Shadow, Vec<V::Pose>)> = hypotheses
            .par_iter()
            .map(|one| (Shadow::new(&one.poses), one.poses.sample(NUM_SAMPLED, settings.seed)))
            .collect();
        let size = hypotheses.iter().map(|one| V::size(&one.model)).fold(0.0, f64::max);
        let balls = || parts.iter().map(|(shadow, _)| shadow.ball());
        let middle = middle_of(balls());
        let reach = |(center, radius): (V, f64)| (center - middle).length() + radius;
        let radius = balls().map(reach).fold(0.0, f64::max);
        let tips = sensor.tip_radius > 0.0;
        let rules = Rules {
            faces: settings.faces,
            edges: settings.edges.unwrap_or(tips),
            vertices: settings.vertices.unwrap_or(tips),
            avoid_assigned: settings.avoid_assigned,
        };
        let (mut shadows, mut views, mut samples) = (Vec::new(), Vec::new(), Vec::new());
        for ((shadow, sampled), one) in parts.into_iter().zip(hypotheses) {
            views.push(spread::<V>(one.poses.witness(), &sampled, V::size(shadow.model()), NUM_VIEWS));
            samples.push(sampled.into_iter().take(NUM_EXPECTED).collect());
            shadows.push(shadow);
        }
        Self {
            shadows,
            views,
            samples,
            poses: hypotheses.iter().map(|one| one.poses.clone()).collect(),
            avoided: hypotheses.iter().map(|one| avoided::<V>(&one.poses, rules)).collect(),
            sensor: *sensor,
            rules,
            margin: settings.margin * size,
            size,
            middle,
            radius,
            workspace: settings.workspace,
            directions: settings.directions,
            tried: settings.tried.clone(),
            halt: Halt::default(),
        }
    }

    /// Until this is set.
    pub fn until(mut self, halt: &Halt) -> Self {
        self.halt = Halt::clone(halt);
        self
    }

    /// Whether nobody waits for more.
    pub fn is_halted(&self) -> bool {
        self.halt.load(Relaxed)
    }

    /// Every hypothesis.
    pub fn everyone(&self) -> Vec<usize> {
        (0..self.shadows.len()).collect()
    }

    /// The line of a direction through a point. It begins on the border of the workspace, or clear of everything; `None` if
    /// it does not enter the workspace.
    pub fn begun(&self, direction: V, through: V) -> Option<Line<V>> {
        let Some([low, high]) = self.workspace else {
            return Some(Line { start: through - direction * self.clear(), direction });
        };
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in V::AXES {
            let (from, to) = (axis.dot(low - through), axis.dot(high - through));
            let speed = axis.dot(direction);
            if speed == 0.0 {
                if from > 0.0 || to < 0.0 {
                    return None;
                }
                continue;
            }
            let (first, second) = (from / speed, to / speed);
            enter = enter.max(first.min(second));
            leave = leave.min(first.max(second));
        }
        (enter < leave).then(|| Line { start: through + direction * enter, direction })
    }

    /// The radius of a ball around the middle outside of which a tip is clear of everything.
    pub fn clear(&self) -> f64 {
        let slacks = self.shadows.iter().map(|shadow| V::position_slack(shadow.model()));
        let slack = slacks.fold(0.0, f64::max);
        self.radius + self.sensor.tip_radius + self.sensor.path_error + slack + 2.0 * self.margin
    }

    /// Whether every line begins clear of all that any hypothesis may occupy, whatever its direction.
    pub fn begins_outside(&self) -> bool {
        let clear = self.clear();
        let holds = |room: V| room.coordinates().iter().all(|one| *one >= clear);
        self.workspace.is_none_or(|[low, high]| holds(self.middle - low) && holds(high - self.middle))
    }

    /// Whether every line begins inside of a member that is at one of its poses: all of the workspace's border is.
    pub fn begins_inside(&self, members: &[usize]) -> bool {
        let Some(corners) = self.workspace else { return false };
        let around = |member: usize, pose: V::Pose| {
            V::surrounds(self.shadows[member].model(), pose, corners, CLEAR * self.size)
        };
        members.iter().any(|member| self.views[*member].iter().any(|pose| around(*member, *pose)))
    }

    /// Whether it is within m of a line that was tried: turned by no more than m in a part's size, and shifted by no more.
    pub fn was_tried(&self, line: &Line<V>) -> bool {
        self.tried
            .iter()
            .map(|tried| V::turn_and_shift(line, tried, self.middle))
            .any(|(turn, shift)| turn * self.size <= self.margin && shift <= self.margin)
    }

    /// What the members can answer to a line, everything widened by `margin`; `None` if one of them makes it unusable.
    pub fn outcomes(&self, line: &Line<V>, members: &[usize], margin: f64) -> Option<Vec<Outcome<V>>> {
        let ask = self.question(line, margin, f64::INFINITY);
        let of = |member: &usize| self.shadows[*member].usable_outcome(&ask);
        if V::Shadow::SLOW { members.par_iter().map(of).collect() } else { members.iter().map(of).collect() }
    }

    /// What a member can answer within a length of the line, everything widened by `margin`.
    pub fn outcome(&self, line: &Line<V>, member: usize, margin: f64, length: f64) -> Outcome<V> {
        self.shadows[member].outcome(&self.question(line, margin, length))
    }

    /// Whether a line is usable and surely touches a member, everything widened by `margin`.
    pub fn surely_touched(&self, line: &Line<V>, member: usize, margin: f64) -> bool {
        self.shadows[member].surely_touched(&self.question(line, margin, f64::INFINITY))
    }

    fn question<'a>(&'a self, line: &'a Line<V>, margin: f64, length: f64) -> Question<'a, V> {
        let (sensor, rules, angle_margin) = (&self.sensor, self.rules, margin / self.size);
        Question { line, sensor, rules, margin, angle_margin, length, halt: &self.halt }
    }

    /// Whether a first contact with a member on a feature breaks a rule.
    pub fn unwanted(&self, member: usize, feature: Feature) -> Option<Fault> {
        self.rules.broken_by(feature, || self.avoided[member].binary_search(&feature).is_ok())
    }

    /// Whether the members are one part, named differently or not, with a pose in common. Its reading leaves all of them,
    /// whatever the line.
    pub fn one_part_at_one_pose(&self, members: &[usize]) -> bool {
        members.iter().all(|member| {
            let [(first, one), (other, another)] =
                [members[0], *member].map(|k| (self.shadows[k].model(), self.views[k][0]));
            one == another && V::same_part(first, other)
        })
    }

    /// Whether a line can be used and leaves fewer than so many pairs of members; `joined` says of two places in `members`
    /// whether they are known to be left. As the verdict would say, but no longer than needed.
    pub fn leaves_fewer(
        &self,
        line: &Line<V>,
        members: &[usize],
        enough: usize,
        joined: impl Fn(usize, usize) -> bool,
    ) -> bool {
        self.left_below(line, members, enough, joined).is_some()
    }

    /// The pairs of members that a line leaves, if it can be used and they are fewer than so many; else as `leaves_fewer`.
    pub fn left_below(
        &self,
        line: &Line<V>,
        members: &[usize],
        enough: usize,
        joined: impl Fn(usize, usize) -> bool,
    ) -> Option<usize> {
        let mut outcomes: Vec<Outcome<V>> = Vec::with_capacity(members.len());
        let known = (0..members.len()).map(|k| (0..k).filter(|j| joined(*j, k)).count()).sum::<usize>();
        let mut left = members.len() + 2 * known;
        for (k, &member) in members.iter().enumerate() {
            let outcome = self.outcome(line, member, 0.0, f64::INFINITY);
            if outcome.fault.is_some() {
                return None;
            }
            for (j, other) in outcomes.iter().enumerate() {
                if !joined(j, k) && !other.separated(&outcome, &self.sensor) {
                    left += 2;
                }
            }
            if left >= enough {
                return None;
            }
            outcomes.push(outcome);
        }
        Some(left)
    }

    /// The verdict on a line among the members; `None` if it can't be used.
    pub fn verdict(&self, line: &Line<V>, members: &[usize], margin: f64) -> Option<Verdict> {
        self.outcomes(line, members, margin).map(|outcomes| Verdict::new(&outcomes, &self.sensor))
    }

    /// Whether a line, everything widened by the margin, stays usable and separates all that the verdict does.
    pub fn keeps(&self, line: &Line<V>, members: &[usize], verdict: &Verdict, margin: f64) -> bool {
        self.verdict(line, members, margin).is_some_and(|other| other.left == verdict.left)
    }

    /// The largest μ, to an eighth of m and at most 64 m, with which the verdict still separates all that it separates
    /// without, and the line stays usable.
    pub fn margin_of(&self, line: &Line<V>, members: &[usize], verdict: &Verdict) -> f64 {
        let holds = |margin: f64| self.keeps(line, members, verdict, margin);
        let step = 0.125 * self.margin;
        if step == 0.0 || !holds(step) {
            return 0.0;
        }
        // Where nothing is told apart, many lines have all of it.
        if holds(step * f64::from(MOST_STEPS)) {
            return step * f64::from(MOST_STEPS);
        }
        let (mut low, mut high) = (1_u32, 2_u32);
        while high < MOST_STEPS && holds(step * f64::from(high)) {
            (low, high) = (high, 2 * high);
        }
        while high - low > 1 {
            let middle = u32::midpoint(low, high);
            if holds(step * f64::from(middle)) { low = middle } else { high = middle }
        }
        step * f64::from(low)
    }

    /// The mean, over sampled poses of the members, of how many members their exact readings leave.
    pub fn expected_score(
        &self,
        line: &Line<V>,
        members: &[usize],
        outcomes: &[Outcome<V>],
        length: f64,
    ) -> f64 {
        let left_by = |member: usize, pose: V::Pose| {
            let found = self.contact(member, pose, line).filter(|found| found.depth <= length);
            let reading =
                found.map(|found| Reading { depth: found.depth, aside: 0.0, normal: Some(found.normal) });
            outcomes.iter().filter(|outcome| outcome.may_answer(reading, &self.sensor)).count()
        };
        let of =
            |member: &usize| self.samples[*member].iter().map(|pose| left_by(*member, *pose)).sum::<usize>();
        let left: usize =
            if V::Shadow::SLOW { members.par_iter().map(of).sum() } else { members.iter().map(of).sum() };
        let count: usize = members.iter().map(|member| self.samples[*member].len()).sum();
        left as f64 / count.max(1) as f64
    }

    /// The exact first contact of a member at a pose.
    pub fn contact(&self, member: usize, pose: V::Pose, line: &Line<V>) -> Option<FirstContact<V>> {
        V::first_contact(self.shadows[member].model(), pose, line, self.sensor.tip_radius)
    }
}

/// The middle of a box around balls; the origin, if there are none.
fn middle_of<V: Dimension>(balls: impl Iterator<Item = (V, f64)>) -> V {
    let boxes = balls.map(|(center, radius)| (center - V::splat(radius), center + V::splat(radius)));
    let around = boxes.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)));
    around.map_or(V::default(), |(low, high)| (low + high) * 0.5)
}

/// Faces that a contact is assigned to, in order, if the rules say that they are not to be touched.
fn avoided<V: Dimension>(poses: &V::PoseSet, rules: Rules) -> Vec<Feature> {
    if !rules.avoid_assigned {
        return Vec::new();
    }
    let mut features = poses.assigned_features();
    features.sort_unstable();
    features.dedup();
    features
}

/// Some of the poses, each as far as possible from those before, as the ends of a part of this size move.
pub(crate) fn spread<V: Dimension>(
    first: V::Pose,
    sampled: &[V::Pose],
    size: f64,
    count: usize,
) -> Vec<V::Pose> {
    let apart = |a: &V::Pose, b: &V::Pose| {
        let ends = std::iter::once(V::default()).chain(V::AXES.iter().map(|axis| *axis * size));
        ends.map(|end| (V::placed(*a, end) - V::placed(*b, end)).length()).fold(0.0, f64::max)
    };
    let mut chosen = vec![first];
    let mut distances: Vec<f64> = sampled.iter().map(|pose| apart(pose, &first)).collect();
    while chosen.len() < count {
        let Some((k, far)) = distances.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break };
        if *far <= 0.0 {
            break;
        }
        let next = sampled[k];
        chosen.push(next);
        for (distance, pose) in distances.iter_mut().zip(sampled) {
            *distance = distance.min(apart(pose, &next));
        }
    }
    chosen
}
