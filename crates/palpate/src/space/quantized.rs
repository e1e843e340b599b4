//! Ranges of a pair in 16 bytes: each end a step of a scale, rounded outward.

use std::f64::consts::PI;

use crate::tree::{PairRange, Range};

/// The last step.
const TOP: u16 = u16::MAX;

/// Low and high of distance, angle, direction and direction back.
pub(crate) type Packed = [u16; 8];

/// Values from `origin` to `origin + 65535 step`.
#[derive(Debug, Clone, Copy)]
struct Scale {
    origin: f64,
    step: f64,
}

impl Scale {
    /// Holds `[low, high]`: the step is longer than computed by more than its rounding.
    fn new(low: f64, high: f64) -> Self {
        Self { origin: low, step: (high - low) / f64::from(TOP) * (1.0 + 1e-12) }
    }

    fn value(self, code: u16) -> f64 {
        self.origin + f64::from(code) * self.step
    }

    /// The range of steps that holds `range`. What is computed by division is corrected by comparison.
    #[expect(clippy::cast_sign_loss, reason = "a cast saturates: nothing passes the first and the last step")]
    fn pack(self, range: Range) -> [u16; 2] {
        let [mut low, mut high] = [
            ((range.low - self.origin) / self.step).floor() as u16,
            ((range.high - self.origin) / self.step).ceil() as u16,
        ];
        while low > 0 && self.value(low) > range.low {
            low -= 1;
        }
        while high < TOP && self.value(high) < range.high {
            high += 1;
        }
        [low, high]
    }

    fn unpack(self, [low, high]: [u16; 2]) -> Range {
        Range { low: self.value(low), high: self.value(high) }
    }
}

/// How a model's ranges are written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quantizer {
    distance: Scale,
    angle: Scale,
    direction: Scale,
}

impl Quantizer {
    /// For distances up to `longest`, which is more than zero.
    pub fn new(longest: f64) -> Self {
        Self {
            distance: Scale::new(0.0, longest),
            angle: Scale::new(0.0, PI),
            direction: Scale::new(-longest, longest),
        }
    }

    /// The largest difference between a range's end and what is stored of it: of an angle, and of a length.
    pub fn steps(&self) -> (f64, f64) {
        (self.angle.step, self.direction.step)
    }

    pub fn pack(&self, pair: &PairRange) -> Packed {
        let [distance, angle] = [self.distance.pack(pair.distance), self.angle.pack(pair.angle)];
        let [there, back] = [pair.direction, pair.direction_back].map(|range| self.direction.pack(range));
        let mut packed = [0; 8];
        for (slot, code) in packed.iter_mut().zip([distance, angle, there, back].as_flattened()) {
            *slot = *code;
        }
        packed
    }

    pub fn unpack(&self, [d0, d1, a0, a1, n0, n1, m0, m1]: Packed) -> PairRange {
        let angle = self.angle.unpack([a0, a1]);
        PairRange {
            distance: self.distance.unpack([d0, d1]),
            // No angle is more than π.
            angle: Range { low: angle.low, high: angle.high.min(PI) },
            direction: self.direction.unpack([n0, n1]),
            direction_back: self.direction.unpack([m0, m1]),
        }
    }
}
