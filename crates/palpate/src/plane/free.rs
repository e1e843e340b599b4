//! Free space as evidence: what a tip swept without touching can't hold the part (DESIGN §2, MATH 2.1.1).

use glam::DVec2;

use super::case::PivotPose;
use super::model::{Model, Surface};
use crate::contact::Evidence;

/// A swept segment, from the pivot, world frame, and the distance that the part keeps from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep {
    start: DVec2,
    end: DVec2,
    /// A pose is excluded iff the signed distance of some swept point to the part is smaller.
    clearance: f64,
}

impl Sweep {
    /// Of every miss, and of every contact that says where its move began.
    ///
    /// A contact's own sweep ends its position error short of the centre. The true centre may be off the sensed one
    /// by that error, hence so may the line on which the tip came: it counts as the path error.
    pub fn all(evidence: &Evidence, model: &Model, pivot: DVec2) -> Vec<Self> {
        let misses = evidence.misses.iter().map(|miss| Self {
            start: miss.start - pivot,
            end: miss.end - pivot,
            clearance: miss.tip_radius - miss.path_error - model.position_slack,
        });
        let approaches = evidence.contacts.iter().filter_map(|contact| {
            let start = contact.start?;
            let way = contact.center - start;
            let short = way.length() - contact.position_error;
            (short > 0.0).then(|| Self {
                start: start - pivot,
                end: start - pivot + way * (short / way.length()),
                clearance: contact.tip_radius - contact.position_error - model.position_slack,
            })
        });
        misses.chain(approaches).collect()
    }

    /// Whether every point of the sweep keeps its distance at `pose`, within `slack`.
    pub fn free(&self, model: &Model, pose: PivotPose, slack: f64) -> bool {
        !self.intrudes(model, pose, -slack)
    }

    /// Whether some point of the sweep is nearer than the clearance plus `extra`.
    ///
    /// The distance to the part is 1-Lipschitz: a piece of the sweep whose middle is further than its half length
    /// beyond the clearance is free. Decided up to 1e-9 of the part, in favour of the pose.
    pub fn intrudes(&self, model: &Model, pose: PivotPose, extra: f64) -> bool {
        let turn = DVec2::from_angle(-pose.angle);
        let [start, end] = [self.start, self.end].map(|point| pose.y + turn.rotate(point));
        let clearance = self.clearance + extra;
        let finest = 1e-9 * model.size;
        let mut pieces = vec![(0.0, 1.0)];
        while let Some((from, to)) = pieces.pop() {
            let distance = signed_distance(model, start.lerp(end, 0.5 * (from + to)));
            let half_length = 0.5 * (to - from) * start.distance(end);
            if distance < clearance {
                return true;
            }
            if distance - half_length < clearance && half_length > finest {
                let middle = 0.5 * (from + to);
                pieces.extend([(from, middle), (middle, to)]);
            }
        }
        false
    }

    /// The largest distance of a swept point from the pivot.
    pub fn reach(&self) -> f64 {
        self.start.length().max(self.end.length())
    }
}

/// Distance to the outline, negative inside a closed model.
fn signed_distance(model: &Model, point: DVec2) -> f64 {
    let mut nearest_sq = f64::INFINITY;
    let mut inside = false;
    for face in model.faces.iter().filter(|face| face.surface != Surface::Seam) {
        let span = face.end - face.start;
        let offset = point - face.start;
        let t = (offset.dot(span) / span.length_squared()).clamp(0.0, 1.0);
        nearest_sq = nearest_sq.min((offset - t * span).length_squared());
        if (face.start.y > point.y) != (face.end.y > point.y) {
            let crossing = face.start.x + (point.y - face.start.y) / span.y * span.x;
            inside ^= point.x < crossing;
        }
    }
    let distance = nearest_sq.sqrt();
    if model.closed && inside { -distance } else { distance }
}
