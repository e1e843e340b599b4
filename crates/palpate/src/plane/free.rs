//! Free space as evidence: what a tip swept without touching can't hold the part (DESIGN §2, MATH 2.1.1).

use crate::part::Surface;
use std::f64::consts::PI;

use arrayvec::ArrayVec;
use glam::DVec2;

use super::arc::Arc;
use super::case::PivotPose;
use super::distance::{crossing, segment_to_segment, to_segment};
use super::model::{Face, Model, Vertex};
use super::site::Site;
use crate::sweep::Sweep;

/// A swept point, and the side of a line on which it must stay: `normal · (y + R(−θ) lever) >= height`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wall {
    pub lever: DVec2,
    pub normal: DVec2,
    pub height: f64,
}

/// The ways out for a swept point that is too near: it must be beyond one of these walls.
pub(crate) type Escapes = ArrayVec<Wall, MOST_ESCAPES>;

/// With more ways out than this, a cell is better divided.
const MOST_ESCAPES: usize = 6;

/// A stretch of a sweep is at least this power of a half of it.
const MOST_HALVINGS: i32 = 14;

/// The worst point of a sweep is found to this share of the part's size.
const FINEST: f64 = 1e-9;

/// Arcs around corners are longer by this, radians, than computed.
const ROUNDING: f64 = 1e-9;

impl Sweep<DVec2> {
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
        model.closed
            && deepest(model, path, &inner_pieces(model, path), -clearance, -clearance).0 > -clearance
    }

    /// By how much the clearance is missed where it is missed most, to a twentieth, and the lever of that point. Negative
    /// if it is not missed.
    pub fn intrusion(&self, model: &Model, pose: PivotPose) -> (f64, DVec2) {
        let turn = DVec2::from_angle(-pose.angle);
        let path = [self.start, self.end].map(|point| pose.y + turn.rotate(point));
        let (distance, t) = nearest_approach(model, path, self.clearance);
        (self.clearance - distance, self.start.lerp(self.end, t))
    }

    /// The walls of which the swept point at `lever` must be beyond one, at every pose within `motion` of `pose` that
    /// leaves it its clearance less `slack`: none, and no pose does. `None`: nothing is said, as the point is clear at
    /// `pose`, or the poses are too far apart, or the walls too many.
    ///
    /// On its straight way from its place at `pose` to that at a valid pose the point leaves the region of points that
    /// are too near, last of all at a point `e` of its border. The nearest place of the outline to `e` is on a face,
    /// moved by the clearance, or at a corner; onward from `e` the point moves away from there (`docs/theory.md`, T7).
    pub fn escapes(
        &self,
        model: &Model,
        lever: DVec2,
        pose: PivotPose,
        motion: f64,
        slack: f64,
    ) -> Option<Escapes> {
        let clearance = self.clearance - slack;
        let point = pose.y + DVec2::from_angle(-pose.angle).rotate(lever);
        let (distance, _) = nearest_approach(model, [point, point], clearance);
        if distance >= clearance || (clearance <= 0.0 && !model.closed) {
            return None;
        }
        let mut escapes = Escapes::new();
        for face in solid(model) {
            let sides = if model.closed { 1 } else { 2 };
            for normal in [face.normal, -face.normal].into_iter().take(sides) {
                let border = [face.start, face.end].map(|end| end + clearance * normal);
                if to_segment(point, border) <= motion {
                    let height = normal.dot(face.start) + clearance;
                    escapes.try_push(Wall { lever, normal, height }).ok()?;
                }
            }
        }
        if clearance == 0.0 {
            return Some(escapes);
        }
        for arc in rounded_corners(model, clearance) {
            let Site::Arc { middle: corner, .. } = arc else { continue };
            if arc.nearest(point).distance(point) <= motion {
                let wall = around_corner(lever, point - corner, clearance, motion)?;
                let height = wall.height + wall.normal.dot(corner);
                escapes.try_push(Wall { height, ..wall }).ok()?;
            }
        }
        Some(escapes)
    }

    /// Ends of a stretch of the sweep around the point at `lever` all of which must be beyond the one, or all beyond the other
    /// of two walls of that point: it can't change sides without passing through what is too deep between them.
    ///
    /// So it is where no other face is within the depth of the stretch at any pose within `motion` of `pose`, and no point
    /// near it is beyond both walls (`docs/theory.md`, T7). `None` if no stretch is found, or outside of the part.
    pub fn stretch(
        &self,
        model: &Model,
        [first, second]: [Wall; 2],
        pose: PivotPose,
        motion: f64,
        slack: f64,
    ) -> Option<[DVec2; 2]> {
        let depth = slack - self.clearance;
        if depth < 0.0 || !model.closed {
            return None;
        }
        let lever = first.lever;
        let turn = DVec2::from_angle(-pose.angle);
        let place = |lever: DVec2| pose.y + turn.rotate(lever);
        let of_walls = |face: &Face| {
            [first, second]
                .iter()
                .any(|wall| face.normal == wall.normal && face.normal.dot(face.start) - depth == wall.height)
        };
        // Beyond both is no point of which the sum of both heights is less than that of both walls.
        let both = first.normal + second.normal;
        let gap = first.height + second.height - both.dot(place(lever));
        for halving in 0..MOST_HALVINGS {
            let share = 0.5_f64.powi(halving);
            let ends = [self.start, self.end].map(|end| lever.lerp(end, share));
            let path = ends.map(place);
            let reach = path[0].distance(place(lever)).max(path[1].distance(place(lever)));
            let alone = |face: &Face| {
                of_walls(face) || segment_to_segment(path, [face.start, face.end]) > depth + motion
            };
            if gap > both.length() * (reach + motion) && solid(model).all(alone) {
                return Some(ends);
            }
        }
        None
    }
}

