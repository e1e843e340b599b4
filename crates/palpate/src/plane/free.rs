//! Free space as evidence: what a tip swept without touching can't hold the part (DESIGN §2, MATH 2.1.1).

use glam::DVec2;

use super::case::PivotPose;
use super::distance::{crossing, segment_to_segment, to_segment};
use super::model::{Face, Model, Surface};
use crate::contact::Evidence;

/// A swept segment, from the pivot, world frame, and the distance that the part keeps from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep {
    start: DVec2,
    end: DVec2,
    /// A pose is excluded iff the signed distance of some swept point to the part is smaller.
    clearance: f64,
}

/// A swept point, and the face on whose outer side it must stay: `normal · (y + R(−θ) lever) >= height`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wall {
    pub lever: DVec2,
    pub normal: DVec2,
    pub height: f64,
}

/// Points at which an intrusion is measured first, less one.
const NUM_SAMPLES: u32 = 24;

/// Steps by which the worst of them is refined.
const NUM_THIRDS: u32 = 24;

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
    pub fn intrudes(&self, model: &Model, pose: PivotPose, extra: f64) -> bool {
        let turn = DVec2::from_angle(-pose.angle);
        let path = [self.start, self.end].map(|point| pose.y + turn.rotate(point));
        let clearance = self.clearance + extra;
        if clearance > 0.0 {
            let near = |face: &Face| segment_to_segment(path, [face.start, face.end]) < clearance;
            return solid(model).any(near) || inside(model, path[0]);
        }
        model.closed && deeper(model, path, -clearance)
    }

    /// By how much the clearance is missed at the worst of some points of the sweep, chosen where it is worst, and that
    /// point: a measure of how far a pose is from being free, not a bound.
    pub fn intrusion(&self, model: &Model, pose: PivotPose) -> (f64, DVec2) {
        let turn = DVec2::from_angle(-pose.angle);
        let depth = |lever: DVec2| {
            let point = pose.y + turn.rotate(lever);
            let [nearest, _] = nearest_faces(model, point);
            if inside(model, point) { nearest.0 } else { -nearest.0 }
        };
        let at = |t: f64| self.start.lerp(self.end, t);
        let step = 1.0 / f64::from(NUM_SAMPLES);
        let coarse = (0..=NUM_SAMPLES).map(|k| step * f64::from(k)).map(|t| (depth(at(t)), t));
        let best = coarse.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 1.0));
        // Between its neighbours the depth mostly rises to one maximum: thirds are left out on the lower side.
        let (mut low, mut high) = ((best.1 - step).max(0.0), (best.1 + step).min(1.0));
        for _ in 0..NUM_THIRDS {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if depth(at(left)) < depth(at(right)) { low = left } else { high = right }
        }
        let refined = 0.5 * (low + high);
        let best = [best, (depth(at(refined)), refined)].into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let best = best.map_or((0.0, self.end), |(depth, t)| (depth, at(t)));
        (self.clearance + best.0, best.1)
    }

    fn samples(&self) -> impl Iterator<Item = DVec2> + use<> {
        let Self { start, end, .. } = *self;
        (0..=NUM_SAMPLES).map(move |step| start.lerp(end, f64::from(step) / f64::from(NUM_SAMPLES)))
    }

    /// The wall of the sampled point that intrudes most at `pose`, among those that are nearer to one face than to any
    /// other at every pose of a cell around `middle`, in which a point at a lever moves by no more than `motion`.
    pub fn wall(
        &self,
        model: &Model,
        middle: PivotPose,
        pose: PivotPose,
        motion: impl Fn(f64) -> f64,
    ) -> Option<Wall> {
        if !model.closed {
            return None;
        }
        let wall = |lever: DVec2| {
            let place = |pose: PivotPose| pose.y + DVec2::from_angle(-pose.angle).rotate(lever);
            let [nearest, next] = nearest_faces(model, place(middle));
            let face = &model.faces[nearest.1];
            let height = face.normal.dot(face.start) + self.clearance;
            let wall = Wall { lever, normal: face.normal, height };
            let alone = nearest.0 + 2.0 * motion(lever.length()) < next.0;
            alone.then(|| (height - face.normal.dot(place(pose)), wall))
        };
        let worst = self.intrusion(model, pose).1;
        self.samples()
            .chain([worst])
            .filter_map(wall)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, wall)| wall)
    }

    /// The largest distance of a swept point from the pivot.
    pub fn reach(&self) -> f64 {
        self.start.length().max(self.end.length())
    }
}

/// Distance and number of the nearest face that is there, and of the next.
fn nearest_faces(model: &Model, point: DVec2) -> [(f64, usize); 2] {
    let mut nearest = [(f64::INFINITY, 0); 2];
    for (number, face) in model.faces.iter().enumerate().filter(|(_, face)| face.surface != Surface::Seam) {
        let distance = to_segment(point, [face.start, face.end]);
        if distance < nearest[0].0 {
            nearest = [(distance, number), nearest[0]];
        } else if distance < nearest[1].0 {
            nearest[1] = (distance, number);
        }
    }
    nearest
}

/// The faces that are there.
fn solid(model: &Model) -> impl Iterator<Item = &Face> {
    model.faces.iter().filter(|face| face.surface != Surface::Seam)
}

/// Whether the point is inside a closed model.
fn inside(model: &Model, point: DVec2) -> bool {
    let crosses = |face: &&Face| {
        let (start, end) = (face.start, face.end);
        (start.y > point.y) != (end.y > point.y)
            && point.x < start.x + (point.y - start.y) / (end.y - start.y) * (end.x - start.x)
    };
    model.closed && solid(model).filter(crosses).count() % 2 == 1
}

/// Whether some point of the path is inside, and further than `depth` from the outline.
fn deeper(model: &Model, path: [DVec2; 2], depth: f64) -> bool {
    let at = |t: f64| path[0].lerp(path[1], t);
    let mut cuts: Vec<f64> =
        solid(model).filter_map(|face| crossing(path, [face.start, face.end])).chain([0.0, 1.0]).collect();
    cuts.sort_by(f64::total_cmp);
    let pieces = cuts.windows(2).filter(|ends| inside(model, at(0.5 * (ends[0] + ends[1]))));
    pieces.into_iter().any(|ends| rises_above(model, [at(ends[0]), at(ends[1])], depth))
}

/// Whether the distance to the outline rises above `depth` on a piece of a path that does not cross it.
///
/// The distance to one face is convex along the piece, hence at most the larger of its values at the ends; the distance
/// to the outline is the least of these. Decided up to 1e-9 of the part, in favour of the pose.
fn rises_above(model: &Model, piece: [DVec2; 2], depth: f64) -> bool {
    let finest = 1e-9 * model.size;
    let mut pieces = vec![piece];
    while let Some([start, end]) = pieces.pop() {
        let middle = start.midpoint(end);
        let (mut bound, mut distance) = (f64::INFINITY, f64::INFINITY);
        for face in solid(model).map(|face| [face.start, face.end]) {
            bound = bound.min(to_segment(start, face).max(to_segment(end, face)));
            distance = distance.min(to_segment(middle, face));
        }
        if distance > depth && inside(model, middle) {
            return true;
        }
        if bound > depth && start.distance(end) > finest {
            pieces.extend([[start, middle], [middle, end]]);
        }
    }
    false
}
