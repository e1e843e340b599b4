//! One model against the evidence, in the coordinates in which pose sets are computed.
//!
//! A pose is written `(θ, y)`: the rotation, and the model point `y` that is placed at the *pivot*, a world point
//! in the middle of the contacts. The world point `pivot + c` is then the model point `y + R(−θ)c`: features stay
//! where they are, levers `c` have the size of the data, and at one θ every condition is a condition on `y`.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc as Shared;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec2;

use super::arc::Arc;
use super::model::Model;
use super::pose::Pose;
use super::site::Site;
use crate::contact::{Contact, Evidence, GRAZING, Prior};
use crate::feature::Feature;
use crate::recognize::{Halt, Limit};
use crate::sweep::Sweep;

/// A pose as rotation and the model point at the pivot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PivotPose {
    pub angle: f64,
    pub y: DVec2,
}

impl PivotPose {
    /// Where a world point, given from the pivot, lies in the model's frame.
    pub fn place(self, lever: DVec2) -> DVec2 {
        self.y + DVec2::from_angle(-self.angle).rotate(lever)
    }
}

/// A contact as seen from the pivot, the model's slacks added to its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Datum {
    /// Sensed centre of the tip from the pivot, world frame.
    pub lever: DVec2,
    /// Its bound: position error and position slack.
    pub bound: f64,
    /// Radius of the tip.
    pub radius: f64,
    /// The outward normals that the reading allows, world frame; `None`: nothing is known of it.
    pub normals: Option<Arc>,
    /// The sensed normals alone.
    sensed: Option<Arc>,
    /// The normals that the direction of travel allows.
    facing: Option<Arc>,
}

impl Datum {
    /// The sensed normals: the reading and its bound.
    pub fn sensed(&self) -> Option<Arc> {
        self.sensed
    }

    /// The same datum with the bounds of its reading multiplied by `share`.
    fn scaled(self, share: f64) -> Self {
        let sensed = self.sensed.map(|sensed| Arc::around(sensed.middle(), share * sensed.half_width()));
        Self { bound: share * self.bound, sensed, normals: both(sensed, self.facing), ..self }
    }
}

/// A model, the evidence, and the tolerances.
#[derive(Debug)]
pub(crate) struct Case {
    pub model: Shared<Model>,
    pub data: Vec<Datum>,
    pub pivot: DVec2,
    pub prior: Option<Prior>,
    pub sweeps: Vec<Sweep<DVec2>>,
    /// Half of τ, a length: a pose is kept if it is valid with every bound enlarged by it. What is asked of a pose
    /// later allows for all of τ, so that rounding in between does not matter.
    pub length_tolerance: f64,
    /// The same as an angle: half of τ over the size of the part.
    pub angle_tolerance: f64,
    /// Bounds every coordinate that occurs; rounding is measured in it.
    pub scale: f64,
    stop: Halt,
    /// Boxes of poses that are examined at most, if that is given.
    pub effort: Option<u64>,
}

/// Outward rounding: computed bounds are wider by this share of the scale, some 10⁴ units of rounding.
const OUTWARD: f64 = 1e-12;

/// The share of the part's own size, in angle or length, by which a bound may be missed through rounding alone.
const ROUNDING: f64 = 1e-10;

impl Case {
    /// `tolerance` is relative to the part's size.
    pub fn new(model: &Shared<Model>, evidence: &Evidence, tolerance: f64) -> Self {
        let pivot = middle(&evidence.contacts, evidence.prior);
        // Without a prior one assignment stands for all that the symmetries take it to, up to what they miss.
        let (miss, turn) = if evidence.prior.is_none() { model.asymmetry } else { (0.0, 0.0) };
        let slacks = (model.position_slack + miss, model.normal_slack + turn);
        let data: Vec<Datum> =
            evidence.contacts.iter().map(|contact| datum(contact, slacks, pivot)).collect();
        let sweeps = Sweep::all(evidence, model.size, slacks.0, pivot);
        let reach = |points: &mut dyn Iterator<Item = DVec2>| points.map(DVec2::length).fold(0.0, f64::max);
        let own_scale = model.size
            + reach(&mut model.faces.iter().flat_map(|face| [face.start, face.end]))
            + sweeps.iter().map(Sweep::reach).fold(0.0, f64::max)
            + data.iter().map(|datum| datum.lever.length() + datum.bound + datum.radius).fold(0.0, f64::max);
        let says_nothing = |prior: &Prior| prior.translation == f64::INFINITY && prior.rotation >= PI;
        let prior =
            evidence.prior.map(|prior| bounded(prior, pivot, own_scale)).filter(|one| !says_nothing(one));
        let scale = own_scale
            + prior
                .filter(|prior| prior.translation.is_finite())
                .map_or(0.0, |prior| prior.translation + prior.world_from_model.translation.distance(pivot));
        Self {
            model: Shared::clone(model),
            data,
            pivot,
            prior,
            sweeps,
            length_tolerance: 0.5 * tolerance * model.size,
            angle_tolerance: 0.5 * tolerance,
            scale,
            stop: Halt::default(),
            effort: None,
        }
    }

    /// The same case, whose searches are given up when `stop` is set, and divide no more boxes than `effort`.
    pub fn until(self, stop: &Halt, effort: Option<u64>) -> Self {
        Self { stop: Halt::clone(stop), effort, ..self }
    }

    /// Whether searches are to be given up: the limit that says so.
    pub fn late(&self) -> Option<Limit> {
        self.stop.load(Relaxed).then_some(Limit::Time)
    }

    /// What tells searches to be given up.
    pub fn halt(&self) -> &Halt {
        &self.stop
    }

