//! All lines, by branch and bound (`docs/theory.md`, T13).
//!
//! Boxes of lines (an interval of directions, an interval of places across) are divided. From a few poses of each
//! hypothesis follows what every line of a box leaves at least; a box that can't beat the best path found is closed. A
//! box so small that no line in it moves anything by more than m is closed by judging its middle: what a line of
//! margin ≥ m in it tells, its middle tells as well.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc as Shared;

use rayon::prelude::*;

use super::views::{Frame, Known, Look, Pair, View};
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::{Proof, Scene};

/// Intervals of directions at the start, if all are allowed.
const FIRST_DIRECTIONS: usize = 64;

/// The share of m by which lines of a smallest box may differ from its middle.
const SMALLEST: f64 = 0.9;

/// Boxes that are looked at together.
const BATCH: usize = 256;

/// A box is coarse if its lines differ by more than this share of what the poses do: few views say as much as many.
const COARSE: f64 = 0.3;

/// Poses of every member at which the tip is also looked at as far off its line as it may be.
const SHIFTED: usize = 3;

/// Views of every member that are looked at from a coarse box.
const COARSE_VIEWS: usize = 2;

/// An interval of directions and one of places across, about the middle of the scene.
#[derive(Debug, Clone)]
pub(crate) struct LineBox {
    pub angle: f64,
    pub half: f64,
    pub aside: f64,
    pub reach: f64,
    /// Pairs that every line of it leaves at least.
    left: usize,
    number: u64,
    /// What the box around it has shown.
    shown: Shared<Shown>,
}

/// Of each member, the one with the largest slack first.
struct Views {
    of: Vec<Vec<View>>,
    /// By how much they move a corner of a part, in the mean over members.
    extent: f64,
}

impl Views {
    fn new(scene: &Scene, members: &[usize]) -> Self {
        let error = scene.sensor.path_error;
        // The tip may be as far off its line as the path error says, on either side.
        let shifts: &[f64] = if error > 0.0 { &[error, -error] } else { &[] };
        let of_member = |member: &usize| -> Vec<View> {
            let poses = scene.many_views(*member);
            let on_line = poses.iter().map(|pose| (*pose, 0.0));
            let off_line =
                poses.iter().take(SHIFTED).flat_map(|pose| shifts.iter().map(|shift| (*pose, *shift)));
            on_line.chain(off_line).map(|(pose, shift)| View::new(scene, *member, pose, shift)).collect()
        };
        let of: Vec<Vec<View>> = members.iter().map(of_member).collect();
        let extent =
            |views: &Vec<View>| views.iter().map(|view| view.moved_from(&views[0])).fold(0.0, f64::max);
        let extent = of.iter().map(extent).sum::<f64>() / of.len() as f64;
        Self { of, extent }
    }
}

/// What is true of every line of a box, and so of its halves.
#[derive(Debug, Default)]
struct Shown {
    /// Of each view of each member; empty: nothing.
    known: Vec<Known>,
    /// Of pairs of members, the larger place first; empty: nothing.
    pairs: Vec<Pair>,
}

