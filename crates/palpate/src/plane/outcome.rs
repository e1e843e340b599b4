//! What a line may meet first, over a whole pose set (MATH 2.3.4, 2.3.5; `docs/theory.md`, T11).

use crate::part::Surface;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::arc::{Arc, wrap};
use super::model::Model;
use super::pose_set::PoseSet;
use super::shadow::{PlacedCell, Shadow, Spot};
use crate::feature::Feature;
use crate::judge::{Fault, Outcome, Rules, Touch};
use crate::line::Line;
use crate::scene::{self, Question};
use crate::sensor::Sensor;
use crate::tree::Range;

/// What is granted beyond the poses: all ranges are wider by it.
#[derive(Debug, Clone, Copy)]
struct Allowance {
    /// The tip may be this far from its line.
    aside: f64,
    /// Depths.
    depth: f64,
    /// Normals, radians.
    angle: f64,
}

impl Allowance {
    /// Path error, the model's slacks, and the margin μ, as a length and as an angle.
    fn new(sensor: &Sensor, model: &Model, margin: f64, angle_margin: f64) -> Self {
        Self {
            aside: sensor.path_error + model.position_slack + margin,
            depth: model.position_slack + margin,
            angle: model.normal_slack + angle_margin,
        }
    }
}

/// The question, with what follows from it for this hypothesis.
struct Asked<'a> {
    line: &'a Line,
    /// Angle of the way back.
    back: f64,
    sensor: &'a Sensor,
    allowance: Allowance,
    rules: Rules,
    /// How far the tip goes.
    length: f64,
}

impl<'a> Asked<'a> {
    fn new(ask: &Question<'a>, model: &Model) -> Self {
        let Question { line, sensor, rules, margin, angle_margin, length, .. } = *ask;
        let allowance = Allowance::new(sensor, model, margin, angle_margin);
        Self { line, back: (-line.direction).to_angle(), sensor, allowance, rules, length }
    }

    /// Angles between the way back and normals.
    fn incidence(&self, normals: Arc) -> Range {
        let away = wrap(normals.middle() - self.back).abs();
        Range { low: (away - normals.half_width()).max(0.0), high: (away + normals.half_width()).min(PI) }
    }
}

/// How far along the line a vertex may be, and how far to the left of it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    along: Range,
    aside: Range,
}

/// A contact that is possible in a cell.
struct Possible {
    feature: Feature,
    depth: Range,
    normals: Arc,
    fault: Option<Fault>,
}

impl scene::Shadow<DVec2> for Shadow {
    const SLOW: bool = false;

    fn new(poses: &PoseSet) -> Self {
        Self::new(poses)
    }

    fn model(&self) -> &Model {
        self.model()
    }

    fn ball(&self) -> (DVec2, f64) {
        (self.middle, self.radius)
    }

    /// The allowance widens everything before nearer contacts hide farther ones, so that with a larger one the outcome only
    /// grows (`docs/theory.md`, T12).
    fn outcome(&self, ask: &Question<'_>) -> Outcome {
        self.outcome_until(&Asked::new(ask, &self.model), |_| false)
    }

    /// Looks no further than needed.
    fn surely_touched(&self, ask: &Question<'_>) -> bool {
        let fails = |outcome: &Outcome| outcome.fault.is_some() || outcome.may_miss;
        !fails(&self.outcome_until(&Asked::new(ask, &self.model), fails))
    }
}

impl Shadow {
    /// The outcome over the first cells, so many that it is as `enough` wants it.
    fn outcome_until(&self, ask: &Asked<'_>, enough: impl Fn(&Outcome) -> bool) -> Outcome {
        let mut outcome = Outcome::default();
        let mut seen = Vec::with_capacity(self.model.vertices.len());
        for cell in &self.cells {
            self.check_start(cell, ask, &mut outcome);
            seen.clear();
            seen.extend(cell.spots.iter().map(|spot| self.seen(spot, ask.line)));
            let (blocked, possible) = self.cell_outcome(cell, &seen, ask);
            outcome.may_miss |= blocked.is_none_or(|depth| depth >= ask.length);
            for one in possible {
                if one.depth.low <= blocked.unwrap_or(f64::INFINITY).min(ask.length) {
                    let fault = one.fault.or_else(|| self.unwanted(one.feature, ask.rules));
                    if let Some(fault) = fault {
                        outcome.fault = Some(outcome.fault.map_or(fault, |known| known.min(fault)));
                    }
                    add(&mut outcome.touches, &one);
                }
            }
            if enough(&outcome) {
                break;
            }
        }
        outcome.touches.sort_by_key(|a| a.feature);
        outcome
    }

