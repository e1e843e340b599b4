//! The hypotheses among which a path is to tell, made ready for lines.

use std::f64::consts::PI;

use glam::DVec2;
use rayon::prelude::*;

use super::arc::wrap;
use super::distance::segment_to_segment;
use super::free::{inside, solid};
use super::model::Face;
use super::outcome::{Allowance, Question};
use super::pose::Pose;
use super::pose_set::PoseSet;
use super::shadow::Shadow;
use super::thesis::Placement;
use crate::hypothesis::Hypothesis;
use crate::judge::{Outcome, Reading, Rules, Verdict};
use crate::line::{FirstContact, Line};
use crate::plan::PlanSettings;
use crate::sensor::Sensor;

/// Poses of each hypothesis from which planners look, the one with the largest slack first.
const NUM_VIEWS: usize = 8;

/// Poses of each hypothesis from which `complete` looks, at most.
const MANY_VIEWS: usize = 12;

/// They are chosen, far from each other, among so many samples.
const NUM_SAMPLED: usize = 48;

/// The border of a workspace is inside of a part if it is so far from its faces, as a share of the size: more than τ.
const CLEAR: f64 = 1e-5;

/// Poses of each hypothesis over which a path's expected score is taken.
const NUM_EXPECTED: usize = 16;

/// Margins are looked for up to so many eighths of m.
const MOST_STEPS: u32 = 512;

/// Hypotheses with all their poses, the sensor, and what is asked of a path.
#[derive(Debug)]
pub(crate) struct Scene {
    pub shadows: Vec<Shadow>,
    /// Valid poses of each hypothesis, spread over its set.
    pub views: Vec<Vec<Pose>>,
    /// Where the thesis places each.
    pub placements: Vec<Placement>,
    samples: Vec<Vec<Pose>>,
    poses: Vec<PoseSet>,
    pub sensor: Sensor,
    pub rules: Rules,
    /// m: paths that keep what they tell under shifts by it are wanted.
    pub margin: f64,
    /// The largest of the parts.
    pub size: f64,
    /// A circle around all that any hypothesis may occupy.
    pub middle: DVec2,
    pub radius: f64,
    workspace: Option<[DVec2; 2]>,
    directions: Option<(DVec2, f64)>,
    tried: Vec<Line>,
}

