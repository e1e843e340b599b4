//! Free space as evidence: what a tip swept freely is not inside the part (DESIGN §2).

use glam::DVec3;

use super::case::PivotPose;
use super::model::Model;
use crate::contact::Evidence;

/// A segment, from the pivot, along which the centre of a tip moved freely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sweep {
    start: DVec3,
    end: DVec3,
    /// Every point of it is at least this far outside the part; below zero: no further inside.
    clearance: f64,
}

/// Points of a sweep that are examined for a depth inside the part, at most.
const MOST_EXAMINED: usize = 2000;

impl Sweep {
    /// Of misses, and of the ways to contacts: these end their position error short of the centre, which counts as
    /// their path error.
    pub fn all(evidence: &Evidence<DVec3>, model: &Model, slack: f64, pivot: DVec3) -> Vec<Self> {
        let misses = evidence.misses.iter().map(|miss| Self {
            start: miss.start - pivot,
            end: miss.end - pivot,
            clearance: miss.tip_radius - miss.path_error - slack,
        });
        let approaches = evidence.contacts.iter().filter_map(|contact| {
            let start = contact.start?;
            let way = contact.center - start;
            let short = way.length() - contact.position_error;
            (short > 0.0).then(|| Self {
                start: start - pivot,
                end: start - pivot + way * (short / way.length()),
                clearance: contact.tip_radius - contact.position_error - slack,
            })
        });
        let near = evidence.contacts.first().map(|contact| {
            let reach = model.size + contact.position_error + contact.tip_radius + slack;
            (contact.center - pivot, 1.01 * reach)
        });
        let all = misses.chain(approaches);
        all.filter_map(|sweep| near.map_or(Some(sweep), |(at, reach)| sweep.clipped(at, reach))).collect()
    }

    /// The part of it that may come near a model within `reach` of a place; `None` if it comes nowhere near.
    fn clipped(self, place: DVec3, reach: f64) -> Option<Self> {
        let reach = reach + self.clearance.max(0.0);
        let way = self.end - self.start;
        let length = way.length();
        let Some(along) = way.try_normalize() else {
            return (self.start.distance(place) <= reach).then_some(self);
        };
        let foot = along.dot(place - self.start);
        let aside = (place - self.start - foot * along).length();
        let half = (reach * reach - aside * aside).max(0.0).sqrt();
        let (from, to) = ((foot - half).max(0.0), (foot + half).min(length));
        let at = |t: f64| if t >= length { self.end } else { self.start + t * along };
        (aside <= reach && from <= to).then(|| Self { start: at(from), end: at(to), ..self })
    }

    /// The farthest of it from the pivot.
    pub fn reach(&self) -> f64 {
        self.start.length().max(self.end.length())
    }

    /// Whether every point of the sweep keeps its distance at `pose`, within `slack`.
    pub fn free(&self, model: &Model, pose: PivotPose, slack: f64) -> bool {
        !self.intrudes(model, pose, -slack)
    }

    /// Whether some point of the sweep is nearer than the clearance plus `extra`.
    ///
    /// Depths inside the part are examined point by point: the distance changes no faster than the point moves, so that a
    /// stretch is clear if its middle is by half its length. Where that is not decided, the sweep is taken for free.
    pub fn intrudes(&self, model: &Model, pose: PivotPose, extra: f64) -> bool {
        let least = self.clearance + extra;
        if !model.closed && least <= 0.0 {
            return false;
        }
        let (start, end) = (pose.place(self.start), pose.place(self.end));
        let mut open = vec![(0.0, 1.0)];
        let length = start.distance(end);
        let finest = 1e-9 * model.size;
        for _ in 0..MOST_EXAMINED {
            let Some((from, to)) = open.pop() else { return false };
            let middle = 0.5 * (from + to);
            let distance = model.signed_distance(start.lerp(end, middle));
            if distance < least {
                return true;
            }
            let half = 0.5 * (to - from) * length;
            if distance - half < least && half > finest {
                open.extend([(middle, to), (from, middle)]);
            }
        }
        false
    }

    /// Where on the sweep the part is nearest or deepest, by how much it falls short of the clearance: a measure.
    pub fn intrusion(&self, model: &Model, pose: PivotPose) -> f64 {
        let (start, end) = (pose.place(self.start), pose.place(self.end));
        let at = |k: u32| model.signed_distance(start.lerp(end, f64::from(k) / 16.0));
        self.clearance - (0..=16).map(at).fold(f64::INFINITY, f64::min)
    }
}
