//! Schneiter's planner in space (thesis 5.4.3).
//!
//! A path starts on the boundary of the union of the placed parts, ends on the boundary of their intersection, and passes
//! through as few blocking boundaries as possible. The search looks at channels: where a blocking boundary along a face
//! ends, the region beyond, up to the next one, lets a path through.
//!
//! The section doubts that this is feasible in space, for the cost of the blocking regions and the number of start points,
//! end points and regions between them. Here space is a grid of cells (`blocking`), as the section's plane is: cells give
//! both boundaries and, with the faces whose extended regions run through them, where blocking boundaries may be. What is
//! searched is what gave the name: channels first, each with some start points, rather than all pairs of end points.
//!
//! Where the description is silent:
//! - If no place is common to all parts, paths end where the most of them overlap; if no place is surely held by any,
//!   they go all the way through.
//! - Channels are found face by face, on a lattice of points on it, at the nominal pose: points through which no blocking
//!   boundary of that face runs. The one farthest from all blocked, and some next to blocked ones, are to be passed. The
//!   widest channels of all faces are kept.
//! - Start points are some cells of the union's boundary, evenly thinned, from which the face is not met at more than Ω;
//!   besides the channels, lines between some cells of both boundaries are tried.
//! - Blocking boundaries are counted as pairs of hypotheses between which the path passes one, of faces that look toward
//!   it. Pairs that it passes by count as well. Of paths that pass as few, the best of each channel come first, that of
//!   the widest before others.

use glam::DVec3;
use rayon::prelude::*;

use super::blocking::{Volume, Wall, whole};
use super::rendering::clearances;
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// So many channels are tried, and so many start points for each.
const MOST_CHANNELS: usize = 384;
const NUM_STARTS: usize = 48;

/// So many cells of either boundary are joined by lines.
const NUM_JOINED: usize = 32;

/// So many paths are judged, at most.
const MOST_JUDGED: usize = 256;

/// Points of a face's lattice along a side, at most.
const MOST_POINTS: f64 = 48.0;

/// Channels, or proposals, that are looked at between two looks at the time.
const AT_ONCE: usize = 16;

/// A place that a path should pass, with the face's normal and the width of the channel.
struct Channel {
    at: DVec3,
    normal: DVec3,
    width: f64,
}

/// A line, and how many pairs of hypotheses it leaves as far as blocking boundaries say.
struct Proposal {
    line: Line<DVec3>,
    left: usize,
    /// Among those through the same channel.
    rank: usize,
    width: f64,
}

/// Offers paths that pass the fewest blocking boundaries.
pub(super) fn schneiter(
    best: &mut Best<'_, DVec3>,
    cells: usize,
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    let (scene, members) = (best.scene, best.members);
    let Some(volume) = Volume::new(scene, members, cells, late) else { return };
    let deepest = volume.depth.iter().copied().max().unwrap_or(0);
    let starts = volume.boundary(|cell| volume.occupied[cell]);
    let ends = volume.boundary(|cell| volume.occupied[cell] && volume.depth[cell] == deepest);
    let search = Search { scene, volume: &volume, num_members: members.len(), deepest };
    let mut proposals = Vec::new();
    for some in channels(&volume).chunks(AT_ONCE) {
        if late() {
            break;
        }
        proposals.par_extend(some.par_iter().flat_map_iter(|channel| search.through(channel, &starts)));
    }
    let ends: Vec<usize> = thinned(&ends, NUM_JOINED).collect();
    for some in ends.chunks(AT_ONCE) {
        if late() {
            break;
        }
        let to = |end: &usize| search.to(volume.grid.center(*end), &starts);
        proposals.par_extend(some.par_iter().flat_map_iter(to));
    }
    proposals.sort_by(|a, b| a.left.cmp(&b.left).then(a.rank.cmp(&b.rank)).then(b.width.total_cmp(&a.width)));
    proposals.truncate(MOST_JUDGED);
    for some in proposals.chunks(AT_ONCE) {
        let left = best.num_left();
        let look = |proposal: &Proposal| {
            let line = scene.line(proposal.line.direction, proposal.line.start)?;
            // What is seen are valid poses: over all poses a line leaves no fewer.
            (scene.glance(&line, members, usize::MAX)? <= left).then_some(line)
        };
        let lines: Vec<Line<DVec3>> = some.par_iter().filter_map(look).collect();
        for line in lines {
            if best.enough(settings.stop) || best.num_judged >= settings.effort || late() {
                return;
            }
            best.offer(&line);
        }
    }
}

/// Some of the cells, evenly spaced.
fn thinned(cells: &[usize], count: usize) -> impl Iterator<Item = usize> + '_ {
    let count = count.min(cells.len());
    (0..count).map(move |k| cells[k * cells.len() / count])
}

