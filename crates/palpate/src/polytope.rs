//! Small convex polytopes in three dimensions, cut by half-spaces so that nothing true is cut off: of `(sin(θ−θ₀), y)` in the
//! plane, of translations and differences in space.
//!
//! A polytope is kept *simple*: each corner lies on exactly three planes, and two corners that share two planes
//! are joined by an edge. A cut never passes closer than a gap to an existing corner (it is moved outward until
//! it does not), so that the side on which each corner lies is certain and the edges stay what they are.

/// `normal · x <= offset`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace {
    pub normal: [f64; 3],
    pub offset: f64,
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    at: [f64; 3],
    planes: [u16; 3],
}

/// A bounded convex polytope in three dimensions, or nothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Polytope {
    corners: Vec<Corner>,
    num_planes: u16,
}

/// A cut keeps this share of the scale between itself and each corner: far above rounding (2⁻⁵²), far below τ.
const GAP: f64 = 1e-13;

/// With more planes than this a polytope is cut no further: each may move corners by rounding.
const MOST_PLANES: u16 = 400;

/// With nearly as many corners it is cut no further either.
const MOST_CORNERS: usize = 256;

type Heights = arrayvec::ArrayVec<f64, MOST_CORNERS>;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Polytope {
    /// The box `low..high`.
    pub fn boxed(low: [f64; 3], high: [f64; 3]) -> Self {
        let corners = (0..8u16).map(|bits| {
            let side = |axis: u16| (bits >> axis) & 1;
            let coordinate = |axis: usize| [low, high][usize::from(side(axis as u16))][axis];
            Corner {
                at: [coordinate(0), coordinate(1), coordinate(2)],
                planes: [side(0), 2 + side(1), 4 + side(2)],
            }
        });
        Self { corners: corners.collect(), num_planes: 6 }
    }

    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    pub fn corners(&self) -> impl ExactSizeIterator<Item = [f64; 3]> + '_ {
        self.corners.iter().map(|corner| corner.at)
    }

    /// The polytope whose corners a rigid motion has moved: for reading, not for cutting on.
    pub fn mapped(&self, motion: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let corners = self.corners.iter().map(|corner| Corner { at: motion(corner.at), ..*corner });
        Self { corners: corners.collect(), num_planes: self.num_planes }
    }

    /// The mean of the corners.
    pub fn mean(&self) -> [f64; 3] {
        let share = 1.0 / self.corners.len() as f64;
        self.corners().fold([0.0; 3], |mean, at| std::array::from_fn(|k| mean[k] + share * at[k]))
    }

    /// The smallest box around it.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        self.corners().fold(start, |(low, high), at| {
            (std::array::from_fn(|k| low[k].min(at[k])), std::array::from_fn(|k| high[k].max(at[k])))
        })
    }

    /// Keeps what lies in `half_space`; `scale` bounds `|normal·x|` and `|offset|`.
    pub fn cut(&mut self, half_space: &HalfSpace, scale: f64) {
        let gap = GAP * scale;
        let heights: Heights = match self.heights(half_space, gap) {
            Some(heights) => heights,
            None => return,
        };
        if heights.iter().all(|&height| height < 0.0) {
            return;
        }
        let plane = self.num_planes;
        self.num_planes += 1;
        let mut kept = Vec::with_capacity(self.corners.len() + 4);
        for (inner, &low) in self.corners.iter().zip(&heights).filter(|(_, height)| **height < 0.0) {
            kept.push(*inner);
            for (outer, &high) in self.corners.iter().zip(&heights).filter(|(_, height)| **height > 0.0) {
                if let Some([first, second]) = shared_edge(inner.planes, outer.planes) {
                    let t = low / (low - high);
                    let at = std::array::from_fn(|k| inner.at[k] + t * (outer.at[k] - inner.at[k]));
                    kept.push(Corner { at, planes: [first, second, plane] });
                }
            }
        }
        self.corners = kept;
    }

    /// Height of each corner above the plane, after the plane was moved outward until none is within `gap` of it.
    ///
    /// `None`: too many corners to cut any further, which leaves the polytope as it is (sound, only looser).
    fn heights(&self, half_space: &HalfSpace, gap: f64) -> Option<Heights> {
        if self.corners.len() > MOST_CORNERS - 8 || self.num_planes >= MOST_PLANES {
            return None;
        }
        let mut heights: Heights =
            self.corners().map(|at| dot(half_space.normal, at) - half_space.offset).collect();
        while heights.iter().any(|height| height.abs() < gap) {
            for height in &mut heights {
                *height -= 2.0 * gap;
            }
        }
        Some(heights)
    }
}

/// The two planes that two corners have in common, if there are two.
fn shared_edge(a: [u16; 3], b: [u16; 3]) -> Option<[u16; 2]> {
    let mut shared = a.into_iter().filter(|plane| b.contains(plane));
    Some([shared.next()?, shared.next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Polytope {
        Polytope::boxed([-1.0; 3], [1.0; 3])
    }

    #[test]
    fn a_corner_cut_off_a_cube_leaves_ten_corners() {
        let mut cube = unit();
        cube.cut(&HalfSpace { normal: [1.0, 1.0, 1.0], offset: 2.0 }, 3.0);
        assert_eq!(cube.corners().len(), 10);
        assert!(cube.corners().all(|at| at.iter().sum::<f64>() <= 2.0 + 1e-9));
    }

    #[test]
    fn contradicting_cuts_leave_nothing() {
        let mut cube = unit();
        cube.cut(&HalfSpace { normal: [0.0, 1.0, 0.5], offset: -0.5 }, 3.0);
        assert!(!cube.is_empty());
        cube.cut(&HalfSpace { normal: [0.0, -1.0, -0.5], offset: 0.4 }, 3.0);
        assert!(cube.is_empty());
    }

    #[test]
    fn no_point_of_the_intersection_is_lost() {
        let mut state = 7_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for round in 0..2000 {
            let cuts: Vec<HalfSpace> = (0..12)
                .map(|k| {
                    let flat = if round % 3 == 0 { 1e-9 } else { 1.0 };
                    let normal = [draw() * flat, draw(), if k % 2 == 0 { draw() } else { 0.0 }];
                    HalfSpace { normal, offset: 0.3 + 0.5 * draw().abs() }
                })
                .collect();
            let mut polytope = unit();
            for cut in &cuts {
                polytope.cut(cut, 4.0);
            }
            for _ in 0..20 {
                let point = [draw(), draw(), draw()];
                let direction = [draw(), draw(), draw()];
                if cuts.iter().all(|cut| dot(cut.normal, point) <= cut.offset) {
                    let reach = polytope.corners().map(|at| dot(direction, at)).fold(f64::MIN, f64::max);
                    assert!(reach >= dot(direction, point) - 1e-12);
                }
            }
        }
    }
}
