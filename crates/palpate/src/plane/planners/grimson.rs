//! Grimson's planner in the plane (thesis 5.4.2).
//!
//! For each of some fixed directions the parts are rendered, orthographically, onto a starting line of buckets: depth and
//! normal of what is met first from the middle of each bucket, for several poses of each hypothesis. A divide-and-conquer
//! search of the buckets finds the regions that tell most.
//!
//! Where the description is silent: directions are evenly spaced; the poses are one that is valid with the largest slack
//! and others at the extremes of the pose set, so that what differs between them is not relied upon; a region is divided
//! until all its buckets tell the same, or one is left. Of regions that tell alike the wider comes first.

use crate::part::Surface;
use std::f64::consts::PI;

use glam::DVec2;

use super::whole;
use crate::best::Best;
use crate::plan::PlanSettings;
use crate::plane::arc::wrap;
use crate::plane::pose::Pose;
use crate::plane::{Face, Vertex};
use crate::scene::Scene;
use crate::tree::Range;

/// A rendered bucket: depth, and how far the normal is turned from the way back; `None` if nothing is met.
type Seen = Option<(f64, f64)>;

/// The turn of what must not be touched.
const NEVER: f64 = PI;

/// A member's renderings, one for each pose.
type Image = Vec<Vec<Seen>>;

/// The middle of a region, and how many pairs it leaves.
struct Proposal {
    angle: f64,
    aside: f64,
    left: usize,
    num_buckets: usize,
}

/// All that one member shows in a region.
#[derive(Clone, Copy)]
struct Span {
    depth: Range,
    turn: Range,
    hits: bool,
    misses: bool,
}

/// Buckets from `from` up to `to`, and their halves.
struct Region {
    from: usize,
    to: usize,
    halves: Option<[usize; 2]>,
    spans: Vec<Span>,
    /// No bucket can be used; each can be.
    skids: bool,
    clean: bool,
}

/// One direction's renderings, with its regions: the halves before the whole.
struct Rendering<'a> {
    scene: &'a Scene,
    images: Vec<Image>,
    regions: Vec<Region>,
}

/// Offers the regions that tell most.
pub(crate) fn grimson(
    best: &mut Best<'_>,
    [cells, num_directions]: [usize; 2],
    settings: &PlanSettings,
    late: &dyn Fn() -> bool,
) {
    let scene = best.scene;
    let width = 2.0 * scene.radius / cells as f64;
    let mut proposals = Vec::new();
    for angle in scene.directions(num_directions).0 {
        if late() {
            break;
        }
        let images = best.members.iter().map(|member| image(scene, *member, angle, cells)).collect();
        let mut rendering = Rendering { scene, images, regions: Vec::new() };
        let whole = rendering.gather(0, cells);
        rendering.divide(whole, &mut |bucket, num_buckets, left| {
            let aside = (bucket as f64 + 0.5) * width - scene.radius;
            proposals.push(Proposal { angle, aside, left, num_buckets });
        });
    }
    proposals.sort_by(|a, b| a.left.cmp(&b.left).then(b.num_buckets.cmp(&a.num_buckets)));
    for proposal in proposals {
        // What is rendered are valid poses: over all poses a line leaves no fewer.
        let hopeless = proposal.left >= best.num_left();
        if hopeless || best.enough(settings.stop) || best.num_judged >= settings.effort || late() {
            return;
        }
        if let Some(line) = scene.line(proposal.angle, proposal.aside) {
            best.offer(&line);
        }
    }
}

fn image(scene: &Scene, member: usize, angle: f64, cells: usize) -> Image {
    scene.views[member].iter().map(|pose| render(scene, member, *pose, angle, cells)).collect()
}

/// A line of buckets, seen by a camera that looks in one direction.
struct Canvas<'a> {
    scene: &'a Scene,
    along: DVec2,
    buckets: Vec<Seen>,
}

/// What is met first from each bucket.
fn render(scene: &Scene, member: usize, pose: Pose, angle: f64, cells: usize) -> Vec<Seen> {
    let mut canvas = Canvas { scene, along: DVec2::from_angle(angle), buckets: vec![None; cells] };
    let model = scene.shadows[member].model();
    for face in model.faces.iter().filter(|face| face.surface != Surface::Seam) {
        canvas.draw_face(face, pose, model.closed);
    }
    for vertex in model.vertices.iter().filter(|_| scene.sensor.tip_radius > 0.0) {
        canvas.draw_vertex(vertex, pose);
    }
    canvas.buckets
}

