//! All lines, by branch and bound (`docs/theory.md`, T13).
//!
//! Boxes of lines (an interval of directions, an interval of places across) are divided. From a few poses of each
//! hypothesis follows what every line of a box leaves at least; a box that can't beat the best path found is closed. A
//! box so small that no line in it moves anything by more than m/2 is closed by judging its middle: what a line of
//! margin ≥ m in it tells, its middle tells as well.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use crate::plan::{Best, PlanSettings};
use crate::plane::arc::wrap;
use crate::plane::model::{Face, Surface};
use crate::plane::pose::Pose;
use crate::plane::scene::Scene;
use crate::tree::Range;

/// Intervals of directions at the start.
const FIRST_DIRECTIONS: u32 = 64;

/// Places at which `late` is asked: every so many boxes.
const ASKED_EVERY: u64 = 64;

/// What was proved.
pub(crate) struct Proof {
    /// No usable path of margin ≥ m has a score below this.
    pub bound: f64,
    /// All boxes are closed.
    pub proved: bool,
    pub num_boxes: u64,
}

/// An interval of directions and one of places across, about the middle of the scene.
#[derive(Debug, Clone, Copy)]
struct Lines {
    angle: f64,
    half: f64,
    aside: f64,
    reach: f64,
    /// Pairs that every line of it leaves at least.
    left: usize,
    number: u64,
}

/// A part at one pose, from the middle of the scene.
struct View {
    starts: Vec<DVec2>,
    ends: Vec<DVec2>,
    normals: Vec<f64>,
    solid: Vec<bool>,
    corners: Vec<DVec2>,
}

/// What a line of a box may meet first of a view: each with its depths and normals.
#[derive(Debug, Clone, Default)]
struct Glance {
    met: Vec<(Range, f64)>,
    may_miss: bool,
    /// Nothing is certain.
    unsure: bool,
}

