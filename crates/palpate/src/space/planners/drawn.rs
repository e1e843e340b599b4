//! Very many lines are looked at from one pose of each hypothesis, the most promising from more of them; those that are left
//! are given room, and the judge decides.
//!
//! **Why.** What a line meets at one pose takes a microsecond, and what it leaves there no judgement undercuts. Lines that meet
//! the same features at these poses are of one kind: a kind is a face of the arrangement of MATH 2.5, that many lines are in if
//! it is large, and one of them is in the midst of it. Where the whole pose sets spoil that one, others of the kind may do.
//!
//! **Which.** Half are drawn from all lines through the scene, evenly; half go to places of the hypotheses' faces within the
//! largest incidence of straight, where touches are most reliable. Draws are numbered: the same lines, whatever the machine.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

use fastrand::Rng;
use glam::DVec3;
use rayon::prelude::*;

use super::polish::polished;
use crate::best::Best;
use crate::feature::Feature;
use crate::line::{FirstContact, Line};
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Lines drawn by the end of each round, and for how many cells of pose sets a line may be judged in it: a line costs as many as
/// all sets have.
const ROUNDS: [(u64, usize); 3] = [(1 << 10, 1_000), (1 << 13, 16_000), (1 << 16, 32_000)];

/// Lines that are judged in a round, whatever they cost.
const FEWEST: usize = 32;

/// So many are looked at between two looks at the time, and so many judged.
const LOOKED_AT_ONCE: u64 = 1 << 12;
const JUDGED_AT_ONCE: usize = 16;

/// Kinds that are given room in a round, at most, and where the search is to be thorough.
const MOST_KINDS: usize = 128;
const MOST_THOROUGH: usize = 400;

/// Of the lines that leave as little as the best one so many are offered at a time: they may be more reliable. What that costs is
/// many judgements.
const MOST_EQUAL: usize = 2;

/// Around the best line: how far, as a share of the size and in radians, and so many lines each.
const NEAR: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
const NUM_NEAR: u64 = 48;

/// A line, and what it leaves where it was looked at.
#[derive(Debug, Clone, Copy)]
struct Seen {
    line: Line<DVec3>,
    left: usize,
    kind: u64,
}

/// How many rounds there are.
pub(super) const NUM_ROUNDS: usize = ROUNDS.len();

/// Offers the most promising lines of some rounds to `best`. Whether the search is over.
pub(super) fn draw(
    best: &mut Best<'_, DVec3>,
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
    rounds: Range<usize>,
) -> bool {
    let surfaces = Surfaces::new(best.scene, best.members);
    let cost: usize = best.members.iter().map(|member| best.scene.shadows[*member].cells.len()).sum();
    let mut first = if rounds.start == 0 { 0 } else { ROUNDS[rounds.start - 1].0 };
    for (last, most_cells) in ROUNDS[rounds].iter().copied() {
        let left = FEWEST.max(most_cells / cost.max(1));
        let mut search = Search { best: &mut *best, settings, late, left };
        let seen = search.look(&surfaces, first..last);
        let kinds = kinds(seen);
        if search.give_room(&kinds) || search.judge(&kinds) || search.improve(last) {
            return true;
        }
        first = last;
    }
    false
}

/// A search in progress; its steps say whether it is over.
struct Search<'s, 'a> {
    best: &'s mut Best<'a, DVec3>,
    settings: &'s PlanSettings<DVec3>,
    late: &'s dyn Fn() -> bool,
    /// Lines that may still be judged in this round.
    left: usize,
}

impl Search<'_, '_> {
    fn is_over(&self) -> bool {
        self.best.enough(self.settings.stop) || self.best.num_judged >= self.settings.effort || (self.late)()
    }

    /// Lines of these numbers that may become the best.
    fn look(&self, surfaces: &Surfaces<'_>, numbers: Range<u64>) -> Vec<Seen> {
        let (scene, members) = (self.best.scene, self.best.members);
        let most = if self.best.thorough { usize::MAX } else { self.best.num_left() };
        let mut all = Vec::new();
        for first in numbers.clone().step_by(LOOKED_AT_ONCE as usize) {
            if (self.late)() {
                break;
            }
            let some = (first..numbers.end.min(first + LOOKED_AT_ONCE)).into_par_iter();
            let look = |number: u64| {
                let line = surfaces.line(scene, number)?;
                let (left, kind) = scene.look(&line, members)?;
                (left <= most).then_some(Seen { line, left, kind })
            };
            all.extend(some.filter_map(look).collect::<Vec<Seen>>());
        }
        all
    }