/// Places on the faces at which none of their blocking boundaries is, the widest first.
fn channels(volume: &Volume<'_>) -> Vec<Channel> {
    let numbers: Vec<usize> = (0..volume.walls.len()).filter(|k| volume.walls[*k].touchable).collect();
    let mut channels: Vec<Channel> =
        numbers.par_iter().flat_map_iter(|wall| channels_of(volume, *wall)).collect();
    channels.sort_by(|a, b| b.width.total_cmp(&a.width));
    channels.truncate(MOST_CHANNELS);
    channels
}

/// The point of a wall that is farthest from all that is blocked, and the first beyond a blocking boundary's end.
fn channels_of(volume: &Volume<'_>, number: usize) -> Vec<Channel> {
    let wall = &volume.walls[number];
    let Lattice { points, count, step } = Lattice::of(wall, volume.grid.step);
    let on_face: Vec<bool> = points.iter().map(|at| wall.holds(*at)).collect();
    let open: Vec<bool> =
        points.iter().zip(&on_face).map(|(at, holds)| *holds && !volume.blocked(number, *at)).collect();
    let clear = clearances(&open, count);
    let Some(middle) =
        (0..clear.len()).filter(|k| open[*k]).max_by_key(|k| (clear[*k], std::cmp::Reverse(*k)))
    else {
        return Vec::new();
    };
    let beside = |k: usize| {
        let sides = [k.checked_sub(1), Some(k + 1), k.checked_sub(count), Some(k + count)];
        sides.into_iter().flatten().any(|next| next < open.len() && on_face[next] && !open[next])
    };
    let beyond: Vec<usize> = (0..open.len()).filter(|k| open[*k] && beside(*k)).collect();
    let (normal, width) = (wall.normal, f64::from(clear[middle]) * step);
    let passed = std::iter::once(middle).chain(thinned(&beyond, 2));
    passed.map(|k| Channel { at: points[k], normal, width }).collect()
}

/// A square lattice of points in the plane of a face, around it.
struct Lattice {
    points: Vec<DVec3>,
    count: usize,
    step: f64,
}

impl Lattice {
    fn of(wall: &Wall, step: f64) -> Self {
        let (right, up) = wall.normal.any_orthonormal_pair();
        let corners = || wall.pieces.iter().flatten();
        let range = |axis: DVec3| {
            let along = corners().map(|corner| axis.dot(*corner));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        };
        let ((left, right_end), (bottom, top)) = (range(right), range(up));
        let extent = (right_end - left).max(top - bottom);
        // Four at least, so that a face narrower than a cell has its own.
        let wanted = (extent / step).ceil().clamp(4.0, MOST_POINTS);
        let step = extent / wanted;
        let count = whole(wanted);
        let place = |row: usize, column: usize| {
            let (x, y) = (left + step * (column as f64 + 0.5), bottom + step * (row as f64 + 0.5));
            x * right + y * up + wall.offset * wall.normal
        };
        let points = (0..count).flat_map(|row| (0..count).map(move |column| place(row, column))).collect();
        Self { points, count, step }
    }
}

/// Traces lines through space.
struct Search<'a> {
    scene: &'a Scene<DVec3>,
    volume: &'a Volume<'a>,
    num_members: usize,
    /// So many parts hold the places at which paths end.
    deepest: u32,
}

