//! Lines as a generator sees them, and the faces that a line is to meet (thesis 5.1).
//!
//! A generator is a face of one hypothesis that must be touched. Its chart has the outward normal as Z; a line is
//! `(x, y) + z·(α, β)`, travelled toward −Z (MATH row 57). A corner P is seen at `(P_x − α P_z, P_y − β P_z)` (5.2 with row 76).

use std::collections::BTreeMap;
use std::sync::OnceLock;

use glam::{DVec2, DVec3, dvec3};
use rayon::prelude::*;

use crate::Feature;
use crate::best::Best;
use crate::dimension::Dimension;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;
use crate::space::lp::{Program, Row};
use crate::space::scene::{features, piece_at};

/// Generators that are planned for, and how many between two looks at the time.
const MOST_GENERATORS: usize = 96;
const AT_ONCE: usize = 12;

/// Lines that are judged of so many generators, at most, unless the search is to be thorough.
const MOST_JUDGED: usize = 8;

/// Lines that are looked at from all views of so many generators, likewise.
const MOST_LOOKED_AT: usize = 32;

/// Directions all around from which candidate sets are looked for.
const NUM_DIRECTIONS: usize = 32;

/// Candidate sets of a generator that are planned for: those that leave the fewest pairs.
const MOST_SETS: usize = 3;

/// The steepest slope that is planned, about 63° from the generator's normal.
const MOST_SLOPE: f64 = 2.0;

/// Two shifts, two slopes, the room.
pub(super) const WIDTH: usize = 5;

/// Coordinates about a generator.
#[derive(Debug, Clone, Copy)]
pub struct Chart {
    /// The origin, world frame.
    pub origin: DVec3,
    /// Unit axes, world frame, at right angles; Z is the outward normal.
    pub axes: [DVec3; 3],
}

impl Chart {
    /// Of an origin and a unit normal.
    #[must_use]
    pub fn new(origin: DVec3, normal: DVec3) -> Self {
        let (right, up) = normal.any_orthonormal_pair();
        Self { origin, axes: [right, up, normal] }
    }

    /// Turned about the normal, radians.
    #[must_use]
    pub fn turned(&self, angle: f64) -> Self {
        let [right, up, normal] = self.axes;
        let (sine, cosine) = angle.sin_cos();
        Self { axes: [cosine * right + sine * up, cosine * up - sine * right, normal], ..*self }
    }

    /// A point of the world.
    #[must_use]
    pub fn point(&self, point: DVec3) -> DVec3 {
        let offset = point - self.origin;
        let [x, y, z] = self.axes.map(|axis| axis.dot(offset));
        dvec3(x, y, z)
    }

    /// The direction of travel of two slopes, unit, world frame.
    #[must_use]
    pub fn direction(&self, slopes: DVec2) -> DVec3 {
        let [right, up, normal] = self.axes;
        -(slopes.x * right + slopes.y * up + normal).normalize()
    }

    /// The place in the generator's plane, world frame.
    #[must_use]
    pub fn place(&self, at: DVec2) -> DVec3 {
        self.origin + at.x * self.axes[0] + at.y * self.axes[1]
    }

    /// `x`, `y`, α and β of a line toward the generator's plane.
    fn parameters(&self, line: &Line<DVec3>) -> [f64; 4] {
        let [x, y, z] = self.axes.map(|axis| axis.dot(line.direction));
        let (start, slopes) = (self.point(line.start), DVec2::new(x, y) / z);
        let at = start.truncate() - start.z * slopes;
        [at.x, at.y, slopes.x, slopes.y]
    }

    /// The line of `x`, `y`, α and β.
    pub(super) fn line(&self, scene: &Scene<DVec3>, [x, y, a, b]: [f64; 4]) -> Option<Line<DVec3>> {
        scene.line(self.direction(DVec2::new(a, b)), self.place(DVec2::new(x, y)))
    }
}

/// A face of one hypothesis at its nominal pose, which must be touched.
#[derive(Debug, Clone)]
pub(super) struct Generator {
    pub member: usize,
    pub face: u32,
    pub chart: Chart,
    /// World frame, moved out by the radius of the tip; convex, counter-clockwise from outside.
    pub corners: Vec<DVec3>,
    /// Once they were asked for.
    sets: OnceLock<Vec<CandidateSet>>,
}

/// The side of a convex piece, chart coordinates, the piece on its left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub ends: [DVec3; 2],
    /// It counts as moved inward by this.
    pub inward: f64,
}

/// Faces that one line is to meet, in pieces, each at all views of its hypothesis.
#[derive(Debug, Clone)]
pub(super) struct CandidateSet {
    /// Corners in the chart, counter-clockwise.
    pub pieces: Vec<Vec<DVec3>>,
    /// A line that meets them at the nominal poses.
    pub start: [f64; 4],
}

/// The largest slope, of Ω: ρ.
pub(super) fn most_slope(scene: &Scene<DVec3>) -> f64 {
    scene.sensor.max_incidence.tan().abs().min(MOST_SLOPE)
}

