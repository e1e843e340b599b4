//! Free space as evidence: what a tip swept freely is not inside the part (DESIGN §2).

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
