//! The planner of first choice in space: renderings in many directions propose, views sort out, margins are widened, and the judge decides.
//!
//! At a fixed direction what a part is met on first is constant between the projections of its edges (MATH 2.5); a grid shows
//! these regions, and the line in the middle of one stands for all of it. Directions are those against the faces' normals,
//! at which touches are most reliable, and others evenly over the sphere.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::polish::polished;
use super::rendering::{Grid, Rendering, clearances};
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;
use crate::space::site::angle;

/// Directions all around, and lines along each side of a grid: of the first round, and of the second if the first finds nothing
/// that is good enough.
const ROUNDS: [(usize, usize); 2] = [(96, 40), (384, 64)];

/// Normals that are nearer to each other than this count as one, radians.
const ALIKE: f64 = 0.1;

/// So many proposals are looked at from all views, and so many are judged, at most, in a round, unless the search is to be thorough.
const MOST_LOOKED_AT: usize = 400;
const MOST_JUDGED: usize = 48;

/// So many are judged at once.
const JUDGED_AT_ONCE: usize = 8;

/// Directions that are rendered between two looks at the time.
const AT_ONCE: usize = 32;

/// Lines that meet the same features count as one; of each kind so many are kept.
const KEPT_OF_A_KIND: usize = 3;

/// Of each direction so many numbers of pairs that are left are tried, the least first.
const LEVELS: usize = 3;

/// A line, and how many pairs it leaves as far as was looked.
#[derive(Debug, Clone, Copy)]
struct Proposal {
    direction: DVec3,
    point: DVec3,
    left: usize,
    /// How far it is from lines that leave more.
    width: f64,
    kind: u64,
}

/// Offers the most promising lines to `best`.
pub(super) fn sweep(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    let stop = settings.stop;
    let spent = |best: &Best<'_, DVec3>| best.num_judged >= settings.effort || late();
    for (num_directions, count) in ROUNDS {
        let scene = best.scene;
        let mut proposals = proposals(scene, best.members, num_directions, count, late);
        proposals.truncate(MOST_LOOKED_AT);
        let look = |proposal: &Proposal| {
            let line = scene.line(proposal.direction, proposal.point)?;
            let left = scene.glance(&line, best.members, usize::MAX)?;
            Some((Proposal { left, ..*proposal }, line))
        };
        let mut looked_at: Vec<(Proposal, Line<DVec3>)> = proposals.par_iter().filter_map(look).collect();
        looked_at.sort_by(|(a, _), (b, _)| a.left.cmp(&b.left).then(b.width.total_cmp(&a.width)));
        let most = if best.thorough { MOST_LOOKED_AT } else { MOST_JUDGED };
        looked_at.truncate(most);
        for some in looked_at.chunks(JUDGED_AT_ONCE) {
            let members = best.members;
            let most = if best.thorough { usize::MAX } else { best.num_left() };
            let with_room = |(proposal, line): &(Proposal, Line<DVec3>)| {
                let roomier = if proposal.left <= most { polished(scene, members, line) } else { None };
                let itself = (proposal.left <= most).then_some(*line);
                [roomier, itself].into_iter().flatten().collect::<Vec<_>>()
            };
            let mut lines: Vec<Line<DVec3>> = some.par_iter().flat_map_iter(with_room).collect();
            let left = settings.effort.saturating_sub(best.num_judged);
            lines.truncate(usize::try_from(left).unwrap_or(usize::MAX));
            // Whether a line may become the best: what can't be used, or leaves more, goes by the way.
            let thorough = best.thorough;
            let may = |line: &Line<DVec3>| {
                thorough
                    || scene.verdict(line, members, 0.0).is_some_and(|verdict| verdict.num_left() <= most)
            };
            let may_lead: Vec<bool> = lines.par_iter().map(may).collect();
            for (line, may_lead) in lines.iter().zip(may_lead) {
                if best.enough(stop) || late() {
                    break;
                }
                if may_lead {
                    best.offer(line);
                } else {
                    best.num_judged += 1;
                }
            }
            if best.enough(stop) || spent(best) {
                break;
            }
        }
        if best.enough(stop) || spent(best) {
            return;
        }
    }
}

