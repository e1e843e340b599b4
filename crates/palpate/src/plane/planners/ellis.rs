//! The thesis's own search (3.1 to 3.3, 4.1), its formulas as MATH 1.3 corrects them.
//!
//! Lines through one face, the generator, and through as many other faces as possible. With the generator on the X axis
//! and its outward normal along +Y a line is `x = q + α·y`, traveled downward (row 57). Every point P becomes a line
//! `q = P_X − α·P_Y` in projection space (eq. 3.1), and slopes at which the projections of two ends meet are critical.
//! At each of them the faces that overlap an end of the generator are pierced in the middle of what they share.
//!
//! It is not complete (row 70): what is seen only between ends of other faces it does not find. Pose uncertainty enters
//! as printed: the inner projection is what the images at the two extreme rotations share (3.3.1), which is no guarantee
//! (row 65); that is for the judge to give. A hypothesis stands at the pose of its first interpretation.
//!
//! Where the thesis is silent: faces that can't be touched are no edges; slopes that differ by less than m over the
//! part's size count as equal; the generator and all that is pierced share more than twice m and the path error (row 58);
//! a face counts as pierced only at slopes at which it does not skid (row 55).

use std::f64::consts::PI;

use glam::{DVec2, dvec2};

use crate::best::Best;
use crate::plan::PlanSettings;
use crate::plane::arc::wrap;
use crate::plane::pose::Pose;
use crate::plane::rays::Line;
use crate::plane::scene::Scene;
use crate::tree::Range;

/// What the thesis's search did, in its own units (3.5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EllisCounters {
    /// M: faces of all hypotheses that no contact is assigned to.
    pub unsensed: u64,
    /// K: faces that one is assigned to.
    pub sensed: u64,
    /// Inner products of normals, for candidate sets.
    pub inner_products: u64,
    /// Generators whose candidate sets were searched.
    pub generators: u64,
    /// ΣN: the members of these candidate sets, the generators not counted.
    pub candidates: u64,
    /// Critical slopes examined.
    pub critical_points: u64,
    /// Those within the bounds, near ones compacted.
    pub critical_kept: u64,
    /// Projections of candidates tested against the generator's.
    pub overlaps: u64,
    /// Paths evaluated.
    pub paths: u64,
}

impl EllisCounters {
    /// The thesis's count of inner products, `M(M−1)/2 + MK` (row 68): every generator with every face, once.
    #[must_use]
    pub fn predicted_inner_products(&self) -> u64 {
        self.unsensed * self.unsensed.saturating_sub(1) / 2 + self.unsensed * self.sensed
    }

    /// The thesis's count of critical points, `4N + 3` for each generator (3.5).
    #[must_use]
    pub fn predicted_critical_points(&self) -> u64 {
        4 * self.candidates + 3 * self.generators
    }
}

/// A face of a hypothesis where the thesis places it.
struct Edge {
    member: usize,
    sensed: bool,
    /// Half the range of its hypothesis' rotations.
    half: f64,
    nominal: Placed,
    extremes: [Placed; 2],
}

/// A face at one pose, moved out by the tip's radius.
#[derive(Clone, Copy)]
struct Placed {
    ends: [DVec2; 2],
    normal: DVec2,
}

/// A generator and its candidate set.
struct Generator {
    edge: usize,
    candidates: Vec<usize>,
    num_hypotheses: usize,
}

/// Coordinates in which the generator lies on the X axis, its outward normal along +Y.
struct Frame {
    origin: DVec2,
    x: DVec2,
    y: DVec2,
}