/// Searches all lines for one that is better than `best`.
pub(crate) fn complete(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> Proof {
    let scene = best.scene;
    let members = best.members;
    let views = Views::new(scene, members);
    let mut open = first_boxes(scene, members.len());
    let mut next_number = open.len() as u64;
    let mut num_boxes = 0;
    // Proof and bound are of lines that begin outside of everything.
    let outside = scene.begins_outside();
    let score = |left: usize| if outside { left as f64 / members.len() as f64 } else { 1.0 };
    while let Some(first) = open.peek() {
        // The heap gives the most promising box first: if that is closed, all are.
        let least = first.left.min(best.num_left());
        let closed = least >= best.num_left();
        if closed || best.enough(settings.stop) || num_boxes >= settings.effort || late() {
            return Proof { bound: score(least), proved: closed && outside, num_boxes };
        }
        let batch: Vec<LineBox> = std::iter::from_fn(|| open.pop()).take(BATCH).collect();
        num_boxes += batch.len() as u64;
        let enough = best.num_left();
        let found: Vec<Found> =
            batch.par_iter().map(|lines| examine(scene, members, &views, lines, enough)).collect();
        for (lines, found) in batch.into_iter().zip(found) {
            match found {
                Found::Nothing => {}
                Found::Line(line) => {
                    best.offer(&line);
                }
                Found::AtLeast(left, shown) => {
                    for part in lines.halves(scene) {
                        let shown = Shared::clone(&shown);
                        open.push(LineBox { left, number: next_number, shown, ..part });
                        next_number += 1;
                    }
                }
            }
        }
    }
    Proof { bound: score(best.num_left().min(members.len().pow(2))), proved: outside, num_boxes }
}

/// What a box may hold that leaves less than `enough`.
enum Found {
    Nothing,
    /// Its middle, as good as any line of margin ≥ m in it.
    Line(Line),
    /// Every line of it leaves so much, at least; and what they may meet.
    AtLeast(usize, Shared<Shown>),
}

fn examine(scene: &Scene, members: &[usize], views: &Views, lines: &LineBox, enough: usize) -> Found {
    if lines.left >= enough {
        return Found::Nothing;
    }
    let Some((left, shown)) = least_left(scene, views, lines, enough) else { return Found::Nothing };
    if left >= enough {
        return Found::Nothing;
    }
    if !lines.is_smallest(scene) {
        return Found::AtLeast(left, Shared::new(shown));
    }
    let joined = |j: usize, k: usize| shown.pairs[k * members.len() + j] == Pair::Joined;
    let better = |line: &Line| scene.leaves_fewer(line, members, enough, joined);
    scene.line(lines.angle, lines.aside).filter(better).map_or(Found::Nothing, Found::Line)
}

/// All lines that are allowed.
fn first_boxes(scene: &Scene, left: usize) -> BinaryHeap<LineBox> {
    let (angles, half) = scene.directions(FIRST_DIRECTIONS);
    let interval = |(number, angle): (u64, f64)| LineBox {
        angle,
        half,
        aside: 0.0,
        reach: scene.clear(),
        left,
        number,
        shown: Shared::default(),
    };
    (0..).zip(angles).map(interval).collect()
}

impl LineBox {
    /// How far a point at `radius` from the middle is moved, seen from the line, from one line of the box to its middle.
    fn motion(&self, radius: f64) -> f64 {
        self.reach + 2.0 * (0.5 * self.half).sin() * radius
    }

    /// No line of the box is farther than m from its middle, with some room for rounding.
    fn is_smallest(&self, scene: &Scene) -> bool {
        self.motion(scene.radius) <= SMALLEST * scene.margin
            && self.half <= SMALLEST * scene.margin / scene.size
    }

    fn halves(&self, scene: &Scene) -> [Self; 2] {
        let turn = (2.0 * (0.5 * self.half).sin() * scene.radius).max(self.half * scene.size);
        if turn > self.reach {
            let half = 0.5 * self.half;
            [-half, half].map(|by| Self { angle: self.angle + by, half, ..self.clone() })
        } else {
            let reach = 0.5 * self.reach;
            [-reach, reach].map(|by| Self { aside: self.aside + by, reach, ..self.clone() })
        }
    }
}

/// Pairs that every usable line of the box leaves at least, or `enough`, and what is then known of it; `None` if no line of
/// it can be used.
fn least_left(scene: &Scene, views: &Views, lines: &LineBox, enough: usize) -> Option<(usize, Shown)> {
    let frame = Frame::new(scene, lines);
    let most = views.of.iter().map(Vec::len).max().unwrap_or(0);
    let mut looks: Vec<Look> = views.of.iter().map(|_| Look::default()).collect();
    let mut known = vec![Known::Nothing; views.of.len() * most];
    let mut pairs = lines.shown.pairs.clone();
    pairs.resize(views.of.len() * views.of.len(), Pair::Open);
    let mut left = views.of.len() + 2 * pairs.iter().filter(|one| **one == Pair::Joined).count();
    let mut apart = vec![true; pairs.len()];
    let is_coarse = lines.motion(scene.radius) > COARSE * views.extent;
    let count = if is_coarse { most.min(COARSE_VIEWS) } else { most };
    for number in 0..count {
        for (k, of_member) in views.of.iter().enumerate() {
            let Some(view) = of_member.get(number) else { continue };
            let place = k * most + number;
            let glance = view.glance(&frame, lines.shown.known.get(place));
            if glance.skids(&frame) {
                return None;
            }
            for (j, other) in looks.iter().enumerate().filter(|(j, _)| *j != k) {
                let pair = k.max(j) * views.of.len() + k.min(j);
                if pairs[pair] != Pair::Open {
                    continue;
                }
                match other.pair(&glance, &frame) {
                    Pair::Apart => {}
                    Pair::Open => apart[pair] = false,
                    Pair::Joined => {
                        pairs[pair] = Pair::Joined;
                        left += 2;
                        if left >= enough {
                            return Some((left, Shown::default()));
                        }
                    }
                }
            }
            known[place] = glance.known();
            looks[k].add(glance);
        }
    }
    for (pair, apart) in pairs.iter_mut().zip(apart) {
        // A coarse box is not looked at from all views.
        if apart && !is_coarse && *pair == Pair::Open {
            *pair = Pair::Apart;
        }
    }
    Some((left, Shown { known, pairs }))
}

impl PartialEq for LineBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for LineBox {}

impl PartialOrd for LineBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for LineBox {
    /// The box that may leave least is on top; of these, the one divided last.
    fn cmp(&self, other: &Self) -> Ordering {
        other.left.cmp(&self.left).then(self.number.cmp(&other.number))
    }
}
