//! The most room within the faces of a candidate set, over all four parameters (thesis 5.1, 5.2).
//!
//! Faces are in convex pieces; the piece that a first line meets stands for the face, instead of all products of pieces (MATH
//! row 84). The least room is made largest, not the sum of all (row 79), with the gradient of row 81. Rooms are bilinear in
//! shifts and slopes (row 82), so that a sequence of linear programs, each within a box, replaces one. Uncertainty is met
//! by the pieces at all views of each hypothesis at once.

use glam::DVec3;

use super::candidates::{CandidateSet, Generator, Side, least_room, offer_planned, roomiest, sides};
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Steps, each of which is linear.
const STEPS: usize = 8;

/// The first step's box: shares of the size, and slopes.
const SHIFT: f64 = 0.2;
const TURN: f64 = 0.3;

/// Offers lines to `best`.
pub(super) fn optimized(
    best: &mut Best<'_, DVec3>,
    generators: &[Generator],
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    offer_planned(best, generators, settings, late, planned);
}

fn planned(scene: &Scene<DVec3>, members: &[usize], generator: &Generator) -> Vec<Line<DVec3>> {
    let of_set = |set: &CandidateSet| {
        let all: Vec<Side> = set.pieces.iter().flat_map(|piece| sides(piece, 0.0)).collect();
        // Where the best direction is not allowed that of the first line is kept.
        let with = |turn: f64| generator.chart.line(scene, optimum(&all, set.start, turn, scene.size));
        with(TURN).or_else(|| with(0.0))
    };
    generator.candidate_sets(scene, members).iter().filter_map(of_set).collect()
}

/// Steps to more room, within a box that is halved where a step leads to less.
fn optimum(sides: &[Side], start: [f64; 4], turn: f64, size: f64) -> [f64; 4] {
    let (mut at, mut half) = (start, [SHIFT * size, SHIFT * size, turn, turn]);
    let mut room = least_room(sides, at);
    for _ in 0..STEPS {
        let next = roomiest(sides, at, half, size);
        let reached = least_room(sides, next);
        if reached > room {
            (at, room) = (next, reached);
        } else {
            half = half.map(|one| 0.5 * one);
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use glam::dvec3;

    use super::super::candidates::{least_room, sides};
    use super::optimum;
    use crate::space::shapes::Random;

    /// Two squares of half sides 4 and 1, the second aside and higher: the most room is 1, and no random line has more.
    #[test]
    fn no_random_line_has_more_room() {
        let square = |half: f64, x: f64, z: f64| {
            [(-half, -half), (half, -half), (half, half), (-half, half)]
                .map(|(u, v)| dvec3(x + u, v, z))
                .to_vec()
        };
        let pieces = [square(4.0, 0.0, 0.0), square(1.0, 6.0, 10.0)];
        let all: Vec<_> = pieces.iter().flat_map(|piece| sides(piece, 0.0)).collect();
        let found = optimum(&all, [0.0; 4], 0.3, 10.0);
        let room = least_room(&all, found);
        assert!((room - 1.0).abs() < 1e-9, "{room} {found:?}");
        let mut random = Random(8);
        for _ in 0..10_000 {
            let line = [5.0, 5.0, 1.0, 1.0].map(|half| half * (2.0 * random.next() - 1.0));
            assert!(least_room(&all, line) <= room + 1e-9);
        }
    }

    /// MATH row 81, against differences.
    #[test]
    fn the_gradient_of_a_room_is_that_of_differences() {
        let mut random = Random(9);
        for _ in 0..1_000 {
            let corners = [0; 2].map(|_| 10.0 * random.direction());
            let Some(side) = sides(&corners, 0.0).next() else { continue };
            let at = [5.0, 5.0, 1.0, 1.0].map(|half| half * (2.0 * random.next() - 1.0));
            let Some((_, gradient)) = side.room(at) else { continue };
            for (k, slope) in gradient.into_iter().enumerate() {
                let moved = |by: f64| {
                    let mut at = at;
                    at[k] += by;
                    side.room(at).expect("it is not along it").0
                };
                let measured = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                assert!((measured - slope).abs() < 1e-4 * (1.0 + slope.abs()), "{measured} {slope}");
            }
        }
    }
}
