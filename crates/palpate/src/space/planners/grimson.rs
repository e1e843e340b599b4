//! Grimson's planner in space (thesis 5.4.2).
//!
//! The parts are rendered onto a grid of buckets: depth and normal of what is met first from the middle of each, for several
//! poses of each hypothesis. A divide-and-conquer search of the buckets finds the regions that tell most. Both readings of
//! the section are tried: lines of a chosen direction, on a plane across it (orthographic), and lines through a chosen
//! position, in every direction toward the parts (perspective).
//!
//! Where the description is silent:
//! - Which directions and positions to choose, which the section calls open: directions against the faces' normals, at which
//!   touches are most reliable, and others evenly over the sphere; positions evenly on a sphere around all.
//! - The poses are one that is valid with the largest slack and others at the extremes of the pose set, so that what differs
//!   between them is not relied upon.
//! - A region is divided across its longer side until all its buckets tell the same, or one is left. Of regions that tell
//!   alike the wider comes first, and of each rendering the best few are kept.
//!
//! Edges and vertices that a ball meets are not rendered: before a line is judged, the exact first contacts at all views are
//! looked at.

use glam::DVec3;
use rayon::prelude::*;

use super::rendering::{Grid, Rendering as View, usable_normals};
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;
use crate::space::Pose;
use crate::space::site::angle;
use crate::tree::Range;

/// Normals that are nearer to each other than this count as one, radians.
const ALIKE: f64 = 0.1;

/// So many poses of each hypothesis are rendered.
const NUM_RENDERED: usize = 3;

/// For so many directions there is one position.
const DIRECTIONS_PER_POSITION: usize = 4;

/// Positions are so many radii away from the middle of all.
const AWAY: f64 = 3.0;

/// So many regions of a rendering are kept.
const KEPT: usize = 16;

/// Renderings that are made between two looks at the time, and proposals that are looked at.
const AT_ONCE: usize = 16;

/// Above so many cells along a side grids count as fine.
const FINE: usize = 64;

/// So many paths are judged, at most.
const MOST_JUDGED: u64 = 256;

/// What is met first from a bucket, at one view: its depth and its normal.
type Seen = Option<(f64, DVec3)>;

/// The middle of a region, and how many pairs it leaves.
struct Proposal {
    line: Line<DVec3>,
    left: usize,
    num_buckets: usize,
}

/// All that one member shows in a region; normals are within a box.
#[derive(Clone, Copy)]
struct Span {
    depth: Range,
    normals: [DVec3; 2],
    hits: bool,
    misses: bool,
}

/// Columns and rows from `low` up to `high`, and their halves.
struct Region {
    low: [usize; 2],
    high: [usize; 2],
    halves: Option<[usize; 2]>,
    spans: Vec<Span>,
    /// No bucket can be used; each can be.
    skids: bool,
    clean: bool,
}

/// One grid's renderings, with its regions: the halves before the whole.
struct Rendering<'a> {
    scene: &'a Scene<DVec3>,
    members: &'a [usize],
    grid: Grid,
    /// Of each member, one for each view, with the normals of its faces there; `None`: must not be touched.
    images: Vec<Vec<(View, Vec<Option<DVec3>>)>>,
    regions: Vec<Region>,
}

