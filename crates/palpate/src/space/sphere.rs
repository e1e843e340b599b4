//! Directions: regions of the sphere that caps bound, and their nearest points.
//!
//! Caps are kept by their angle and compared by chords: a cosine near 1 has no digits for a small angle.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

/// Directions within an angle of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cap {
    /// Unit.
    pub axis: DVec3,
    /// Radians, `[0, π]`.
    pub angle: f64,
    /// The chord of the angle.
    chord: f64,
}

/// A direction counts as inside if it misses by no more, radians.
const ROUNDING: f64 = 1e-11;

/// Axes nearer than this, radians, count as one where rims cross: what that adds to a direction's error is below twice of it.
const COAXIAL: f64 = 3e-8;

impl Cap {
    /// Directions within `angle` of the unit vector `axis`.
    pub fn around(axis: DVec3, angle: f64) -> Self {
        let angle = angle.clamp(0.0, PI);
        Self { axis, angle, chord: 2.0 * (0.5 * angle).sin() }
    }

    /// The half of the sphere towards `axis`.
    pub fn half(axis: DVec3) -> Self {
        Self::around(axis, FRAC_PI_2)
    }

    /// Caps no wider than `fine`, below a quarter turn, that cover the sphere: one around each square of a grid on a cube.
    #[expect(clippy::cast_sign_loss, reason = "a count is not below one")]
    pub fn cover(fine: f64) -> Vec<Self> {
        // A point of a square is no farther from its middle than half its diagonal, and the sphere is no nearer than 1.
        let count = (0.5 * 2.0 * std::f64::consts::SQRT_2 / fine).ceil().max(1.0) as u32;
        let at = |k: u32| 2.0 * f64::from(k) / f64::from(count) - 1.0;
        let square = |(k, j): (u32, u32)| {
            let corners = [(k, j), (k + 1, j), (k, j + 1), (k + 1, j + 1)];
            let corners = corners.map(|(k, j)| DVec3::new(at(k), at(j), 1.0).normalize());
            let axis = corners.iter().sum::<DVec3>().normalize();
            let farthest = corners.iter().map(|corner| corner.distance(axis)).fold(0.0, f64::max);
            Self::around(axis, 2.0 * (0.5 * farthest).asin() + ROUNDING)
        };
        let side = (0..count).flat_map(|k| (0..count).map(move |j| (k, j))).map(square);
        let turned = |cap: Self| {
            let DVec3 { x, y, z } = cap.axis;
            [DVec3::new(x, y, z), DVec3::new(y, z, x), DVec3::new(z, x, y)]
                .into_iter()
                .flat_map(move |axis| [axis, -axis].map(|axis| Self::around(axis, cap.angle)))
        };
        side.flat_map(turned).collect()
    }

    /// Whether two have a direction in common, or are apart by rounding only.
    pub fn meets(self, other: Self) -> bool {
        self.axis.distance(other.axis) <= 2.0 * (0.5 * (self.angle + other.angle).min(PI)).sin() + ROUNDING
    }

    /// Whether a unit direction is in it.
    pub fn holds(self, direction: DVec3) -> bool {
        self.nearly_holds(direction, ROUNDING)
    }

    fn nearly_holds(self, direction: DVec3, slack: f64) -> bool {
        direction.distance_squared(self.axis) <= (self.chord + slack).powi(2)
    }

    /// Its direction nearest to `direction`.
    fn nearest(self, direction: DVec3) -> DVec3 {
        if self.holds(direction) {
            return direction;
        }
        let across = direction - self.axis * direction.dot(self.axis);
        // Of a direction opposite to the axis only rounding is left, and any way to the rim is as short.
        let some =
            if across.length() > 1e-12 { across.normalize() } else { self.axis.any_orthonormal_vector() };
        let across = (some - self.axis * some.dot(self.axis)).normalize();
        let (sine, cosine) = self.angle.sin_cos();
        cosine * self.axis + sine * across
    }

    /// By how much a direction on its rim may seem to miss the others: where axes count as one, their rims are not crossed.
    fn slack(self, caps: &[Self]) -> f64 {
        let coaxial =
            |other: &Self| other.axis != self.axis && other.axis.distance(self.axis) < 2.0 * COAXIAL;
        if caps.iter().any(coaxial) { 4.0 * COAXIAL } else { ROUNDING }
    }