/// The largest pieces of each member first.
pub(super) fn generators(scene: &Scene<DVec3>, members: &[usize]) -> Vec<Generator> {
    let mut all: Vec<(usize, Generator)> = Vec::new();
    for &member in members {
        let (model, pose) = (scene.shadows[member].model(), scene.views[member][0]);
        let mut own: Vec<(f64, Generator)> = Vec::new();
        for (number, face) in (0_u32..).zip(&model.faces).filter(|(_, face)| face.is_touchable()) {
            let normal = pose.rotation * face.normal;
            let within =
                |(axis, cone)| Dimension::angle_between(axis, -normal) <= cone + scene.sensor.max_incidence;
            if !scene.directions.is_none_or(within) || scene.unwanted(member, Feature::Face(number)).is_some()
            {
                continue;
            }
            for piece in &face.pieces {
                let at = |k: &u32| pose.apply(model.vertices[*k as usize].point);
                let corners: Vec<DVec3> =
                    piece.iter().map(|k| at(k) + scene.sensor.tip_radius * normal).collect();
                let origin = corners.iter().sum::<DVec3>() / corners.len() as f64;
                let chart = Chart::new(origin, normal);
                let seen: Vec<DVec3> = corners.iter().map(|corner| chart.point(*corner)).collect();
                own.push((area(&seen, DVec2::ZERO), Generator::new(member, number, chart, corners)));
            }
        }
        own.sort_by(|a, b| b.0.total_cmp(&a.0));
        all.extend(own.into_iter().map(|(_, one)| one).enumerate());
    }
    all.sort_by_key(|(rank, _)| *rank);
    all.into_iter().map(|(_, one)| one).take(MOST_GENERATORS).collect()
}

/// The signed area of a polygon as it is seen at two slopes.
pub(super) fn area(corners: &[DVec3], slopes: DVec2) -> f64 {
    let seen = |corner: &DVec3| corner.truncate() - corner.z * slopes;
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    0.5 * sides.map(|(a, b)| seen(a).perp_dot(seen(b))).sum::<f64>()
}

/// Offers what is planned for each generator.
pub(super) fn offer_planned(
    best: &mut Best<'_, DVec3>,
    generators: &[Generator],
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
    plan: impl Fn(&Scene<DVec3>, &[usize], &Generator) -> Vec<Line<DVec3>> + Sync,
) {
    let (scene, members) = (best.scene, best.members);
    for some in generators.chunks(AT_ONCE) {
        if late() || best.num_judged >= settings.effort || best.enough(settings.stop) {
            return;
        }
        let lines: Vec<Line<DVec3>> =
            some.par_iter().flat_map_iter(|generator| plan(scene, members, generator)).collect();
        let (most, thorough) = (best.num_left(), best.thorough);
        // From one view at first, which is quick.
        let look = |line: Line<DVec3>, num_views: usize| {
            let left = scene.glance(&line, members, num_views)?;
            (thorough || left <= most).then_some((left, line))
        };
        let mut looked_at: Vec<(usize, Line<DVec3>)> =
            lines.into_par_iter().filter_map(|line| look(line, 1)).collect();
        looked_at.sort_by_key(|(left, _)| *left);
        looked_at.truncate(if thorough { usize::MAX } else { MOST_LOOKED_AT });
        let looked_at: Vec<(usize, Line<DVec3>)> =
            looked_at.into_par_iter().filter_map(|(_, line)| look(line, usize::MAX)).collect();
        let may_be_used = |(_, line): &(usize, Line<DVec3>)| thorough || scene.may_be_used(line, members);
        let mut looked_at: Vec<_> = looked_at.into_par_iter().filter(may_be_used).collect();
        looked_at.sort_by_key(|(left, _)| *left);
        looked_at.truncate(if thorough { usize::MAX } else { MOST_JUDGED });
        for (left, line) in looked_at {
            if late() || best.num_judged >= settings.effort || best.enough(settings.stop) {
                return;
            }
            if !best.hopeless(left) {
                best.offer(&line);
            }
        }
    }
}

impl Generator {
    fn new(member: usize, face: u32, chart: Chart, corners: Vec<DVec3>) -> Self {
        Self { member, face, chart, corners, sets: OnceLock::new() }
    }

    /// The sets of faces that lines through it meet, those that leave the fewest pairs at the nominal poses first.
    pub fn candidate_sets(&self, scene: &Scene<DVec3>, members: &[usize]) -> &[CandidateSet] {
        self.sets.get_or_init(|| candidate_sets(scene, members, self))
    }
}