/// Offers the regions that tell most.
pub(super) fn grimson(
    best: &mut Best<'_, DVec3>,
    [cells, num_directions]: [usize; 2],
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    let (scene, members) = (best.scene, best.members);
    let mut proposals = Vec::new();
    // Fine grids take longer: fewer between two looks at the time.
    let at_once = (AT_ONCE * FINE / (FINE + cells)).max(1);
    for some in grids(scene, members, cells, num_directions).chunks(at_once) {
        if late() {
            break;
        }
        let regions = |grid: &Grid| Rendering::new(scene, members, grid.clone()).proposals();
        proposals.par_extend(some.par_iter().flat_map_iter(regions));
    }
    // A stable order: whatever the number of threads, the answer is the same.
    proposals.sort_by(|a, b| a.left.cmp(&b.left).then(b.num_buckets.cmp(&a.num_buckets)));
    let most = best.num_judged + MOST_JUDGED;
    for some in proposals.chunks(AT_ONCE) {
        let left = best.num_left();
        let look = |proposal: &Proposal| {
            let line = scene.line(proposal.line.direction, proposal.line.start)?;
            let promising = proposal.left < left && scene.glance(&line, members, usize::MAX)? < left;
            (promising && scene.may_be_used(&line, members)).then_some(line)
        };
        let lines: Vec<Line<DVec3>> = some.par_iter().filter_map(look).collect();
        for line in lines {
            let spent = best.num_judged >= settings.effort.min(most);
            if best.enough(settings.stop) || spent || late() {
                return;
            }
            best.offer(&line);
        }
        // What is rendered are valid poses: over all poses a line leaves no fewer.
        if some.iter().any(|proposal| proposal.left >= best.num_left()) || late() {
            return;
        }
    }
}

/// Grids of the directions and of the positions.
fn grids(scene: &Scene<DVec3>, members: &[usize], cells: usize, num_directions: usize) -> Vec<Grid> {
    let orthographic = directions(scene, members, num_directions)
        .into_iter()
        .map(|direction| Grid::new(direction, scene.middle, scene.radius, cells));
    let gazes = scene.directions(num_directions.div_ceil(DIRECTIONS_PER_POSITION));
    let focus = AWAY * scene.radius;
    let perspective = gazes.map(|gaze| Grid::perspective(gaze, scene.middle, scene.radius, cells, focus));
    orthographic.chain(perspective).collect()
}

impl<'a> Rendering<'a> {
    fn new(scene: &'a Scene<DVec3>, members: &'a [usize], grid: Grid) -> Self {
        let image = |member: &usize| {
            let model = scene.shadows[*member].model();
            let view = |pose: &Pose| {
                let normals = usable_normals(scene, *member, *pose);
                (grid.render(model, *pose, scene.sensor.tip_radius), normals)
            };
            scene.views[*member].iter().take(NUM_RENDERED).map(view).collect()
        };
        let images = members.iter().map(image).collect();
        let mut rendering = Self { scene, members, grid, images, regions: Vec::new() };
        rendering.gather([0, 0], [rendering.grid.count; 2]);
        rendering
    }