    /// Judges a line in the midst of each kind, moved to where it has most room and as it is. Where no line is known that can be
    /// used the kinds with most lines come first.
    fn give_room(&mut self, kinds: &[Vec<Seen>]) -> bool {
        let (scene, members, thorough) = (self.best.scene, self.best.members, self.best.thorough);
        let around = |kind: &&Vec<Seen>| {
            let middle = midst(scene, kind);
            [polished(scene, members, &middle), Some(middle)]
        };
        if self.best.path.is_none() && !thorough {
            let mut largest: Vec<&Vec<Seen>> = kinds.iter().collect();
            largest.sort_by_key(|kind| std::cmp::Reverse(kind.len()));
            largest.truncate(JUDGED_AT_ONCE / 2);
            let lines: Vec<Line<DVec3>> = largest.par_iter().flat_map_iter(around).flatten().collect();
            self.offer(&lines);
        }
        let most = if thorough { MOST_THOROUGH } else { MOST_KINDS.min(self.left / 4) };
        let mut num_equal = 0;
        for some in kinds[..kinds.len().min(most)].chunks(JUDGED_AT_ONCE / 2) {
            if self.is_over() {
                return true;
            }
            let left = some[0][0].left;
            if self.best.hopeless(left) || (left == self.best.num_left() && num_equal >= MOST_EQUAL) {
                break;
            }
            num_equal += usize::from(left == self.best.num_left());
            let some: Vec<&Vec<Seen>> = some.iter().collect();
            let lines: Vec<Line<DVec3>> = some.par_iter().flat_map_iter(around).flatten().collect();
            self.offer(&lines);
        }
        self.is_over()
    }

    /// Judges lines as they were drawn, kind by kind.
    fn judge(&mut self, kinds: &[Vec<Seen>]) -> bool {
        if self.best.thorough {
            return self.is_over();
        }
        let lines: Vec<&Seen> = kinds.iter().flatten().collect();
        for some in lines.chunks(JUDGED_AT_ONCE) {
            if self.is_over() {
                return true;
            }
            if self.left < JUDGED_AT_ONCE {
                break;
            }
            let lines: Vec<Line<DVec3>> =
                some.iter().filter(|seen| seen.left < self.best.num_left()).map(|seen| seen.line).collect();
            self.offer(&lines);
        }
        self.is_over()
    }

    /// Judges lines near the best one, as long as there are better ones.
    fn improve(&mut self, round: u64) -> bool {
        for near in NEAR {
            let Some(path) = &self.best.path else { break };
            if self.is_over() {
                return true;
            }
            let (scene, center) = (self.best.scene, path.line);
            let moved = |k: u64| {
                let mut random = Rng::with_seed(round ^ (k << 32) ^ near.to_bits());
                let (right, up) = center.direction.any_orthonormal_pair();
                let mut step = || near * (2.0 * random.f64() - 1.0);
                let direction = (center.direction + step() * right + step() * up).normalize();
                let shift = scene.size * (step() * right + step() * up);
                scene.line(direction, center.at(center.depth_and_aside(scene.middle).0) + shift)
            };
            let mut lines: Vec<Line<DVec3>> =
                (0..NUM_NEAR.min(self.left as u64 / 4)).filter_map(moved).collect();
            lines.extend(polished(scene, self.best.members, &center));
            for some in lines.chunks(JUDGED_AT_ONCE) {
                if self.is_over() {
                    return true;
                }
                self.offer(some);
            }
        }
        self.is_over()
    }

    /// Offers those of some lines that may become the best; of those that leave as much as the best does, a few.
    fn offer(&mut self, lines: &[Line<DVec3>]) {
        let (scene, members, thorough) = (self.best.scene, self.best.members, self.best.thorough);
        let most = self.best.num_left();
        let affordable = self.settings.effort.saturating_sub(self.best.num_judged);
        let lines = &lines[..lines.len().min(usize::try_from(affordable).unwrap_or(usize::MAX))];
        let left = |line: &Line<DVec3>| {
            if thorough {
                return Some(Some(0));
            }
            let promising =
                scene.glance(line, members, usize::MAX)? <= most && scene.may_be_used(line, members);
            promising.then(|| scene.left_below(line, members, most + 1, |_, _| false))
        };
        // Of what has been judged, and what that leaves if it may be the best.
        let judged: Vec<(Option<usize>, &Line<DVec3>)> =
            lines.par_iter().filter_map(|line| Some((left(line)?, line))).collect();
        self.left = self.left.saturating_sub(judged.len());
        let mut found: Vec<(usize, &Line<DVec3>)> =
            judged.iter().filter_map(|(left, line)| Some(((*left)?, *line))).collect();
        self.best.num_judged += (judged.len() - found.len()) as u64;
        found.sort_by_key(|(left, _)| *left);
        let mut num_equal = 0;
        for (left, line) in found {
            let equal = !thorough && left == self.best.num_left();
            num_equal += usize::from(equal);
            if self.is_over() || self.best.hopeless(left) || (equal && num_equal > MOST_EQUAL) {
                break;
            }
            self.best.offer(line);
        }
    }
}

