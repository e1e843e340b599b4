//! The problem in space as two of the plane (thesis 5.4.4).
//!
//! First x and α: each face counts as the segment between its corners of least and largest x, which is liberal. Then y and β
//! in the slice by `x = X + αz`, which holds all lines of these (X, α): what is met first in the slice is met first in space
//! (MATH 2.5, row 94; the thesis slices parallel to Y-Z, which paths with α ≠ 0 leave). Both orders are planned, in the
//! chart turned about the generator's normal to where the bounding rectangles of the faces exceed them least.
//!
//! Planes of both problems hold bare segments with normals of space, so that they are no models of the plane: the
//! arrangement is here, middles between the critical positions at critical slopes (3.2, 4.1) and between these.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::candidates::{Chart, Generator, area, most_slope, offer_planned};
use super::polish::polished;
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Turns of the chart that are compared, over a right angle.
const NUM_TURNS: u32 = 12;

/// Slopes of one problem, and positions at each.
const MOST_SLOPES: usize = 9;
const MOST_POSITIONS: usize = 16;

/// Solutions that are kept: of the first problem, and of the second for each.
const KEPT: [usize; 2] = [3, 2];

/// Of a generator's lines so many are kept, the best at the nominal poses, as they are and given more room.
const MOST_POLISHED: usize = 6;

/// A face that is turned to the generator's side, in pieces, chart coordinates.
struct Seen {
    pieces: Vec<Vec<DVec3>>,
    normal: DVec3,
}

/// Part of a face in a plane of one coordinate and the height.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    ends: [DVec2; 2],
    /// World frame.
    normal: DVec3,
}

/// A line of one problem.
#[derive(Debug, Clone, Copy)]
struct Solution {
    offset: f64,
    slope: f64,
    left: usize,
    width: f64,
}

/// Offers lines to `best`.
pub(super) fn decoupled(
    best: &mut Best<'_, DVec3>,
    generators: &[Generator],
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    offer_planned(best, generators, settings, late, planned);
}

fn planned(scene: &Scene<DVec3>, members: &[usize], generator: &Generator) -> Vec<Line<DVec3>> {
    let faces: Vec<Seen> = members.iter().flat_map(|member| seen(scene, *member, &generator.chart)).collect();
    let chart = generator.chart.turned(best_turn(&faces, generator.chart.axes[2]));
    // The other order is the same in the chart turned by a right angle.
    let both = [chart, chart.turned(FRAC_PI_2)];
    let lines = both.iter().flat_map(|chart| ordered(scene, members, generator, chart));
    let mut looked_at: Vec<(usize, Line<DVec3>)> =
        lines.filter_map(|line| Some((scene.glance(&line, members, 1)?, line))).collect();
    looked_at.sort_by_key(|(left, _)| *left);
    looked_at.truncate(MOST_POLISHED);
    let as_they_are = looked_at.iter().map(|(_, line)| *line);
    as_they_are.clone().chain(as_they_are.filter_map(|line| polished(scene, members, &line))).collect()
}

/// Faces of a member at its nominal pose that are turned to the generator's side, moved out by the radius of the tip.
fn seen(scene: &Scene<DVec3>, member: usize, chart: &Chart) -> Vec<Seen> {
    let (model, pose) = (scene.shadows[member].model(), scene.views[member][0]);
    let mut all = Vec::new();
    for face in &model.faces {
        let outward = pose.rotation * face.normal;
        let normal = if model.closed || outward.dot(chart.axes[2]) > 0.0 { outward } else { -outward };
        let moved = scene.sensor.tip_radius * normal;
        let at = |k: &u32| chart.point(pose.apply(model.vertices[*k as usize].point) + moved);
        let pieces = face.pieces.iter().map(|piece| piece.iter().map(at).collect()).collect();
        all.push(Seen { pieces, normal });
    }
    all
}

