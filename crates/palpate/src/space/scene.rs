//! Lines of space among the hypotheses of a scene.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::pose::Pose;
use super::{Model, PoseSet, Shadow};
use crate::dimension::Dimension;
use crate::feature::Feature;
use crate::judge::Outcome;
use crate::line::{FirstContact, Line};
use crate::plan::normalized;
use crate::scene::{self, Question, Scene};

/// Directions from which a hypothesis is verified; those straight at a face come on top.
const NUM_VERIFYING: usize = 64;

/// Directions are allowed if they are outside of the cone by no more, radians.
const ROUNDING: f64 = 1e-12;

impl scene::Shadow<DVec3> for Shadow {
    const SLOW: bool = true;

    fn new(poses: &PoseSet) -> Self {
        Self::new(poses)
    }

    fn model(&self) -> &Model {
        self.model()
    }

    fn ball(&self) -> (DVec3, f64) {
        (self.middle, self.radius)
    }

    fn outcome(&self, ask: &Question<'_, DVec3>) -> Outcome<DVec3> {
        self.outcome(ask, |_| false)
    }

    fn usable_outcome(&self, ask: &Question<'_, DVec3>) -> Option<Outcome<DVec3>> {
        let outcome = self.outcome(ask, |outcome| outcome.fault.is_some());
        outcome.fault.is_none().then_some(outcome)
    }
}

impl Scene<DVec3> {
    /// The line of a direction through a point. It begins on the border of the workspace, or clear of everything; `None` if
    /// it does not enter the workspace or comes from a direction that is not allowed.
    pub fn line(&self, direction: DVec3, through: DVec3) -> Option<Line<DVec3>> {
        if self.allows(direction) { self.begun(direction, through) } else { None }
    }

    /// Whether paths may go so.
    pub fn allows(&self, direction: DVec3) -> bool {
        let within = |(axis, cone)| Dimension::angle_between(axis, direction) <= cone + ROUNDING;
        self.directions.is_none_or(within)
    }

    /// Allowed directions, evenly spread: as many as would be `count` if all were (a Fibonacci lattice).
    pub fn directions(&self, count: usize) -> impl Iterator<Item = DVec3> + use<> {
        let (turn, share) = self.cone();
        let count = (count as f64 * share).ceil().max(1.0);
        let golden = PI * (3.0 - 5_f64.sqrt());
        let direction = move |k: f64| {
            let height = 1.0 - 2.0 * share * (k + 0.5) / count;
            let across = (1.0 - height * height).max(0.0).sqrt();
            let (sine, cosine) = (golden * k).sin_cos();
            turn * DVec3::new(across * cosine, across * sine, height)
        };
        std::iter::successors(Some(0.0), |k| Some(k + 1.0)).take_while(move |k| *k < count).map(direction)
    }

    /// One of the allowed directions, which are even if the two numbers are, from 0 to 1.
    pub fn drawn_direction(&self, [along, around]: [f64; 2]) -> DVec3 {
        let (turn, share) = self.cone();
        let height = 1.0 - 2.0 * share * along;
        let across = (1.0 - height * height).max(0.0).sqrt();
        let (sine, cosine) = (2.0 * PI * around).sin_cos();
        turn * DVec3::new(across * cosine, across * sine, height)
    }

    /// What turns the z axis to that of the allowed directions, and their share of all.
    fn cone(&self) -> (DQuat, f64) {
        let (axis, cone) = self.directions.unwrap_or((DVec3::Z, PI));
        let turn = DQuat::from_rotation_arc(DVec3::Z, normalized(axis).unwrap_or(DVec3::Z));
        (turn, 0.5 * (1.0 - cone.cos()))
    }

    /// What a line meets at one pose of each member; `None` if it can't be used.
    pub(super) fn met(
        &self,
        line: &Line<DVec3>,
        members: &[usize],
    ) -> Option<Vec<Option<FirstContact<DVec3>>>> {
        let of = |&member: &usize| {
            let found = self.contact(member, self.views[member][0], line);
            found.is_none_or(|found| self.is_reliable(member, line, found)).then_some(found)
        };
        members.iter().map(of).collect()
    }

    /// Ordered pairs of exact readings that may be the same, each with itself included.
    pub(super) fn num_alike(&self, met: &[Option<FirstContact<DVec3>>]) -> usize {
        let pairs = |k: usize| met[..k].iter().filter(|other| self.alike(**other, met[k])).count();
        met.len() + 2 * (0..met.len()).map(pairs).sum::<usize>()
    }