/// Lines by what they meet: those that leave least first, then the kinds of which there are most.
fn kinds(seen: Vec<Seen>) -> Vec<Vec<Seen>> {
    let mut of_kind: BTreeMap<(usize, u64), Vec<Seen>> = BTreeMap::new();
    for one in seen {
        of_kind.entry((one.left, one.kind)).or_default().push(one);
    }
    let mut kinds: Vec<Vec<Seen>> = of_kind.into_values().collect();
    kinds.sort_by(|a, b| a[0].left.cmp(&b[0].left).then(b.len().cmp(&a.len())));
    kinds
}

/// Of lines of one kind the one that is nearest to their mean.
fn midst(scene: &Scene<DVec3>, kind: &[Seen]) -> Line<DVec3> {
    let place = |line: &Line<DVec3>| line.at(line.depth_and_aside(scene.middle).0);
    let count = kind.len() as f64;
    let direction = kind.iter().map(|one| one.line.direction).sum::<DVec3>() / count;
    let middle = kind.iter().map(|one| place(&one.line)).sum::<DVec3>() / count;
    let off = |one: &Seen| {
        (one.line.direction - direction).length() * scene.size + place(&one.line).distance(middle)
    };
    kind.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a kind has a line").line
}

/// The members at one pose each, as surfaces of which places are drawn.
struct Surfaces<'a> {
    of_member: Vec<Surface<'a>>,
}

struct Surface<'a> {
    model: &'a crate::space::Model,
    pose: crate::space::Pose,
    /// Of the triangles up to each, summed.
    areas: Vec<f64>,
}

impl<'a> Surfaces<'a> {
    fn new(scene: &'a Scene<DVec3>, members: &[usize]) -> Self {
        let surface = |member: &usize| {
            let (model, pose) = (scene.shadows[*member].model(), scene.views[*member][0]);
            let mut sum = 0.0;
            let areas = model.triangles.iter().map(|(corners, face)| {
                let [a, b, c] = corners.map(|k| model.vertices[k as usize].point);
                sum += if model.faces[*face as usize].is_touchable() {
                    (b - a).cross(c - a).length()
                } else {
                    0.0
                };
                sum
            });
            Surface { model, pose, areas: areas.collect() }
        };
        Self { of_member: members.iter().map(surface).collect() }
    }

    /// The line with a number: an even one at one of all, an odd one at a face; `None` if it is not allowed.
    fn line(&self, scene: &Scene<DVec3>, number: u64) -> Option<Line<DVec3>> {
        let mut random = Rng::with_seed(number);
        if number.is_multiple_of(2) {
            let direction = scene.drawn_direction([random.f64(), random.f64()]);
            let (right, up) = direction.any_orthonormal_pair();
            let (sine, cosine) = (2.0 * PI * random.f64()).sin_cos();
            let off = scene.radius * random.f64().sqrt();
            return scene.line(direction, scene.middle + off * (cosine * right + sine * up));
        }
        let surface = &self.of_member[(number / 2) as usize % self.of_member.len()];
        let (place, normal) = surface.place(&mut random);
        let (right, up) = normal.any_orthonormal_pair();
        let (sine, cosine) = (2.0 * PI * random.f64()).sin_cos();
        // Straight ones are more reliable: more of them.
        let tilt = scene.sensor.max_incidence * random.f64();
        let toward = -(tilt.cos() * normal + tilt.sin() * (cosine * right + sine * up));
        scene.line(toward, place)
    }
}

impl Surface<'_> {
    /// A place on the surface and the outward normal there, world frame.
    fn place(&self, random: &mut Rng) -> (DVec3, DVec3) {
        let all = self.areas.last().copied().unwrap_or(0.0);
        let chosen = self.areas.partition_point(|sum| *sum < all * random.f64()).min(self.areas.len() - 1);
        let (corners, face) = &self.model.triangles[chosen];
        let [a, b, c] = corners.map(|k| self.model.vertices[k as usize].point);
        let (root, share) = (random.f64().sqrt(), random.f64());
        let place = a + root * (1.0 - share) * (b - a) + root * share * (c - a);
        (self.pose.apply(place), self.pose.rotation * self.model.faces[*face as usize].normal)
    }
}

