//! What a line may meet first in space, over a whole pose set (`docs/theory.md`, T21).
//!
//! Everything is said in the model's frame, of one cell of poses after another: there the part stands still, and the line is
//! where the middle of the cell has it, give or take what the cell's linear conditions leave.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec2, DVec3, dvec2};
use rayon::prelude::*;

use super::distance::{beside_box, on_segment};
use super::model::Face;
use super::shadow::{PlacedCell, Ray, Rim, Shadow};
use super::site::angle;
use super::sphere::Cap;
use crate::feature::Feature;
use crate::judge::{Fault, Outcome, Rules, Touch};
use crate::line::Line;
use crate::part::Surface;
use crate::plane::Arc;
use crate::scene::Question;
use crate::sensor::{Sensor, Stem};
use crate::tree::Range;

/// Faces that are seen more sidelong than this short of a right angle are met anywhere, radians.
const SIDELONG: f64 = 1e-3;

/// Edges nearer to the line's direction than this, radians, are met with any of their normals.
const ALONG: f64 = 0.05;

/// A range of depths that is this share of the sensor's error wide needs no closer look.
const FINE: f64 = 0.25;

/// Computed depths are wrong by no more than this share of the size of what is seen.
const ROUNDING: f64 = 1e-9;

/// Shares of what a part covers of a line, at which the line may be deep enough in it.
const COVERED: [f64; 5] = [0.0, 0.0625, 0.125, 0.25, 0.5];

/// Cells that are looked at between two looks at what was found; several threads share them.
const AT_ONCE: usize = 32;

/// Pieces into which the way of a stem is divided, at most.
const MOST_PIECES: usize = 400;

/// What is asked, and what is granted: all ranges are wider by it.
struct Granted<'a> {
    line: &'a Line<DVec3>,
    sensor: &'a Sensor,
    rules: Rules,
    /// The tip may be this far from its line.
    aside: f64,
    /// Of depths.
    depth: f64,
    /// Of normals, radians.
    angle: f64,
    /// How far the tip goes.
    length: f64,
}

/// A contact that is possible in a cell.
struct Possible {
    feature: Feature,
    depth: Range,
    normals: Cap,
    fault: Option<Fault>,
}

/// What may happen at the poses of one cell.
struct InCell {
    /// Contacts that may come first.
    possible: Vec<Possible>,
    may_miss: bool,
    /// Of the start and the stem.
    fault: Option<Fault>,
}

/// Where the points at which a line pierces a plane are, as seen from a face in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Inside,
    Outside,
    /// They may be either.
    Across,
}

impl Shadow {
    /// What the line may meet first, over all poses, or over the first cells, so many that it is as `enough` wants it; everything
    /// is wider by a margin, a length and an angle.
    ///
    /// The allowance widens everything before nearer contacts hide farther ones: what is said with one holds for all smaller
    /// shifts of the line (`docs/theory.md`, T21).
    pub(super) fn outcome(
        &self,
        ask: &Question<'_, DVec3>,
        enough: impl Fn(&Outcome<DVec3>) -> bool,
    ) -> Outcome<DVec3> {
        let &Question { line, sensor, rules, margin, angle_margin, length, halt } = ask;
        let (miss, turn) = self.asymmetry;
        let depth = self.model.position_slack + miss + margin;
        let aside = sensor.path_error + depth;
        let angle = self.model.normal_slack + turn + angle_margin;
        let ask = Granted { line, sensor, rules, aside, depth, angle, length };
        let mut outcome = Outcome::default();
        if self.is_passed(&ask) {
            outcome.may_miss = true;
            return outcome;
        }
        let in_cell = |cell: &PlacedCell| self.in_cell(&mut Ray::new(self, cell, line), &ask);
        for some in self.cells.chunks(AT_ONCE) {
            for found in some.par_iter().map(in_cell).collect::<Vec<_>>().into_iter().flatten() {
                self.include(&found, &ask, &mut outcome);
            }
            if halt.load(Relaxed) {
                // Cut short: it may not be used.
                add_fault(&mut outcome, Some(Fault::Start));
                break;
            }
            if enough(&outcome) {
                break;
            }
        }
        outcome.touches.sort_by_key(|touch| touch.feature);
        outcome
    }

    /// Whether the line, and a stem, come nowhere near the part.
    fn is_passed(&self, ask: &Granted<'_>) -> bool {
        let (along, aside) = ask.line.depth_and_aside(self.middle);
        let reach = self.radius + ask.sensor.tip_radius + ask.aside;
        ask.sensor.stem.is_none() && (aside > reach || along < -reach)
    }

