//! Free space as evidence: what a tip swept freely is not inside the part (DESIGN §2).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::case::PivotPose;
use super::model::Model;
use crate::sweep::Sweep;

/// Points of a sweep that are examined for a depth inside the part, at most.
const MOST_EXAMINED: usize = 2000;

impl Sweep<DVec3> {
    /// Whether every point of the sweep keeps its distance at `pose`, within `slack`.
    pub fn free(&self, model: &Model, pose: PivotPose, slack: f64) -> bool {
        !self.intrudes(model, pose, -slack)
    }

    /// Whether some point of the sweep is nearer than the clearance plus `extra`.
    ///
    /// Depths inside the part are examined point by point: the distance changes no faster than the point moves, so that a
    /// stretch is clear if its middle is by half its length. The stretch that may be deepest comes first (Piyavskii 1972), so
    /// that more clearance never hides what less of it finds. Where that is not decided, the sweep is taken for free.
    pub fn intrudes(&self, model: &Model, pose: PivotPose, extra: f64) -> bool {
        let least = self.clearance + extra;
        if !model.closed && least <= 0.0 {
            return false;
        }
        let (start, end) = (pose.place(self.start), pose.place(self.end));
        let length = start.distance(end);
        let finest = 1e-9 * model.size;
        let mut open = BinaryHeap::from([Stretch { lowest: f64::NEG_INFINITY, from: 0.0, to: 1.0 }]);
        for _ in 0..MOST_EXAMINED {
            let Some(Stretch { from, to, .. }) = open.pop() else { return false };
            let middle = 0.5 * (from + to);
            let distance = model.signed_distance(start.lerp(end, middle));
            if distance < least {
                return true;
            }
            let half = 0.5 * (to - from) * length;
            let lowest = distance - half;
            if lowest < least && half > finest {
                open.extend([(middle, to), (from, middle)].map(|(from, to)| Stretch { lowest, from, to }));
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

/// A stretch of a sweep, from 0 to 1, none of whose points is nearer than `lowest`. The lowest is the greatest.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    lowest: f64,
    from: f64,
    to: f64,
}

impl Ord for Stretch {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lowest.total_cmp(&self.lowest).then(other.from.total_cmp(&self.from))
    }
}

impl PartialOrd for Stretch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Stretch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Stretch {}

#[cfg(test)]
mod tests {
    use glam::{DMat3, dvec2, dvec3};

    use super::*;
    use crate::space::shapes::{extruded, mesh};

    /// Over the lower step the sweep is as deep as it may be, but for a hair; in the higher one it is far too deep.
    #[test]
    fn a_long_stretch_near_the_bound_hides_nothing() {
        let steps = [(0.0, 0.0), (30.0, 0.0), (30.0, 20.0), (20.0, 20.0), (20.0, 12.0), (0.0, 12.0)];
        let model = mesh(&extruded(&[steps.map(|(x, y)| dvec2(x, y)).to_vec()], 40.0));
        let pose = PivotPose { rotation: DMat3::IDENTITY, y: DVec3::ZERO };
        for hair in [1e-12, 1e-9, 1e-6] {
            let depth = |end: f64| Sweep {
                start: dvec3(1.0, 11.9 + hair, 20.0),
                end: dvec3(end, 11.9 + hair, 20.0),
                clearance: -0.1,
            };
            assert!(depth(28.0).intrudes(&model, pose, 0.0));
            assert!(!depth(18.0).intrudes(&model, pose, 0.0));
            assert!(depth(18.0).intrudes(&model, pose, 2.0 * hair));
        }
    }
}
