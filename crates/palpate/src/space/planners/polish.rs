//! Lines moved to where the faces that they meet leave them the most room (MATH 2.5, row 79).
//!
//! To first order, how far a line passes inside of a face's side is linear in its two shifts and its two slopes: the largest
//! least room is a linear program, the four-parameter form of the thesis's optimization (5.2) as MATH corrects it.

use glam::DVec3;

use super::candidates::{WIDTH, most_room};
use crate::feature::Feature;
use crate::line::{FirstContact, Line};
use crate::scene::Scene;
use crate::space::Pose;
use crate::space::lp::Row;
use crate::space::scene::{features, piece_at};

/// Steps, each of which is linear.
const STEPS: usize = 3;

/// A step turns by no more than this, radians, and shifts by no more than this share of the size.
const MOST_TURN: f64 = 0.2;
const MOST_SHIFT: f64 = 0.2;

/// The line with the most room around it, near a line that meets faces, that meets the same faces at all views; `None`: it is
/// the line itself, or it meets none.
pub(super) fn polished(scene: &Scene<DVec3>, members: &[usize], line: &Line<DVec3>) -> Option<Line<DVec3>> {
    let (mut best, mut next) = (*line, *line);
    let mut met = met(scene, members, line);
    let mut most = f64::NEG_INFINITY;
    for step in 0..=STEPS {
        let Some(rows) = rows(scene, members, &next, &met) else { break };
        let room = room(&rows);
        // The room is linear to first order only: a step may have lost some.
        if !room.is_finite() || room <= most + 1e-3 * scene.margin {
            break;
        }
        (best, most) = (next, room);
        if step == STEPS {
            break;
        }
        let shift = MOST_SHIFT * scene.size;
        let half = [shift, shift, MOST_TURN, MOST_TURN];
        let [x, y, a, b] = most_room(rows.into_iter(), half, scene.size);
        let (right, up) = best.direction.any_orthonormal_pair();
        let direction = (best.direction + a * right + b * up).normalize();
        let point = pivot(scene, &best) + x * right + y * up;
        let Some(moved) = scene.line(direction, point) else { break };
        let met_then = self::met(scene, members, &moved);
        if features(&met_then) != features(&met) {
            break;
        }
        (next, met) = (moved, met_then);
    }
    (best != *line).then_some(best)
}

/// The least room that the rows grant without a step; infinite if none asks for room.
fn room(rows: &[Row<WIDTH>]) -> f64 {
    let reached = rows.iter().filter(|row| row.normal[WIDTH - 1] > 0.0);
    reached.map(|row| row.bound).fold(f64::INFINITY, f64::min)
}

/// The point of a line that is nearest to the middle of the scene.
fn pivot(scene: &Scene<DVec3>, line: &Line<DVec3>) -> DVec3 {
    line.at(line.depth_and_aside(scene.middle).0)
}

/// What is met at each view of each member, one after the other.
fn met(scene: &Scene<DVec3>, members: &[usize], line: &Line<DVec3>) -> Vec<Option<FirstContact<DVec3>>> {
    views(scene, members).map(|(member, pose)| scene.contact(member, pose, line)).collect()
}

/// Members, and their poses.
fn views<'a>(scene: &'a Scene<DVec3>, members: &'a [usize]) -> impl Iterator<Item = (usize, Pose)> + 'a {
    members.iter().flat_map(|member| scene.views[*member].iter().map(move |pose| (*member, *pose)))
}

/// That the line stays inside of the sides of the faces it meets, by the room, and within the largest incidence.
fn rows(
    scene: &Scene<DVec3>,
    members: &[usize],
    line: &Line<DVec3>,
    met: &[Option<FirstContact<DVec3>>],
) -> Option<Vec<Row<WIDTH>>> {
    let (right, up) = line.direction.any_orthonormal_pair();
    let pivot = pivot(scene, line);
    let flattest = scene.sensor.max_incidence.cos();
    let mut rows = Vec::new();
    for ((member, pose), met) in views(scene, members).zip(met) {
        let Some(met) = met else { continue };
        let Feature::Face(number) = met.feature else { return None };
        let model = scene.shadows[member].model();
        let moved = scene.sensor.tip_radius * met.normal;
        // A convex piece of the face stands for it.
        let piece = piece_at(model, number, pose.inverse().apply(line.at(met.depth) - moved))?;
        let at = |k: &u32| pose.apply(model.vertices[*k as usize].point) + moved;
        for (a, b) in piece.iter().map(at).zip(piece.iter().cycle().skip(1).map(at)) {
            // Across the line and the side, away from the face.
            let Some(out) = (b - a).cross(line.direction).try_normalize() else { continue };
            let out = if out.dot(0.5 * (a + b) - line.at(met.depth)) < 0.0 { -out } else { out };
            let depth = line.direction.dot(line.at(met.depth) - pivot);
            let bound = out.dot(a - line.start);
            let (x, y) = (out.dot(right), out.dot(up));
            rows.push(Row { normal: [x, y, depth * x, depth * y, 1.0], bound });
        }
        let slack = -met.normal.dot(line.direction) - flattest;
        let normal = [0.0, 0.0, met.normal.dot(right), met.normal.dot(up), 0.0];
        rows.push(Row { normal, bound: slack });
    }
    Some(rows)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{blocks, sensor};
    use super::*;
    use crate::PlanSettings;
    use crate::space::shapes::Random;

    /// What is made of a line is allowed, meets the same and has more room.
    #[test]
    fn a_polished_line_has_more_room() {
        let hypotheses = blocks();
        let directions = Some((DVec3::Z, 0.8));
        let scene =
            Scene::new(&hypotheses, &sensor(), &PlanSettings { directions, ..PlanSettings::default() });
        let members = scene.everyone();
        let mut random = Random(11);
        let mut num_polished = 0;
        for _ in 0..400 {
            let through = scene.middle + random.point(-15.0, 15.0);
            let Some(line) = scene.line(random.direction(), through) else { continue };
            let Some(polished) = polished(&scene, &members, &line) else { continue };
            num_polished += 1;
            assert!(scene.allows(polished.direction));
            let [before, after] = [line, polished].map(|line| {
                let met = met(&scene, &members, &line);
                let room = room(&rows(&scene, &members, &line, &met).expect("it meets faces"));
                (features(&met), room)
            });
            assert_eq!(before.0, after.0);
            assert!(after.1 > before.1);
        }
        assert!(num_polished > 10, "{num_polished}");
    }
}