    /// The best regions, in lines through their middles.
    fn proposals(&self) -> Vec<Proposal> {
        let mut found = Vec::new();
        self.divide(self.regions.len() - 1, &mut |bucket, num_buckets, left| {
            found.push((left, num_buckets, bucket));
        });
        found.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)).then(a.2.cmp(&b.2)));
        found.truncate(KEPT);
        let proposal =
            |(left, num_buckets, bucket)| Proposal { line: self.grid.line(bucket), left, num_buckets };
        found.into_iter().map(proposal).collect()
    }

    /// Makes the region of some buckets, its halves first; returns its number.
    fn gather(&mut self, low: [usize; 2], high: [usize; 2]) -> usize {
        let side = usize::from(high[1] - low[1] > high[0] - low[0]);
        let region = if high[side] - low[side] == 1 {
            self.bucket(low)
        } else {
            let (mut first, mut second) = (high, low);
            first[side] = usize::midpoint(low[side], high[side]);
            second[side] = first[side];
            let halves = [self.gather(low, first), self.gather(second, high)];
            let [a, b] = halves.map(|half| &self.regions[half]);
            let spans = a.spans.iter().zip(&b.spans).map(|(a, b)| a.joined(b)).collect();
            let (skids, clean) = (a.skids && b.skids, a.clean && b.clean);
            Region { low, high, halves: Some(halves), spans, skids, clean }
        };
        self.regions.push(region);
        self.regions.len() - 1
    }

    /// A bucket's number.
    fn number(&self, [column, row]: [usize; 2]) -> usize {
        row * self.grid.count + column
    }

    fn bucket(&self, low: [usize; 2]) -> Region {
        let number = self.number(low);
        let span = |image: &Vec<(View, Vec<Option<DVec3>>)>| {
            let seen = image.iter().map(|view| Span::of(seen(view, number)));
            seen.reduce(|a, b| a.joined(&b)).unwrap_or(Span::of(None))
        };
        let direction = self.grid.line(number).direction;
        let flattest = self.scene.sensor.max_incidence.cos();
        let skids = self.images.iter().flatten().any(|(view, normals)| {
            view.depth[number].is_finite()
                && normals[view.face[number] as usize].is_none_or(|normal| -normal.dot(direction) < flattest)
        });
        let allowed = self.scene.allows(direction);
        // A line that meets nothing tells nothing.
        let empty = self.images.iter().flatten().all(|(view, _)| view.depth[number].is_infinite());
        let unusable = skids || !allowed || empty;
        let spans = self.images.iter().map(span).collect();
        Region { low, high: low.map(|at| at + 1), halves: None, spans, skids: unusable, clean: !unusable }
    }

    /// Proposes the largest parts of a region that tell the same in all their buckets.
    fn divide(&self, number: usize, propose: &mut dyn FnMut(usize, usize, usize)) {
        let region = &self.regions[number];
        if region.skids {
            return;
        }
        let alike = self.told_alike(region);
        let middle = [0, 1].map(|side| usize::midpoint(region.low[side], region.high[side]));
        let num_buckets = (region.high[0] - region.low[0]) * (region.high[1] - region.low[1]);
        match (alike, region.halves) {
            (Some(left), _) => propose(self.number(middle), num_buckets, left),
            (None, Some(halves)) => halves.into_iter().for_each(|half| self.divide(half, propose)),
            (None, None) => {
                let bucket = self.number(region.low);
                propose(bucket, 1, self.num_left(bucket));
            }
        }
    }

    /// The pairs that each bucket leaves, if it is surely the same pairs for all.
    fn told_alike(&self, region: &Region) -> Option<usize> {
        let mut left = region.spans.len();
        for (k, a) in region.spans.iter().enumerate().filter(|_| region.clean) {
            for b in &region.spans[..k] {
                if a.surely_alike(b, self.scene) {
                    left += 2;
                } else if !a.surely_apart(b, self.scene) {
                    return None;
                }
            }
        }
        region.clean.then_some(left)
    }

    /// The pairs that one bucket leaves: some pose of one looks like some pose of the other.
    fn num_left(&self, at: usize) -> usize {
        let seen = |member: usize| self.images[member].iter().map(move |view| seen(view, at));
        let mut left = self.members.len();
        for k in 0..self.members.len() {
            let alike = |b: &usize| seen(k).any(|one| seen(*b).any(|other| alike(self.scene, one, other)));
            left += 2 * (0..k).filter(alike).count();
        }
        left
    }
}

/// What a view shows in a bucket; the normal of what must not be touched is of no use, and zero.
fn seen((view, normals): &(View, Vec<Option<DVec3>>), at: usize) -> Seen {
    let depth = view.depth[at];
    depth.is_finite().then(|| (depth, normals[view.face[at] as usize].unwrap_or(DVec3::ZERO)))
}

/// Whether two readings may be the same.
fn alike(scene: &Scene<DVec3>, a: Seen, b: Seen) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some((one, a)), Some((other, b))) => confuses(scene, (one - other).abs(), a.distance(b)),
        _ => false,
    }
}

/// Whether the sensor may confuse depths so far apart, and unit normals whose ends are.
fn confuses(scene: &Scene<DVec3>, depth: f64, chord: f64) -> bool {
    scene.sensor.confuses(depth, || 2.0 * (0.5 * chord).min(1.0).asin())
}

impl Span {
    fn of(seen: Seen) -> Self {
        let none = Range { low: f64::INFINITY, high: f64::NEG_INFINITY };
        if let Some((depth, normal)) = seen {
            let depth = Range { low: depth, high: depth };
            return Self { depth, normals: [normal; 2], hits: true, misses: false };
        }
        Self { depth: none, normals: [DVec3::INFINITY, DVec3::NEG_INFINITY], hits: false, misses: true }
    }