impl Scene<DVec3> {
    /// Pairs that a line leaves at one pose of each member, and the kind of line: what it meets; `None` if it can't be used.
    fn look(&self, line: &Line<DVec3>, members: &[usize]) -> Option<(usize, u64)> {
        let met = self.met(line, members)?;
        let number = |met: &Option<FirstContact<DVec3>>| {
            met.map_or(0, |met| match met.feature {
                Feature::Face(k) => 1 + 3 * u64::from(k),
                Feature::Edge(k) => 2 + 3 * u64::from(k),
                Feature::Vertex(k) => 3 + 3 * u64::from(k),
            })
        };
        // FNV-1a, of the features.
        let kind = met
            .iter()
            .map(number)
            .fold(0xcbf2_9ce4_8422_2325_u64, |kind, number| (kind ^ number).wrapping_mul(0x0100_0000_01b3));
        Some((self.num_alike(&met), kind))
    }
}

#[cfg(test)]
mod tests {
    use glam::dvec3;

    use super::super::tests::{blocks, sensor};
    use super::*;
    use crate::dimension::Dimension;

    #[test]
    fn what_a_line_leaves_at_one_pose_no_judgement_undercuts() {
        let hypotheses = blocks();
        assert!(hypotheses.len() > 3);
        let scene = Scene::new(&hypotheses, &sensor(), &PlanSettings::default());
        let members = scene.everyone();
        let surfaces = Surfaces::new(&scene, &members);
        let (mut num_judged, mut num_equal) = (0, 0);
        for number in 0..4000 {
            let line = surfaces.line(&scene, number).expect("all are allowed");
            let looked = scene.look(&line, &members);
            assert_eq!(looked.map(|(left, _)| left), scene.glance(&line, &members, 1));
            if let Some(verdict) = scene.verdict(&line, &members, 0.0) {
                let (left, _) = looked.expect("what can be used can be used at each pose");
                assert!(left <= verdict.num_left());
                assert_eq!(
                    scene.left_below(&line, &members, usize::MAX, |_, _| false),
                    Some(verdict.num_left())
                );
                (num_judged, num_equal) =
                    (num_judged + 1, num_equal + usize::from(left == verdict.num_left()));
            }
        }
        assert!(num_judged > 500 && num_equal > 100, "{num_judged} {num_equal}");
    }

    #[test]
    fn lines_are_drawn_within_the_cone_and_the_workspace_and_at_faces() {
        let hypotheses = blocks();
        let (axis, cone) = (dvec3(0.3, 0.2, -1.0), 0.8);
        let (low, high) = (DVec3::splat(-60.0), DVec3::splat(80.0));
        let settings = PlanSettings {
            directions: Some((axis, cone)),
            workspace: Some([low, high]),
            ..PlanSettings::default()
        };
        let scene = Scene::new(&hypotheses, &sensor(), &settings);
        let members = scene.everyone();
        let surfaces = Surfaces::new(&scene, &members);
        let (mut evenly, mut at_faces) = (0, 0);
        for number in 0..2000 {
            let Some(line) = surfaces.line(&scene, number) else { continue };
            assert_eq!(surfaces.line(&scene, number), Some(line));
            assert!(Dimension::angle_between(axis, line.direction) <= cone + 1e-9);
            let room = (line.start - low).min(high - line.start).min_element();
            assert!(room.abs() < 1e-9, "{line:?} does not begin on the border");
            *if number.is_multiple_of(2) { &mut evenly } else { &mut at_faces } += 1;
        }
        assert!(evenly > 500 && at_faces > 100, "{evenly} {at_faces}");
    }

    #[test]
    fn kinds_are_sorted_by_what_they_leave_and_how_many_there_are() {
        let hypotheses = blocks();
        let scene = Scene::new(&hypotheses, &sensor(), &PlanSettings::default());
        let members = scene.everyone();
        let surfaces = Surfaces::new(&scene, &members);
        let seen = (0..3000).filter_map(|number| {
            let line = surfaces.line(&scene, number)?;
            let (left, kind) = scene.look(&line, &members)?;
            Some(Seen { line, left, kind })
        });
        let seen: Vec<Seen> = seen.collect();
        let count = seen.len();
        let kinds = kinds(seen);
        assert_eq!(kinds.iter().map(Vec::len).sum::<usize>(), count);
        assert!(kinds.windows(2).all(|two| {
            let [one, other] = [&two[0], &two[1]].map(|kind| (kind[0].left, std::cmp::Reverse(kind.len())));
            one <= other
        }));
        for kind in &kinds {
            assert!(kind.iter().all(|one| (one.left, one.kind) == (kind[0].left, kind[0].kind)));
            let middle = midst(&scene, kind);
            assert!(kind.iter().any(|one| one.line == middle));
        }
    }
}