/// The turn of the chart at which the bounding rectangles of faces, seen along the generator's normal, exceed them least:
/// the rectangles are smallest, as the faces stay as large as they are.
fn best_turn(faces: &[Seen], normal: DVec3) -> f64 {
    let turned = |turn: f64| {
        let back = DVec2::from_angle(-turn);
        let around = |face: &Seen| {
            let corners = face.pieces.iter().flatten().map(|at| back.rotate(at.truncate()).extend(at.z));
            rectangle(corners, DVec2::ZERO)
        };
        faces.iter().filter(|face| face.normal.dot(normal) > 0.0).map(around).sum::<f64>()
    };
    let turns = (0..NUM_TURNS).map(|k| FRAC_PI_2 * f64::from(k) / f64::from(NUM_TURNS));
    let sizes = turns.map(|turn| (turned(turn), turn));
    sizes.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, turn)| turn)
}

/// The area of the rectangle around corners as they are seen at two slopes.
fn rectangle(corners: impl Iterator<Item = DVec3>, slopes: DVec2) -> f64 {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = corners
        .map(|corner| corner.truncate() - corner.z * slopes)
        .fold(start, |(low, high), at| (low.min(at), high.max(at)));
    (high - low).max(DVec2::ZERO).element_product()
}

/// The share of lines with these slopes, among those that two decoupled problems hold to hit a convex piece of a face, that do
/// (thesis 5.4.4; MATH 2.5: the area as it is seen, in that of its bounding rectangle). Corners are in the chart.
#[must_use]
pub fn predicted_hit_rate(corners: &[DVec3], slopes: DVec2) -> f64 {
    let around = rectangle(corners.iter().copied(), slopes);
    if around > 0.0 { area(corners, slopes).abs() / around } else { 0.0 }
}

/// x and α first.
fn ordered(
    scene: &Scene<DVec3>,
    members: &[usize],
    generator: &Generator,
    chart: &Chart,
) -> Vec<Line<DVec3>> {
    let faces: Vec<Vec<Seen>> = members.iter().map(|member| seen(scene, *member, chart)).collect();
    let own: Vec<DVec3> = generator.corners.iter().map(|corner| chart.point(*corner)).collect();
    let span = |at: &dyn Fn(&DVec3) -> f64| {
        own.iter()
            .map(at)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let liberal: Vec<Vec<Segment>> =
        faces.iter().map(|faces| faces.iter().filter_map(|face| shadows(face, chart)).collect()).collect();
    let most = most_slope(scene);
    let mut lines = Vec::new();
    for first in solutions(scene, &liberal, span(&|corner| corner.x), most, |_| true, None, KEPT[0]) {
        let slices: Vec<Vec<Segment>> = faces
            .iter()
            .map(|faces| faces.iter().flat_map(|face| slice(face, first.offset, first.slope)).collect())
            .collect();
        let allowed = |slope: f64| {
            let slopes = DVec2::new(first.slope, slope);
            slopes.length() <= most && scene.allows(chart.direction(slopes))
        };
        let direct = |slope: f64| chart.direction(DVec2::new(first.slope, slope));
        // The part of the generator that is in the slice, in its own plane.
        let within = sliced(&own, first.offset, first.slope).map(|[a, b]| [a.x.min(b.x), a.x.max(b.x)]);
        let Some(within) = within else { continue };
        for second in solutions(scene, &slices, within, most, allowed, Some(&direct), KEPT[1]) {
            lines.extend(chart.line(scene, [first.offset, second.offset, first.slope, second.slope]));
        }
    }
    lines
}

/// A face as the segment between its corners of least and largest x, if it is turned to the generator's side.
fn shadows(face: &Seen, chart: &Chart) -> Option<Segment> {
    let corners = || face.pieces.iter().flatten();
    let low = corners().min_by(|a, b| a.x.total_cmp(&b.x))?;
    let high = corners().max_by(|a, b| a.x.total_cmp(&b.x))?;
    let ends = [low, high].map(|corner| DVec2::new(corner.x, corner.z));
    (face.normal.dot(chart.axes[2]) > 0.0).then_some(Segment { ends, normal: face.normal })
}

/// A face in the plane `x = offset + slope · z`: y and height.
fn slice(face: &Seen, offset: f64, slope: f64) -> impl Iterator<Item = Segment> + '_ {
    let pieces = face.pieces.iter().filter_map(move |piece| sliced(piece, offset, slope));
    pieces.map(|ends| Segment { ends, normal: face.normal })
}

