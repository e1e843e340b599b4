//! How far a set of poses extends.

use std::cell::{OnceCell, RefCell};
use std::collections::BinaryHeap;

use glam::DVec3;

use super::cell::{Cell, Conditions, Linearized, most};
use super::solve;
use crate::nearest::Nearest;
use crate::polytope::{HalfSpace, Polytope};

/// A diameter is looked for until its bound is above the largest width by no more than this share.
const ENOUGH: f64 = 0.005;

/// Widths that are asked for at most.
const MOST_WIDTHS: usize = 48;

/// A cell is divided while its conditions are loose by more than this share of the largest width.
const LOOSE: f64 = 0.02;

/// Cells that are divided for one direction at most.
const MOST_AT_ONCE: usize = 24;

/// What is to be bounded in a cell: `middle + about·d + direction·(y − y₀)`, give or take `loose`.
pub(super) struct Along {
    pub middle: f64,
    pub about: DVec3,
    pub direction: DVec3,
    pub loose: f64,
}

/// Cells that hold all poses, divided where that tells more of how far these reach.
pub(super) struct Extent<'a> {
    /// Of the pieces.
    conditions: Vec<Conditions<'a>>,
    cells: Vec<Enclosed>,
    /// So many cells may be divided yet.
    left: usize,
}

/// A cell of a piece.
struct Enclosed {
    cell: Cell,
    piece: usize,
    /// Its linear conditions, and those of the first order alone; made when first asked for.
    linearized: [OnceCell<RefCell<Linearized>>; 2],
    divided: bool,
}

impl Enclosed {
    fn new(piece: usize, cell: Cell) -> Self {
        Self { cell, piece, linearized: Default::default(), divided: false }
    }

    fn of_box(&self, along: &Along) -> f64 {
        let half = along.about.abs().dot(self.cell.v_half) + along.direction.abs().dot(self.cell.y_half);
        along.middle + along.loose + half
    }

    fn of_poses(&self, conditions: &[Conditions<'_>], along: &Along, first_order: bool) -> f64 {
        if !self.cell.is_linear() {
            return self.of_box(along);
        }
        let make = || {
            let rows = self.cell.rows(&conditions[self.piece], first_order);
            RefCell::new(self.cell.linearized(&rows))
        };
        let linearized = self.linearized[usize::from(first_order)].get_or_init(make);
        let loose = if first_order { 0.0 } else { along.loose };
        let reach = most(&mut linearized.borrow_mut(), along.about, along.direction);
        (along.middle + loose + reach).min(self.of_box(along))
    }
}

impl<'a> Extent<'a> {
    /// Of the cells of pieces, in the order of their conditions, which may be divided so many times.
    pub fn new(conditions: Vec<Conditions<'a>>, cells: &[Vec<Cell>], left: usize) -> Self {
        let of_piece = |(piece, cells): (usize, &Vec<Cell>)| {
            cells.iter().map(move |cell| Enclosed::new(piece, cell.clone())).collect::<Vec<_>>()
        };
        Self { conditions, cells: cells.iter().enumerate().flat_map(of_piece).collect(), left }
    }

    /// No two poses are further apart, if they are measured by what is `along` an axis.
    pub fn diameter(&mut self, along: impl Fn(DVec3, &Cell) -> Along) -> f64 {
        let mut widest = 0.0_f64;
        diameter(|axis| {
            let mut most = |axis: DVec3| self.most(widest, |cell| along(axis, cell));
            let width = (most(axis) + most(-axis)).max(0.0);
            widest = widest.max(width);
            width
        })
    }

    /// The cells of each piece, as they are divided by now.
    pub fn into_cells(self) -> Vec<Vec<Cell>> {
        let mut cells = vec![Vec::new(); self.conditions.len()];
        for one in self.cells.into_iter().filter(|one| !one.divided) {
            cells[one.piece].push(one.cell);
        }
        cells
    }

