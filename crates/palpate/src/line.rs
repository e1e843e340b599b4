//! Directed lines, along which a tip goes, and what it meets first.

use std::cmp::Ordering;

use glam::DVec2;

use crate::Feature;
use crate::dimension::Dimension;

/// A directed line: the tip's centre is at `start + t·direction`, `t >= 0`. World frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<V = DVec2> {
    /// Where `t` is zero.
    pub start: V,
    /// Unit direction of travel.
    pub direction: V,
}

impl<V: Dimension> Line<V> {
    /// The place at `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> V {
        self.start + self.direction * t
    }

    /// How far along the line a point is, and how far from it.
    #[must_use]
    pub fn depth_and_aside(&self, point: V) -> (f64, f64) {
        let offset = point - self.start;
        let depth = self.direction.dot(offset);
        (depth, (offset - self.direction * depth).length())
    }

    /// An order, so that nothing is arbitrary: by the start, coordinate by coordinate, then by the direction.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        let by_coordinates = |a: V, b: V| {
            let pairs = a.coordinates().iter().zip(b.coordinates());
            pairs.map(|(a, b)| a.total_cmp(b)).fold(Ordering::Equal, Ordering::then)
        };
        let (a, b) = (self.direction, other.direction);
        let by_direction = match (a.angle(), b.angle()) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            _ => by_coordinates(a, b),
        };
        by_coordinates(self.start, other.start).then(by_direction)
    }
}

impl Line {
    /// To the left of the direction of travel.
    #[must_use]
    pub fn left(&self) -> DVec2 {
        self.direction.perp()
    }

    /// How far along and how far to the left of the line a point is.
    #[must_use]
    pub fn coordinates(&self, point: DVec2) -> (f64, f64) {
        let offset = point - self.start;
        (self.direction.dot(offset), self.left().dot(offset))
    }
}

/// What a tip on a line meets first, the part being at one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstContact<V = DVec2> {
    /// Of the tip's centre, along the line from its start.
    pub depth: f64,
    /// Unit outward normal of what is touched, world frame.
    pub normal: V,
    /// What is touched.
    pub feature: Feature,
    /// It is touched where a reading may come from it: neither an untouchable face nor the back of a loose one, nor a
    /// corner of these.
    pub touchable: bool,
}
