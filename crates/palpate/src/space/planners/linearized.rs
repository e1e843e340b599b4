//! Faces flattened to polygons at the middle of their heights, so that one linear program has all four parameters (thesis
//! 5.3).
//!
//! Every corner of the flat polygon is seen within `√(α² + β²) · H / 2` of the face's, H being the face's extent along the
//! generator's normal (`docs/theory.md`; MATH 2.5, *Linearisation, sound version*): moved inward by as much, for all slopes of
//! the program, a line with room meets the face. Corrected: the bound as MATH row 85 has it, no absolute values too early,
//! and the error in area with the length of the sides (row 92), which the thesis's (5.3) lacks.

use glam::{DVec2, DVec3};

use super::candidates::{CandidateSet, Generator, Side, most_slope, offer_planned, roomiest, sides};
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Slopes over which a program is solved, as shares of tan Ω: the fewer, the less is moved inward.
const SHARES: [f64; 2] = [0.2, 1.0];

/// Offers lines to `best`.
pub(super) fn linearized(
    best: &mut Best<'_, DVec3>,
    generators: &[Generator],
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    offer_planned(best, generators, settings, late, planned);
}

fn planned(scene: &Scene<DVec3>, members: &[usize], generator: &Generator) -> Vec<Line<DVec3>> {
    let rho = most_slope(scene);
    let of_set = |set: &CandidateSet, share: f64| {
        let at = |slopes: [f64; 2], most: f64| {
            let [x, y, ..] = set.start;
            let half = most / 2_f64.sqrt();
            let reach = 2.0 * scene.radius;
            let steepest = DVec2::from(slopes).length() + most;
            let all = flat_sides(&set.pieces, steepest);
            let found = roomiest(&all, [x, y, slopes[0], slopes[1]], [reach, reach, half, half], reach);
            generator.chart.line(scene, found)
        };
        // Where the best direction is not allowed that of the first line is kept.
        at([0.0; 2], share * rho).or_else(|| at([set.start[2], set.start[3]], 0.0))
    };
    let sets = generator.candidate_sets(scene, members);
    sets.iter().flat_map(|set| SHARES.iter().filter_map(move |share| of_set(set, *share))).collect()
}

/// The sides of flat pieces, moved inward by the error at slopes up to `most`.
fn flat_sides(pieces: &[Vec<DVec3>], most: f64) -> Vec<Side> {
    let flat = pieces.iter().map(|piece| (flattened(piece), linearization_error(piece, DVec2::X * most)));
    flat.flat_map(|(piece, error)| sides(&piece, error.shift).collect::<Vec<_>>()).collect()
}

/// The lowest and the highest of corners.
fn heights(corners: &[DVec3]) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    corners.iter().fold(start, |[low, high], corner| [low.min(corner.z), high.max(corner.z)])
}

/// Corners at the middle of their heights.
fn flattened(corners: &[DVec3]) -> Vec<DVec3> {
    let [low, high] = heights(corners);
    corners.iter().map(|corner| corner.truncate().extend(low.midpoint(high))).collect()
}

/// By how much a flattened polygon is wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizationError {
    /// No place of its border is seen further from where that of the polygon itself is.
    pub shift: f64,
    /// An upper bound of the area that one of both covers and the other does not, as they are seen.
    pub area: f64,
}

/// By how much a polygon that is flattened to the middle of its heights is wrong at two slopes (thesis 5.3, corrected by
/// MATH rows 85 and 92). Corners are in the chart of the generator.
#[must_use]
pub fn linearization_error(corners: &[DVec3], slopes: DVec2) -> LinearizationError {
    let [low, high] = heights(corners);
    let middle = low.midpoint(high);
    let of_side = |(a, b): (&DVec3, &DVec3)| {
        let along = b.truncate() - a.truncate();
        along.perp_dot(slopes).abs() * mean_distance(a.z - middle, b.z - middle)
    };
    let area = corners.iter().zip(corners.iter().cycle().skip(1)).map(of_side).sum();
    LinearizationError { shift: 0.5 * slopes.length() * (high - low), area }
}

/// The mean of `|h|` from one height to another.
fn mean_distance(from: f64, to: f64) -> f64 {
    if from * to >= 0.0 { 0.5 * (from + to).abs() } else { 0.5 * (from * from + to * to) / (to - from).abs() }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3, dvec3};

    use super::{flat_sides, flattened, linearization_error};
    use crate::space::planners::candidates::{least_room, sides};
    use crate::space::shapes::Random;

    /// A convex polygon in a tilted plane, counter-clockwise from above.
    fn tilted(random: &mut Random) -> Vec<DVec3> {
        let tilt = DVec2::new(random.next() - 0.5, random.next() - 0.5);
        let (wide, high) = (2.0 + 8.0 * random.next(), 2.0 + 8.0 * random.next());
        (0..5)
            .map(|k| {
                let (sine, cosine) = (1.256 * f64::from(k) + random.next()).sin_cos();
                let at = DVec2::new(wide * cosine, high * sine);
                dvec3(at.x, at.y, 3.0 + tilt.dot(at))
            })
            .collect()
    }

    /// Whoever has room in the flat polygon moved inward meets the face; and no flat one is further off than is said.
    #[test]
    fn a_line_with_room_in_the_flat_polygon_meets_the_face() {
        let mut random = Random(10);
        let mut held = 0;
        for _ in 0..500 {
            let corners = tilted(&mut random);
            let flat = flat_sides(std::slice::from_ref(&corners), 0.5);
            let itself: Vec<_> = sides(&corners, 0.0).collect();
            for _ in 0..40 {
                let slopes = DVec2::from_angle(std::f64::consts::TAU * random.next()) * (0.5 * random.next());
                let line = [20.0 * random.next() - 10.0, 20.0 * random.next() - 10.0, slopes.x, slopes.y];
                if least_room(&flat, line) >= 0.0 {
                    assert!(least_room(&itself, line) >= -1e-9);
                    held += 1;
                }
                let error = linearization_error(&corners, slopes);
                for (a, b) in corners.iter().zip(flattened(&corners)) {
                    let seen = |one: DVec3| one.truncate() - one.z * slopes;
                    assert!(seen(*a).distance(seen(b)) <= error.shift + 1e-9);
                }
            }
        }
        assert!(held > 1_000, "{held}");
    }

    /// The area between both, by random points.
    #[test]
    fn the_error_in_area_is_not_exceeded() {
        let mut random = Random(11);
        for _ in 0..30 {
            let corners = tilted(&mut random);
            let slopes = DVec2::new(random.next() - 0.5, random.next() - 0.5);
            let itself: Vec<_> = sides(&corners, 0.0).collect();
            let flat: Vec<_> = sides(&flattened(&corners), 0.0).collect();
            let (count, side) = (20_000, 40.0);
            let between = (0..count)
                .filter(|_| {
                    let at = [side * (random.next() - 0.5), side * (random.next() - 0.5), slopes.x, slopes.y];
                    (least_room(&itself, at) >= 0.0) != (least_room(&flat, at) >= 0.0)
                })
                .count();
            let measured = side * side * between as f64 / f64::from(count);
            let bound = linearization_error(&corners, slopes).area;
            // Five standard deviations of what is counted.
            let spread = side * side * (between as f64).sqrt() / f64::from(count);
            assert!(measured <= bound + 5.0 * spread, "{measured} {bound}");
        }
    }
}