fn candidate_sets(scene: &Scene<DVec3>, members: &[usize], generator: &Generator) -> Vec<CandidateSet> {
    let normal = generator.chart.axes[2];
    let flattest = most_slope(scene).atan().cos();
    let across = scene.directions(NUM_DIRECTIONS).filter(|one| -one.dot(normal) >= flattest);
    let middle = generator.chart.origin;
    let places: Vec<DVec3> =
        std::iter::once(middle).chain(generator.corners.iter().map(|one| middle.midpoint(*one))).collect();
    let mut found: BTreeMap<Vec<Option<Feature>>, (usize, Line<DVec3>)> = BTreeMap::new();
    for direction in std::iter::once(-normal).chain(across) {
        for line in places.iter().filter_map(|place| scene.line(direction, *place)) {
            let Some(met) = scene.met(&line, members) else { continue };
            let left = scene.num_alike(&met);
            let features = features(&met);
            let own = members.iter().position(|member| *member == generator.member);
            if own.is_some_and(|own| features[own] == Some(Feature::Face(generator.face))) {
                found.entry(features).or_insert((left, line));
            }
        }
    }
    let mut sets: Vec<(usize, Line<DVec3>)> = found.into_values().collect();
    sets.sort_by_key(|(left, _)| *left);
    sets.truncate(MOST_SETS);
    sets.into_iter().filter_map(|(_, line)| candidate_set(scene, members, &generator.chart, &line)).collect()
}

/// The convex pieces that a line meets at the nominal poses, at all views; `None`: it meets edges or vertices.
fn candidate_set(
    scene: &Scene<DVec3>,
    members: &[usize],
    chart: &Chart,
    line: &Line<DVec3>,
) -> Option<CandidateSet> {
    let mut pieces = Vec::new();
    for &member in members {
        let (model, views) = (scene.shadows[member].model(), &scene.views[member]);
        let Some(met) = scene.contact(member, views[0], line) else { continue };
        let Feature::Face(number) = met.feature else { return None };
        let place = views[0].inverse().apply(line.at(met.depth) - scene.sensor.tip_radius * met.normal);
        let (face, piece) = (&model.faces[number as usize], piece_at(model, number, place)?);
        for pose in views {
            // The side of a loose face that is met is the one that is turned to the line.
            let normal = pose.rotation * face.normal;
            let out = if normal.dot(line.direction) < 0.0 { normal } else { -normal };
            let moved = scene.sensor.tip_radius * out;
            let at = |k: &u32| chart.point(pose.apply(model.vertices[*k as usize].point) + moved);
            let mut corners: Vec<DVec3> = piece.iter().map(at).collect();
            if normal.dot(line.direction) >= 0.0 {
                corners.reverse();
            }
            pieces.push(corners);
        }
    }
    Some(CandidateSet { pieces, start: chart.parameters(line) })
}

/// The sides of a piece.
pub(super) fn sides(corners: &[DVec3], inward: f64) -> impl Iterator<Item = Side> + '_ {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.map(move |(a, b)| Side { ends: [*a, *b], inward })
}

impl Side {
    /// How far inside of it a line is as the line sees it, and the gradient `(N_x, N_y, L_z N_x, L_z N_y)` (MATH row 81).
    /// `None`: the line runs along it.
    pub fn room(&self, [x, y, a, b]: [f64; 4]) -> Option<(f64, [f64; 4])> {
        let slopes = DVec2::new(a, b);
        let [from, to] = self.ends.map(|end| end.truncate() - end.z * slopes);
        let along = to - from;
        let inward = along.perp().try_normalize()?;
        let offset = DVec2::new(x, y) - from;
        let share = offset.dot(along) / along.length_squared();
        let height = self.ends[0].z + share * (self.ends[1].z - self.ends[0].z);
        let gradient = [inward.x, inward.y, height * inward.x, height * inward.y];
        Some((inward.dot(offset) - self.inward, gradient))
    }
}

/// The least room of a line.
pub(super) fn least_room(sides: &[Side], at: [f64; 4]) -> f64 {
    sides.iter().filter_map(|side| side.room(at)).map(|(room, _)| room).fold(f64::INFINITY, f64::min)
}

/// Within a box about `at`, where the least room, taken as linear, is largest; where none is inside of all sides, the least
/// violation (MATH rows 79, 80).
pub(super) fn roomiest(sides: &[Side], at: [f64; 4], half: [f64; 4], size: f64) -> [f64; 4] {
    let rows = sides.iter().filter_map(|side| {
        let (bound, [x, y, a, b]) = side.room(at)?;
        Some(Row { normal: [-x, -y, -a, -b, 1.0], bound })
    });
    let [x, y, a, b] = most_room(rows, half, size);
    [at[0] + x, at[1] + y, at[2] + a, at[3] + b]
}

/// The step of shifts and slopes within a box that gives the most room, rows being linear in these and in the room.
pub(super) fn most_room(
    rows: impl Iterator<Item = Row<WIDTH>>,
    [x, y, a, b]: [f64; 4],
    most: f64,
) -> [f64; 4] {
    let mut objective = [0.0; WIDTH];
    objective[WIDTH - 1] = 1.0;
    let [x, y, a, b, _] = Program::new(rows, [x, y, a, b, most]).maximize(&objective).point;
    [x, y, a, b]
}