/// Beyond a corner, seen from it: the wall of a point at `offset` that moves by no more than `motion`.
///
/// Seen from the corner, the point turns by no more than β with sin β = motion / |offset|. Outside (clearance c > 0) it
/// ends at |q| ≥ c, so that û·q ≥ c cos β for û along `offset`. Inside, at depth d = −c, it leaves through a point from
/// which the corner is seen within β of −û, and so is its end: |q| ≤ d / cos 2β. `None` if β is too wide.
fn around_corner(lever: DVec2, offset: DVec2, clearance: f64, motion: f64) -> Option<Wall> {
    let outward = offset.try_normalize()?;
    let cosine = (1.0 - (motion / offset.length()).powi(2)).max(0.0).sqrt();
    if clearance > 0.0 {
        return (motion < offset.length()).then_some(Wall {
            lever,
            normal: outward,
            height: clearance * cosine,
        });
    }
    let twice = 2.0 * cosine * cosine - 1.0;
    (motion < offset.length() && twice > 0.0).then(|| Wall {
        lever,
        normal: -outward,
        height: clearance / twice,
    })
}

/// Where the border of what is too near goes around corners: outside, around those that stick out (of an open model, around
/// all); inside, around those that stick in.
fn rounded_corners(model: &Model, clearance: f64) -> impl Iterator<Item = Site> {
    let outside = clearance > 0.0;
    let rounded = move |middle: DVec2| {
        let before = solid(model).find(|face| face.end == middle);
        let after = solid(model).find(|face| face.start == middle);
        let normals = match (before, after) {
            (Some(before), Some(after)) if model.closed => {
                let sticks_out = before.normal.perp_dot(after.normal) > 0.0;
                let cone = |first, second| Vertex::cone(first, second).widen(ROUNDING);
                match (sticks_out, outside) {
                    (true, true) => cone(before, after),
                    (false, false) => cone(after, before).turn(PI),
                    _ => return None,
                }
            }
            _ => Arc::FULL,
        };
        Some(Site::Arc { middle, radius: clearance.abs(), normals })
    };
    model.vertices.iter().filter_map(move |vertex| rounded(vertex.point))
}

impl Model {
    /// The distance of a point from the part, negative inside; of an open model always positive.
    pub(crate) fn signed_distance(&self, point: DVec2) -> f64 {
        let distances = solid(self).map(|face| to_segment(point, [face.start, face.end]));
        let distance = distances.fold(f64::INFINITY, f64::min);
        if inside(self, point) { -distance } else { distance }
    }
}

/// The faces that are there.
pub(super) fn solid(model: &Model) -> impl Iterator<Item = &Face> {
    model.faces.iter().filter(|face| face.surface != Surface::Seam)
}

/// Whether the point is inside a closed model.
pub(super) fn inside(model: &Model, point: DVec2) -> bool {
    let crosses = |face: &&Face| {
        let (start, end) = (face.start, face.end);
        (start.y > point.y) != (end.y > point.y)
            && point.x < start.x + (point.y - start.y) / (end.y - start.y) * (end.x - start.x)
    };
    model.closed && solid(model).filter(crosses).count() % 2 == 1
}