    /// What may happen at the poses of a cell; `None`: there are none.
    fn in_cell(&self, ray: &mut Ray<'_>, ask: &Granted<'_>) -> Option<InCell> {
        let radius = ask.sensor.tip_radius;
        // The tip must be clear of the part where it starts.
        let keep = radius + ask.aside;
        let away = ask.line.start.distance(self.middle);
        let starts_near =
            away <= self.radius + keep && self.model.signed_distance(ray.start) <= keep + ray.motion(0.0);
        let mut possible = Vec::new();
        let mut blocked: Option<f64> = None;
        let faces = self.faces_near(ray, keep);
        // A loose face is in the way from behind as well, at some poses of the cell or at all.
        let sides: &[bool] = if self.model.closed { &[true] } else { &[true, false] };
        for (&number, &front) in faces.iter().flat_map(|face| sides.iter().map(move |front| (face, front))) {
            let (one, sure) = self.on_face(ray, number, front, ask);
            possible.extend(one);
            if let Some(depth) = sure {
                blocked = Some(blocked.map_or(depth, |known: f64| known.min(depth)));
            }
        }
        if radius > 0.0 {
            let mut edges: Vec<u32> =
                faces.iter().flat_map(|face| &self.edges_of[*face as usize]).copied().collect();
            edges.sort_unstable();
            edges.dedup();
            let ends = |edge: &u32| self.model.edges[*edge as usize].ends;
            let mut vertices: Vec<u32> = edges.iter().flat_map(ends).collect();
            vertices.sort_unstable();
            vertices.dedup();
            possible.extend(edges.iter().filter_map(|edge| self.on_edge(ray, *edge, ask)));
            possible.extend(vertices.iter().filter_map(|vertex| self.on_vertex(ray, *vertex, ask)));
        }
        if ray.is_empty() {
            return None;
        }
        if blocked.is_none() && !possible.is_empty() {
            blocked = self.surely_met(ray, ask);
        }
        let last = blocked.unwrap_or(f64::INFINITY).min(ask.length);
        possible.retain(|one| one.depth.low <= last && one.depth.high >= 0.0);
        let may_miss = blocked.is_none_or(|depth| depth >= ask.length);
        let stem_meets =
            ask.sensor.stem.as_ref().is_some_and(|stem| !self.stem_is_clear(ray, ask, stem, last));
        let fault = if starts_near { Some(Fault::Start) } else { stem_meets.then_some(Fault::Stem) };
        Some(InCell { possible, may_miss, fault })
    }

    /// Adds what may happen at the poses of one cell to what may at those of others.
    fn include(&self, found: &InCell, ask: &Granted<'_>, outcome: &mut Outcome<DVec3>) {
        outcome.may_miss |= found.may_miss;
        for one in &found.possible {
            add_fault(outcome, one.fault.or_else(|| self.unwanted(one.feature, ask.rules)));
            add(&mut outcome.touches, one);
        }
        add_fault(outcome, found.fault);
    }

    /// Whether a first contact on the feature breaks a rule.
    fn unwanted(&self, feature: Feature, rules: Rules) -> Option<Fault> {
        match feature {
            Feature::Face(number) if rules.avoid_assigned && self.assigned[number as usize] => {
                Some(Fault::Assigned)
            }
            Feature::Face(_) if !rules.faces => Some(Fault::Kind),
            Feature::Edge(_) if !rules.edges => Some(Fault::Kind),
            Feature::Vertex(_) if !rules.vertices => Some(Fault::Kind),
            _ => None,
        }
    }