    /// Where the rims of two caps cross, and how far rounding may have moved that, radians.
    fn crossings(self, other: Self) -> Option<([DVec3; 2], f64)> {
        if other.angle.sin() < self.angle.sin() {
            // A small rim is where it is to a share of its own size only as seen from its own axis.
            return other.crossings(self);
        }
        // An orthonormal frame: this axis, towards the other one, across.
        let offset = other.axis - self.axis;
        let toward = offset - self.axis * offset.dot(self.axis);
        let sine = toward.length();
        if sine < COAXIAL {
            return None;
        }
        let toward = toward / sine;
        let (across, x) = self.angle.sin_cos();
        // cos β − cos α cos d, by differences that keep their digits.
        let (sum, difference) = (0.5 * (self.angle + other.angle), 0.5 * (self.angle - other.angle));
        let y = (2.0 * sum.sin() * difference.sin() + 0.5 * x * offset.length_squared()) / sine;
        let slack = ROUNDING + 4.0 * f64::EPSILON / sine;
        // Rims that miss each other by rounding touch.
        (y.abs() <= across + slack).then(|| {
            let base = x * self.axis + y.clamp(-across, across) * toward;
            let rest = (across * across - y * y).max(0.0).sqrt() * self.axis.cross(toward);
            ([base + rest, base - rest], slack)
        })
    }
}

/// The direction nearest to `direction` in all of `caps`; `None` if they have none in common.
///
/// It is `direction` itself, the nearest of one cap, or where two rims cross: along a rim the distance has one least
/// value, so that a nearest point of the region is there, or at the end of an arc.
pub(crate) fn nearest(direction: DVec3, caps: &[Cap]) -> Option<DVec3> {
    let inside = |candidate: DVec3, slack: f64| caps.iter().all(|cap| cap.nearly_holds(candidate, slack));
    if inside(direction, ROUNDING) {
        return Some(direction);
    }
    let slacks: Vec<f64> = caps.iter().map(|cap| cap.slack(caps)).collect();
    let mut best: Option<DVec3> = None;
    for (cap, slack) in caps.iter().zip(&slacks) {
        let candidate = cap.nearest(direction);
        if inside(candidate, ROUNDING) {
            // All that is in every cap is in this one, whose nearest it is.
            return Some(candidate);
        }
        offer(&mut best, direction, candidate, |candidate| inside(candidate, *slack));
    }
    for (k, cap) in caps.iter().enumerate() {
        for (other, slack_of_other) in caps[..k].iter().zip(&slacks) {
            if let Some((crossings, slack)) = cap.crossings(*other) {
                let slack = slack.max(slacks[k]).max(*slack_of_other);
                for crossing in crossings {
                    offer(&mut best, direction, crossing, |candidate| inside(candidate, slack));
                }
            }
        }
    }
    best
}

/// Takes a candidate that is nearer than the best and allowed.
fn offer(best: &mut Option<DVec3>, direction: DVec3, candidate: DVec3, allowed: impl Fn(DVec3) -> bool) {
    let square = direction.distance_squared(candidate);
    if best.is_none_or(|known| square < direction.distance_squared(known)) && allowed(candidate) {
        *best = Some(candidate);
    }
}

/// No direction in all of `caps` has more of `direction`; `-∞` if there is none.
pub(crate) fn greatest(direction: DVec3, caps: &[Cap]) -> f64 {
    let length = direction.length();
    match direction.try_normalize() {
        None => 0.0,
        Some(unit) => {
            nearest(unit, caps).map_or(f64::NEG_INFINITY, |n| length * (unit.dot(n) + 4.0 * COAXIAL))
        }
    }
}

/// No direction in all of `caps` has more of `direction`: the least of what each cap allows by itself, which takes no rims
/// that cross.
pub(crate) fn greatest_in_each(direction: DVec3, caps: &[Cap]) -> f64 {
    let length = direction.length();
    let Some(unit) = direction.try_normalize() else { return 0.0 };
    let most = |cap: &Cap| {
        let (apart, across) = (unit.dot(cap.axis), unit.cross(cap.axis).length());
        let (sine, cosine) =
            (cap.chord * (1.0 - 0.25 * cap.chord * cap.chord).max(0.0).sqrt(), 0.5 * cap.chord * cap.chord);
        let cosine = 1.0 - cosine;
        if apart >= cosine { 1.0 } else { apart * cosine + across * sine }
    };
    length * (caps.iter().map(most).fold(1.0, f64::min) + 4.0 * COAXIAL)
}