/// Where a convex polygon crosses the plane.
fn sliced(corners: &[DVec3], offset: f64, slope: f64) -> Option<[DVec2; 2]> {
    let beyond = |corner: &DVec3| corner.x - offset - slope * corner.z;
    let mut ends = Vec::with_capacity(2);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (from, to) = (beyond(a), beyond(b));
        if (from < 0.0) != (to < 0.0) {
            let at = a.lerp(*b, from / (from - to));
            ends.push(DVec2::new(at.y, at.z));
        }
    }
    ends.try_into().ok()
}

/// The height at which each `offset + slope · z`, coming from above, meets the first of the segments, and which; `offsets` go
/// up.
fn first_met(segments: &[Segment], offsets: &[f64], slope: f64) -> Vec<Option<(f64, DVec3)>> {
    let mut first: Vec<Option<(f64, DVec3)>> = vec![None; offsets.len()];
    for segment in segments {
        let [a, b] = segment.ends.map(|end| end.x - slope * end.y);
        let from = offsets.partition_point(|offset| *offset <= a.min(b));
        let to = offsets.partition_point(|offset| *offset <= a.max(b));
        for (known, offset) in first[from..to].iter_mut().zip(&offsets[from..to]) {
            let height = segment.ends[0].lerp(segment.ends[1], (a - offset) / (a - b)).y;
            if known.is_none_or(|(highest, _)| height >= highest) {
                *known = Some((height, segment.normal));
            }
        }
    }
    first
}

/// The lines of a plane through the generator's span that leave the fewest pairs, the widest first among equals. `direct`
/// has the direction of a slope, where it is known.
fn solutions(
    scene: &Scene<DVec3>,
    segments: &[Vec<Segment>],
    span: [f64; 2],
    most: f64,
    allowed: impl Fn(f64) -> bool,
    direct: Option<&dyn Fn(f64) -> DVec3>,
    kept: usize,
) -> Vec<Solution> {
    let ends: Vec<DVec2> = segments.iter().flatten().flat_map(|segment| segment.ends).collect();
    let flattest = scene.sensor.max_incidence.cos();
    let mut found: Vec<Solution> = Vec::new();
    for slope in slopes(&ends, span, most).into_iter().filter(|slope| allowed(*slope)) {
        let mut critical: Vec<f64> = ends.iter().map(|end| end.x - slope * end.y).collect();
        critical.retain(|at| span[0] < *at && *at < span[1]);
        critical.extend(span);
        critical.sort_by(f64::total_cmp);
        let mut gaps: Vec<[f64; 2]> =
            critical.windows(2).map(|pair| [0.5 * (pair[0] + pair[1]), pair[1] - pair[0]]).collect();
        gaps.sort_by(|a, b| b[1].total_cmp(&a[1]));
        gaps.truncate(MOST_POSITIONS);
        gaps.retain(|gap| gap[1] > 0.0);
        gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let offsets: Vec<f64> = gaps.iter().map(|gap| gap[0]).collect();
        let of_members: Vec<_> =
            segments.iter().map(|segments| first_met(segments, &offsets, slope)).collect();
        let direction = direct.map(|direct| direct(slope));
        let stretch = (1.0 + slope * slope).sqrt();
        for (k, [offset, width]) in gaps.into_iter().enumerate() {
            let mut met: Vec<(f64, DVec3)> = of_members.iter().filter_map(|of_member| of_member[k]).collect();
            let steep = |normal: DVec3| direction.is_some_and(|one| -normal.dot(one) < flattest);
            if met.is_empty() || met.iter().any(|(_, normal)| steep(*normal)) {
                continue;
            }
            let num_missed = segments.len() - met.len();
            for (depth, _) in &mut met {
                *depth *= -stretch;
            }
            let left = num_missed.pow(2) + num_alike(scene, &mut met);
            found.push(Solution { offset, slope, left, width });
        }
    }
    found.sort_by(|a, b| a.left.cmp(&b.left).then(b.width.total_cmp(&a.width)));
    found.truncate(kept);
    found
}

/// Zero, and slopes in the middle between critical ones: those at which an end is seen at an end of the generator.
fn slopes(ends: &[DVec2], span: [f64; 2], most: f64) -> Vec<f64> {
    let of_end = |end: &DVec2| span.map(|from| (end.x - from) / end.y);
    let mut critical: Vec<f64> = ends.iter().flat_map(of_end).filter(|slope| slope.abs() < most).collect();
    critical.extend([-most, most]);
    critical.sort_by(f64::total_cmp);
    let middles: Vec<f64> = critical.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let count = middles.len().min(MOST_SLOPES - 1);
    let chosen = (0..count).map(|k| middles[(2 * k + 1) * middles.len() / (2 * count)]);
    std::iter::once(0.0).chain(chosen).collect()
}

