//! Schneiter's planner in the plane (thesis 5.4.3).
//!
//! A path starts on the boundary of the union of the placed parts, ends on the boundary of their intersection, and passes
//! through as few blocking boundaries as possible. The search looks at channels: where a blocking boundary along a face
//! ends, the region beyond, up to the next one, lets a path through.
//!
//! Where the description is silent:
//! - If no place is common to all parts, paths end where the most of them overlap; if no place is surely held by any,
//!   they go all the way through.
//! - Channels are found face by face: runs of cells along it, at the nominal pose, in which no blocking boundary of that
//!   face lies. The middle of each, and the first place beyond either end, are to be passed.
//! - Start points are some cells of the union's boundary, evenly thinned, from which the face is not met at more than Ω;
//!   besides the channels, lines between some cells of both boundaries are tried.
//! - Blocking boundaries are counted as pairs of hypotheses between which the path passes one, of faces that look toward
//!   it. Pairs that it passes by count as well. Of paths that pass as few, the best of each channel come first, that of
//!   the widest before others.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use glam::DVec2;

use super::blocking::Plane;
use super::whole;
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// So many start points are tried for each channel.
const NUM_STARTS: usize = 128;

/// So many cells of either boundary are joined by lines.
const NUM_JOINED: usize = 48;

/// So many paths are judged, at most.
const MOST_JUDGED: usize = 2000;

/// A place that a path should pass, with the face's normal and the width of the channel.
struct Channel {
    at: DVec2,
    normal: DVec2,
    width: f64,
}

/// A line, and how many pairs of hypotheses it leaves as far as blocking boundaries say.
struct Proposal {
    line: Line,
    left: usize,
    /// Among those through the same channel.
    rank: usize,
    width: f64,
}

/// Offers paths that pass the fewest blocking boundaries.
pub(crate) fn schneiter(best: &mut Best<'_>, cells: usize, settings: &PlanSettings, late: &dyn Fn() -> bool) {
    let scene = best.scene;
    let Some(plane) = Plane::new(scene, best.members, cells, late) else { return };
    let deepest = plane.depth.iter().copied().max().unwrap_or(0);
    let starts = plane.boundary(|cell| plane.occupied[cell]);
    let ends = plane.boundary(|cell| plane.occupied[cell] && plane.depth[cell] == deepest);
    let search = Search { scene, plane: &plane, num_members: best.members.len(), deepest };
    let mut proposals = Vec::new();
    for channel in channels(&plane) {
        if late() {
            break;
        }
        proposals.extend(search.through(&channel, &starts));
    }
    for end in thinned(&ends, NUM_JOINED).take_while(|_| !late()) {
        proposals.extend(search.to(plane.grid.center(end), &starts));
    }
    proposals.sort_by(|a, b| a.left.cmp(&b.left).then(a.rank.cmp(&b.rank)).then(b.width.total_cmp(&a.width)));
    for proposal in proposals.iter().take(MOST_JUDGED) {
        if best.enough(settings.stop) || best.num_judged >= settings.effort || late() {
            return;
        }
        let (angle, aside) = scene.numbers(&proposal.line);
        if let Some(line) = scene.line(angle, aside) {
            best.offer(&line);
        }
    }
}

/// Some of the cells, evenly spaced.
fn thinned(cells: &[usize], count: usize) -> impl Iterator<Item = usize> + '_ {
    let count = count.min(cells.len());
    (0..count).map(move |k| cells[k * cells.len() / count])
}

/// Runs along each face in which none of its blocking boundaries lies.
fn channels(plane: &Plane) -> Vec<Channel> {
    let mut channels = Vec::new();
    for (number, wall) in plane.walls.iter().enumerate() {
        let [from, to] = wall.ends;
        let count = (from.distance(to) / plane.grid.step).ceil().max(1.0);
        let place = |k: usize| from.lerp(to, (k as f64 + 0.5) / count);
        let blocked: Vec<bool> = (0..whole(count)).map(|k| plane.blocked(number, place(k))).collect();
        let mut first = 0;
        for run in blocked.chunk_by(|a, b| a == b) {
            let last = first + run.len() - 1;
            if !run[0] {
                let mut passed = vec![usize::midpoint(first, last), first, last];
                passed.truncate(if run.len() > 2 { 3 } else { 1 });
                let (normal, width) = (DVec2::from_angle(wall.normal), run.len() as f64);
                channels.extend(passed.into_iter().map(|k| Channel { at: place(k), normal, width }));
            }
            first = last + 1;
        }
    }
    channels
}