#[cfg(test)]
mod tests {
    /// Every direction is in a cap of the cover, none of which is wider than asked for.
    #[test]
    fn a_cover_leaves_no_direction_out() {
        for fine in [0.15, 0.3, 0.6, 1.2] {
            let caps = Cap::cover(fine);
            assert!(caps.iter().all(|cap| cap.angle <= fine && (cap.axis.length() - 1.0).abs() < 1e-12));
            let num = 100_000;
            let apart = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
            for k in 0..num {
                let height = 1.0 - (f64::from(k) + 0.5) * 2.0 / f64::from(num);
                let (sine, cosine) = (apart * f64::from(k)).sin_cos();
                let around = (1.0 - height * height).sqrt();
                let direction = DVec3::new(around * cosine, around * sine, height);
                assert!(caps.iter().any(|cap| cap.holds(direction)), "{direction} at {fine}");
            }
        }
    }

    use super::{COAXIAL, Cap, greatest, greatest_in_each, nearest};
    use crate::space::site::angle;
    use glam::DVec3;

    fn draw(rng: &mut fastrand::Rng) -> DVec3 {
        loop {
            let v = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0;
            if v.length() < 1.0 && v.length() > 1e-3 {
                return v / v.length();
            }
        }
    }

    /// A direction so far from another.
    fn beside(rng: &mut fastrand::Rng, axis: DVec3, angle: f64) -> DVec3 {
        let across = axis.cross(draw(rng)).normalize_or_zero();
        angle.cos() * axis + angle.sin() * across
    }

    #[test]
    fn nearest_is_not_beaten_by_samples() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut found = 0;
        for _ in 0..300 {
            let count = rng.usize(1..6);
            let caps: Vec<Cap> =
                (0..count).map(|_| Cap::around(draw(&mut rng), 0.3 + 1.8 * rng.f64())).collect();
            let direction = draw(&mut rng);
            let answer = nearest(direction, &caps);
            for _ in 0..300 {
                let sample = draw(&mut rng);
                if caps.iter().all(|cap| cap.holds(sample)) {
                    let answer = answer.expect("there is a direction");
                    assert!(answer.dot(direction) >= sample.dot(direction) - 1e-10);
                    assert!(greatest(direction, &caps) >= sample.dot(direction));
                    assert!(greatest_in_each(direction, &caps) >= greatest(direction, &caps) - 1e-12);
                }
            }
            if let Some(answer) = answer {
                found += 1;
                assert!((answer.length() - 1.0).abs() < 1e-12);
                assert!(caps.iter().all(|cap| angle(answer, cap.axis) <= cap.angle + 1e-9));
            }
        }
        assert!(found > 100);
    }

    /// A direction opposite to the axis of a half is a right angle from the region, though nothing but rounding says where.
    #[test]
    fn opposite_directions_have_a_nearest() {
        let mut rng = fastrand::Rng::with_seed(5);
        for _ in 0..20_000 {
            let corners = [(); 3].map(|()| draw(&mut rng));
            if corners[0].cross(corners[1]).dot(corners[2]) < 1e-2 {
                continue;
            }
            let halves: Vec<Cap> =
                (0..3).map(|k| Cap::half(corners[k].cross(corners[(k + 1) % 3]).normalize())).collect();
            for half in &halves {
                let answer = nearest(-half.axis, &halves).expect("the corners");
                assert!((angle(answer, -half.axis) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
                assert!(halves.iter().all(|half| half.axis.dot(answer) > -1e-9));
            }
        }
    }

    /// Caps of all sizes down to none, with axes that nearly coincide, around a direction that is in all of them, often on
    /// their rims: it is not lost, and what is returned misses no cap by more than is said.
    #[test]
    fn a_direction_in_all_caps_is_not_lost() {
        let mut rng = fastrand::Rng::with_seed(4);
        for _ in 0..50_000 {
            let kept = draw(&mut rng);
            let count = rng.usize(2..7);
            let size = 10_f64.powf(-9.0 * rng.f64());
            let caps: Vec<Cap> = (0..count)
                .map(|_| {
                    let angle = if rng.u8(..5) == 0 { 0.0 } else { size * rng.f64() };
                    let angle = if rng.u8(..4) == 0 { std::f64::consts::FRAC_PI_2 } else { angle };
                    let share = if rng.bool() { 1.0 } else { rng.f64() };
                    Cap::around(beside(&mut rng, kept, angle * share), angle)
                })
                .collect();
            let away = size * rng.f64();
            let direction = if rng.bool() { draw(&mut rng) } else { beside(&mut rng, kept, away) };
            let answer = nearest(direction, &caps).expect("the direction that is kept");
            for cap in &caps {
                assert!(angle(answer, cap.axis) <= cap.angle + 8.0 * COAXIAL);
            }
            assert!(answer.distance(direction) <= kept.distance(direction) + 8.0 * COAXIAL);
            assert!(greatest(direction, &caps) >= kept.dot(direction));
        }
    }
}
