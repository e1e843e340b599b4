//! The linear conditions of a cell.
//!
//! About the middle `v₀` of a cell, with `A = exp(v₀) S₀`, J the left Jacobian at `v₀` and `v = v₀ + d`,
//!
//! `S c = A c + (J d) × A c + ρ`,  `|ρ| ≤ ½ (1 + |v|/6) |d|² |c|`
//!
//! (proof: `docs/theory.md`, T17). So every condition `u·(y + S c) ≤ b` implies one that is linear in `(d, y)`, loose by a
//! second-order term only: few cells are tight. (MATH 2.1.2 is loose by `|d| |c|`.)

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};

use super::case::PivotPose;
use super::cell::{Cell, Conditions, chord};
use super::lp::Row;
use super::site::{Site, angle, around};

/// `(d, y − y₀, share)`: the last is how much of every bound is left, as a share.
pub(super) const WIDTH: usize = 7;

/// Bounds below this share of the part count as so much where shares are compared.
const LEAST_SHARE: f64 = 1e-3;

/// So many sites are bounded by all their directions, more by those of a box.
const FEW_SITES: usize = 4;

/// A direction in which a candidate was found to miss a condition: of its place, or of its normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    condition: usize,
    direction: DVec3,
    of_normal: bool,
}

/// A cell keeps its last cuts.
const MOST_CUTS: usize = 40;

impl Cell {
    /// Linear conditions in `(d, y − y₀, share)`; `at_middle`: those of the first order, that hold for the middle.
    pub fn rows(&self, conditions: &Conditions<'_>, at_middle: bool) -> Vec<Row<WIDTH>> {
        let linear = Linear::new(self, conditions, at_middle);
        let mut rows = Vec::with_capacity(24 * conditions.sites.len());
        let mut directions = Vec::new();
        for condition in 0..conditions.sites.len() {
            let left = || self.left_of(conditions, condition);
            directions.clear();
            let mean: DVec3 = left().map(|site| site.mean_normal).sum();
            let mean = mean.try_normalize();
            let (a, b) = mean.unwrap_or(DVec3::Z).any_orthonormal_pair();
            if left().count() <= FEW_SITES {
                left().for_each(|site| site.directions(&mut directions));
            } else {
                let mean = mean.unwrap_or(DVec3::Z);
                directions.extend([mean, -mean, a, -a, b, -b]);
            }
            rows.extend(directions.iter().filter_map(|direction| linear.of_place(condition, *direction)));
            rows.extend(directions.iter().filter_map(|direction| linear.of_foot(condition, *direction)));
            directions.clear();
            match (left().next(), mean) {
                (Some(only), _) if left().count() == 1 => only.normal_directions(&mut directions),
                (_, Some(mean)) => {
                    directions.push(-mean);
                    directions.extend(around(a, b));
                }
                _ => {}
            }
            rows.extend(directions.iter().filter_map(|direction| linear.of_normal(condition, *direction)));
        }
        linear.of_cuts(&self.cuts, &mut rows);
        self.prior_rows(conditions, at_middle, &mut rows);
        rows
    }

    /// The sites of a condition that are left.
    fn left_of<'a>(
        &self,
        conditions: &'a Conditions<'_>,
        condition: usize,
    ) -> impl Iterator<Item = &'a Site> {
        let sites = &conditions.sites[condition].1;
        self.left[condition].iter().map(move |number| &sites[*number as usize])
    }

    /// Adds the directions in which a pose misses its conditions, and their rows to `rows`.
    pub fn cut_at(&mut self, conditions: &Conditions<'_>, pose: PivotPose, rows: &mut Vec<Row<WIDTH>>) {
        let case = conditions.case;
        let known = self.cuts.len();
        for (condition, (contact, sites)) in conditions.sites.iter().enumerate() {
            let datum = &case.data[*contact];
            let left = || self.left[condition].iter().map(|number| &sites[*number as usize]);
            if let Some((axis, error)) = datum.reading.sensed {
                let axis = pose.rotation * axis;
                let nearest = left().map(|site| site.nearest_normal(axis));
                let nearest = nearest.max_by(|a, b| a.dot(axis).total_cmp(&b.dot(axis)));
                let away = nearest.filter(|nearest| angle(*nearest, axis) > error + conditions.angle);
                let direction = away.and_then(|nearest| (axis - axis.dot(nearest) * nearest).try_normalize());
                if let Some(direction) = direction {
                    self.cuts.push(Cut { condition, direction, of_normal: true });
                    continue;
                }
            }
            let caps = datum.reading.caps(conditions.angle, |axis| pose.rotation * axis);
            let place = pose.place(datum.lever);
            let nearest = left().filter_map(|site| site.nearest(place, &caps));
            let nearest =
                nearest.min_by(|a, b| a.distance_squared(place).total_cmp(&b.distance_squared(place)));
            let away = nearest.map(|nearest| place - nearest).filter(|away| away.length() > datum.bound);
            if let Some(direction) = away.and_then(DVec3::try_normalize) {
                self.cuts.push(Cut { condition, direction, of_normal: false });
            }
        }
        Linear::new(self, conditions, false).of_cuts(&self.cuts[known..], rows);
        let surplus = self.cuts.len().saturating_sub(MOST_CUTS);
        self.cuts.drain(..surplus);
    }

    /// The prior's: of its translation, as far as it is linear; rotations are left to `allowed`.
    fn prior_rows(&self, conditions: &Conditions<'_>, at_middle: bool, rows: &mut Vec<Row<WIDTH>>) {
        let case = conditions.case;
        let Some(prior) = case.prior else { return };
        let turn = self.rotation();
        let jacobian = left_jacobian(self.v).transpose();
        let mut both = |axis: DVec3, most: f64| {
            if !most.is_finite() {
                return;
            }
            // axis·T = axis·pivot − (S axis)·y
            let turned = turn * axis;
            let about = jacobian * turned.cross(self.y);
            let loose = if at_middle {
                0.0
            } else {
                chord(self.radius()) * self.y_half.length()
                    + self.looseness() * (self.y.length() + self.y_half.length())
            };
            let from = axis.dot(case.pivot - prior.world_from_model.translation) - turned.dot(self.y);
            let most = most + conditions.slack + case.outward() + loose;
            let share = most.max(1e-3 * case.model.size);
            rows.push(row(-about, -turned, share, most - from));
            rows.push(row(about, turned, share, most + from));
        };
        match prior.lying {
            None => DVec3::AXES.into_iter().for_each(|axis| both(axis, prior.translation)),
            Some(lying) => {
                both(lying.normal, lying.height);
                let (a, b) = (
                    lying.normal.any_orthonormal_vector(),
                    lying.normal.cross(lying.normal.any_orthonormal_vector()),
                );
                both(a, prior.translation);
                both(b, prior.translation);
            }
        }
    }
}