/// Searches all lines for one that is better than `best`.
pub(crate) fn complete(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> Proof {
    let scene = best.scene;
    let members = best.members;
    let views: Vec<Vec<View>> = members
        .iter()
        .map(|member| scene.views[*member].iter().map(|pose| View::new(scene, *member, *pose)).collect())
        .collect();
    let mut open = BinaryHeap::new();
    let mut num_boxes = 0;
    let half = PI / f64::from(FIRST_DIRECTIONS);
    for k in 0..FIRST_DIRECTIONS {
        let angle = -PI + (2.0 * f64::from(k) + 1.0) * half;
        open.push(Lines { angle, half, aside: 0.0, reach: scene.radius, left: members.len(), number: u64::from(k) });
    }
    let mut next_number = u64::from(FIRST_DIRECTIONS);
    let score = |left: usize| left as f64 / members.len() as f64;
    while let Some(lines) = open.pop() {
        // The heap gives the most promising box first: if that is closed, all are.
        if lines.left >= best.num_left() || best.enough(settings.stop) {
            let proved = lines.left >= best.num_left();
            return Proof { bound: score(lines.left.min(best.num_left())), proved, num_boxes };
        }
        if num_boxes >= settings.effort || (num_boxes % ASKED_EVERY == 0 && late()) {
            return Proof { bound: score(lines.left), proved: false, num_boxes };
        }
        num_boxes += 1;
        if !scene.allowed(lines.angle, lines.half) {
            continue;
        }
        let Some(left) = least_left(scene, &views, &lines, best.num_left()) else { continue };
        let left = left.max(lines.left);
        if left >= best.num_left() {
            continue;
        }
        if lines.motion(scene.radius) <= 0.5 * scene.margin && lines.half <= 0.5 * scene.margin / scene.size {
            if let Some(line) = scene.line(lines.angle, lines.aside) {
                best.offer(&line);
            }
            continue;
        }
        for part in lines.halves(scene) {
            open.push(Lines { left, number: next_number, ..part });
            next_number += 1;
        }
    }
    Proof { bound: score(best.num_left().min(members.len().pow(2))), proved: true, num_boxes }
}

impl Lines {
    /// How far a point at `radius` from the middle is moved, seen from the line, from one line of the box to its middle.
    fn motion(&self, radius: f64) -> f64 {
        self.reach + 2.0 * (0.5 * self.half).sin() * radius
    }

    fn halves(&self, scene: &Scene) -> [Self; 2] {
        let turn = (2.0 * (0.5 * self.half).sin() * scene.radius).max(self.half * scene.size);
        if turn > self.reach {
            let half = 0.5 * self.half;
            [-half, half].map(|by| Self { angle: self.angle + by, half, ..*self })
        } else {
            let reach = 0.5 * self.reach;
            [-reach, reach].map(|by| Self { aside: self.aside + by, reach, ..*self })
        }
    }
}

/// Pairs that every usable line of the box leaves at least; `None` if no line of it can be used.
fn least_left(scene: &Scene, views: &[Vec<View>], lines: &Lines, enough: usize) -> Option<usize> {
    let mut glances: Vec<Vec<Glance>> = views.iter().map(|_| Vec::new()).collect();
    let mut joined = vec![false; views.len() * views.len()];
    let mut left = views.len();
    let most = views.iter().map(Vec::len).max().unwrap_or(0);
    for number in 0..most {
        for (k, of_member) in views.iter().enumerate() {
            let Some(view) = of_member.get(number) else { continue };
            let glance = view.glance(scene, lines);
            if glance.skids(scene, lines) {
                return None;
            }
            for (j, others) in glances.iter().enumerate() {
                let pair = k.max(j) * views.len() + k.min(j);
                if j != k && !joined[pair] && others.iter().any(|other| glance.surely_alike(other, scene, lines)) {
                    joined[pair] = true;
                    left += 2;
                }
            }
            glances[k].push(glance);
        }
        if left >= enough {
            break;
        }
    }
    Some(left)
}

impl View {
    fn new(scene: &Scene, member: usize, pose: Pose) -> Self {
        let model = scene.shadows[member].model();
        let radius = scene.sensor.tip_radius;
        let faces = || model.faces.iter().filter(|face| face.surface != Surface::Seam);
        let moved = |face: &Face, end: DVec2| {
            pose.apply(end) + radius * pose.rotation.rotate(face.normal) - scene.middle
        };
        Self {
            starts: faces().map(|face| moved(face, face.start)).collect(),
            ends: faces().map(|face| moved(face, face.end)).collect(),
            normals: faces().map(|face| pose.rotation.rotate(face.normal).to_angle()).collect(),
            solid: faces().map(|face| face.surface == Surface::Touchable).collect(),
            corners: model.vertices.iter().map(|vertex| pose.apply(vertex.point) - scene.middle).collect(),
        }
    }

    /// What lines of the box may meet first. The part of a closed model is met at one of the faces that look toward it.
    fn glance(&self, scene: &Scene, lines: &Lines) -> Glance {
        let along = DVec2::from_angle(lines.angle);
        let aside = along.perp();
        let chord = 2.0 * (0.5 * lines.half).sin();
        let radius = scene.sensor.tip_radius;
        let place = |at: DVec2| (along.dot(at), aside.dot(at) - lines.aside, lines.reach + chord * at.length());
        let mut glance = Glance::default();
        let near = |at: &DVec2| {
            let (_, s, motion) = place(*at);
            (s - motion <= radius, s + motion >= -radius)
        };
        let (mut some_right, mut some_left) = (false, false);
        for corner in &self.corners {
            let (right, left) = near(corner);
            some_right |= right;
            some_left |= left;
        }
        if !(some_right && some_left) {
            glance.may_miss = true;
            return glance;
        }
        if radius > 0.0 && self.corners.iter().map(near).any(|(right, left)| right && left) {
            glance.unsure = true;
            return glance;
        }
        let mut nearest_sure = f64::INFINITY;
        let mut crossed = false;
        for k in 0..self.starts.len() {
            let incidence = wrap(self.normals[k] - (-along).to_angle()).abs();
            if incidence - lines.half >= FRAC_PI_2 {
                continue;
            }
            let (t0, s0, m0) = place(self.starts[k]);
            let (t1, s1, m1) = place(self.ends[k]);
            if s0.min(s1) - m0.max(m1) > 0.0 || s0.max(s1) + m0.max(m1) < 0.0 {
                continue;
            }
            crossed = true;
            let motion = m0.max(m1);
            let sure = incidence + lines.half < FRAC_PI_2
                && ((s0 + m0 < 0.0 && s1 - m1 > 0.0) || (s1 + m1 < 0.0 && s0 - m0 > 0.0));
            // Where it is crossed, at most `motion` from the middle line across, and that far again along.
            let range = if (s1 - s0).abs() > 2.0 * motion {
                let slope = (t1 - t0) / (s1 - s0);
                let at = t0 - slope * s0;
                let spread = motion * (1.0 + slope.abs());
                let clipped = Range { low: t0.min(t1) - motion, high: t0.max(t1) + motion };
                Range { low: (at - spread).max(clipped.low), high: (at + spread).min(clipped.high) }
            } else {
                Range { low: t0.min(t1) - motion, high: t0.max(t1) + motion }
            };
            if sure {
                nearest_sure = nearest_sure.min(range.high);
            }
            glance.met.push((range, self.normals[k]));
            if !self.solid[k] {
                glance.unsure = true;
            }
        }
        glance.met.retain(|(range, _)| range.low <= nearest_sure);
        glance.may_miss = nearest_sure == f64::INFINITY;
        glance.unsure |= glance.met.len() > 4 || (!crossed && !glance.may_miss);
        glance
    }
}

impl Glance {
    /// Whether whatever is met is met at too large an incidence for a usable line of margin m.
    fn skids(&self, scene: &Scene, lines: &Lines) -> bool {
        let back = wrap(lines.angle + PI);
        !self.unsure
            && !self.may_miss
            && self.met.iter().all(|(_, normal)| {
                wrap(normal - back).abs() - lines.half > scene.sensor.max_incidence - scene.margin / scene.size
            })
    }

    /// Whether on every line of the box the two readings may be the same, were each wrong by its bounds and by m.
    fn surely_alike(&self, other: &Self, scene: &Scene, _lines: &Lines) -> bool {
        if self.unsure || other.unsure {
            return false;
        }
        if self.may_miss || other.may_miss {
            return self.met.is_empty() && other.met.is_empty();
        }
        let (depth, angle) = (2.0 * scene.margin, 2.0 * scene.margin / scene.size);
        let alike = |a: &(Range, f64), b: &(Range, f64)| {
            let farthest = (a.0.high - b.0.low).max(b.0.high - a.0.low);
            scene.alike(Some((0.0, a.1)), Some((farthest, b.1)), -depth, -angle)
        };
        self.met.iter().all(|a| other.met.iter().all(|b| alike(a, b)))
    }
}

impl PartialEq for Lines {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Lines {}

impl PartialOrd for Lines {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Lines {
    /// The box that may leave least is on top; of these, the one divided last.
    fn cmp(&self, other: &Self) -> Ordering {
        other.left.cmp(&self.left).then(self.number.cmp(&other.number))
    }
}