impl Canvas<'_> {
    /// How far to the left of the middle, and how far along.
    fn place(&self, at: DVec2) -> (f64, f64) {
        (self.along.perp().dot(at - self.scene.middle), self.along.dot(at - self.scene.middle))
    }

    /// A face, moved out by the tip's radius. Of a closed part its back is never met first; of a loose one it is in the way.
    fn draw_face(&mut self, face: &Face, pose: Pose, closed: bool) {
        let normal = pose.rotation.rotate(face.normal);
        let front = normal.dot(self.along) < 0.0;
        if !front && closed {
            return;
        }
        let outward = if front { normal } else { -normal };
        let turn = if front && face.is_touchable() { wrap((-self.along).angle_to(normal)) } else { NEVER };
        let moved = |end: DVec2| pose.apply(end) + self.scene.sensor.tip_radius * outward;
        let ends = [face.start, face.end].map(|end| self.place(moved(end)));
        let [(s0, t0), (s1, t1)] = if ends[0].0 <= ends[1].0 { ends } else { [ends[1], ends[0]] };
        if s1 > s0 {
            self.draw(s0, s1, &|aside| (t0 + (aside - s0) * (t1 - t0) / (s1 - s0), turn));
        }
    }

    /// A vertex, as a ball meets it.
    fn draw_vertex(&mut self, vertex: &Vertex, pose: Pose) {
        let (s, t) = self.place(pose.apply(vertex.point));
        let radius = self.scene.sensor.tip_radius;
        let allowed = self.scene.rules.vertices && vertex.normals.is_some();
        self.draw(s - radius, s + radius, &|aside| {
            let turn = ((s - aside) / radius).clamp(-1.0, 1.0).asin();
            (t - radius * turn.cos(), if allowed { turn } else { NEVER })
        });
    }

    /// Fills the buckets whose middles are between two places, the nearer hiding the farther.
    fn draw(&mut self, from: f64, to: f64, reading: &dyn Fn(f64) -> (f64, f64)) {
        let width = 2.0 * self.scene.radius / self.buckets.len() as f64;
        let first = whole(((from + self.scene.radius) / width - 0.5).ceil());
        for (k, bucket) in self.buckets.iter_mut().enumerate().skip(first) {
            let aside = (k as f64 + 0.5) * width - self.scene.radius;
            if aside > to {
                break;
            }
            let seen = reading(aside);
            if bucket.is_none_or(|known| seen.0 < known.0) {
                *bucket = Some(seen);
            }
        }
    }
}

impl Rendering<'_> {
    /// Makes the region of some buckets, its halves first; returns its number.
    fn gather(&mut self, from: usize, to: usize) -> usize {
        let region = if to - from == 1 {
            self.bucket(from)
        } else {
            let middle = usize::midpoint(from, to);
            let halves = [self.gather(from, middle), self.gather(middle, to)];
            let [a, b] = halves.map(|half| &self.regions[half]);
            let spans = a.spans.iter().zip(&b.spans).map(|(a, b)| a.joined(b)).collect();
            Region {
                from,
                to,
                halves: Some(halves),
                spans,
                skids: a.skids && b.skids,
                clean: a.clean && b.clean,
            }
        };
        self.regions.push(region);
        self.regions.len() - 1
    }

    fn bucket(&self, at: usize) -> Region {
        let readings =
            |image: &Image| image.iter().map(|view| Span::of(view[at])).reduce(|a, b| a.joined(&b));
        let spans = self.images.iter().map(|image| readings(image).unwrap_or(Span::of(None))).collect();
        let limit = self.scene.sensor.max_incidence;
        let skids =
            self.images.iter().flatten().any(|view| view[at].is_some_and(|seen| seen.1.abs() > limit));
        Region { from: at, to: at + 1, halves: None, spans, skids, clean: !skids }
    }

    /// Proposes the largest parts of a region that tell the same in all their buckets.
    fn divide(&self, number: usize, propose: &mut dyn FnMut(usize, usize, usize)) {
        let region = &self.regions[number];
        if region.skids {
            return;
        }
        match region.halves {
            None => propose(region.from, 1, self.num_left(region.from)),
            Some(halves) => match self.told_alike(region) {
                Some(left) => propose(usize::midpoint(region.from, region.to), region.to - region.from, left),
                None => halves.into_iter().for_each(|half| self.divide(half, propose)),
            },
        }
    }

    /// The pairs that each bucket leaves, if it is surely the same pairs for all.
    fn told_alike(&self, region: &Region) -> Option<usize> {
        let mut left = region.spans.len();
        for (k, a) in region.spans.iter().enumerate() {
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
        let mut left = self.images.len();
        for (k, a) in self.images.iter().enumerate() {
            let alike =
                |b: &&Image| a.iter().any(|a| b.iter().any(|b| self.scene.alike(a[at], b[at], 0.0, 0.0)));
            left += 2 * self.images[..k].iter().filter(alike).count();
        }
        left
    }
}

impl Span {
    fn of(seen: Seen) -> Self {
        let none = Range { low: f64::INFINITY, high: f64::NEG_INFINITY };
        let exactly = |value: f64| Range { low: value, high: value };
        match seen {
            Some((depth, turn)) => {
                Self { depth: exactly(depth), turn: exactly(turn), hits: true, misses: false }
            }
            None => Self { depth: none, turn: none, hits: false, misses: true },
        }
    }

    fn joined(&self, other: &Self) -> Self {
        Self {
            depth: self.depth.hull(other.depth),
            turn: self.turn.hull(other.turn),
            hits: self.hits || other.hits,
            misses: self.misses || other.misses,
        }
    }

    fn surely_alike(&self, other: &Self, scene: &Scene) -> bool {
        if self.misses || other.misses {
            return !self.hits && !other.hits;
        }
        let farthest = |a: Range, b: Range| (a.high - b.low).max(b.high - a.low);
        let readings = [(0.0, 0.0), (farthest(self.depth, other.depth), farthest(self.turn, other.turn))];
        scene.alike(Some(readings[0]), Some(readings[1]), 0.0, 0.0)
    }

    fn surely_apart(&self, other: &Self, scene: &Scene) -> bool {
        if self.misses && other.misses {
            return false;
        }
        if !self.hits || !other.hits {
            return true;
        }
        let nearest = |a: Range, b: Range| (a.low - b.high).max(b.low - a.high).max(0.0);
        let readings = [(0.0, 0.0), (nearest(self.depth, other.depth), nearest(self.turn, other.turn))];
        !scene.alike(Some(readings[0]), Some(readings[1]), 0.0, 0.0)
    }
}