/// The least signed distance of the path to the part (of an open model, the distance), and where: the share of the way.
/// Inside, it is found to a twentieth of its difference from the clearance, and not sought where it is no smaller.
fn nearest_approach(model: &Model, path: [DVec2; 2], clearance: f64) -> (f64, f64) {
    if model.closed {
        let pieces = inner_pieces(model, path);
        if !pieces.is_empty() {
            let (depth, t) = deepest(model, path, &pieces, -clearance, f64::INFINITY);
            return (-depth, t);
        }
    }
    let way = path[1] - path[0];
    let length_sq = way.length_squared();
    let foot = |point: DVec2| {
        if length_sq > 0.0 { ((point - path[0]).dot(way) / length_sq).clamp(0.0, 1.0) } else { 0.0 }
    };
    let mut nearest = (f64::INFINITY, 0.0);
    for face in solid(model).map(|face| [face.start, face.end]) {
        let crossed = crossing(path, face).map(|t| (0.0, t));
        let from_path = [0.0, 1.0].map(|t| (to_segment(path[0].lerp(path[1], t), face), t));
        let from_face = face.map(|end| (to_segment(end, path), foot(end)));
        for found in crossed.into_iter().chain(from_path).chain(from_face) {
            if found.0 < nearest.0 {
                nearest = found;
            }
        }
    }
    nearest
}

/// The pieces of the path that are inside a closed model, as shares of the way.
fn inner_pieces(model: &Model, path: [DVec2; 2]) -> Vec<[f64; 2]> {
    let at = |t: f64| path[0].lerp(path[1], t);
    let mut cuts: Vec<f64> =
        solid(model).filter_map(|face| crossing(path, [face.start, face.end])).chain([0.0, 1.0]).collect();
    cuts.sort_by(f64::total_cmp);
    let pieces = cuts.windows(2).map(|ends| [ends[0], ends[1]]);
    pieces.filter(|[from, to]| inside(model, at(0.5 * (from + to)))).collect()
}

/// The largest distance to the outline on pieces of a path that do not cross it, and where, to a twentieth of what it is
/// above `floor`. Below `floor` it is not sought; once above `enough` it is no longer.
///
/// The distance to one face is convex along a piece, hence nowhere above the chord between its ends. Of the faces nearest to
/// the two ends the chords cross at the highest that the distance to the outline can be, and there the piece is divided.
fn deepest(model: &Model, path: [DVec2; 2], pieces: &[[f64; 2]], floor: f64, enough: f64) -> (f64, f64) {
    let finest = FINEST * model.size;
    let length = path[0].distance(path[1]);
    let to_face = |t: f64, face: &Face| to_segment(path[0].lerp(path[1], t), [face.start, face.end]);
    let look = |t: f64| {
        let distances = solid(model).map(|face| (to_face(t, face), face));
        distances.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(distance, face)| (t, distance, face))
    };
    let mut open = Vec::new();
    let mut best = (0.0, pieces.first().map_or(0.0, |[from, to]| 0.5 * (from + to)));
    let take = |best: &mut (f64, f64), t: f64| {
        let seen = look(t);
        if let Some((_, distance, _)) = seen.filter(|(_, distance, _)| *distance > best.0) {
            *best = (distance, t);
        }
        seen
    };
    for [from, to] in pieces {
        open.extend(take(&mut best, *from).zip(take(&mut best, *to)));
    }
    while let Some((from, to)) = open.pop() {
        if best.0 > enough {
            break;
        }
        // By how much each end is farther from the face that is nearest to the other end.
        let (ahead, behind) = (to_face(from.0, to.2) - from.1, to_face(to.0, from.2) - to.1);
        if ahead + behind <= 0.0 {
            continue;
        }
        let share = ahead / (ahead + behind);
        let bound = from.1 + share * (to.1 + behind - from.1);
        let wanted = best.0.max(floor) + finest.max(0.05 * (best.0 - floor));
        if bound > wanted && (to.0 - from.0) * length > finest {
            let t = from.0 + share * (to.0 - from.0);
            if let Some(middle) = take(&mut best, t).filter(|_| from.0 < t && t < to.0) {
                open.extend([(from, middle), (middle, to)]);
            }
        }
    }
    best
}

#[cfg(test)]
#[path = "free_tests.rs"]
mod tests;