    /// Pairs that a line leaves, seen from so many views of each member at most: no judgement can be better. `None` if one of
    /// them makes it unusable.
    pub fn glance(&self, line: &Line<DVec3>, members: &[usize], num_views: usize) -> Option<usize> {
        let mut seen: Vec<Vec<Option<FirstContact<DVec3>>>> = Vec::with_capacity(members.len());
        let mut left = members.len();
        for &member in members {
            let mut contacts = Vec::new();
            for pose in self.views[member].iter().take(num_views) {
                let found = self.contact(member, *pose, line);
                if found.is_some_and(|found| !self.is_reliable(member, line, found)) {
                    return None;
                }
                contacts.push(found);
            }
            let alike = |others: &&Vec<Option<FirstContact<DVec3>>>| {
                contacts.iter().any(|a| others.iter().any(|b| self.alike(*a, *b)))
            };
            left += 2 * seen.iter().filter(alike).count();
            seen.push(contacts);
        }
        Some(left)
    }

    /// Whether no sampled pose of the members makes a line unusable.
    pub(super) fn may_be_used(&self, line: &Line<DVec3>, members: &[usize]) -> bool {
        let at = |member: usize, pose: Pose| {
            self.contact(member, pose, line).is_none_or(|found| self.is_reliable(member, line, found))
        };
        members.iter().all(|&member| self.samples[member].iter().all(|pose| at(member, *pose)))
    }

    /// Whether a first contact gives a reading, and breaks no rule.
    pub(super) fn is_reliable(&self, member: usize, line: &Line<DVec3>, found: FirstContact<DVec3>) -> bool {
        found.touchable
            && Dimension::angle_between(found.normal, -line.direction) <= self.sensor.max_incidence
            && self.unwanted(member, found.feature).is_none()
    }

    /// Whether two exact readings, either wrong by its bounds, may be the same; `None` is a miss.
    pub(super) fn alike(&self, a: Option<FirstContact<DVec3>>, b: Option<FirstContact<DVec3>>) -> bool {
        match (a, b) {
            (None, None) => true,
            (Some(a), Some(b)) => self
                .sensor
                .confuses((a.depth - b.depth).abs(), || Dimension::angle_between(a.normal, b.normal)),
            _ => false,
        }
    }
}

/// The features of contacts.
pub(super) fn features(met: &[Option<FirstContact<DVec3>>]) -> Vec<Option<Feature>> {
    met.iter().map(|met| met.map(|met| met.feature)).collect()
}

/// The convex piece of a face that holds a place of its plane, model frame.
pub(super) fn piece_at(model: &Model, face: u32, place: DVec3) -> Option<&[u32]> {
    let face = &model.faces[face as usize];
    let holds = |piece: &&Vec<u32>| {
        let corners = || piece.iter().map(|k| model.vertices[*k as usize].point);
        let mut sides = corners().zip(corners().cycle().skip(1));
        sides.all(|(a, b)| face.normal.cross(b - a).dot(place - a) >= 0.0)
    };
    face.pieces.iter().find(holds).map(Vec::as_slice)
}

/// A place in the middle of each convex piece of the faces that can be touched, with its normal, as a pose has them.
pub(super) fn places(model: &Model, pose: Pose) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    model.faces.iter().filter(|face| face.is_touchable()).flat_map(move |face| {
        face.pieces.iter().map(move |piece| {
            let corners = piece.iter().map(|k| model.vertices[*k as usize].point);
            let middle = corners.sum::<DVec3>() / piece.len() as f64;
            (pose.apply(middle), pose.rotation * face.normal)
        })
    })
}