impl Scene {
    pub fn new(hypotheses: &[Hypothesis], sensor: &Sensor, settings: &PlanSettings) -> Self {
        let parts: Vec<(Shadow, Vec<Pose>)> = hypotheses
            .par_iter()
            .map(|one| (Shadow::new(&one.poses), one.poses.sample(NUM_SAMPLED, settings.seed)))
            .collect();
        let size = hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max);
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = parts.iter().fold(start, |(low, high), (shadow, _)| {
            (low.min(shadow.middle - shadow.radius), high.max(shadow.middle + shadow.radius))
        });
        let middle = if parts.is_empty() { DVec2::ZERO } else { 0.5 * (low + high) };
        let reach = |(shadow, _): &(Shadow, Vec<Pose>)| shadow.middle.distance(middle) + shadow.radius;
        let radius = parts.iter().map(reach).fold(0.0, f64::max);
        let tips = sensor.tip_radius > 0.0;
        let rules = Rules {
            faces: settings.faces,
            edges: false,
            vertices: settings.vertices.unwrap_or(tips),
            avoid_assigned: settings.avoid_assigned,
        };
        let (mut shadows, mut views, mut samples) = (Vec::new(), Vec::new(), Vec::new());
        let mut placements = Vec::new();
        for ((shadow, sampled), one) in parts.into_iter().zip(hypotheses) {
            let looked_from = spread(one.poses.witness(), &sampled, &shadow, NUM_VIEWS);
            placements.push(Placement::new(&one.poses, &looked_from));
            views.push(looked_from);
            samples.push(sampled.into_iter().take(NUM_EXPECTED).collect());
            shadows.push(shadow);
        }
        let margin = settings.margin * size;
        let (workspace, directions) = (settings.workspace, settings.directions);
        Self {
            shadows,
            views,
            placements,
            samples,
            poses: hypotheses.iter().map(|one| one.poses.clone()).collect(),
            sensor: *sensor,
            rules,
            margin,
            size,
            middle,
            radius,
            workspace,
            directions,
            tried: settings.tried.clone(),
        }
    }

    /// The views of a member, and poses at the extremes of its set.
    pub fn many_views(&self, member: usize) -> Vec<Pose> {
        let views = &self.views[member];
        let mut others = self.poses[member].extremes();
        others.extend(&views[1..]);
        spread(views[0], &others, &self.shadows[member], MANY_VIEWS)
    }

    /// Every hypothesis.
    pub fn everyone(&self) -> Vec<usize> {
        (0..self.shadows.len()).collect()
    }

    /// Lines are numbered by the angle of their direction and by how far they pass to the left of the middle. Each begins
    /// on the border of the workspace, or clear of everything; `None` if it does not enter the workspace or comes from a
    /// direction that is not allowed.
    pub fn line(&self, angle: f64, aside: f64) -> Option<Line> {
        if !self.allowed(angle) {
            return None;
        }
        let direction = DVec2::from_angle(angle);
        let foot = self.middle + aside * direction.perp();
        let Some([low, high]) = self.workspace else {
            return Some(Line { start: foot - self.clear() * direction, direction });
        };
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in [DVec2::X, DVec2::Y] {
            let (from, to) = (axis.dot(low - foot), axis.dot(high - foot));
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
        (enter < leave).then(|| Line { start: foot + enter * direction, direction })
    }

    /// The radius of a circle around the middle outside of which a tip is clear of everything.
    pub fn clear(&self) -> f64 {
        let slack = self.shadows.iter().map(|shadow| shadow.model().position_slack).fold(0.0, f64::max);
        self.radius + self.sensor.tip_radius + self.sensor.path_error + slack + 2.0 * self.margin
    }

    /// Whether every line begins clear of all that any hypothesis may occupy, whatever its direction.
    pub fn begins_outside(&self) -> bool {
        let clear = self.clear();
        self.workspace.is_none_or(|[low, high]| {
            (self.middle - low).min_element() >= clear && (high - self.middle).min_element() >= clear
        })
    }

    /// Whether every line begins inside of a member that is at one of its poses: all of the workspace's border is.
    pub fn begins_inside(&self, members: &[usize]) -> bool {
        let Some([low, high]) = self.workspace else { return false };
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let around = |member: usize, pose: Pose| {
            let model = self.shadows[member].model();
            let inverse = pose.inverse();
            let corners = corners.map(|corner| inverse.apply(corner));
            let border = |k: usize| [corners[k], corners[(k + 1) % 4]];
            let clear_of = |face: &Face| {
                let distance = |k| segment_to_segment([face.start, face.end], border(k));
                (0..4).all(|k| distance(k) > CLEAR * self.size)
            };
            inside(model, corners[0]) && solid(model).all(clear_of)
        };
        members.iter().any(|member| self.views[*member].iter().any(|pose| around(*member, *pose)))
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
        (line.direction.to_angle(), line.left().dot(line.start - self.middle))
    }

    /// Whether it is within m of a line that was tried: turned by no more than m in a part's size, and shifted by no more.
    pub fn was_tried(&self, line: &Line) -> bool {
        let (angle, aside) = self.numbers(line);
        self.tried.iter().map(|tried| self.numbers(tried)).any(|(other, place)| {
            wrap(angle - other).abs() * self.size <= self.margin && (aside - place).abs() <= self.margin
        })
    }

    /// What the members can answer to a line, everything widened by `margin`. Stops at the first that makes it unusable.
    pub fn outcomes(
        &self,
        line: &Line,
        members: &[usize],
        margin: f64,
    ) -> Result<Vec<Outcome>, Vec<Outcome>> {
        let mut outcomes = Vec::with_capacity(members.len());
        for &member in members {
            outcomes.push(self.outcome(line, member, margin, f64::INFINITY));
            if outcomes.last().is_some_and(|outcome| outcome.fault.is_some()) {
                return Err(outcomes);
            }
        }
        Ok(outcomes)
    }

    /// What a member can answer within a length of the line, everything widened by `margin`.
    pub fn outcome(&self, line: &Line, member: usize, margin: f64, length: f64) -> Outcome {
        self.shadows[member].outcome(&self.question(line, member, margin, length))
    }

    /// Whether a line is usable and surely touches a member, everything widened by `margin`.
    pub fn surely_touched(&self, line: &Line, member: usize, margin: f64) -> bool {
        self.shadows[member].surely_touched(&self.question(line, member, margin, f64::INFINITY))
    }

    fn question<'a>(&'a self, line: &'a Line, member: usize, margin: f64, length: f64) -> Question<'a> {
        let model = self.shadows[member].model();
        let allowance = Allowance::new(&self.sensor, model, margin, margin / self.size);
        Question::new(line, &self.sensor, allowance, self.rules, length)
    }

    /// Whether the members are one part, named differently or not, with a pose in common. Its reading leaves all of them,
    /// whatever the line.
    pub fn one_part_at_one_pose(&self, members: &[usize]) -> bool {
        members.iter().all(|member| {
            let [(first, one), (other, another)] =
                [members[0], *member].map(|k| (self.shadows[k].model(), self.views[k][0]));
            one == another && first.closed == other.closed && first.faces == other.faces
        })
    }

    /// Whether a line can be used and leaves fewer than so many pairs of members; `joined` says of two places in `members`
    /// whether they are known to be left. As the verdict would say, but no longer than needed.
    pub fn leaves_fewer(
        &self,
        line: &Line,
        members: &[usize],
        enough: usize,
        joined: impl Fn(usize, usize) -> bool,
    ) -> bool {
        let mut outcomes: Vec<Outcome> = Vec::with_capacity(members.len());
        let known = (0..members.len()).map(|k| (0..k).filter(|j| joined(*j, k)).count()).sum::<usize>();
        let mut left = members.len() + 2 * known;
        for (k, &member) in members.iter().enumerate() {
            let outcome = self.outcome(line, member, 0.0, f64::INFINITY);
            if outcome.fault.is_some() {
                return false;
            }
            for (j, other) in outcomes.iter().enumerate() {
                if !joined(j, k) && !other.separated(&outcome, &self.sensor) {
                    left += 2;
                }
            }
            if left >= enough {
                return false;
            }
            outcomes.push(outcome);
        }
        true
    }

    /// The verdict on a line among the members; `None` if it can't be used.
    pub fn verdict(&self, line: &Line, members: &[usize], margin: f64) -> Option<Verdict> {
        self.outcomes(line, members, margin).ok().map(|outcomes| Verdict::new(&outcomes, &self.sensor))
    }

    /// Whether a line, everything widened by the margin, stays usable and separates all that the verdict does.
    pub fn keeps(&self, line: &Line, members: &[usize], verdict: &Verdict, margin: f64) -> bool {
        self.verdict(line, members, margin).is_some_and(|other| other.left == verdict.left)
    }

    /// The largest μ, to an eighth of m and at most 64 m, with which the verdict still separates all that it separates
    /// without, and the line stays usable.
    pub fn margin_of(&self, line: &Line, members: &[usize], verdict: &Verdict) -> f64 {
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
    pub fn expected_score(&self, line: &Line, members: &[usize], outcomes: &[Outcome], length: f64) -> f64 {
        let (mut left, mut count) = (0, 0);
        for &member in members {
            for pose in &self.samples[member] {
                let found = self.contact(member, *pose, line).filter(|found| found.depth <= length);
                let reading =
                    found.map(|found| Reading { depth: found.depth, aside: 0.0, normal: Some(found.normal) });
                left += outcomes.iter().filter(|outcome| outcome.may_answer(reading, &self.sensor)).count();
                count += 1;
            }
        }
        f64::from(left as u32) / f64::from(count.max(1))
    }

    /// The exact first contact of a member at a pose.
    pub fn contact(&self, member: usize, pose: Pose, line: &Line) -> Option<FirstContact> {
        self.shadows[member].model().first_contact(pose, line, self.sensor.tip_radius)
    }
}

/// Some of the poses, each as far as possible from those before, as the parts' extremes move.
fn spread(first: Pose, sampled: &[Pose], shadow: &Shadow, count: usize) -> Vec<Pose> {
    let size = shadow.model().size;
    let apart = |a: &Pose, b: &Pose| {
        let ends = [DVec2::ZERO, DVec2::new(size, 0.0), DVec2::new(0.0, size)];
        ends.map(|end| a.apply(end).distance(b.apply(end))).into_iter().fold(0.0, f64::max)
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
