//! One model against the evidence, in the coordinates in which pose sets are computed.
//!
//! A pose is written `(S, y)`: `S` turns world directions into the model's frame, and `y` is the model point that is
//! placed at the *pivot*, a world point in the middle of the contacts. The world point `pivot + c` is then the model
//! point `y + S c`: features stay where they are, and levers `c` have the size of the data.

use std::f64::consts::PI;
use std::sync::Arc as Shared;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DMat3, DVec3};

use super::model::Model;
use super::pose::{self, Pose};
use super::prior::Prior;
use super::site::{Reading, Site, Sites, angle};
use crate::contact::{Contact, Evidence};
use crate::feature::Feature;
use crate::recognize::{Halt, Limit, Settings};
use crate::sweep::Sweep;

/// A pose as the rotation into the model's frame and the model point at the pivot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PivotPose {
    pub rotation: DMat3,
    pub y: DVec3,
}

impl PivotPose {
    /// Where a world point, given from the pivot, lies in the model's frame.
    pub fn place(self, lever: DVec3) -> DVec3 {
        self.y + self.rotation * lever
    }
}

/// A contact as seen from the pivot, the model's slacks added to its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Datum {
    /// Sensed centre of the tip from the pivot, world frame.
    pub lever: DVec3,
    /// Its bound: position error and position slack.
    pub bound: f64,
    /// Radius of the tip.
    pub radius: f64,
    /// The outward normals that the reading allows, world frame.
    pub reading: Reading,
}

/// A model, the evidence, and the tolerances.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub model: Shared<Model>,
    pub data: Vec<Datum>,
    pub pivot: DVec3,
    pub prior: Option<Prior>,
    pub sweeps: Vec<Sweep<DVec3>>,
    /// Half of τ, a length: a pose is kept if it is valid with every bound enlarged by it. What is asked of a pose
    /// later allows for all of τ, so that rounding in between does not matter.
    pub length_tolerance: f64,
    /// The same as an angle: half of τ over the size of the part.
    pub angle_tolerance: f64,
    /// Bounds every coordinate that occurs; rounding is measured in it.
    pub scale: f64,
    stop: Halt,
    /// Cells of poses that are examined at most, if that is given.
    pub effort: Option<u64>,
}

/// Outward rounding: computed bounds are wider by this share of the scale, some 10⁴ units of rounding.
const OUTWARD: f64 = 1e-12;

/// The share of the part's own size, in angle or length, by which a bound may be missed through rounding alone.
const ROUNDING: f64 = 1e-10;

impl Case {
    pub fn new(model: &Shared<Model>, evidence: &Evidence<DVec3>, settings: &Settings, stop: &Halt) -> Self {
        let tolerance = settings.tolerance;
        let pivot = middle(&evidence.contacts);
        let slacks = (model.position_slack, model.normal_slack);
        let data: Vec<Datum> =
            evidence.contacts.iter().map(|contact| datum(contact, slacks, pivot)).collect();
        let sweeps = Sweep::all(evidence, model.size, slacks.0, pivot);
        let reach = |points: &mut dyn Iterator<Item = DVec3>| points.map(DVec3::length).fold(0.0, f64::max);
        let scale = model.size
            + reach(&mut model.vertices.iter().map(|vertex| vertex.point))
            + sweeps.iter().map(Sweep::reach).fold(0.0, f64::max)
            + data.iter().map(|datum| datum.lever.length() + datum.bound + datum.radius).fold(0.0, f64::max);
        let case = Self {
            model: Shared::clone(model),
            data,
            pivot,
            prior: evidence.prior,
            sweeps,
            length_tolerance: 0.5 * tolerance * model.size,
            angle_tolerance: 0.5 * tolerance,
            scale,
            stop: Halt::clone(stop),
            effort: settings.effort,
        };
        // Without a prior one assignment stands for all that the symmetries take it to.
        case.of_images()
    }

    /// The same case, whose searches go on, and which takes the images of what is valid for valid.
    pub fn of_answers(&self) -> Self {
        Self { stop: Halt::default(), ..self.of_images() }
    }

    /// The case in which the images of poses are valid that are in this one: with its bounds enlarged by what the symmetries
    /// miss. With a prior each pose stands for itself.
    fn of_images(&self) -> Self {
        let mut case = self.clone();
        if case.prior.is_some() {
            return case;
        }
        let (miss, turn) = case.model.asymmetry;
        for datum in &mut case.data {
            // A tip's centre is turned about the point where it rests.
            datum.bound += miss + 2.0 * datum.radius * (0.5 * turn).sin();
            let Reading { sensed, facing } = &mut datum.reading;
            sensed.iter_mut().chain(facing).for_each(|(_, error)| *error += turn);
        }
        case.sweeps.iter_mut().for_each(|sweep| sweep.clearance -= miss);
        case
    }

    /// Whether searches are to be given up.
    pub fn stopped(&self) -> bool {
        self.stop.load(Relaxed)
    }

    /// The same, as the limit that says so.
    pub fn late(&self) -> Option<Limit> {
        self.stopped().then_some(Limit::Time)
    }

    /// What tells searches to be given up.
    pub fn halt(&self) -> &Halt {
        &self.stop
    }

    /// A length that covers all rounding in this case.
    pub fn outward(&self) -> f64 {
        OUTWARD * self.scale
    }