    /// The faces that may come within `keep` of the line, in order.
    fn faces_near(&self, ray: &Ray<'_>, keep: f64) -> Vec<u32> {
        let bvh = self.model.bvh();
        let reach = keep + ray.motion_near(ray.cell.y, bvh.reach(ray.cell.y) + keep);
        let mut faces = Vec::new();
        let bound = |low: DVec3, high: DVec3| beside_box(ray.start, ray.direction, low, high);
        bvh.descend(reach, bound, |_, face| {
            faces.push(face);
            reach
        });
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// A contact of the tip with one side of a face, moved out by the tip's radius, and by which depth the tip has met it, if it surely
    /// does.
    ///
    /// At depth `t` the tip's centre is at `q(t)`. With `g = n·q(t₀) − offset − r` at a depth `t₀`, it meets the face's plane
    /// at `t = t₀ − g/(n·u)`, where along a direction `e` of the plane it has `(e − f n)·q(t₀) + f (offset + r)`, with
    /// `f = (e·u)/(n·u)`; over the cell `f` changes by no more than the turn over the squared cosine of the incidence.
    fn on_face(
        &self,
        ray: &mut Ray<'_>,
        number: u32,
        front: bool,
        ask: &Granted<'_>,
    ) -> (Option<Possible>, Option<f64>) {
        let face = &self.model.faces[number as usize];
        let turned = ray.cell.radius;
        let (normal, offset) = if front { (face.normal, face.offset) } else { (-face.normal, -face.offset) };
        let away = angle(-ray.direction, normal);
        let incidence = Range { low: (away - turned - ask.angle).max(0.0), high: away + turned + ask.angle };
        if incidence.low >= FRAC_PI_2 {
            // It turns away at all poses of the cell: the tip would come through the part.
            return (None, None);
        }
        let touchable = front && face.surface == Surface::Touchable;
        let fault = if touchable {
            (incidence.high > ask.sensor.max_incidence).then_some(Fault::Skid)
        } else {
            Some(Fault::Untouchable)
        };
        let normals = Cap::around(ray.cell.turn.transpose() * normal, turned + ask.angle);
        let possible = |depth: Range| Possible { feature: Feature::Face(number), depth, normals, fault };
        let steepest = away + turned;
        if steepest >= FRAC_PI_2 - SIDELONG {
            return (self.sidelong(ray, face, ask).map(possible), None);
        }
        let radius = ask.sensor.tip_radius;
        let inner = offset + radius;
        let speed = normal.dot(ray.direction);
        let depth = (inner - normal.dot(ray.start)) / speed;
        let middle = ray.at(depth) - radius * normal;
        let sides = Outline::new(self, face, normal, middle);
        let slowest = steepest.cos();
        let mut place = Place::Across;
        let mut gap = Range { low: 0.0, high: 0.0 };
        for closely in [false, true] {
            gap = ray.range(normal, depth, closely);
            let largest = gap.high.max(-gap.low) + ask.aside;
            let reach = [sides.out, sides.along].map(|axis| {
                let share = axis.dot(ray.direction) / speed;
                let across = axis - share * normal;
                let loose = turned / (slowest * slowest) * largest + across.length() * ask.aside;
                ray.range(across, depth, closely).widened(loose)
            });
            place = sides.place(reach, || face.is_before(&self.model, middle));
            if place != Place::Across {
                break;
            }
        }
        if place == Place::Outside || ray.is_empty() {
            return (None, None);
        }
        // What is far below the sensor's error tells nothing.
        if gap.high - gap.low > FINE * ask.sensor.position_error {
            let closest = ray.range(normal, depth, true);
            gap = Range { low: gap.low.max(closest.low), high: gap.high.min(closest.high) };
        }
        let gap = gap.widened(ask.aside * steepest.sin());
        let fastest = (away - turned).max(0.0).cos();
        let beyond = |value: f64, upper: bool| {
            if (value > 0.0) == upper { value / slowest } else { value / fastest }
        };
        let range = Range { low: depth + beyond(gap.low, false), high: depth + beyond(gap.high, true) };
        let range = range.widened(ask.depth + ROUNDING * (self.radius + depth.abs()));
        let sure = (place == Place::Inside && range.low > 0.0).then_some(range.high);
        (Some(possible(range)), sure)
    }

    /// Depths at which a face that is seen nearly edge-on may be met, if the line may come near it.
    fn sidelong(&self, ray: &Ray<'_>, face: &Face, ask: &Granted<'_>) -> Option<Range> {
        let keep = ask.sensor.tip_radius + ask.aside;
        let corners = || face.loops.iter().flatten().map(|k| self.model.vertices[*k as usize].point);
        let motion = corners().map(|corner| ray.motion_near(corner, keep)).fold(0.0, f64::max);
        let reach = keep + motion;
        let beside = sides(self, face).map(|[a, b]| line_to_segment(ray.start, ray.direction, a, b));
        let speed = face.normal.dot(ray.direction);
        let pierced = || {
            let place = ray.at((face.offset - face.normal.dot(ray.start)) / speed);
            place.is_finite() && face.is_before(&self.model, place)
        };
        if beside.fold(f64::INFINITY, f64::min) > reach && !pierced() {
            return None;
        }
        let along = corners().map(|corner| ray.direction.dot(corner - ray.start));
        let none = Range { low: f64::INFINITY, high: f64::NEG_INFINITY };
        let span = along.fold(none, |all, t| all.hull(Range { low: t, high: t }));
        Some(span.widened(reach + ask.depth))
    }

    /// A contact of a ball with an edge that sticks out.
    ///
    /// Near the edge no pose has the line further than `motion` from where the middle has it: the tip meets the edge no sooner
    /// than a ball so much larger does, and no later than one so much smaller.
    fn on_edge(&self, ray: &Ray<'_>, number: u32, ask: &Granted<'_>) -> Option<Possible> {
        let rim = self.edges[number as usize]?;
        let ends = self.model.edges[number as usize].ends.map(|end| self.model.vertices[end as usize].point);
        let radius = ask.sensor.tip_radius;
        let loose = ends.map(|end| ray.motion_near(end, radius + ask.aside));
        let loose = loose[0].max(loose[1]) + ask.aside;
        let met = |radius: f64| near_segment(ray.start, ray.direction, ends, radius);
        let outer = met(radius + loose)?;
        let inner = if radius > loose { met(radius - loose) } else { None };
        let depth = Range { low: outer.low, high: inner.map_or(outer.high, |inner| inner.low) };
        let depth = depth.widened(ask.depth + ROUNDING * (self.radius + depth.low.abs()));
        let normals = Self::normals_at_edge(ray, rim, ends, loose, ask)?;
        let fault = fault_at(normals, rim.touchable, ask);
        (depth.high >= 0.0).then_some(Possible { feature: Feature::Edge(number), depth, normals, fault })
    }

    /// The normals with which a ball may meet an edge, if it does at all: those of the edge that face the line, as far
    /// aside as it passes.
    fn normals_at_edge(
        ray: &Ray<'_>,
        rim: Rim,
        [a, b]: [DVec3; 2],
        loose: f64,
        ask: &Granted<'_>,
    ) -> Option<Cap> {
        let turned = ray.cell.radius;
        let Some([first, second]) = rim.normals else { return Some(Cap::around(-ask.line.direction, PI)) };
        let mean = (first + second).normalize_or(first);
        let half = 0.5 * angle(first, second);
        let whole = Cap::around(ray.cell.turn.transpose() * mean, half + turned + ask.angle);
        let axis = (b - a).normalize_or_zero();
        let across = axis.cross(ray.direction);
        let sine = across.length();
        if sine < ALONG {
            return Some(whole);
        }
        // Seen along the edge: towards where the tip comes from, and aside.
        let aside = across / sine;
        let toward = aside.cross(axis);
        let toward = if toward.dot(ray.direction) > 0.0 { -toward } else { toward };
        let offset = aside.dot(ray.start - a);
        let radius = ask.sensor.tip_radius;
        let [low, high] = [offset - loose, offset + loose].map(|offset| (offset / radius).clamp(-1.0, 1.0));
        if offset - loose > radius || offset + loose < -radius {
            return None;
        }
        // A ball meets nothing that it leaves: of the far side no more than the turn shows.
        let far = (turned / sine).min(1.0).asin();
        let high = if high >= far.cos() { FRAC_PI_2 + far } else { high.asin() };
        let low = if low <= -far.cos() { -FRAC_PI_2 - far } else { low.asin() };
        let hit = Arc { start: low, width: high - low }.widen(ask.angle + ROUNDING);
        let middle = aside.dot(mean).atan2(toward.dot(mean));
        let parts = hit.intersect(Arc::around(middle, half + ask.angle + ROUNDING));
        let part = match parts.as_slice() {
            [] => return None,
            [one] => *one,
            _ => hit,
        };
        let (sine, cosine) = part.middle().sin_cos();
        let axis = ray.cell.turn.transpose() * (cosine * toward + sine * aside);
        Some(Cap::around(axis, part.half_width() + turned + ask.angle))
    }

    /// A contact of a ball with a vertex that sticks out.
    fn on_vertex(&self, ray: &Ray<'_>, number: u32, ask: &Granted<'_>) -> Option<Possible> {
        let (axis, spread, touchable) = self.vertices[number as usize]?;
        let point = self.model.vertices[number as usize].point;
        let radius = ask.sensor.tip_radius;
        let loose = ray.motion_near(point, radius + ask.aside) + ask.aside;
        let met = |radius: f64| near_segment(ray.start, ray.direction, [point, point], radius);
        let outer = met(radius + loose)?;
        let inner = if radius > loose { met(radius - loose) } else { None };
        let depth = Range { low: outer.low, high: inner.map_or(outer.high, |inner| inner.low) };
        let depth = depth.widened(ask.depth + ROUNDING * (self.radius + depth.low.abs()));
        let turned = ray.cell.radius;
        // The line passes the vertex so far aside: the sine of the incidence, times the radius.
        let offset = point - ray.start;
        let aside = (offset - offset.dot(ray.direction) * ray.direction).length() + loose;
        let slant = if aside < radius { (aside / radius).asin() } else { FRAC_PI_2 };
        let hit = Cap::around(-ask.line.direction, slant + turned + ask.angle);
        let whole = Cap::around(ray.cell.turn.transpose() * axis, spread + turned + ask.angle);
        if !hit.meets(whole) {
            return None;
        }
        let normals = if hit.angle < whole.angle { hit } else { whole };
        let fault = fault_at(normals, touchable, ask);
        (depth.high >= 0.0).then_some(Possible { feature: Feature::Vertex(number), depth, normals, fault })
    }

    /// A depth by which the line has surely met the part, though no face of it is sure: there the tip's centre is deep enough
    /// in the part, or near enough to it, that no pose has it clear. It is looked for along what the part covers of the line.
    fn surely_met(&self, ray: &Ray<'_>, ask: &Granted<'_>) -> Option<f64> {
        let first = self.model.first_hit(ray.start, ray.direction)?.distance;
        let beyond = first + ROUNDING.sqrt() * self.model.size;
        let covered = self.model.first_hit(ray.at(beyond), ray.direction).map_or(0.0, |hit| hit.distance);
        COVERED.iter().map(|share| first + share * covered).find(|depth| {
            let clear = self.model.signed_distance(ray.at(*depth)) + ray.motion(*depth) + ask.aside;
            clear <= ask.sensor.tip_radius
        })
    }

    /// Whether the stem touches nothing while the tip goes to a depth, at any pose of the cell.
    ///
    /// Until it touches, the tip's centre is its radius away from the part: what is of the stem that near to it is clear.
    fn stem_is_clear(&self, ray: &Ray<'_>, ask: &Granted<'_>, stem: &Stem, depth: f64) -> bool {
        let rod = ray.cell.turn * stem.direction;
        let beyond = ask.line.start.distance(self.middle) + self.radius + stem.length;
        let far = depth.min(beyond) + ask.depth;
        let near = (ask.sensor.tip_radius - stem.radius).max(0.0);
        if stem.length <= near {
            return true;
        }
        // Pieces of the way: middles and half sides, along the line and along the rod.
        let mut open = vec![(0.5 * far, 0.5 * far, 0.5 * (near + stem.length), 0.5 * (stem.length - near))];
        let mut num_pieces = 1;
        while let Some((t, t_half, s, s_half)) = open.pop() {
            let lever = s.abs() + s_half;
            let motion = ray.motion(t) + 2.0 * (0.5 * ray.cell.radius.min(PI)).sin() * lever;
            let keep = stem.radius + motion + ask.aside;
            let clear = self.model.signed_distance(ray.at(t) + s * rod) - keep;
            if clear > t_half + s_half {
                continue;
            }
            num_pieces += 1;
            if clear <= 0.0 || num_pieces > MOST_PIECES {
                return false;
            }
            if t_half > s_half {
                open.extend([-0.5, 0.5].map(|by| (t + by * t_half, 0.5 * t_half, s, s_half)));
            } else {
                open.extend([-0.5, 0.5].map(|by| (t, t_half, s + by * s_half, 0.5 * s_half)));
            }
        }
        true
    }
}

/// The sides of a face, as seen from a place in its plane.
struct Outline {
    /// Away from the face across its nearest side, and along that: unit, in the plane.
    out: DVec3,
    along: DVec3,
    sides: Vec<[DVec2; 2]>,
}

impl Outline {
    fn new(shadow: &Shadow, face: &Face, normal: DVec3, place: DVec3) -> Self {
        let distance = |side: &[DVec3; 2]| on_segment(place, side[0], side[1]).distance_squared(place);
        let nearest = sides(shadow, face).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let along = nearest.and_then(|[a, b]| (b - a).try_normalize());
        let along = along.unwrap_or_else(|| normal.any_orthonormal_vector());
        // In the plane to rounding, whatever the corners are off by.
        let out = along.cross(normal).normalize_or(normal.any_orthonormal_vector());
        let along = normal.cross(out);
        let seen = |point: DVec3| dvec2(out.dot(point - place), along.dot(point - place));
        Self { out, along, sides: sides(shadow, face).map(|side| side.map(seen)).collect() }
    }