/// At the pose with the largest slack: through places of each face, straight at it and from evenly spread directions.
pub(super) fn verifying_lines(scene: &Scene<DVec3>) -> impl Iterator<Item = Line<DVec3>> + '_ {
    places(scene.shadows[0].model(), scene.views[0][0]).flat_map(move |(place, normal)| {
        let toward = scene.directions(NUM_VERIFYING).filter(move |direction| direction.dot(normal) < 0.0);
        let directions = std::iter::once(-normal).chain(toward);
        directions.filter_map(move |direction| scene.line(direction, place))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::dvec3;

    use super::*;
    use crate::space::shapes::{cuboid, mesh};
    use crate::{Contact, Evidence, Hypothesis, Normal, PlanSettings, Sensor, Settings, recognize};

    /// A block of sides 30, 20 and 12, touched in the middle of three of them.
    fn hypotheses() -> Vec<Hypothesis<DVec3>> {
        let model = Arc::new(mesh(&cuboid(DVec3::ZERO, dvec3(30.0, 20.0, 12.0))));
        let touched = [
            (dvec3(0.0, 10.0, 6.0), -DVec3::X),
            (dvec3(15.0, 0.0, 6.0), -DVec3::Y),
            (dvec3(15.0, 10.0, 0.0), -DVec3::Z),
        ];
        let contacts = touched.map(|(at, normal)| {
            let normal = Normal::new(normal, 0.02).expect("bounds are valid");
            Contact::new(at, 0.0, 0.3).expect("bounds are valid").with_normal(normal)
        });
        let evidence = Evidence { contacts: contacts.into(), ..Evidence::default() };
        recognize(&[model], &evidence, &Settings::default()).expect("well-formed").hypotheses
    }

    fn sensor() -> Sensor {
        Sensor::new(0.01, Some(0.02), 1.0).expect("bounds are valid")
    }

    fn scene(settings: &PlanSettings<DVec3>) -> Scene<DVec3> {
        Scene::new(&hypotheses(), &sensor(), settings)
    }

    #[test]
    fn directions_are_evenly_spread_over_what_is_allowed() {
        for cone in [PI, 1.2, 0.3, 0.0] {
            let axis = dvec3(1.0, -2.0, 0.5);
            let scene = scene(&PlanSettings { directions: Some((axis, cone)), ..PlanSettings::default() });
            let count = 4000.0;
            let directions: Vec<DVec3> = scene.directions(4000).collect();
            assert_eq!(directions.len() as f64, (count * 0.5 * (1.0 - cone.cos())).ceil().max(1.0));
            for direction in &directions {
                assert!((direction.length() - 1.0).abs() < 1e-12);
                assert!(scene.line(*direction, DVec3::ZERO).is_some(), "{direction} is not allowed");
            }
            // Within half of the cone are as many as its share of the area says.
            let inner = directions.iter().filter(|one| Dimension::angle_between(axis, **one) <= 0.5 * cone);
            let share = (1.0 - (0.5 * cone).cos()) / (1.0 - cone.cos()).max(f64::MIN_POSITIVE);
            let expected = share * directions.len() as f64;
            assert!((inner.count() as f64 - expected).abs() <= 2.0 || cone == 0.0);
        }
    }

    #[test]
    fn lines_begin_on_the_border_of_the_workspace_or_clear_of_everything() {
        let (low, high) = (dvec3(-9.0, -8.0, -7.0), dvec3(9.0, 10.0, 11.0));
        let within = scene(&PlanSettings { workspace: Some([low, high]), ..PlanSettings::default() });
        let anywhere = scene(&PlanSettings::default());
        for direction in within.directions(200) {
            let through = dvec3(1.0, 2.0, 3.0);
            let line = within.line(direction, through).expect("it enters");
            assert!(line.depth_and_aside(through).1 < 1e-12 && line.depth_and_aside(through).0 > 0.0);
            let place = line.start.clamp(low, high);
            assert!(place.distance(line.start) < 1e-12);
            let room = (line.start - low).min(high - line.start).min_element();
            assert!(room.abs() < 1e-12, "{line:?} begins inside");
            let line = anywhere.line(direction, anywhere.middle).expect("all are allowed");
            assert!(line.start.distance(anywhere.middle) > anywhere.radius);
        }
        assert_eq!(within.line(DVec3::X, dvec3(0.0, 11.0, 0.0)), None);
    }

    /// Every vertex at every sampled pose is in the ball.
    #[test]
    fn the_ball_holds_all_that_is_occupied() {
        let hypotheses = hypotheses();
        let scene = Scene::new(&hypotheses, &sensor(), &PlanSettings::default());
        for one in &hypotheses {
            for pose in one.poses.sample(200, 7) {
                let placed = one.model.vertices.iter().map(|vertex| pose.apply(vertex.point));
                placed.for_each(|at| assert!(at.distance(scene.middle) <= scene.radius));
            }
        }
    }

    #[test]
    fn a_line_near_one_that_was_tried_was_tried() {
        let tried = Line { start: dvec3(5.0, 1.0, 0.5), direction: -DVec3::X };
        let scene = scene(&PlanSettings { tried: vec![tried], ..PlanSettings::default() });
        let m = scene.margin;
        let shifted = |by: DVec3| Line { start: tried.start + by, ..tried };
        assert!(scene.was_tried(&shifted(dvec3(3.0, 0.6 * m, 0.6 * m))));
        assert!(!scene.was_tried(&shifted(dvec3(0.0, 0.8 * m, 0.8 * m))));
        let turned = |angle: f64| {
            let direction = DQuat::from_axis_angle(DVec3::Y, angle) * tried.direction;
            let foot = tried.at(tried.direction.dot(scene.middle - tried.start));
            Line { start: foot - direction, direction }
        };
        assert!(scene.was_tried(&turned(0.4 * m / scene.size)));
        assert!(!scene.was_tried(&turned(1.1 * m / scene.size)));
    }

    #[test]
    fn a_workspace_inside_of_the_part_is_noticed() {
        let hypotheses = hypotheses();
        let truth = hypotheses.iter().position(|one| one.poses.contains(Pose::IDENTITY)).expect("the truth");
        let begins_inside = |half: f64| {
            let (at, half) = (dvec3(15.0, 10.0, 6.0), DVec3::splat(half));
            let settings =
                PlanSettings { workspace: Some([at - half, at + half]), ..PlanSettings::default() };
            Scene::new(&hypotheses, &sensor(), &settings).begins_inside(&[truth])
        };
        assert!(begins_inside(1.0));
        assert!(!begins_inside(6.5) && !begins_inside(100.0));
    }
}
