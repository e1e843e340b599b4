//! Cells that hold every pose that satisfies the conditions, before these are looked at together (theory, T18).
//!
//! Two sensed normals that are not parallel leave a ball of rotations (MATH row 47): with errors `a`, `b`, residuals `e`
//! of the rotation that fits both best, and the acute angle θ between their lines,
//! `sin(Φ/2) ≤ sin((max(a, b) + e)/2) / sin(θ/2)`. One alone leaves the turns about it; none, all rotations. Where what a
//! contact may lie on has many normals, as edges and vertices have, caps cover them, and each pair of caps leaves a ball.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::case::Case;
use super::cell::{Cell, Conditions};
use super::pose;
use super::site::{self, Site, Sites, angle};
use super::solve::all_sites;
use super::sphere::Cap;

/// Rotations about one normal are divided into so many cells.
const NUM_SPINS: u32 = 11;

/// Two normals that leave rotations within this angle, radians, are good for a chart.
const GOOD_BALL: f64 = 1.0;

/// Caps that cover normals are no wider, radians: those that leave the least to divide are taken.
const CAPS: [f64; 3] = [0.15, 0.3, 0.6];

/// Rotations within this angle, radians, cost as much as a single one.
const FINE_BALL: f64 = 0.2;

/// Balls of rotations that two normals may leave; where they would leave more, turns about one normal are fewer.
const MOST_BALLS: usize = 4_000;

/// A sensed normal, and caps that hold all normals of the sites that it may be of.
struct Sensed<'a> {
    case: &'a Case,
    /// World frame.
    reading: DVec3,
    /// The sensed normal, turned, is this near to one of them, radians.
    error: f64,
    /// One around all of them, model frame.
    whole: Cap,
    sites: &'a [Site],
}

/// The cells, one by one; not disjoint. Where a search is stopped they may be fewer and wider.
pub(super) fn first_cells<'a>(conditions: &'a Conditions<'_>) -> impl Iterator<Item = Cell> + 'a {
    let places = Places::new(conditions);
    rotations(conditions).into_iter().map(move |(turn, half)| places.cell(turn, half))
}

/// One cell that holds every pose that satisfies the conditions: made in no time.
pub(super) fn whole(conditions: &Conditions<'_>) -> Cell {
    let (turn, radius) = of_prior(conditions).unwrap_or((DMat3::IDENTITY, PI));
    Places::new(conditions).cell(turn, DVec3::splat(radius))
}

/// Rotations, each with half the sides of the box in its chart that belongs to it: every pose is in one.
fn rotations(conditions: &Conditions<'_>) -> Vec<(DMat3, DVec3)> {
    let sensed: Vec<Sensed<'_>> =
        conditions.sites.iter().filter_map(|one| of_contact(conditions, one)).collect();
    let prior = of_prior(conditions);
    let balls = best_pair(&sensed).and_then(|[a, b]| balls(a, b));
    let ball = |(turn, radius): (DMat3, f64)| (turn, DVec3::splat(radius));
    if let Some(balls) = balls {
        let widest = balls.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        return match prior {
            Some(prior) if prior.1 <= widest => vec![ball(prior)],
            Some((middle, most)) => {
                let near = |(turn, radius): &(DMat3, f64)| {
                    pose::angle(*turn * middle.transpose()) <= most + radius + 1e-9
                };
                balls.into_iter().filter(near).map(ball).collect()
            }
            None => balls.into_iter().map(ball).collect(),
        };
    }
    if let Some(prior) = prior {
        return vec![ball(prior)];
    }
    let surest = sensed.iter().min_by(|a, b| a.width().total_cmp(&b.width()));
    match surest.filter(|one| one.width() < 1.0) {
        Some(one) => {
            let turns = |cap| spins(one.reading, cap, one.error);
            one.caps(CAPS[0]).into_iter().flat_map(turns).collect()
        }
        None => vec![ball((DMat3::IDENTITY, PI))],
    }
}

/// The rotations that the prior allows, as a middle and a radius, if it excludes any.
fn of_prior(conditions: &Conditions<'_>) -> Option<(DMat3, f64)> {
    let prior = conditions.case.prior?;
    let tilt = prior.lying.map_or(0.0, |lying| lying.tilt);
    // Tilt and turn are each allowed the tolerance.
    let radius = prior.rotation + tilt + 2.0 * conditions.angle;
    (radius < PI).then_some((prior.world_from_model.rotation.transpose(), radius))
}