    /// Where a rectangle around the place is; `inside`: whether the place is on the face.
    fn place(&self, [out, along]: [Range; 2], inside: impl Fn() -> bool) -> Place {
        let middle = 0.5 * dvec2(out.low + out.high, along.low + along.high);
        let half = 0.5 * dvec2(out.high - out.low, along.high - along.low);
        let meets = |[a, b]: &[DVec2; 2]| {
            let (a, b) = (*a - middle, *b - middle);
            let way = b - a;
            let across = way.perp();
            a.min(b).cmple(half).all()
                && a.max(b).cmpge(-half).all()
                && across.dot(a).abs() <= across.abs().dot(half)
        };
        if self.sides.iter().any(meets) {
            return Place::Across;
        }
        if inside() { Place::Inside } else { Place::Outside }
    }
}

/// The sides of a face, all of its loops.
fn sides<'a>(shadow: &'a Shadow, face: &'a Face) -> impl Iterator<Item = [DVec3; 2]> + 'a {
    let at = |k: u32| shadow.model.vertices[k as usize].point;
    face.loops.iter().flat_map(move |corners| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(move |(a, b)| [at(*a), at(*b)])
    })
}

/// Incidences beyond the largest that is reliable, and what can't be touched.
fn fault_at(normals: Cap, touchable: bool, ask: &Granted<'_>) -> Option<Fault> {
    if !touchable {
        return Some(Fault::Untouchable);
    }
    let steepest = angle(-ask.line.direction, normals.axis) + normals.angle;
    (steepest > ask.sensor.max_incidence).then_some(Fault::Skid)
}

