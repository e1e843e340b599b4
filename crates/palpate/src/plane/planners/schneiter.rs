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
//!   it. Of paths that pass as few, the one through the widest channel comes first.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec2;

use super::blocking::Plane;
use crate::plan::{Best, PlanSettings};
use crate::plane::rays::Line;
use crate::plane::scene::Scene;

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

/// A line, and how many pairs of hypotheses it passes blocking boundaries of.
struct Proposal {
    line: Line,
    num_blocked: usize,
    width: f64,
}

/// Offers paths that pass the fewest blocking boundaries.
pub(crate) fn schneiter(best: &mut Best<'_>, cells: usize, settings: &PlanSettings, late: &dyn Fn() -> bool) {
    let scene = best.scene;
    let plane = Plane::new(scene, best.members, cells);
    let deepest = plane.depth.iter().copied().max().unwrap_or(0);
    let starts = plane.boundary(|cell| plane.occupied[cell]);
    let ends = plane.boundary(|cell| plane.occupied[cell] && plane.depth[cell] == deepest);
    let mut proposals = Vec::new();
    let mut search =
        Search { plane: &plane, num_members: best.members.len(), deepest, proposals: &mut proposals };
    for channel in channels(&plane) {
        if late() {
            break;
        }
        search.through(scene, &channel, &starts);
    }
    for end in thinned(&ends, NUM_JOINED) {
        for start in thinned(&starts, NUM_JOINED) {
            search.trace(plane.grid.center(start), plane.grid.center(end), 0.0);
        }
    }
    proposals.sort_by(|a, b| a.num_blocked.cmp(&b.num_blocked).then(b.width.total_cmp(&a.width)));
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
        let blocked: Vec<bool> = (0..count as usize).map(|k| plane.blocked(number, place(k))).collect();
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
    plane: &'a Plane,
    num_members: usize,
    /// So many parts hold the places at which paths end.
    deepest: u32,
    proposals: &'a mut Vec<Proposal>,
}

impl Search<'_> {
    /// Lines from the union's boundary through a channel.
    fn through(&mut self, scene: &Scene, channel: &Channel, starts: &[usize]) {
        let steepest = scene.sensor.max_incidence.cos();
        for start in thinned(starts, NUM_STARTS) {
            let from = self.plane.grid.center(start);
            let direction = (channel.at - from).try_normalize().unwrap_or(-channel.normal);
            if -direction.dot(channel.normal) >= steepest {
                self.trace(from, from + direction, channel.width);
            }
        }
        self.trace(channel.at + channel.normal, channel.at, channel.width);
    }

    /// A line through two points, proposed if it reaches a place where paths end; it counts what it passes until then.
    fn trace(&mut self, from: DVec2, through: DVec2, width: f64) {
        let grid = self.plane.grid;
        let Some(direction) = (through - from).try_normalize() else { return };
        let diagonal = grid.cells as f64 * grid.step / FRAC_1_SQRT_2;
        let middle = grid.low + 0.5 * grid.cells as f64 * grid.step;
        let foot = from + (middle - from).dot(direction) * direction;
        let step = 0.5 * grid.step;
        let at = |k: usize| foot + (step * k as f64 - 0.5 * diagonal) * direction;
        let mut passed: Vec<u32> = Vec::new();
        let mut reached = self.deepest == 0;
        for cell in (0..(diagonal / step) as usize).filter_map(|k| grid.cell(at(k))) {
            if self.deepest > 0 && self.plane.depth[cell] == self.deepest {
                reached = true;
                break;
            }
            let cover = self.plane.cover(cell);
            if passed.last() != Some(&cover) {
                passed.push(cover);
            }
        }
        if reached {
            let num_blocked = self.num_blocked(passed, direction);
            self.proposals.push(Proposal { line: Line { start: from, direction }, num_blocked, width });
        }
    }

    /// Pairs of hypotheses with a blocking boundary among the passed.
    fn num_blocked(&self, mut passed: Vec<u32>, direction: DVec2) -> usize {
        passed.sort_unstable();
        passed.dedup();
        let mut blocked = vec![false; self.num_members * self.num_members];
        for block in passed.into_iter().flat_map(|cover| self.plane.blocking(cover, direction)) {
            let [a, b] = block.members;
            blocked[a.min(b) * self.num_members + a.max(b)] = true;
        }
        blocked.into_iter().filter(|pair| *pair).count()
    }
}