impl Search<'_> {
    /// Lines from the union's boundary through a channel.
    fn through(&self, channel: &Channel, starts: &[usize]) -> Vec<Proposal> {
        let steepest = self.scene.sensor.max_incidence.cos();
        let toward = |start: usize| (channel.at - self.volume.grid.center(start)).try_normalize();
        let directions = thinned(starts, NUM_STARTS).filter_map(toward);
        let mut directions: Vec<DVec3> =
            directions.chain([-channel.normal]).filter(|one| -one.dot(channel.normal) >= steepest).collect();
        directions.sort_by(|a, b| a.dot(channel.normal).total_cmp(&b.dot(channel.normal)));
        let lines = directions.into_iter().map(|direction| Line { start: channel.at, direction });
        self.ranked(lines, channel.width)
    }

    /// Lines from the union's boundary to a place where paths end.
    fn to(&self, end: DVec3, starts: &[usize]) -> Vec<Proposal> {
        let toward = |start: usize| (end - self.volume.grid.center(start)).try_normalize();
        let directions = thinned(starts, NUM_JOINED).filter_map(toward);
        self.ranked(directions.map(|direction| Line { start: end, direction }), 0.0)
    }

    /// Those lines that are allowed and reach a place where paths end; of them, those that leave fewest first.
    fn ranked(&self, lines: impl Iterator<Item = Line<DVec3>>, width: f64) -> Vec<Proposal> {
        let allowed = lines.filter(|line| self.scene.allows(line.direction));
        let mut traced: Vec<(usize, Line<DVec3>)> =
            allowed.filter_map(|line| Some((self.trace(&line)?, line))).collect();
        traced.sort_by_key(|(left, _)| *left);
        let proposal = |(rank, (left, line))| Proposal { line, left, rank, width };
        traced.into_iter().enumerate().map(proposal).collect()
    }

    /// The pairs that a line leaves, as far as blocking boundaries say; `None` if it reaches no place where paths end.
    fn trace(&self, line: &Line<DVec3>) -> Option<usize> {
        let grid = self.volume.grid;
        let middle = line.depth_and_aside(self.scene.middle).0;
        let half = 0.5 * 3_f64.sqrt() * grid.cells as f64 * grid.step;
        let mut passed: Vec<u32> = Vec::new();
        let mut end = f64::INFINITY;
        let mut last = usize::MAX;
        let mut at = middle - half;
        while at < middle + half {
            let cell = grid.cell(line.at(at)).filter(|cell| *cell != last);
            if let Some(cell) = cell {
                last = cell;
                if self.deepest > 0 && self.volume.depth[cell] == self.deepest {
                    end = at;
                    break;
                }
                passed.extend(&self.volume.covers[cell]);
            }
            at += 0.5 * grid.step;
        }
        (self.deepest == 0 || end.is_finite()).then(|| self.num_left(passed, line))
    }

    /// Pairs of hypotheses with a blocking boundary among the passed, and pairs that are not met at all.
    fn num_left(&self, mut passed: Vec<u32>, line: &Line<DVec3>) -> usize {
        passed.sort_unstable();
        passed.dedup();
        let walls = passed.iter().map(|wall| &self.volume.walls[*wall as usize]);
        // Where the line goes through those that look toward it.
        let crossed: Vec<(&Wall, DVec3)> = walls
            .filter(|wall| wall.normal.dot(line.direction) < 0.0)
            .map(|wall| {
                let depth = (wall.offset - wall.normal.dot(line.start)) / wall.normal.dot(line.direction);
                (wall, line.at(depth))
            })
            .filter(|(wall, at)| wall.holds(*at))
            .collect();
        let n = self.num_members;
        let (mut met, mut blocked) = (vec![false; n], vec![false; n * n]);
        for (k, (a, at)) in crossed.iter().enumerate() {
            met[a.member] = true;
            for (b, other) in &crossed[..k] {
                if self.volume.confused(a, b, *at) || self.volume.confused(b, a, *other) {
                    blocked[a.member.min(b.member) * n + a.member.max(b.member)] = true;
                }
            }
        }
        let num_passed_by = met.iter().filter(|met| !**met).count();
        let num_blocked = blocked.iter().filter(|blocked| **blocked).count();
        num_blocked + num_passed_by * num_passed_by.saturating_sub(1) / 2
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::tests::{blocks, sensor};
    use super::*;
    use crate::space::Pose;

    /// Of two blocks that stand alike only the tops, and the sides above the lower one, let paths through.
    #[test]
    fn channels_are_where_the_blocks_differ() {
        let mut hypotheses = blocks();
        hypotheses.retain(|one| one.poses.contains(Pose::IDENTITY));
        let settings = PlanSettings::default();
        let scene = Scene::new(&hypotheses, &sensor(), &settings);
        let members = scene.everyone();
        let volume = Volume::new(&scene, &members, 48, &|| false).expect("time is not limited");
        let channels = channels(&volume);
        assert!(channels.len() >= 6);
        let tops = channels.iter().filter(|channel| channel.normal.z > 0.9).count();
        assert!(tops >= 2);
        // Cells are coarser than what the planes say: a side is blocked up to a cell above the lower block.
        let lowest = 12.0 - 2.0 * volume.grid.step;
        for channel in &channels {
            assert!(channel.at.z > lowest, "{} along {}", channel.at, channel.normal);
        }

        // From above both are told apart; from below, and from the side, they are not, and beside them nothing is met.
        let search = Search { scene: &scene, volume: &volume, num_members: 2, deepest: 2 };
        let traced = |direction: DVec3, start: DVec3| search.trace(&Line { start, direction });
        assert_eq!(traced(-DVec3::Z, DVec3::new(15.0, 10.0, 50.0)), Some(0));
        assert_eq!(traced(DVec3::Z, DVec3::new(15.0, 10.0, -50.0)), Some(1));
        assert_eq!(traced(DVec3::X, DVec3::new(-50.0, 10.0, 6.0)), Some(1));
        assert_eq!(traced(DVec3::X, DVec3::new(-50.0, 30.0, 6.0)), None);
    }
}