    fn joined(&self, other: &Self) -> Self {
        let ([a, b], [c, d]) = (self.normals, other.normals);
        Self {
            depth: self.depth.hull(other.depth),
            normals: [a.min(c), b.max(d)],
            hits: self.hits || other.hits,
            misses: self.misses || other.misses,
        }
    }

    fn surely_alike(&self, other: &Self, scene: &Scene<DVec3>) -> bool {
        if self.misses || other.misses {
            return !self.hits && !other.hits;
        }
        let ([a, b], [c, d]) = (self.normals, other.normals);
        let farthest = (self.depth.high - other.depth.low).max(other.depth.high - self.depth.low);
        confuses(scene, farthest, (b - c).max(d - a).length())
    }

    fn surely_apart(&self, other: &Self, scene: &Scene<DVec3>) -> bool {
        if self.misses && other.misses {
            return false;
        }
        if !self.hits || !other.hits {
            return true;
        }
        let ([a, b], [c, d]) = (self.normals, other.normals);
        let nearest = (self.depth.low - other.depth.high).max(other.depth.low - self.depth.high).max(0.0);
        !confuses(scene, nearest, (a - d).max(c - b).max(DVec3::ZERO).length())
    }
}

/// Directions that are allowed: against the normals of the members' faces, and so many as would be `count` all around.
fn directions(scene: &Scene<DVec3>, members: &[usize], count: usize) -> Vec<DVec3> {
    let mut chosen: Vec<DVec3> = Vec::new();
    let faces = |member: &usize| &scene.shadows[*member].model().faces;
    let most = members.iter().map(|member| faces(member).len()).max().unwrap_or(0);
    // The members take turns, so that none of many faces uses up the count.
    for number in 0..most {
        for member in members {
            let Some(face) = faces(member).get(number) else { continue };
            let direction = -(scene.views[*member][0].rotation * face.normal);
            let other = chosen.iter().all(|one| angle(*one, direction) > ALIKE);
            if chosen.len() < count && other && scene.allows(direction) {
                chosen.push(direction);
            }
        }
    }
    chosen.extend(scene.directions(count));
    chosen
}

#[cfg(test)]
mod tests {
    use super::super::tests::{blocks, sensor};
    use super::*;

    /// What divide and conquer proposes is what looking at every bucket finds: no bucket leaves fewer, and all buckets of a
    /// region leave what is said of it.
    #[test]
    fn divide_and_conquer_finds_what_looking_at_all_finds() {
        let hypotheses = blocks();
        let settings = PlanSettings { directions: Some((DVec3::Z, 2.5)), ..PlanSettings::default() };
        let scene = Scene::new(&hypotheses, &sensor(), &settings);
        let members = scene.everyone();
        let count = 48;
        let (mut num_wide, mut num_found) = (0, 0);
        for grid in grids(&scene, &members, count, 24) {
            let rendering = Rendering::new(&scene, &members, grid);
            let all = 0..count * count;
            let usable = |at: &usize| !rendering.bucket([at % count, at / count]).skids;
            let fewest = all.filter(usable).map(|at| rendering.num_left(at)).min();
            let proposals = rendering.proposals();
            assert_eq!(proposals.first().map(|one| one.left), fewest);
            num_found += proposals.len();
            for region in rendering.regions.iter().filter(|region| region.halves.is_some()) {
                let Some(left) = rendering.told_alike(region) else { continue };
                num_wide += 1;
                for row in region.low[1]..region.high[1] {
                    for column in region.low[0]..region.high[0] {
                        assert!(usable(&rendering.number([column, row])));
                        assert_eq!(rendering.num_left(rendering.number([column, row])), left);
                    }
                }
            }
        }
        assert!(num_wide > 100 && num_found > 100, "{num_wide} {num_found}");
    }
}