    /// A length by which rounding alone may miss a bound.
    pub fn rounding(&self) -> f64 {
        (ROUNDING * self.scale).min(0.5 * self.length_tolerance)
    }

    pub fn pivot_pose(&self, world_from_model: Pose) -> PivotPose {
        let y = world_from_model.inverse().apply(self.pivot);
        PivotPose { rotation: world_from_model.rotation.transpose(), y }
    }

    pub fn pose(&self, pose: PivotPose) -> Pose {
        let rotation = pose.rotation.transpose();
        Pose { rotation, translation: self.pivot - rotation * pose.y }
    }

    /// The sites of `feature` for the tip of contact `i`.
    pub fn sites(&self, contact: usize, feature: Feature) -> Vec<Site> {
        Site::all(&self.model, feature, self.data[contact].radius)
    }

    /// The sites of each contact's features. Contacts of one radius that have the same features share them.
    pub fn sites_of<'b>(&self, pairs: impl Iterator<Item = (usize, &'b [Feature])>) -> Vec<(usize, Sites)> {
        let mut known: Vec<(usize, &[Feature], Sites)> = Vec::new();
        let of_contact = |(contact, features): (usize, &'b [Feature])| {
            let radius = |contact: usize| self.data[contact].radius;
            let alike = |(other, others, _): &&(usize, &[Feature], _)| {
                radius(*other) == radius(contact) && *others == features
            };
            let sites = match known.iter().find(alike) {
                Some((_, _, sites)) => Shared::clone(sites),
                None => features.iter().flat_map(|feature| self.sites(contact, *feature)).collect(),
            };
            known.push((contact, features, Shared::clone(&sites)));
            (contact, sites)
        };
        pairs.map(of_contact).collect()
    }

    /// By how much contact `i` misses the nearest of the sites at `pose`: a length beyond its bound. Infinite where the
    /// normals, widened by `slack`, exclude all of them.
    pub fn excess(&self, contact: usize, sites: &[Site], pose: PivotPose, slack: f64) -> f64 {
        let datum = &self.data[contact];
        let caps = datum.reading.caps(slack, |axis| pose.rotation * axis);
        let place = pose.place(datum.lever);
        sites.iter().map(|site| site.distance(place, &caps)).fold(f64::INFINITY, f64::min) - datum.bound
    }

    /// By how much the prior is missed: the larger of the excess in translation and in rotation times the size.
    pub fn prior_excess(&self, pose: PivotPose) -> f64 {
        let Some(prior) = self.prior else { return f64::NEG_INFINITY };
        let pose = self.pose(pose);
        let offset = pose.translation - prior.world_from_model.translation;
        let turn = pose.rotation * prior.world_from_model.rotation.transpose();
        let size = self.model.size;
        match prior.lying {
            None => (offset.abs().max_element() - prior.translation)
                .max((pose::angle(turn) - prior.rotation) * size),
            Some(lying) => {
                let height = offset.dot(lying.normal);
                let along = (offset - height * lying.normal).length();
                let (tilt, twist) = tilt_and_twist(turn, lying.normal);
                (along - prior.translation)
                    .max(height.abs() - lying.height)
                    .max((tilt - lying.tilt) * size)
                    .max((twist.abs() - prior.rotation) * size)
            }
        }
    }

    /// No two rotations that the prior allows, within τ, differ by more, radians.
    pub fn most_turn(&self) -> f64 {
        let around = |prior: Prior| prior.rotation + prior.lying.map_or(0.0, |lying| lying.tilt);
        self.prior.map_or(PI, |prior| (2.0 * (around(prior) + 4.0 * self.angle_tolerance)).min(PI))
    }

    /// Whether prior and free sweeps allow the pose, within `slack`.
    pub fn allows(&self, pose: PivotPose, slack: f64) -> bool {
        self.prior_excess(pose) <= slack
            && self.sweeps.iter().all(|sweep| sweep.free(&self.model, pose, slack))
    }
}

/// A rotation as a tilt of `normal` followed by a turn about it, radians.
pub(crate) fn tilt_and_twist(rotation: DMat3, normal: DVec3) -> (f64, f64) {
    let turn = glam::DQuat::from_mat3(&rotation);
    let along = DVec3::new(turn.x, turn.y, turn.z).dot(normal);
    let twist = 2.0 * along.atan2(turn.w);
    let twist = twist - std::f64::consts::TAU * (twist / std::f64::consts::TAU).round();
    (angle(rotation * normal, normal), twist)
}

/// The middle of the contacts' bounding box.
fn middle(contacts: &[Contact<DVec3>]) -> DVec3 {
    let mut centers = contacts.iter().map(|contact| contact.center);
    let first = centers.next().unwrap_or_default();
    let (low, high) = centers.fold((first, first), |(low, high), at| (low.min(at), high.max(at)));
    0.5 * (low + high)
}

fn datum(contact: &Contact<DVec3>, (position_slack, normal_slack): (f64, f64), pivot: DVec3) -> Datum {
    let sensed = contact.normal.map(|normal| (normal.direction, normal.error + normal_slack));
    let facing = contact.approach.map(|approach| (-approach, normal_slack));
    Datum {
        lever: contact.center - pivot,
        bound: contact.position_error + position_slack,
        radius: contact.tip_radius,
        reading: Reading { sensed, facing },
    }
}