/// Directions that are allowed: against the normals of the members' faces, and so many as would be `count` all around.
fn directions(scene: &Scene<DVec3>, members: &[usize], count: usize) -> Vec<DVec3> {
    let mut chosen: Vec<DVec3> = Vec::new();
    for &member in members {
        let pose = scene.views[member][0];
        for face in &scene.shadows[member].model().faces {
            let direction = -(pose.rotation * face.normal);
            let other = chosen.iter().all(|one| angle(*one, direction) > ALIKE);
            if chosen.len() < count && other && scene.allows(direction) {
                chosen.push(direction);
            }
        }
    }
    chosen.extend(scene.directions(count));
    chosen
}

/// Lines of every direction, those that leave least at the nominal poses first.
fn proposals(
    scene: &Scene<DVec3>,
    members: &[usize],
    num_directions: usize,
    count: usize,
    late: &dyn Fn() -> bool,
) -> Vec<Proposal> {
    let mut kinds: BTreeMap<u64, Vec<Proposal>> = BTreeMap::new();
    for some in directions(scene, members, num_directions).chunks(AT_ONCE) {
        if late() {
            break;
        }
        let of_direction = |direction: &DVec3| in_direction(scene, members, *direction, count);
        let found: Vec<Vec<Proposal>> = some.par_iter().map(of_direction).collect();
        for proposal in found.into_iter().flatten() {
            kinds.entry(proposal.kind).or_default().push(proposal);
        }
    }
    let order = |a: &Proposal, b: &Proposal| a.left.cmp(&b.left).then(b.width.total_cmp(&a.width));
    let kept = kinds.into_values().flat_map(|mut kind| {
        kind.sort_by(order);
        kind.truncate(KEPT_OF_A_KIND);
        kind
    });
    let mut all: Vec<Proposal> = kept.collect();
    all.sort_by(order);
    all
}

/// The lines of one direction that leave least, in the middle of their regions.
fn in_direction(scene: &Scene<DVec3>, members: &[usize], direction: DVec3, count: usize) -> Vec<Proposal> {
    let grid = Grid::new(direction, scene.middle, scene.radius, count);
    let render = |member: &usize| {
        let model = scene.shadows[*member].model();
        grid.render(model, scene.views[*member][0], scene.sensor.tip_radius)
    };
    let renderings: Vec<Rendering> = members.iter().map(render).collect();
    let normals: Vec<Vec<DVec3>> = members
        .iter()
        .map(|member| {
            let turn = scene.views[*member][0].rotation;
            scene.shadows[*member].model().faces.iter().map(|face| turn * face.normal).collect()
        })
        .collect();
    let most = scene.sensor.max_incidence.cos();
    let mut seen = Vec::with_capacity(members.len());
    let left: Vec<usize> = (0..count * count)
        .map(|at| {
            seen.clear();
            let mut num_missed = 0;
            for (rendering, normals) in renderings.iter().zip(&normals) {
                let face = rendering.face[at];
                if face == u32::MAX {
                    num_missed += 1;
                    continue;
                }
                let normal = normals[face as usize];
                if -normal.dot(direction) < most {
                    return usize::MAX;
                }
                seen.push((rendering.depth[at], normal));
            }
            if seen.is_empty() { usize::MAX } else { num_missed * num_missed + num_alike(scene, &mut seen) }
        })
        .collect();
    let mut levels: Vec<usize> = left.iter().copied().filter(|left| *left < usize::MAX).collect();
    levels.sort_unstable();
    levels.dedup();
    let mut found = Vec::new();
    for level in levels.into_iter().take(LEVELS) {
        let marked: Vec<bool> = left.iter().map(|left| *left <= level).collect();
        let clear = clearances(&marked, count);
        let Some(at) = (0..clear.len()).max_by_key(|at| (clear[*at], std::cmp::Reverse(*at))) else {
            continue;
        };
        let kind = renderings.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, one| {
            // FNV-1a, of the features that are met.
            (hash ^ u64::from(one.face[at])).wrapping_mul(0x0100_0000_01b3)
        });
        let width = f64::from(clear[at]) * grid.step;
        found.push(Proposal { direction, point: grid.point(at), left: left[at], width, kind });
    }
    found
}

/// Ordered pairs of readings that may be the same, each with itself included.
pub(super) fn num_alike(scene: &Scene<DVec3>, seen: &mut [(f64, DVec3)]) -> usize {
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
