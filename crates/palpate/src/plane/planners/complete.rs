//! All lines, by branch and bound (`docs/theory.md`, T13).
//!
//! Boxes of lines (an interval of directions, an interval of places across) are divided. From a few poses of each
//! hypothesis follows what every line of a box leaves at least; a box that can't beat the best path found is closed. A
//! box so small that no line in it moves anything by more than m is closed by judging its middle: what a line of
//! margin ≥ m in it tells, its middle tells as well.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;
use std::sync::Arc as Shared;

use rayon::prelude::*;

use super::views::{Frame, Known, Look, View};
use crate::best::Best;
use crate::plan::PlanSettings;
use crate::plane::Line;
use crate::plane::scene::Scene;

/// Intervals of directions at the start.
const FIRST_DIRECTIONS: u32 = 64;

/// The share of m by which lines of a smallest box may differ from its middle.
const SMALLEST: f64 = 0.9;

/// Boxes that are looked at together.
const BATCH: usize = 256;

/// What was proved.
pub(crate) struct Proof {
    /// No usable path of margin ≥ m has a score below this.
    pub bound: f64,
    /// All boxes are closed.
    pub proved: bool,
    pub num_boxes: u64,
}

/// An interval of directions and one of places across, about the middle of the scene.
#[derive(Debug, Clone)]
pub(crate) struct Lines {
    pub angle: f64,
    pub half: f64,
    pub aside: f64,
    pub reach: f64,
    /// Pairs that every line of it leaves at least.
    left: usize,
    number: u64,
    /// What the box around it has shown of each view; empty: nothing.
    known: Shared<[Known]>,
}

/// Searches all lines for one that is better than `best`.
pub(crate) fn complete(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> Proof {
    let scene = best.scene;
    let members = best.members;
    let views: Vec<Vec<View>> = members
        .iter()
        .map(|member| scene.views[*member].iter().map(|pose| View::new(scene, *member, *pose)).collect())
        .collect();
    let mut open = first_boxes(scene, members.len());
    let mut next_number = open.len() as u64;
    let mut num_boxes = 0;
    // The proof is of lines that begin outside of everything.
    let outside = scene.begins_outside();
    let score = |left: usize| left as f64 / members.len() as f64;
    while let Some(first) = open.peek() {
        // The heap gives the most promising box first: if that is closed, all are.
        let least = first.left.min(best.num_left());
        let closed = least >= best.num_left();
        if closed || best.enough(settings.stop) || num_boxes >= settings.effort || late() {
            return Proof { bound: score(least), proved: closed && outside, num_boxes };
        }
        let batch: Vec<Lines> = std::iter::from_fn(|| open.pop()).take(BATCH).collect();
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
                Found::AtLeast(left, known) => {
                    for part in lines.halves(scene) {
                        let known = Shared::clone(&known);
                        open.push(Lines { left, number: next_number, known, ..part });
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
    /// Lines that leave so much, at least; and what they may meet.
    AtLeast(usize, Shared<[Known]>),
}

fn examine(scene: &Scene, members: &[usize], views: &[Vec<View>], lines: &Lines, enough: usize) -> Found {
    if lines.left >= enough || !scene.allowed(lines.angle, lines.half) {
        return Found::Nothing;
    }
    let Some((left, known)) = least_left(scene, views, lines, enough) else { return Found::Nothing };
    let left = left.max(lines.left);
    if left >= enough {
        return Found::Nothing;
    }
    if !lines.is_smallest(scene) {
        return Found::AtLeast(left, known);
    }
    let better = |line: &Line| scene.verdict(line, members, 0.0).is_some_and(|one| one.num_left() < enough);
    scene.line(lines.angle, lines.aside).filter(better).map_or(Found::Nothing, Found::Line)
}

/// All lines.
fn first_boxes(scene: &Scene, left: usize) -> BinaryHeap<Lines> {
    let half = PI / f64::from(FIRST_DIRECTIONS);
    let interval = |k: u32| {
        let angle = -PI + (2.0 * f64::from(k) + 1.0) * half;
        Lines {
            angle,
            half,
            aside: 0.0,
            reach: scene.radius,
            left,
            number: u64::from(k),
            known: Shared::default(),
        }
    };
    (0..FIRST_DIRECTIONS).map(interval).collect()
}

impl Lines {
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

/// Pairs that every usable line of the box leaves at least, or `enough`, and what is then known of each view; `None` if no
/// line of it can be used.
fn least_left(
    scene: &Scene,
    views: &[Vec<View>],
    lines: &Lines,
    enough: usize,
) -> Option<(usize, Shared<[Known]>)> {
    let frame = Frame::new(scene, lines);
    let most = views.iter().map(Vec::len).max().unwrap_or(0);
    let mut looks: Vec<Look> = views.iter().map(|_| Look::default()).collect();
    let mut joined = vec![false; views.len() * views.len()];
    let mut known = vec![Known::Nothing; views.len() * most];
    let mut left = views.len();
    for number in 0..most {
        for (k, of_member) in views.iter().enumerate() {
            let Some(view) = of_member.get(number) else { continue };
            let place = k * most + number;
            let glance = view.glance(&frame, lines.known.get(place));
            if glance.skids(&frame) {
                return None;
            }
            for (j, other) in looks.iter().enumerate() {
                let pair = k.max(j) * views.len() + k.min(j);
                if j != k && other.holds_alike(&glance, &frame) && !std::mem::replace(&mut joined[pair], true)
                {
                    left += 2;
                    if left >= enough {
                        return Some((left, Shared::default()));
                    }
                }
            }
            known[place] = glance.known();
            looks[k].add(glance);
        }
    }
    Some((left, known.into()))
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
