//! Closed arcs of directions on the circle.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::judge::Normals;

/// A closed arc: the angles `start + t` for `0 <= t <= width`. Radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Where it begins, counter-clockwise.
    pub start: f64,
    /// How far it goes on, `0..=2π`.
    pub width: f64,
}

/// `angle` brought into `[-π, π)`.
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    let turned = (angle + PI).rem_euclid(TAU);
    if turned >= TAU { -PI } else { turned - PI }
}

impl Normals<DVec2> for Arc {
    fn angle_to(self, normal: DVec2) -> f64 {
        self.distance(normal.to_angle())
    }

    fn apart(self, other: Self) -> f64 {
        (self.distance(other.middle()) - other.half_width()).max(0.0)
    }

    fn cap(self) -> (DVec2, f64) {
        (DVec2::from_angle(self.middle()), self.half_width())
    }
}

impl Arc {
    /// The whole circle.
    pub const FULL: Self = Self { start: -PI, width: TAU };

    /// The angles within `half_width` of `middle`.
    #[must_use]
    pub fn around(middle: f64, half_width: f64) -> Self {
        if half_width >= PI {
            Self::FULL
        } else {
            Self { start: middle - half_width, width: 2.0 * half_width }
        }
    }

    /// The middle of the arc.
    #[must_use]
    pub fn middle(self) -> f64 {
        self.start + 0.5 * self.width
    }

    /// Half its width.
    #[must_use]
    pub fn half_width(self) -> f64 {
        0.5 * self.width
    }

    /// The arc with `slack` more at either end.
    #[must_use]
    pub fn widen(self, slack: f64) -> Self {
        let width = self.width + 2.0 * slack;
        if width >= TAU { Self::FULL } else { Self { start: self.start - slack, width } }
    }

    /// The arc turned by `angle`.
    #[must_use]
    pub fn turn(self, angle: f64) -> Self {
        Self { start: self.start + angle, ..self }
    }

    /// The smallest angle between `angle` and a member of the arc; zero inside.
    #[must_use]
    pub fn distance(self, angle: f64) -> f64 {
        (wrap(angle - self.middle()).abs() - self.half_width()).max(0.0)
    }

    /// The parts that two arcs share: none, one or two arcs.
    #[must_use]
    pub fn intersect(self, other: Self) -> arrayvec::ArrayVec<Self, 2> {
        let mut parts = arrayvec::ArrayVec::new();
        if self.width >= TAU {
            parts.push(other);
            return parts;
        }
        if other.width >= TAU {
            parts.push(self);
            return parts;
        }
        // `other` begins `offset` after `self`, and once more a turn earlier.
        let offset = (other.start - self.start).rem_euclid(TAU);
        for begin in [offset - TAU, offset] {
            let low = begin.max(0.0);
            let high = (begin + other.width).min(self.width);
            if low <= high {
                parts.push(Self { start: self.start + low, width: high - low });
            }
        }
        parts
    }
}