fn of_contact<'a>(
    conditions: &'a Conditions<'_>,
    (contact, sites): &'a (usize, Sites),
) -> Option<Sensed<'a>> {
    let (reading, error) = conditions.case.data[*contact].reading.sensed?;
    let mean = sites.iter().map(|site| site.mean_normal).sum::<DVec3>().try_normalize();
    let mean = mean.unwrap_or_else(|| sites[0].mean_normal);
    let spread = sites.iter().map(|site| angle(mean, site.mean_normal) + site.spread);
    let whole = Cap::around(mean, spread.fold(0.0, f64::max));
    let case = conditions.case;
    Some(Sensed { case, reading, error: error + conditions.angle + 1e-9, whole, sites })
}

impl Sensed<'_> {
    /// How far the sensed normal may be from the middle of its cap, radians.
    fn width(&self) -> f64 {
        self.error + self.whole.angle.min(CAPS[0])
    }

    /// Few caps, no wider than `fine`, that hold all normals of the sites.
    fn caps(&self, fine: f64) -> Vec<Cap> {
        if self.whole.angle <= fine {
            return vec![self.whole];
        }
        let mut of_sites = Vec::new();
        let cover = Cap::cover(fine);
        for site in self.sites {
            if self.case.stopped() {
                return cover;
            }
            site.cover(fine, &mut of_sites);
        }
        let mut caps: Vec<Cap> = Vec::new();
        for cap in &of_sites {
            if self.case.stopped() {
                return cover;
            }
            // Normals of many small facets share caps.
            let near = |kept: &&mut Cap| angle(kept.axis, cap.axis) + cap.angle <= fine;
            match caps.iter_mut().find(near) {
                Some(kept) => {
                    let angle = kept.angle.max(angle(kept.axis, cap.axis) + cap.angle);
                    *kept = Cap::around(kept.axis, angle);
                }
                None => caps.push(*cap),
            }
            if caps.len() > cover.len() {
                // So many that overlap are more than it takes to cover the sphere.
                let met = |one: &Cap| of_sites.iter().any(|cap| cap.meets(*one));
                return cover.into_iter().filter(met).collect();
            }
        }
        caps
    }
}

/// The two contacts whose normals leave the fewest and smallest balls, by a rough count.
fn best_pair<'a, 'b>(sensed: &'b [Sensed<'a>]) -> Option<[&'b Sensed<'a>; 2]> {
    let mut best: Option<(f64, [&Sensed<'_>; 2])> = None;
    for (k, a) in sensed.iter().enumerate() {
        for b in &sensed[..k] {
            let apart = angle(a.reading, b.reading);
            let sine = (0.5 * a.width().max(b.width())).sin() / (0.5 * apart.min(PI - apart)).sin();
            let count = |one: &Sensed<'_>| 1.0 + one.whole.angle / CAPS[0];
            let cost = count(a) * count(b) * sine.max(0.5 * CAPS[0]).powi(3);
            if sine < 1.0 && best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, [b, a]));
            }
        }
    }
    best.map(|(_, pair)| pair)
}

/// For each pair of caps that can be of two sensed normals: the rotation that fits both best, and the radius around it
/// that holds all that both allow. Nothing, if a ball is too large for a chart, or if they are too many.
fn balls(a: &Sensed<'_>, b: &Sensed<'_>) -> Option<Vec<(DMat3, f64)>> {
    let apart = angle(a.reading, b.reading);
    let mut best: Option<(f64, Vec<(DMat3, f64)>)> = None;
    for fine in CAPS {
        let [firsts, seconds] = [a, b].map(|one| one.caps(fine));
        let both = firsts.iter().flat_map(|first| seconds.iter().map(move |second| [first, second]));
        let balls: Vec<(DMat3, f64)> = both
            .filter_map(|[first, second]| {
                let errors = [a.error + first.angle, b.error + second.angle];
                let agree = (angle(first.axis, second.axis) - apart).abs() <= errors[0] + errors[1];
                agree.then(|| ball([a.reading, b.reading], [first.axis, second.axis], errors))
            })
            .take(MOST_BALLS + 1)
            .collect();
        if balls.len() > MOST_BALLS {
            continue;
        }
        let widest = balls.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        let cost: f64 = balls.iter().map(|(_, radius)| radius.max(FINE_BALL).powi(3)).sum();
        if widest <= GOOD_BALL && best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, balls));
        }
    }
    best.map(|(_, balls)| balls)
}

