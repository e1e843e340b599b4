//! Which features can have a normal at an angle to those of another: cones in cells of a cube about the sphere.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::spherical::{Cone, angle};
use crate::tree::Range;

/// Cones of one cell have half angles that differ by less than this, radians.
const CLASS: f64 = PI / 16.0;

/// Feature numbers by cells; each cell with a cap that holds all normals of its features.
#[derive(Debug)]
pub(crate) struct AngleIndex {
    cells: Vec<Cell>,
    /// Feature numbers, cell by cell, increasing in each.
    numbers: Vec<u32>,
}

#[derive(Debug)]
struct Cell {
    center: DVec3,
    /// Of the cap, half angles of the cones included; π where there is no cap.
    radius: f64,
    numbers: std::ops::Range<usize>,
}

impl AngleIndex {
    /// Of cones numbered in order. Memory is linear in them: about 4 share a cell of one class if they are spread.
    #[expect(clippy::cast_sign_loss, reason = "a half angle is not below zero")]
    pub fn new<'a>(cones: impl ExactSizeIterator<Item = &'a Cone> + Clone) -> Self {
        let side = (cones.len() as f64 / 24.0).sqrt().round().clamp(1.0, 12.0);
        let mut by_cell: BTreeMap<(u8, u16), Vec<(u32, &Cone)>> = BTreeMap::new();
        for (number, cone) in cones.enumerate() {
            let class = (cone.half_angle / CLASS) as u8;
            by_cell.entry((class, cell_of(cone.axis, side))).or_default().push((number as u32, cone));
        }
        let mut numbers = Vec::new();
        let cells = by_cell.into_values().map(|members| {
            let center = members.iter().map(|(_, cone)| cone.axis).sum::<DVec3>().normalize_or(DVec3::Z);
            let radius = members.iter().map(|(_, cone)| angle(center, cone.axis) + cone.half_angle);
            let radius = radius.fold(0.0, f64::max).min(PI);
            let begin = numbers.len();
            numbers.extend(members.iter().map(|(number, _)| *number));
            Cell { center, radius, numbers: begin..numbers.len() }
        });
        let cells = cells.collect();
        Self { cells, numbers }
    }

    /// All whose angle to `cone` can be in `range`, and some more; cell by cell, increasing in each.
    pub fn near(&self, cone: &Cone, range: Range) -> impl Iterator<Item = usize> {
        let (axis, half_angle) = (cone.axis, cone.half_angle);
        let meets = move |cell: &&Cell| {
            let between = angle(axis, cell.center);
            range.meets(Range { low: between, high: between }.widened(half_angle + cell.radius))
        };
        self.cells
            .iter()
            .filter(meets)
            .flat_map(|cell| &self.numbers[cell.numbers.clone()])
            .map(|k| *k as usize)
    }
}

/// The number of the cell of a unit vector, of `side · side` on each face of the cube.
#[expect(clippy::cast_sign_loss, reason = "nothing of it is below zero")]
fn cell_of(axis: DVec3, side: f64) -> u16 {
    let sizes = axis.abs();
    let major = sizes.max_position();
    let place = |k: usize| {
        let share = 0.5 + 0.5 * axis[(major + k) % 3] / sizes[major];
        (share * side).floor().clamp(0.0, side - 1.0)
    };
    let face = 2 * major + usize::from(axis[major] < 0.0);
    ((face as f64 * side + place(1)) * side + place(2)) as u16
}