    /// No pose has more; `-∞`: there is none. The cell that reaches farthest is divided while its conditions are loose by
    /// more than a share of `widest`.
    fn most(&mut self, widest: f64, along: impl Fn(&Cell) -> Along) -> f64 {
        // The farthest first; `value`: it is a bound of the cell's poses, not of its box.
        let bound = |most: f64, number: usize, value: bool| Nearest { miss: -most, number, value };
        let of_box = |(number, one): (usize, &Enclosed)| {
            (!one.divided).then(|| bound(one.of_box(&along(&one.cell)), number, false))
        };
        let mut open: BinaryHeap<_> = self.cells.iter().enumerate().filter_map(of_box).collect();
        let mut num_divided = 0;
        while let Some(Nearest { miss, number, value: of_poses }) = open.pop() {
            let one = &self.cells[number];
            let what = along(&one.cell);
            if !of_poses {
                open.push(bound(one.of_poses(&self.conditions, &what, false), number, true));
                continue;
            }
            let most = -miss;
            let divisible = num_divided < MOST_AT_ONCE && self.left > 0;
            if !divisible || most - one.of_poses(&self.conditions, &what, true) <= LOOSE * widest {
                return most;
            }
            num_divided += 1;
            self.left -= 1;
            let piece = one.piece;
            let halves = solve::halved(&self.conditions[piece], &one.cell);
            let halves: Vec<Enclosed> = halves.map(|half| Enclosed::new(piece, half)).collect();
            self.cells[number].divided = true;
            for half in halves {
                open.push(bound(half.of_box(&along(&half.cell)).min(most), self.cells.len(), false));
                self.cells.push(half);
            }
        }
        f64::NEG_INFINITY
    }
}

/// No two members of a set are further apart, if along a unit vector `u` no two are by more than `width(u)`.
///
/// Differences of members are in the polytope `|u_k·d| ≤ width(u_k)` for the vectors that were asked for. Its farthest
/// corner is a bound, and that corner's direction the next one that is asked for.
pub(super) fn diameter(mut width: impl FnMut(DVec3) -> f64) -> f64 {
    let widths = DVec3::from_array(DVec3::AXES.map(&mut width));
    let mut seen = widths.max_element();
    if seen <= 0.0 {
        return 0.0;
    }
    let half = widths.max(DVec3::splat(1e-9 * seen));
    let scale = 2.0 * half.length();
    let mut polytope = Polytope::boxed((-half).to_array(), half.to_array());
    for _ in 0..MOST_WIDTHS {
        let corner = farthest(&polytope);
        let length = corner.length();
        if length <= seen * (1.0 + ENOUGH) {
            break;
        }
        let direction = corner / length;
        let offset = width(direction).max(1e-9 * seen);
        seen = seen.max(offset);
        if offset > length * (1.0 - 0.1 * ENOUGH) {
            break;
        }
        let before = polytope.corners().len();
        for normal in [direction, -direction] {
            polytope.cut(&HalfSpace { normal: normal.to_array(), offset }, scale);
        }
        if polytope.corners().len() == before && farthest(&polytope) == corner {
            break;
        }
    }
    farthest(&polytope).length()
}

fn farthest(polytope: &Polytope) -> DVec3 {
    let corners = polytope.corners().map(DVec3::from_array);
    corners.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{ENOUGH, diameter};
    use glam::{DMat3, DVec3};

    /// Ellipsoids, from needles and discs to balls: their widths are known, and so is the diameter.
    #[test]
    fn the_diameter_of_an_ellipsoid_is_bounded_closely() {
        let mut random = fastrand::Rng::with_seed(5);
        for number in 0..300 {
            let flat = 10_f64.powf(-3.0 * random.f64());
            let axes =
                [DVec3::new(1.0, flat, flat * flat), DVec3::new(1.0, 1.0, flat), DVec3::ONE][number % 3];
            let vector = DVec3::new(random.f64(), random.f64(), random.f64()) * 3.0;
            let turn = DMat3::from_axis_angle(vector.normalize(), vector.length());
            let mut num_asked = 0;
            let bound = diameter(|u| {
                num_asked += 1;
                2.0 * (axes * (turn.transpose() * u)).length()
            });
            // What is nearly a ball takes all the widths that may be asked for.
            let slim = number % 3 == 0 && flat < 0.5;
            let most = if slim { 2.0 * (1.0 + ENOUGH) } else { 2.0 * 1.05 };
            assert!((2.0 - 1e-9..=most).contains(&bound), "problem {number}: {bound} after {num_asked}");
        }
    }

    #[test]
    fn a_point_has_none() {
        assert_eq!(diameter(|_| 0.0), 0.0);
    }
}