/// The radius is above half a turn where nothing is known.
fn ball(readings: [DVec3; 2], normals: [DVec3; 2], errors: [f64; 2]) -> (DMat3, f64) {
    let frame = |[first, second]: [DVec3; 2]| {
        let middle = (first + second).try_normalize()?;
        let across = first.cross(second).try_normalize()?;
        Some(DMat3::from_cols(middle, across, middle.cross(across)))
    };
    let (Some(model), Some(world)) = (frame(normals), frame(readings)) else {
        return (DMat3::IDENTITY, f64::INFINITY);
    };
    // Nearly parallel normals span a frame that is orthogonal only roughly; what is used is a rotation.
    let turn = pose::proper(model * world.transpose());
    let worst = (0..2).map(|k| errors[k] + angle(turn * readings[k], normals[k])).fold(0.0, f64::max);
    let apart = angle(readings[0], readings[1]);
    let sine = (0.5 * worst).sin() / (0.5 * apart.min(PI - apart)).sin();
    let radius = if worst < PI && sine < 1.0 { 2.0 * sine.asin() + 1e-9 } else { f64::INFINITY };
    (turn, radius)
}

/// Turns about a normal that is known, in boxes: each is a tilt `t` by at most the error, after a turn `s` about the
/// normal within the half width. Of the product, the rotation vector is at most `(θ/2)/sin(θ/2)` times `2 sin(t/2)`
/// across, and `2 sin(s/2)` along the normal, where θ is its length, at most `s + t`.
fn spins(reading: DVec3, cap: Cap, error: f64) -> impl Iterator<Item = (DMat3, DVec3)> {
    let (normal, error) = (cap.axis, error + cap.angle);
    let half = PI / f64::from(NUM_SPINS);
    let longest = 0.5 * (half + error);
    let stretch = longest / longest.sin();
    let across = stretch * 2.0 * (0.5 * error).sin() + 1e-9;
    let along = stretch * 2.0 * (0.5 * half).sin() + 1e-9;
    // The chart is turned so that its first axis is the normal.
    let align = DMat3::from_quat(glam::DQuat::from_rotation_arc(reading, normal));
    let size = around_cylinder(normal, along, across);
    (0..NUM_SPINS).map(move |k| (pose::rotation(normal * (f64::from(2 * k) * half)) * align, size))
}

/// Half the sides of a box around a cylinder: half its length is `along` a unit axis, its radius `across`.
fn around_cylinder(axis: DVec3, along: f64, across: f64) -> DVec3 {
    // Rounding may leave a unit vector's coordinate above one.
    axis.abs() * along + (DVec3::ONE - axis * axis).map(|square| square.max(0.0).sqrt()) * across
}

/// Where the sites of each condition are.
struct Places<'a, 'b> {
    conditions: &'a Conditions<'b>,
    /// The box around those of each.
    boxes: Vec<(DVec3, DVec3)>,
}

impl<'a, 'b> Places<'a, 'b> {
    fn new(conditions: &'a Conditions<'b>) -> Self {
        let boxes = conditions.sites.iter().map(|(_, sites)| site::around_all(sites.iter()));
        Self { conditions, boxes: boxes.collect() }
    }

    /// The cell of such rotations, with all model points that may be at the pivot.
    fn cell(&self, base: DMat3, v_half: DVec3) -> Cell {
        let conditions = self.conditions;
        let case = conditions.case;
        let radius = v_half.length().min(PI);
        let around = conditions.sites.iter().zip(&self.boxes).map(|((contact, _), (low, high))| {
            let datum = &case.data[*contact];
            let lever = base * datum.lever;
            let near = datum.bound
                + conditions.slack
                + 2.0 * (0.5 * radius).sin() * datum.lever.length()
                + case.outward();
            (*low - lever - near, *high - lever + near)
        });
        let (low, high) = around
            .fold((DVec3::NEG_INFINITY, DVec3::INFINITY), |(low, high), (l, h)| (low.max(l), high.min(h)));
        // No overlap: a cell of no size, which its own conditions refute.
        let high = high.max(low);
        Cell {
            base,
            v: DVec3::ZERO,
            v_half,
            y: 0.5 * (low + high),
            y_half: 0.5 * (high - low) + case.outward(),
            left: all_sites(conditions),
            cuts: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::around_cylinder;
    use glam::DVec3;

    /// The axis of a cap on an edge may be off one by a unit of rounding: the turns about it are cells all the same.
    #[test]
    fn an_axis_that_is_rounded_up_has_a_box() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (sine, cosine) = std::f64::consts::FRAC_PI_4.sin_cos();
        let (first, across) = (DVec3::new(half, half, 0.0), DVec3::new(half, -half, 0.0));
        let axis = cosine.max(sine) * first + cosine.max(sine) * across;
        assert!(axis.x > 1.0);
        let size = around_cylinder(axis, 0.3, 0.1);
        assert!(size.cmpge(DVec3::new(0.3, 0.1, 0.1) - 1e-12).all() && size.is_finite());
    }
}