/// Conditions about the middle of a cell.
struct Linear<'a> {
    cell: &'a Cell,
    conditions: &'a Conditions<'a>,
    turn: DMat3,
    /// The transpose of J.
    jacobian: DMat3,
    radius: f64,
    loose: f64,
}

impl<'a> Linear<'a> {
    fn new(cell: &'a Cell, conditions: &'a Conditions<'a>, at_middle: bool) -> Self {
        let radius = if at_middle { 0.0 } else { cell.radius() };
        let loose = if at_middle { 0.0 } else { cell.looseness() };
        let jacobian = left_jacobian(cell.v).transpose();
        Self { cell, conditions, turn: cell.rotation(), jacobian, radius, loose }
    }

    fn of_cuts(&self, cuts: &[Cut], rows: &mut Vec<Row<WIDTH>>) {
        for cut in cuts {
            if cut.of_normal {
                rows.extend(self.of_normal(cut.condition, cut.direction));
            } else {
                rows.extend(self.of_place(cut.condition, cut.direction));
                rows.extend(self.of_foot(cut.condition, cut.direction));
            }
        }
    }

    /// No place of the condition's contact is beyond its sites by more than its bound, along `direction`.
    fn of_place(&self, condition: usize, direction: DVec3) -> Option<Row<WIDTH>> {
        let case = self.conditions.case;
        let datum = &case.data[self.conditions.sites[condition].0];
        let caps = datum.reading.caps(self.conditions.angle + self.radius, |axis| self.turn * axis);
        let tight = self.cell.left[condition].len() == 1;
        let supports =
            self.cell.left_of(self.conditions, condition).map(|site| site.support(direction, &caps, tight));
        let farthest = supports.fold(f64::NEG_INFINITY, f64::max);
        let lever = self.turn * datum.lever;
        let bound =
            datum.bound + self.conditions.slack + case.outward() + self.loose * lever.length() + farthest
                - direction.dot(self.cell.y + lever);
        let share = datum.bound.max(LEAST_SHARE * case.model.size);
        let about = self.jacobian * lever.cross(direction);
        (farthest > f64::NEG_INFINITY).then(|| row(about, direction, share, bound))
    }

    /// No point where the condition's tip touches is beyond its features by more than its bound, along `direction`.
    ///
    /// The tip's centre less the radius along the sensed normal moves with the pose as any lever does: what is unknown of
    /// the normal is then its error alone, not the cell's rotations (`of_place`).
    fn of_foot(&self, condition: usize, direction: DVec3) -> Option<Row<WIDTH>> {
        let case = self.conditions.case;
        let datum = &case.data[self.conditions.sites[condition].0];
        let (axis, error) = datum.reading.sensed.filter(|(_, error)| datum.radius > 0.0 && *error < 1.0)?;
        if !self.cell.left_of(self.conditions, condition).any(Site::is_round) {
            return None;
        }
        let foot = datum.lever - datum.radius * axis;
        let away = normal_beyond(
            angle(direction, self.turn * axis),
            error + self.conditions.angle + 1e-9,
            self.radius,
        );
        let supports = self.cell.left_of(self.conditions, condition).map(|site| site.foot_support(direction));
        let farthest = supports.fold(f64::NEG_INFINITY, f64::max);
        let lever = self.turn * foot;
        let bound = datum.bound
            + self.conditions.slack
            + case.outward()
            + self.loose * lever.length()
            + datum.radius * away
            + farthest
            - direction.dot(self.cell.y + lever);
        let share = datum.bound.max(LEAST_SHARE * case.model.size);
        let about = self.jacobian * lever.cross(direction);
        Some(row(about, direction, share, bound))
    }

