//! Directions: convex regions of the sphere and their nearest points.

use glam::DVec3;

/// Directions `n` with `n · axis ≥ least`: a cap, or a half of the sphere if `least` is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cap {
    /// Unit.
    pub axis: DVec3,
    pub least: f64,
}

/// A direction counts as inside if it misses by no more: some units of rounding.
const ROUNDING: f64 = 1e-13;

impl Cap {
    /// Directions within `angle` of `axis`, radians, `[0, π]`.
    pub fn around(axis: DVec3, angle: f64) -> Self {
        Self { axis, least: if angle >= std::f64::consts::PI { -2.0 } else { angle.cos() } }
    }

    fn holds(self, direction: DVec3) -> bool {
        direction.dot(self.axis) >= self.least - ROUNDING
    }

    /// Its direction nearest to `direction`, on the rim if that is outside; `None` if it has none.
    fn nearest(self, direction: DVec3) -> Option<DVec3> {
        if self.holds(direction) {
            return Some(direction);
        }
        let sine = (1.0 - self.least * self.least).max(0.0).sqrt();
        (self.least <= 1.0 + ROUNDING).then(|| {
            let across = direction - self.axis * direction.dot(self.axis);
            let across = across.try_normalize().unwrap_or_else(|| self.axis.any_orthonormal_vector());
            self.least * self.axis + sine * across
        })
    }

    /// Where the rims of two caps cross.
    fn crossings(self, other: Self) -> Option<[DVec3; 2]> {
        let along = self.axis.cross(other.axis);
        let square = along.length_squared();
        let cosine = self.axis.dot(other.axis);
        (square > 1e-24).then(|| {
            let a = (self.least - other.least * cosine) / square;
            let b = (other.least - self.least * cosine) / square;
            let base = a * self.axis + b * other.axis;
            let rest = ((1.0 - base.length_squared()).max(0.0) / square).sqrt();
            [base + rest * along, base - rest * along]
        })
    }
}

/// The direction nearest to `direction` in all of `caps`; `None` if they have none in common.
///
/// It is `direction` itself, the nearest of one cap, or where two rims cross: the region is an intersection of caps,
/// and a nearest point of it has at most two of them at their rim.
pub(crate) fn nearest(direction: DVec3, caps: &[Cap]) -> Option<DVec3> {
    let inside = |candidate: DVec3, but: [usize; 2]| {
        let others = caps.iter().enumerate().filter(|(k, _)| !but.contains(k));
        others.into_iter().all(|(_, cap)| cap.holds(candidate))
    };
    if inside(direction, [usize::MAX; 2]) {
        return Some(direction);
    }
    let mut best: Option<DVec3> = None;
    let mut offer = |candidate: DVec3| {
        if best.is_none_or(|known| direction.dot(candidate) > direction.dot(known)) {
            best = Some(candidate);
        }
    };
    for (k, cap) in caps.iter().enumerate() {
        if let Some(candidate) = cap.nearest(direction).filter(|one| inside(*one, [k; 2])) {
            offer(candidate);
        }
        for (j, other) in caps[..k].iter().enumerate() {
            if let Some(crossings) = cap.crossings(*other) {
                for crossing in crossings {
                    // Rims that do not cross give a point off the sphere.
                    let on_sphere = (crossing.length_squared() - 1.0).abs() < 1e-6;
                    if on_sphere && inside(crossing, [j, k]) {
                        offer(crossing);
                    }
                }
            }
        }
    }
    best
}

/// The greatest `direction · n` of a direction `n` in all of `caps`, some rounding more; `-∞` if there is none.
pub(crate) fn greatest(direction: DVec3, caps: &[Cap]) -> f64 {
    let length = direction.length();
    match direction.try_normalize() {
        None => 0.0,
        Some(unit) => {
            nearest(unit, caps).map_or(f64::NEG_INFINITY, |n| length * (unit.dot(n) + 1e-12).min(1.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Cap, nearest};
    use glam::DVec3;

    fn draw(rng: &mut fastrand::Rng) -> DVec3 {
        loop {
            let v = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0;
            if v.length() < 1.0 && v.length() > 1e-3 {
                return v / v.length();
            }
        }
    }

    #[test]
    fn nearest_is_not_beaten_by_samples() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut found = 0;
        for _ in 0..300 {
            let count = rng.usize(1..6);
            let caps: Vec<Cap> =
                (0..count).map(|_| Cap { axis: draw(&mut rng), least: rng.f64() * 0.9 - 0.3 }).collect();
            let direction = draw(&mut rng);
            let answer = nearest(direction, &caps);
            for _ in 0..300 {
                let sample = draw(&mut rng);
                if caps.iter().all(|cap| sample.dot(cap.axis) >= cap.least) {
                    let answer = answer.expect("there is a direction");
                    assert!(answer.dot(direction) >= sample.dot(direction) - 1e-12);
                }
            }
            if let Some(answer) = answer {
                found += 1;
                assert!((answer.length() - 1.0).abs() < 1e-6);
                assert!(caps.iter().all(|cap| answer.dot(cap.axis) >= cap.least - 1e-9));
            }
        }
        assert!(found > 100);
    }
}