/// Traces lines through the plane.
struct Search<'a> {
    scene: &'a Scene,
    plane: &'a Plane,
    num_members: usize,
    /// So many parts hold the places at which paths end.
    deepest: u32,
}

impl Search<'_> {
    /// Lines from the union's boundary through a channel.
    fn through(&self, channel: &Channel, starts: &[usize]) -> Vec<Proposal> {
        let steepest = self.scene.sensor.max_incidence.cos();
        let toward = |start: usize| (channel.at - self.plane.grid.center(start)).try_normalize();
        let directions = thinned(starts, NUM_STARTS).filter_map(toward);
        let mut directions: Vec<DVec2> =
            directions.chain([-channel.normal]).filter(|one| -one.dot(channel.normal) >= steepest).collect();
        directions.sort_by(|a, b| a.dot(channel.normal).total_cmp(&b.dot(channel.normal)));
        self.ranked(
            directions.into_iter().map(|direction| Line { start: channel.at, direction }),
            channel.width,
        )
    }

    /// Lines from the union's boundary to a place where paths end.
    fn to(&self, end: DVec2, starts: &[usize]) -> Vec<Proposal> {
        let toward = |start: usize| (end - self.plane.grid.center(start)).try_normalize();
        let directions = thinned(starts, NUM_JOINED).filter_map(toward);
        self.ranked(directions.map(|direction| Line { start: end, direction }), 0.0)
    }

    /// Those lines that reach a place where paths end; of them, those that leave fewest first.
    fn ranked(&self, lines: impl Iterator<Item = Line>, width: f64) -> Vec<Proposal> {
        let traced = lines.filter_map(|line| Some((self.trace(&line)?, line)));
        let mut traced: Vec<(usize, Line)> = traced.collect();
        traced.sort_by_key(|(left, _)| *left);
        let proposal = |(rank, (left, line))| Proposal { line, left, rank, width };
        traced.into_iter().enumerate().map(proposal).collect()
    }

    /// The pairs that a line leaves, as far as blocking boundaries say; `None` if it reaches no place where paths end.
    fn trace(&self, line: &Line) -> Option<usize> {
        let grid = self.plane.grid;
        let side = grid.cells as f64 * grid.step;
        let middle = grid.low + 0.5 * side;
        let (nearest, step) = (line.coordinates(middle).0, 0.5 * grid.step);
        let at = |k: usize| line.at(nearest + step * k as f64 - FRAC_1_SQRT_2 * side);
        let mut passed: Vec<u32> = Vec::new();
        let mut reached = self.deepest == 0;
        for cell in (0..whole(SQRT_2 * side / step)).filter_map(|k| grid.cell(at(k))) {
            if self.deepest > 0 && self.plane.depth[cell] == self.deepest {
                reached = true;
                break;
            }
            let cover = self.plane.cover(cell);
            if passed.last() != Some(&cover) {
                passed.push(cover);
            }
        }
        reached.then(|| self.num_left(passed, line.direction))
    }

    /// Pairs of hypotheses with a blocking boundary among the passed, and pairs that are not met at all.
    fn num_left(&self, mut passed: Vec<u32>, direction: DVec2) -> usize {
        passed.sort_unstable();
        passed.dedup();
        let mut met = vec![false; self.num_members];
        let mut blocked = vec![false; self.num_members * self.num_members];
        for cover in passed {
            for member in self.plane.met(cover, direction) {
                met[member] = true;
            }
            for [a, b] in self.plane.blocking(cover, direction) {
                blocked[a.min(b) * self.num_members + a.max(b)] = true;
            }
        }
        let num_passed_by = met.iter().filter(|met| !**met).count();
        let num_blocked = blocked.iter().filter(|blocked| **blocked).count();
        num_blocked + num_passed_by * num_passed_by.saturating_sub(1) / 2
    }
}