    /// The same case with the bounds of every reading multiplied by `share`.
    pub fn scaled(&self, share: f64) -> Self {
        Self {
            model: Shared::clone(&self.model),
            data: self.data.iter().map(|datum| datum.scaled(share)).collect(),
            sweeps: self.sweeps.clone(),
            stop: Halt::clone(&self.stop),
            ..*self
        }
    }

    /// Whether each contact's normal and approach leave a normal.
    pub fn consistent(&self) -> bool {
        self.data.iter().all(|datum| match (datum.sensed, datum.facing) {
            (Some(sensed), Some(facing)) => !shared(sensed, facing).is_empty(),
            _ => true,
        })
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
        PivotPose { angle: world_from_model.angle(), y }
    }

    pub fn pose(&self, pose: PivotPose) -> Pose {
        let rotation = DVec2::from_angle(pose.angle);
        Pose { rotation, translation: self.pivot - rotation.rotate(pose.y) }
    }

    /// Where contact `i` lies in the model's frame.
    pub fn place(&self, contact: usize, pose: PivotPose) -> DVec2 {
        pose.place(self.data[contact].lever)
    }

    /// The site of `feature` for the tip of contact `i`.
    pub fn site(&self, contact: usize, feature: Feature) -> Option<Site> {
        Site::new(&self.model, feature, self.data[contact].radius)
    }

    /// The rotations that bring a normal of the site to contact `i`'s, within `slack` more than its bound.
    pub fn rotations(&self, contact: usize, site: &Site, slack: f64) -> Arc {
        site.rotations(self.data[contact].normals.map(|normals| normals.widen(slack)))
    }

    /// By how much contact `i` misses the site at `pose`: a length beyond its bound. Infinite where the normals,
    /// widened by `slack`, exclude it.
    pub fn excess(&self, contact: usize, site: &Site, pose: PivotPose, slack: f64) -> f64 {
        let datum = &self.data[contact];
        let ranges = [datum.sensed, datum.facing].map(|range| range.map(|range| range.widen(slack)));
        if ranges.iter().any(|range| site.rotations(*range).distance(pose.angle) > 0.0) {
            return f64::INFINITY;
        }
        let [sensed, facing] = ranges.map(|range| range.map(|range| range.turn(-pose.angle)));
        let x = self.place(contact, pose);
        let distance = |site: &Site| site.nearest(x).distance(x);
        let parts = site.restrict(sensed).into_iter().flat_map(|part| part.restrict(facing));
        parts.map(|part| distance(&part)).fold(f64::INFINITY, f64::min) - datum.bound
    }

    /// By how much the prior is missed: the larger of the excess in translation and in rotation times the size.
    pub fn prior_excess(&self, pose: PivotPose) -> f64 {
        self.prior.map_or(f64::NEG_INFINITY, |prior| {
            let offset = self.pose(pose).translation - prior.world_from_model.translation;
            let turn = super::arc::wrap(pose.angle - prior.world_from_model.angle()).abs();
            let translation = offset.abs().max_element() - prior.translation;
            translation.max((turn - prior.rotation) * self.model.size)
        })
    }

    /// Whether prior and free sweeps allow the pose, within `slack`.
    pub fn allows(&self, pose: PivotPose, slack: f64) -> bool {
        self.prior_excess(pose) <= slack
            && self.sweeps.iter().all(|sweep| sweep.free(&self.model, pose, slack))
    }
}

/// A box of translations that holds every pose that touches a contact says nothing: it is left out, so that its size
/// does not count as a coordinate.
fn bounded(prior: Prior, pivot: DVec2, scale: f64) -> Prior {
    let farthest = prior.world_from_model.translation.distance(pivot) + 4.0 * scale;
    let translation = if prior.translation > farthest { f64::INFINITY } else { prior.translation };
    Prior { translation, ..prior }
}

/// The middle of the contacts' bounding box; with none, of the prior.
fn middle(contacts: &[Contact], prior: Option<Prior>) -> DVec2 {
    let mut centers = contacts.iter().map(|contact| contact.center);
    let Some(first) = centers.next() else {
        return prior.map_or(DVec2::ZERO, |prior| prior.world_from_model.translation);
    };
    let (low, high) = centers.fold((first, first), |(low, high), at| (low.min(at), high.max(at)));
    0.5 * (low + high)
}

fn datum(contact: &Contact, (position_slack, normal_slack): (f64, f64), pivot: DVec2) -> Datum {
    let sensed =
        contact.normal.map(|normal| Arc::around(normal.direction.to_angle(), normal.error + normal_slack));
    // −approach·n ≥ 0: the normal is within a quarter turn of the way back.
    let facing =
        contact.approach.map(|approach| Arc::around((-approach).to_angle(), FRAC_PI_2 + normal_slack));
    Datum {
        lever: contact.center - pivot,
        bound: contact.position_error + position_slack,
        radius: contact.tip_radius,
        normals: both(sensed, facing),
        sensed,
        facing,
    }
}

fn shared(sensed: Arc, facing: Arc) -> arrayvec::ArrayVec<Arc, 2> {
    sensed.widen(GRAZING).intersect(facing.widen(GRAZING))
}

/// The normals that both allow, as one arc; [`Case::excess`] asks each of the two.
fn both(sensed: Option<Arc>, facing: Option<Arc>) -> Option<Arc> {
    match (sensed, facing) {
        (Some(sensed), Some(facing)) => {
            let shared = shared(sensed, facing);
            // Two arcs: all of one that holds both. None: such a case is not consistent, and nothing explains it.
            Some(if shared.len() == 1 { shared[0] } else { sensed })
        }
        (sensed, facing) => sensed.or(facing),
    }
}