/// Ordered pairs of readings that may be the same, each with itself included.
fn num_alike(scene: &Scene<DVec3>, seen: &mut [(f64, DVec3)]) -> usize {
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let near = 2.0 * scene.sensor.position_error;
    let least = scene.sensor.normal_error.map_or(-2.0, |error| (2.0 * error).cos());
    let mut left = seen.len();
    for (k, a) in seen.iter().enumerate() {
        let alike = seen[k + 1..].iter().take_while(|b| b.0 - a.0 <= near);
        left += 2 * alike.filter(|b| a.1.dot(b.1) >= least).count();
    }
    left
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3, dvec3};

    use super::super::candidates::Chart;
    use super::{Seen, first_met, predicted_hit_rate, slice};
    use crate::line::Line;
    use crate::space::shapes::{Cells, Random, mesh};

    /// MATH 2.5, E141: what is met first in the slice is what is met first in space.
    #[test]
    fn what_is_met_first_in_a_slice_is_met_first_in_space() {
        let mut random = Random(5);
        let mut met = 0;
        for _ in 0..100 {
            let model = mesh(&Cells::random(&mut random, 4, 0.5).shape());
            let pose = random.pose();
            let chart = Chart::new(pose.apply(dvec3(5.0, 5.0, 10.0)), random.direction());
            let faces: Vec<Seen> = model
                .faces
                .iter()
                .map(|face| {
                    let at = |k: &u32| chart.point(pose.apply(model.vertices[*k as usize].point));
                    let pieces = face.pieces.iter().map(|piece| piece.iter().map(at).collect()).collect();
                    Seen { pieces, normal: pose.rotation * face.normal }
                })
                .collect();
            for _ in 0..50 {
                let mut between = |half: f64| half * (2.0 * random.next() - 1.0);
                let (at, slopes) =
                    (DVec2::new(between(15.0), between(15.0)), DVec2::new(between(2.0), between(2.0)));
                let segments: Vec<_> = faces.iter().flat_map(|face| slice(face, at.x, slopes.x)).collect();
                let direction = chart.direction(slopes);
                let line = Line { start: chart.place(at) - 300.0 * direction, direction };
                let found = model.first_contact(pose, &line, 0.0);
                let height = found.map(|found| chart.point(line.at(found.depth)).z);
                let sliced = first_met(&segments, &[at.y], slopes.y)[0].map(|(height, _)| height);
                assert_eq!(height.is_some(), sliced.is_some());
                if let (Some(height), Some(sliced)) = (height, sliced) {
                    assert!((height - sliced).abs() < 1e-8, "{height} {sliced}");
                    met += 1;
                }
            }
        }
        assert!(met > 1_000, "{met}");
    }

    /// Against random lines through the bounding rectangle.
    #[test]
    fn the_predicted_hit_rate_is_the_share_of_lines_that_hit() {
        let mut random = Random(6);
        for _ in 0..20 {
            let mut corners = [0; 3].map(|_| 10.0 * random.direction());
            let slopes = DVec2::new(random.next() - 0.5, random.next() - 0.5);
            let seen = |corner: DVec3| corner.truncate() - corner.z * slopes;
            if (seen(corners[1]) - seen(corners[0])).perp_dot(seen(corners[2]) - seen(corners[0])) < 0.0 {
                corners.swap(1, 2);
            }
            let [a, b, c] = corners.map(seen);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let count = 20_000;
            let hits = (0..count)
                .filter(|_| {
                    let at = low + (high - low) * DVec2::new(random.next(), random.next());
                    [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).perp_dot(at - *p) >= 0.0)
                })
                .count();
            let measured = hits as f64 / f64::from(count);
            let predicted = predicted_hit_rate(&corners, slopes);
            assert!((measured - predicted).abs() < 0.02, "{measured} {predicted}");
            // Half for any triangle with a corner of its rectangle, less for others.
            assert!(predicted <= 0.5 + 1e-9);
        }
    }
}