    /// No reading of the condition's normal is beyond its sites' by more than its bound, towards `direction`.
    fn of_normal(&self, condition: usize, direction: DVec3) -> Option<Row<WIDTH>> {
        let case = self.conditions.case;
        let (axis, error) = case.data[self.conditions.sites[condition].0].reading.sensed?;
        let axis = self.turn * axis;
        let sites = self.cell.left_of(self.conditions, condition);
        let nearest = sites.map(|site| site.normal_distance(direction)).fold(f64::INFINITY, f64::min);
        let within = (nearest - error - self.conditions.angle - 1e-12).max(0.0).cos();
        let bound = within + 1e-12 + self.loose - direction.dot(axis);
        let about = self.jacobian * axis.cross(direction);
        (within < 1.0).then(|| row(about, DVec3::ZERO, error.max(LEAST_SHARE), bound))
    }
}

/// The most of `u·(n − m)` for unit vectors, `n` within `error` of `m`, and `m` at `apart` from `u`, give or take `turn`.
///
/// It is `cos(β − error) − cos β` at an angle β from `u` to `m`, or `1 − cos β` below the error, and grows up to
/// `β = (π + error)/2`.
fn normal_beyond(apart: f64, error: f64, turn: f64) -> f64 {
    let greatest = FRAC_PI_2 + 0.5 * error;
    let beta = greatest.clamp((apart - turn).max(0.0), (apart + turn).min(PI).max((apart - turn).max(0.0)));
    (beta - error).max(0.0).cos() - beta.cos() + 1e-12
}

pub(super) fn row(about: DVec3, direction: DVec3, share: f64, bound: f64) -> Row<WIDTH> {
    let normal = [about.x, about.y, about.z, direction.x, direction.y, direction.z, share];
    Row { normal, bound }
}

/// `J` with `exp(v + d) ≈ exp(J d) exp(v)`.
pub(super) fn left_jacobian(v: DVec3) -> DMat3 {
    let square = v.length_squared();
    let size = square.sqrt();
    let (first, second) = if size < 1e-4 {
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
    } else {
        ((1.0 - size.cos()) / square, (size - size.sin()) / (square * size))
    };
    let cross = cross_matrix(v);
    DMat3::IDENTITY + cross * first + cross * cross * second
}

fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

#[cfg(test)]
mod tests {
    use super::super::pose::rotation;
    use super::super::site::angle;
    use super::{left_jacobian, normal_beyond};
    use glam::DVec3;

    fn draw(rng: &mut fastrand::Rng, size: f64) -> DVec3 {
        size * (DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0)
    }

    /// The remainder of the first order is within its bound (theory, T17), in charts out to half a turn and beyond, and the
    /// bound is not idle: some remainders use most of it.
    #[test]
    fn the_second_order_is_bounded() {
        let mut rng = fastrand::Rng::with_seed(8);
        let mut most = 0.0_f64;
        for _ in 0..200_000 {
            let size = 2.0 * rng.f64();
            let v = draw(&mut rng, size);
            let size = 1.2 * rng.f64();
            let d = draw(&mut rng, size);
            let c = draw(&mut rng, 1.0);
            let middle = rotation(v) * c;
            let linear = middle + (left_jacobian(v) * d).cross(middle);
            let rest = (rotation(v + d) * c - linear).length();
            let longest = v.length() + d.length();
            let bound = 0.5 * (1.0 + longest / 6.0) * d.length_squared() * c.length();
            assert!(rest <= bound + 1e-14);
            if d.length() > 0.01 {
                most = most.max(rest / bound);
            }
        }
        assert!(most > 0.8);
    }

    /// No normal within its error of a sensed one, which is within a turn of a middle, is further along than is said; some
    /// are nearly as far.
    #[test]
    fn how_far_a_normal_is_beyond_is_bounded() {
        let mut rng = fastrand::Rng::with_seed(9);
        let mut unit = || loop {
            let v = draw(&mut rng, 1.0);
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        };
        let mut share = 0.0_f64;
        for k in 0..100_000 {
            let (direction, middle) = (unit(), unit());
            let (error, turn) = (0.9 * unit().x.abs(), 0.9 * unit().y.abs());
            let beside = |from: DVec3, most: f64, toward: DVec3| {
                rotation(from.cross(toward).normalize_or_zero() * most) * from
            };
            // At the bounds, and towards or away from the direction, in half of them.
            let (first, second) = if k % 2 == 0 { (direction, direction) } else { (unit(), unit()) };
            let sensed = beside(middle, if k % 3 == 0 { -turn } else { turn * unit().z.abs() }, first);
            let normal = beside(sensed, error, second);
            let most = normal_beyond(angle(direction, middle), error, turn);
            let found = direction.dot(normal - sensed);
            assert!(found <= most + 1e-9, "{found} {most}");
            share = share.max(found / most);
        }
        assert!(share > 0.99);
    }
}