fn add_fault(outcome: &mut Outcome<DVec3>, fault: Option<Fault>) {
    if let Some(fault) = fault {
        outcome.fault = Some(outcome.fault.map_or(fault, |known| known.min(fault)));
    }
}

/// Adds a contact; those on one feature become one.
fn add(touches: &mut Vec<Touch<DVec3>>, one: &Possible) {
    match touches.iter_mut().find(|touch| touch.feature == one.feature) {
        Some(touch) => {
            touch.depth = touch.depth.hull(one.depth);
            touch.normals = touch.normals.around_both(one.normals);
        }
        None => touches.push(Touch { feature: one.feature, depth: one.depth, normals: one.normals }),
    }
}

/// The least distance between a line along a unit direction and a segment.
fn line_to_segment(start: DVec3, direction: DVec3, a: DVec3, b: DVec3) -> f64 {
    let across = |point: DVec3| (point - start) - direction * direction.dot(point - start);
    on_segment(DVec3::ZERO, across(a), across(b)).length()
}

/// The depths at which a line along a unit direction is within `radius` of a segment; `None`: nowhere.
fn near_segment(start: DVec3, direction: DVec3, [a, b]: [DVec3; 2], radius: f64) -> Option<Range> {
    let mut all: Option<Range> = None;
    let mut take = |range: Range| all = Some(all.map_or(range, |known| known.hull(range)));
    for end in [a, b] {
        let offset = end - start;
        let foot = direction.dot(offset);
        let square = radius * radius - (offset - foot * direction).length_squared();
        if square >= 0.0 {
            take(Range { low: foot - square.sqrt(), high: foot + square.sqrt() });
        }
    }
    // Between the ends it is a cylinder.
    if let Some(axis) = (b - a).try_normalize() {
        let length = (b - a).length();
        let flat = |vector: DVec3| vector - axis * axis.dot(vector);
        let (from, way) = (flat(start - a), flat(direction));
        let square = way.length_squared();
        if square > 0.0 {
            let foot = -from.dot(way) / square;
            let left = radius * radius - (from + foot * way).length_squared();
            if left >= 0.0 {
                let half = (left / square).sqrt();
                for depth in [foot - half, foot + half] {
                    let along = axis.dot(start + depth * direction - a);
                    if (0.0..=length).contains(&along) {
                        take(Range { low: depth, high: depth });
                    }
                }
            }
        }
    }
    all
}