    /// Whether a first contact on the feature breaks a rule.
    fn unwanted(&self, feature: Feature, rules: Rules) -> Option<Fault> {
        rules.broken_by(feature, || self.assigned[feature.number() as usize])
    }

    /// The tip must be clear of the part where it starts, at every pose of the cell.
    fn check_start(&self, cell: &PlacedCell, ask: &Asked<'_>, outcome: &mut Outcome) {
        let keep = ask.sensor.tip_radius + ask.allowance.aside;
        if ask.line.start.distance(self.middle) > self.radius + keep {
            return;
        }
        // In the model's frame, from the middle of the cell, the start moves by no more than `motion`.
        let lever = ask.line.start - self.pivot;
        let motion = cell.spread + 2.0 * (0.5 * cell.half).sin() * lever.length();
        let at = cell.y_mid + cell.turned_back(lever);
        if self.model.signed_distance(at) <= keep + motion {
            outcome.fault = Some(Fault::Start);
        }
    }

    fn seen(&self, spot: &Spot, line: &Line) -> Seen {
        let none = Range { low: f64::INFINITY, high: f64::NEG_INFINITY };
        let (mut along, mut aside) = (none, none);
        for point in &self.points[spot.hull.clone()] {
            let (t, s) = line.coordinates(*point);
            along = Range { low: along.low.min(t), high: along.high.max(t) };
            aside = Range { low: aside.low.min(s), high: aside.high.max(s) };
        }
        Seen { along: along.widened(spot.pad), aside: aside.widened(spot.pad) }
    }

    /// By which depth the line has surely met the part (`None`: it may pass it by), and what it may meet, in one cell.
    fn cell_outcome(
        &self,
        cell: &PlacedCell,
        seen: &[Seen],
        ask: &Asked<'_>,
    ) -> (Option<f64>, Vec<Possible>) {
        let mut possible = Vec::new();
        let reach = ask.allowance.aside + ask.sensor.tip_radius;
        if seen.iter().all(|seen| seen.aside.low > reach) || seen.iter().all(|seen| seen.aside.high < -reach)
        {
            return (None, possible);
        }
        for number in 0..self.model.faces.len() {
            possible.extend(self.possible_on_face(cell, seen, number, ask));
        }
        if ask.sensor.tip_radius > 0.0 {
            for number in 0..self.model.vertices.len() {
                possible.extend(self.possible_on_vertex(cell, seen, number, ask));
            }
        }
        let blocked = self.surely_met(cell, seen, ask);
        (blocked.filter(|depth| *depth >= 0.0), possible)
    }

    /// A contact of the tip with one face, moved out by the tip's radius.
    fn possible_on_face(
        &self,
        cell: &PlacedCell,
        seen: &[Seen],
        number: usize,
        ask: &Asked<'_>,
    ) -> Option<Possible> {
        let face = &self.model.faces[number];
        if face.surface == Surface::Seam {
            return None;
        }
        let [start, end] = self.ends[number].map(|vertex| seen[vertex]);
        let near = start.aside.hull(end.aside);
        let reach = ask.allowance.aside + ask.sensor.tip_radius;
        if near.low > reach || near.high < -reach {
            return None;
        }
        let (normal, angle) = cell.normals[number];
        let normals = Arc::around(angle, cell.half + ask.allowance.angle);
        let incidence = ask.incidence(normals);
        if incidence.low >= FRAC_PI_2 || (incidence.high >= FRAC_PI_2 && !self.model.closed) {
            // The back of a face: of a closed part it is never met first, of a loose one it is in the way, and the radius
            // moves it to the other side.
            if self.model.closed {
                return None;
            }
            let along = start.along.hull(end.along);
            let depth = along.widened(ask.allowance.depth + ask.sensor.tip_radius);
            return (depth.high >= 0.0).then_some(Possible {
                feature: Feature::Face(number as u32),
                depth,
                normals: normals.turn(PI),
                fault: Some(Fault::Untouchable),
            });
        }
        // The radius moves the face to one side.
        let moved = moved_by(ask.sensor.tip_radius, normal, ask.line.left(), cell.half);
        if near.low + moved.low > ask.allowance.aside || near.high + moved.high < -ask.allowance.aside {
            return None;
        }
        let depth = self.face_depth(cell, [start, end], number, ask.sensor.tip_radius, ask)?;
        let limit = ask.sensor.max_incidence;
        let fault = match face.surface {
            Surface::Touchable => (incidence.high > limit).then_some(Fault::Skid),
            _ => Some(Fault::Untouchable),
        };
        (depth.high >= 0.0).then_some(Possible {
            feature: Feature::Face(number as u32),
            depth,
            normals,
            fault,
        })
    }