/// Searches every generator's candidate set; stops as soon as a path is good enough.
pub(crate) fn ellis(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> EllisCounters {
    let edges = edges(best.scene, best.members);
    let mut counters = EllisCounters::default();
    for generator in generators(best.scene, &edges, &mut counters) {
        counters.generators += 1;
        counters.candidates += generator.candidates.len() as u64;
        let frame = Frame::of(&edges[generator.edge].nominal);
        for slope in critical_slopes(best.scene, &edges, &generator, &frame, &mut counters) {
            if late() {
                return counters;
            }
            for start in starts(best.scene, &edges, &generator, &frame, slope, &mut counters) {
                let (angle, aside) = best.scene.numbers(&frame.line(slope, start));
                let Some(line) = best.scene.line(angle, aside) else { continue };
                if best.num_judged >= settings.effort {
                    return counters;
                }
                best.offer(&line);
                counters.paths += 1;
                if best.enough(settings.stop) {
                    return counters;
                }
            }
        }
    }
    counters
}

fn edges(scene: &Scene, members: &[usize]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (place, &member) in members.iter().enumerate() {
        let placement = &scene.placements[member];
        for (number, face) in scene.shadows[member].model().faces.iter().enumerate() {
            if !face.is_touchable() {
                continue;
            }
            let at = |pose: Pose| {
                let normal = pose.rotation.rotate(face.normal);
                let ends =
                    [face.start, face.end].map(|end| pose.apply(end) + scene.sensor.tip_radius * normal);
                Placed { ends, normal }
            };
            edges.push(Edge {
                member: place,
                sensed: placement.sensed[number],
                half: placement.half,
                nominal: at(placement.nominal),
                extremes: placement.extremes.map(at),
            });
        }
    }
    edges
}

/// The candidate set of each face that was not sensed, those with the most hypotheses in it first.
///
/// Two faces can be pierced by one line if their normals are within 2Ω, and both rotation half ranges, of each other
/// (row 56). Sensed faces are candidates too (row 68).
fn generators(scene: &Scene, edges: &[Edge], counters: &mut EllisCounters) -> Vec<Generator> {
    let mut sets: Vec<Vec<usize>> = edges.iter().map(|_| Vec::new()).collect();
    counters.sensed = edges.iter().filter(|edge| edge.sensed).count() as u64;
    counters.unsensed = edges.len() as u64 - counters.sensed;
    for (k, a) in edges.iter().enumerate() {
        for (j, b) in edges[..k].iter().enumerate().filter(|(_, b)| !(a.sensed && b.sensed)) {
            counters.inner_products += 1;
            let widest = 2.0 * scene.sensor.max_incidence + a.half + b.half;
            if a.nominal.normal.dot(b.nominal.normal) >= widest.min(PI).cos() {
                sets[k].push(j);
                sets[j].push(k);
            }
        }
    }
    let mut generators: Vec<Generator> = sets
        .into_iter()
        .enumerate()
        .filter(|(edge, _)| !edges[*edge].sensed)
        .map(|(edge, mut candidates)| {
            candidates.sort_unstable();
            let mut present: Vec<usize> = candidates.iter().map(|k| edges[*k].member).collect();
            present.push(edges[edge].member);
            present.sort_unstable();
            present.dedup();
            Generator { edge, candidates, num_hypotheses: present.len() }
        })
        .collect();
    generators.sort_by_key(|one| (usize::MAX - one.num_hypotheses, one.edge));
    generators
}

/// Slopes at which an end of a candidate meets an end of the generator in projection space, and the bounds and zero:
/// from zero outward (4.1).
fn critical_slopes(
    scene: &Scene,
    edges: &[Edge],
    generator: &Generator,
    frame: &Frame,
    counters: &mut EllisCounters,
) -> Vec<f64> {
    let edge = &edges[generator.edge];
    let steepest = (scene.sensor.max_incidence - edge.half).max(0.0).tan();
    let ends = edge.nominal.ends.map(|end| frame.coordinates(end));
    let mut slopes = vec![-steepest, steepest, 0.0];
    for &candidate in &generator.candidates {
        for p in edges[candidate].nominal.ends.map(|end| frame.coordinates(end)) {
            slopes.extend(ends.map(|r| (p.x - r.x) / (p.y - r.y)));
        }
    }
    counters.critical_points += slopes.len() as u64;
    slopes.retain(|slope| slope.abs() <= steepest);
    slopes.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.total_cmp(b)));
    // The last one kept on either side of zero.
    let mut last = [f64::INFINITY; 2];
    let apart = scene.margin / scene.size;
    slopes.retain(|slope| {
        let near = last.iter().any(|kept| (slope - kept).abs() < apart);
        if !near {
            last[usize::from(*slope < 0.0)] = *slope;
        }
        !near
    });
    counters.critical_kept += slopes.len() as u64;
    slopes
}

/// The middles of what is shared by the generator and all faces that overlap its left end, and the same for its right end.
fn starts(
    scene: &Scene,
    edges: &[Edge],
    generator: &Generator,
    frame: &Frame,
    slope: f64,
    counters: &mut EllisCounters,
) -> Vec<f64> {
    let clearance = 2.0 * (scene.sensor.path_error + scene.margin);
    let inner = frame.inner(&edges[generator.edge], slope);
    if inner.high - inner.low <= clearance {
        return Vec::new();
    }
    let mut shared = [inner; 2];
    for &candidate in &generator.candidates {
        counters.overlaps += 1;
        let image = frame.inner(&edges[candidate], slope);
        if image.high - image.low <= clearance || frame.skids(&edges[candidate], slope, scene) {
            continue;
        }
        // Ends that meet exactly at a critical slope do so up to its compaction.
        let near = 2.0 * scene.margin;
        if image.low <= inner.low + near && image.high > inner.low + clearance {
            shared[0] = intersection(shared[0], image);
        }
        if image.high >= inner.high - near && image.low < inner.high - clearance {
            shared[1] = intersection(shared[1], image);
        }
    }
    let wide = shared.into_iter().filter(|range| range.high - range.low > clearance);
    let mut middles: Vec<f64> = wide.map(|range| 0.5 * (range.low + range.high)).collect();
    middles.dedup();
    middles
}

fn intersection(a: Range, b: Range) -> Range {
    Range { low: a.low.max(b.low), high: a.high.min(b.high) }
}

impl Frame {
    fn of(generator: &Placed) -> Self {
        Self { origin: generator.ends[0], x: -generator.normal.perp(), y: generator.normal }
    }

    fn coordinates(&self, point: DVec2) -> DVec2 {
        let offset = point - self.origin;
        dvec2(self.x.dot(offset), self.y.dot(offset))
    }

    /// The line that comes down to `start` on the X axis.
    fn line(&self, slope: f64, start: f64) -> Line {
        let direction = -(slope * self.x + self.y) / slope.hypot(1.0);
        Line { start: self.origin + start * self.x, direction }
    }

    /// The inner projection (3.3.1): what the images at the two extreme poses share; low above high if nothing.
    fn inner(&self, edge: &Edge, slope: f64) -> Range {
        let image = |placed: &Placed| {
            let [a, b] = placed.ends.map(|end| {
                let point = self.coordinates(end);
                point.x - slope * point.y
            });
            Range { low: a.min(b), high: a.max(b) }
        };
        intersection(image(&edge.extremes[0]), image(&edge.extremes[1]))
    }

    /// Whether a line of this slope meets the face at more than Ω at either extreme pose, or from behind.
    fn skids(&self, edge: &Edge, slope: f64, scene: &Scene) -> bool {
        let back = (slope * self.x + self.y).to_angle();
        let away = |placed: &Placed| wrap(placed.normal.to_angle() - back).abs();
        edge.extremes.iter().any(|placed| away(placed) > scene.sensor.max_incidence)
    }
}