    /// Depths at which the tip's centre may meet the line of a face, moved out by `radius`, between the face's ends.
    ///
    /// The signed distance of a point of the path from the moved line is linear in `(s, y)` but for the cosine; divided
    /// by the cosine of the incidence it is the way that is left to go (MATH 2.3.5).
    fn face_depth(
        &self,
        cell: &PlacedCell,
        [start, end]: [Seen; 2],
        number: usize,
        radius: f64,
        ask: &Asked<'_>,
    ) -> Option<Range> {
        let face = &self.model.faces[number];
        let (normal, angle) = cell.normals[number];
        // How far along the line the radius moves each end: r·(n·u) over the cell.
        let shift = moved_by(radius, normal, ask.line.direction, cell.half);
        let span = start.along.hull(end.along);
        let extent = Range { low: span.low + shift.low, high: span.high + shift.high };
        // Ends cut off where the path does not reach: only the part of the face within `aside` of the line is met.
        let incidence = ask.incidence(Arc::around(angle, cell.half));
        if incidence.high + ask.allowance.angle >= FRAC_PI_2 - 1e-3 {
            return Some(extent.widened(ask.allowance.depth));
        }
        let (slowest, fastest) = (incidence.high.cos(), incidence.low.cos());
        let inner = face.normal.dot(face.start) + radius;
        let along_normal = normal.dot(ask.line.direction);
        let t_mid =
            (inner - face.normal.dot(cell.y_mid) + normal.dot(self.pivot - ask.line.start)) / along_normal;
        let arm = self.pivot - ask.line.at(t_mid);
        let (a, b) = (normal.dot(arm), normal.perp().dot(arm));
        let mut gap = Range { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for (s, y) in &cell.corners {
            let value = inner - face.normal.dot(*y) + cell.mu * a + s * b;
            gap = Range { low: gap.low.min(value), high: gap.high.max(value) };
        }
        let gap = gap.widened(cell.rho * a.abs() + ask.allowance.aside * incidence.high.sin());
        // t − t_mid = gap / (n·u), and n·u is in [−fastest, −slowest].
        let quotient = |value: f64, upper: bool| {
            if (value > 0.0) == upper { value / slowest } else { value / fastest }
        };
        let depth = Range {
            low: (t_mid + quotient(-gap.high, false)).max(extent.low),
            high: (t_mid + quotient(-gap.low, true)).min(extent.high),
        };
        let rounding = 1e-9 * (self.radius + depth.low.abs());
        (depth.low <= depth.high + rounding).then(|| depth.widened(ask.allowance.depth + rounding))
    }

    /// A contact of a ball with a vertex that sticks out.
    fn possible_on_vertex(
        &self,
        cell: &PlacedCell,
        seen: &[Seen],
        number: usize,
        ask: &Asked<'_>,
    ) -> Option<Possible> {
        let radius = ask.sensor.tip_radius;
        let Seen { along, aside } = seen[number];
        let cone = self.cones[number]?;
        // The vertex's offset to the left of the tip's way, as a share of the radius: the sine of the incidence.
        let low = ((aside.low - ask.allowance.aside) / radius).max(-1.0);
        let high = ((aside.high + ask.allowance.aside) / radius).min(1.0);
        if low > high {
            return None;
        }
        let (low, high) = (low.asin(), high.asin());
        let hit = Arc { start: ask.back + low, width: high - low }.widen(ask.allowance.angle);
        let sticking = cone.turn(cell.mid).widen(cell.half + ask.allowance.angle);
        let parts = hit.intersect(sticking);
        let first = parts.first()?;
        let normals = if parts.len() == 1 { *first } else { hit };
        let incidence = ask.incidence(normals);
        let depth = Range {
            low: along.low - radius * incidence.low.cos(),
            high: along.high - radius * incidence.high.min(FRAC_PI_2).cos(),
        };
        let rounding = 1e-9 * (self.radius + depth.low.abs());
        let depth = depth.widened(ask.allowance.depth + rounding);
        let touchable = self.model.vertices[number].normals.is_some();
        let fault = if touchable {
            (incidence.high > ask.sensor.max_incidence).then_some(Fault::Skid)
        } else {
            Some(Fault::Untouchable)
        };
        let feature = Feature::Vertex(number as u32);
        (depth.high >= 0.0).then_some(Possible { feature, depth, normals, fault })
    }

    /// A depth by which the line has surely met the part, if it surely does.
    ///
    /// Between a vertex that is surely to its left and the next one that is surely to its right an outline must cross the
    /// line, inward; of a loose face this is said only if it is one face. The tip touches no later than its centre is its
    /// radius away from that crossing, or from a vertex that is surely as near to the line.
    fn surely_met(&self, cell: &PlacedCell, seen: &[Seen], ask: &Asked<'_>) -> Option<f64> {
        let side = |vertex: usize| {
            if seen[vertex].aside.low > ask.allowance.aside {
                1
            } else if seen[vertex].aside.high < -ask.allowance.aside {
                -1
            } else {
                0
            }
        };
        // The depth by which a run of faces is met: the farthest of those that the line may cross.
        let farthest = |faces: &mut dyn Iterator<Item = usize>| {
            let mut depth = f64::NEG_INFINITY;
            for number in faces {
                let [start, end] = self.ends[number].map(|vertex| seen[vertex]);
                let reach = start.aside.hull(end.aside);
                if reach.low > ask.allowance.aside || reach.high < -ask.allowance.aside {
                    continue;
                }
                if start.along.hull(end.along).low <= 0.0 {
                    return None;
                }
                let normals = Arc::around(cell.normals[number].1, cell.half + ask.allowance.angle);
                if ask.incidence(normals).low < FRAC_PI_2 {
                    let range = self.face_depth(cell, [start, end], number, 0.0, ask);
                    depth = range.map_or(depth, |range| depth.max(range.high));
                } else if !self.model.closed {
                    depth = depth.max(start.along.hull(end.along).high + ask.allowance.depth);
                }
            }
            depth.is_finite().then_some(depth - ask.sensor.tip_radius)
        };
        let mut least: Option<f64> = None;
        let mut take = |depth: Option<f64>| {
            if let Some(depth) = depth {
                least = Some(least.map_or(depth, |known: f64| known.min(depth)));
            }
        };
        for (seen, solid) in seen.iter().zip(&self.solid) {
            if *solid {
                take(met_by_vertex(seen, ask));
            }
        }
        if !self.model.closed {
            for number in
                (0..self.model.faces.len()).filter(|k| self.model.faces[*k].surface != Surface::Seam)
            {
                let [start, end] = self.ends[number];
                if side(start) * side(end) < 0 {
                    take(farthest(&mut std::iter::once(number)));
                }
            }
            return least;
        }
        for faces in &self.loops {
            let count = faces.len();
            let at = |k: usize| faces.start + k % count;
            let Some(first) = (0..count).find(|k| side(self.ends[at(*k)][0]) != 0) else { continue };
            let mut from = first;
            for k in first + 1..=first + count {
                let here = side(self.ends[at(k)][0]);
                if here == 0 {
                    continue;
                }
                if side(self.ends[at(from)][0]) == 1 && here == -1 {
                    take(farthest(&mut (from..k).map(at)));
                }
                from = k;
            }
        }
        least
    }
}

/// A depth by which a ball has surely met a vertex: it is ahead, and closer to the line than the radius.
fn met_by_vertex(Seen { along, aside }: &Seen, ask: &Asked<'_>) -> Option<f64> {
    let radius = ask.sensor.tip_radius;
    let off = aside.high.max(-aside.low) + ask.allowance.aside;
    let sure = along.low > 0.0 && off < radius;
    sure.then(|| along.high - (radius * radius - off * off).sqrt() + ask.allowance.depth)
}

/// Adds a contact; those on one feature become one.
fn add(touches: &mut Vec<Touch>, one: &Possible) {
    match touches.iter_mut().find(|touch| touch.feature == one.feature) {
        Some(touch) => {
            touch.depth = touch.depth.hull(one.depth);
            touch.normals = around_both(touch.normals, one.normals);
        }
        None => touches.push(Touch { feature: one.feature, depth: one.depth, normals: one.normals }),
    }
}

/// An arc that holds two, the shorter way around.
fn around_both(a: Arc, b: Arc) -> Arc {
    let offset = wrap(b.middle() - a.middle());
    let low = (-a.half_width()).min(offset - b.half_width());
    let high = a.half_width().max(offset + b.half_width());
    if high - low >= TAU { Arc::FULL } else { Arc { start: a.middle() + low, width: high - low } }
}

/// How far a radius moves a face along `direction`: as its normal, which turns by up to `half`, has it.
fn moved_by(radius: f64, normal: DVec2, direction: DVec2, half: f64) -> Range {
    if radius == 0.0 {
        return Range { low: 0.0, high: 0.0 };
    }
    let angle = wrap(normal.to_angle() - direction.to_angle()).abs();
    let cosine = |angle: f64| radius * angle.cos();
    Range { low: cosine((angle + half).min(PI)), high: cosine((angle - half).max(0.0)) }
}
