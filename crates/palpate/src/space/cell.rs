//! A cell of pose space.
//!
//! Rotations are written in a chart, `S = exp(v) S₀`, with `v` in a box: boxes of one chart nest exactly, and no rotation
//! of one is further from another than their vectors.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::case::{Case, PivotPose};
use super::linear::{Cut, WIDTH, left_jacobian};
use super::lp::{Program, Row};
use super::pose::{Pose, rotation, vector};
use super::site::{Site, Sites, angle, around_all};
use crate::feature::Feature;
use crate::sweep::Sweep;

/// The largest share that is asked for: all that a bound leaves is 1.
const MOST_SHARE: f64 = 2.0;

/// Chart coordinates of a rotation are right to this, radians.
const TURN_ROUNDING: f64 = 1e-9;

/// A turn and a shift within a cell.
const MOTIONS: usize = WIDTH - 1;

/// The linear conditions of a cell, to be asked how far its valid poses reach one way and another.
pub(super) type Linearized = Program<MOTIONS>;

/// Above this radius, radians, the linear conditions say nothing, and above the other too little for a search.
const WIDEST: f64 = 1.2;
const WIDEST_SEARCHED: f64 = 0.3;

/// A part of pose space.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    /// `S₀` of its chart.
    pub base: DMat3,
    pub v: DVec3,
    pub v_half: DVec3,
    pub y: DVec3,
    pub y_half: DVec3,
    /// For each condition, the sites that are left in the cell, as numbers among the condition's.
    pub left: Vec<Vec<u32>>,
    /// Directions that its linear conditions have beside those of the sites.
    pub(super) cuts: Vec<Cut>,
}

/// Contacts on sites: the conditions that a pose must satisfy together.
#[derive(Debug)]
pub(crate) struct Conditions<'a> {
    pub case: &'a Case,
    /// A contact and the sites it may lie on.
    pub sites: Vec<(usize, Sites)>,
    /// Added to every bound, a length: nothing where a certificate is sought, τ where everything valid up to τ is enclosed.
    pub slack: f64,
    /// The same for angles.
    pub angle: f64,
}

impl<'a> Conditions<'a> {
    /// That contact `i` lies on one of the features, for each pair; `None` if one has none that can be touched.
    pub fn new<'b>(case: &'a Case, pairs: impl Iterator<Item = (usize, &'b [Feature])>) -> Option<Self> {
        let sites = case.sites_of(pairs);
        let possible = sites.iter().all(|(_, sites)| !sites.is_empty());
        possible.then_some(Self { case, sites, slack: 0.0, angle: case.angle_tolerance })
    }

    /// The same conditions with every bound enlarged by τ.
    pub fn relaxed(self) -> Self {
        let case = self.case;
        Self { slack: 2.0 * case.length_tolerance, angle: 2.0 * case.angle_tolerance, ..self }
    }

    /// Whether the pose satisfies all of them, bounds enlarged by `length` and `angle`.
    pub fn satisfied(&self, pose: PivotPose, length: f64, angle: f64) -> bool {
        self.sites.iter().all(|(contact, sites)| self.case.excess(*contact, sites, pose, angle) <= length)
            && self.case.allows(pose, length)
    }

    /// By how much the pose misses the worst of contacts, prior and free space, a length: a measure, not a bound.
    pub fn miss(&self, pose: PivotPose) -> f64 {
        let case = self.case;
        let contacts = self.sites.iter().map(|(contact, sites)| {
            let excess = case.excess(*contact, sites, pose, case.angle_tolerance);
            if excess.is_finite() { excess } else { case.model.size * self.turn(*contact, sites, pose) }
        });
        let sweeps = case.sweeps.iter().map(|sweep| sweep.intrusion(&case.model, pose));
        contacts.chain(sweeps).fold(case.prior_excess(pose), f64::max)
    }

    /// By what angle the normals miss, radians.
    fn turn(&self, contact: usize, sites: &[Site], pose: PivotPose) -> f64 {
        let Some((axis, error)) = self.case.data[contact].reading.sensed else { return 1.0 };
        let axis = pose.rotation * axis;
        let nearest = sites.iter().map(|site| site.normal_distance(axis)).fold(f64::INFINITY, f64::min);
        (nearest - error).max(1e-3)
    }

    /// The largest share of its bounds that a reading uses at the pose.
    pub fn used(&self, pose: PivotPose) -> f64 {
        let case = self.case;
        let share = |(contact, sites): &(usize, Sites)| {
            let datum = &case.data[*contact];
            let length = case.excess(*contact, sites, pose, case.angle_tolerance) + datum.bound;
            let turn = datum.reading.sensed.map_or(0.0, |(axis, error)| {
                let axis = pose.rotation * axis;
                let nearest = sites.iter().map(|site| site.normal_distance(axis));
                nearest.fold(f64::INFINITY, f64::min) / error.max(1e-9)
            });
            (length / datum.bound.max(1e-9 * case.model.size)).max(turn)
        };
        self.sites.iter().map(share).fold(0.0, f64::max)
    }

    /// The largest lever.
    pub fn reach(&self) -> f64 {
        let lever = |contact: usize| self.case.data[contact].lever.length() + self.case.data[contact].radius;
        let contacts = self.sites.iter().map(|(contact, _)| lever(*contact));
        let sweeps = self.case.sweeps.iter().map(Sweep::reach);
        contacts.chain(sweeps).fold(0.25 * self.case.model.size, f64::max)
    }
}

impl Cell {
    /// The rotation at its middle.
    pub fn rotation(&self) -> DMat3 {
        rotation(self.v) * self.base
    }

    /// The pose at its middle.
    pub fn middle(&self) -> PivotPose {
        PivotPose { rotation: self.rotation(), y: self.y }
    }

    /// No rotation of the cell is further from its middle's, radians: axis and angle shorten no way.
    pub fn radius(&self) -> f64 {
        self.v_half.length()
    }

    /// The second-order term of a unit lever.
    pub fn looseness(&self) -> f64 {
        self.second_order(self.v_half.length_squared())
    }

    fn second_order(&self, square: f64) -> f64 {
        0.5 * (1.0 + (self.v.length() + self.v_half.length()) / 6.0) * square
    }

    /// No pose of the cell moves a point at such a lever further from where its middle does.
    pub fn motion(&self, lever: f64) -> f64 {
        chord(self.radius()) * lever + self.y_half.length()
    }

    /// Halves across the widest side; `turn_only`: of its rotations.
    pub fn split(&self, reach: f64, turn_only: bool) -> [Self; 2] {
        let (mut low, mut high) = (self.clone(), self.clone());
        let turn = widest(self.v_half);
        let shift = widest(self.y_half);
        if turn_only || self.v_half[turn] * reach >= self.y_half[shift] {
            let half = 0.5 * self.v_half[turn];
            (low.v_half[turn], high.v_half[turn]) = (half, half);
            low.v[turn] -= half;
            high.v[turn] += half;
        } else {
            let half = 0.5 * self.y_half[shift];
            (low.y_half[shift], high.y_half[shift]) = (half, half);
            low.y[shift] -= half;
            high.y[shift] += half;
        }
        [low, high]
    }

    /// Leaves only the sites that are possible in the cell; `false` if a condition has none, or prior or free space
    /// exclude all of the cell.
    pub fn restrict(&mut self, conditions: &Conditions<'_>) -> bool {
        let case = conditions.case;
        let turn = self.rotation();
        let radius = self.radius();
        for ((contact, sites), left) in conditions.sites.iter().zip(&mut self.left) {
            let datum = &case.data[*contact];
            let lever = turn * datum.lever;
            let place = self.y + lever;
            let moved =
                datum.bound + conditions.slack + chord(radius) * datum.lever.length() + case.outward();
            let near = moved + self.y_half.length();
            let caps = datum.reading.caps(conditions.angle + radius, |axis| turn * axis);
            left.retain(|number| {
                let site = &sites[*number as usize];
                place.distance_squared(site.middle) <= (near + site.reach).powi(2)
                    && caps.iter().all(|cap| {
                        angle(cap.axis, site.mean_normal) <= cap.angle + site.spread + 1e-9
                            && site.normal_distance(cap.axis) <= cap.angle + 1e-9
                    })
                    && site.distance(place, &caps) <= near
            });
            // Of many sites a cell keeps few: memory is theirs.
            if left.capacity() > 4 * left.len() + 64 {
                left.shrink_to_fit();
            }
            // The box that what is left leaves of the model points at the pivot.
            let (low, high) = around_all(left.iter().map(|number| &sites[*number as usize]));
            let low = (low - lever - moved).max(self.y - self.y_half);
            let high = (high - lever + moved).min(self.y + self.y_half);
            if left.is_empty() || low.cmpgt(high).any() {
                return false;
            }
            self.y = 0.5 * (low + high);
            self.y_half = 0.5 * (high - low) + 4.0 * f64::EPSILON * (self.y.abs() + self.y_half);
        }
        self.allowed(conditions)
    }

    /// Whether prior and free space leave anything of it.
    fn allowed(&self, conditions: &Conditions<'_>) -> bool {
        let case = conditions.case;
        let middle = self.middle();
        // A pose moves the model's origin by no more than a lever of that length.
        let moved = self.motion(self.y.length()) + conditions.slack + case.outward();
        let turned = 2.0 * self.radius() * case.model.size;
        // A turn about the plane's normal is well defined, and changes no faster than twice, while the part is upright.
        let upright = case
            .prior
            .and_then(|prior| prior.lying)
            .is_none_or(|lying| lying.tilt + 2.0 * self.radius() <= 1.0);
        (!upright || self.radius() > 0.5 || case.prior_excess(middle) <= moved + turned)
            && case.sweeps.iter().all(|sweep| {
                let motion = self.motion(sweep.reach()) + conditions.slack;
                !sweep.intrudes(&case.model, middle, -motion)
            })
    }

    fn half_widths(&self) -> [f64; MOTIONS] {
        let (v, y) = (self.v_half, self.y_half);
        [v.x, v.y, v.z, y.x, y.y, y.z]
    }

    /// The pose in which the worst bound is left the most of, to first order; `None`: there is certainly no valid pose.
    pub fn candidate(&self, rows: &[Row<WIDTH>]) -> Option<PivotPose> {
        let mut objective = [0.0; WIDTH];
        objective[WIDTH - 1] = 1.0;
        let [a, b, c, d, e, f] = self.half_widths();
        let half = [a, b, c, d, e, f, MOST_SHARE];
        let optimum = Program::new(rows.iter().copied(), half).maximize(&objective);
        (optimum.bound >= 0.0).then(|| self.at(optimum.point))
    }

    fn at(&self, point: [f64; WIDTH]) -> PivotPose {
        let d = DVec3::new(point[0], point[1], point[2]);
        let y = DVec3::new(point[3], point[4], point[5]);
        PivotPose { rotation: rotation(self.v + d) * self.base, y: self.y + y }
    }

    /// The rows, for `most`.
    pub fn linearized(&self, rows: &[Row<WIDTH>]) -> Linearized {
        let motions =
            |row: &Row<WIDTH>| Row { normal: std::array::from_fn(|j| row.normal[j]), bound: row.bound };
        Program::new(rows.iter().map(motions), self.half_widths())
    }

    /// Shrinks the box to what the rows leave; `false` if that is nothing.
    pub fn contract(&mut self, rows: &[Row<WIDTH>]) -> bool {
        let mut linearized = self.linearized(rows);
        let (mut v, mut v_half) = (self.v, self.v_half);
        let (mut y, mut y_half) = (self.y, self.y_half);
        for (k, axis) in DVec3::AXES.into_iter().enumerate() {
            let turns = [axis, -axis].map(|axis| most(&mut linearized, axis, DVec3::ZERO));
            let shifts = [axis, -axis].map(|axis| most(&mut linearized, DVec3::ZERO, axis));
            for ([high, low], middle, half) in
                [(turns, &mut v[k], &mut v_half[k]), (shifts, &mut y[k], &mut y_half[k])]
            {
                let (high, low) = (high.min(*half), (-low).max(-*half));
                if low > high {
                    return false;
                }
                // Rounded outward, so that the new box holds all that is left.
                *middle += 0.5 * (high + low);
                *half = 0.5 * (high - low) + 4.0 * f64::EPSILON * (middle.abs() + *half);
            }
        }
        (self.v, self.v_half, self.y, self.y_half) = (v, v_half, y, y_half);
        true
    }

    /// Whether linear conditions say anything.
    pub fn is_linear(&self) -> bool {
        self.radius() <= WIDEST
    }

    /// Whether a search asks linear conditions: what is wider is divided first.
    pub fn is_narrow(&self) -> bool {
        self.radius() <= WIDEST_SEARCHED
    }

    /// The same, made narrow around a pose of it, for a step towards a witness.
    pub fn around(&self, pose: PivotPose, v: DVec3) -> Self {
        Self { v, y: pose.y, ..self.clone() }
    }

    /// The same cell with more around it, and such sites.
    pub fn widened(&self, length: f64, turn: f64, left: Vec<Vec<u32>>) -> Self {
        Self {
            v_half: self.v_half + turn + TURN_ROUNDING,
            y_half: self.y_half + length,
            left,
            ..self.clone()
        }
    }

    /// In another chart, a cell that holds it; `None` if its rotations are too far from there.
    ///
    /// Rotations within Φ of `exp(v)` have vectors within `Φ (θ/2)/sin(θ/2)` of `v`, where no vector on the way is longer
    /// than θ: that is the norm of the inverse of the Jacobian.
    pub fn rebased(&self, base: DMat3) -> Option<Self> {
        let radius = self.radius();
        let v = Self { base, ..self.clone() }.coordinates(self.rotation());
        let longest = 0.5 * (v.length() + 2.0 * radius);
        let stretch = longest / longest.sin().max(f64::MIN_POSITIVE);
        (longest < 0.8 && stretch * radius <= 2.0 * radius).then(|| Self {
            base,
            v,
            v_half: DVec3::splat(stretch * radius + 1e-12),
            ..self.clone()
        })
    }

    /// Leaves of each condition the site that the pose is nearest to.
    pub fn keep_nearest(&mut self, conditions: &Conditions<'_>, pose: PivotPose) {
        let case = conditions.case;
        for ((contact, sites), left) in conditions.sites.iter().zip(&mut self.left) {
            let excess = |number: &u32| {
                let one = std::slice::from_ref(&sites[*number as usize]);
                case.excess(*contact, one, pose, case.angle_tolerance)
            };
            if let Some(nearest) = left.iter().copied().min_by(|a, b| excess(a).total_cmp(&excess(b))) {
                *left = vec![nearest];
            }
        }
    }

    /// The chart coordinates of a rotation.
    pub fn coordinates(&self, turn: DMat3) -> DVec3 {
        vector(turn * self.base.transpose())
    }

    /// Whether a pose is in the cell, within a length and an angle.
    pub fn holds(&self, pose: PivotPose, length: f64, turn: f64) -> bool {
        let v = self.coordinates(pose.rotation);
        // The same rotation the other way round: near half a turn, either may be in the box.
        let other = v - v.normalize_or_zero() * TAU;
        [v, other].iter().any(|v| (*v - self.v).abs().cmple(self.v_half + turn + TURN_ROUNDING).all())
            && (pose.y - self.y).abs().cmple(self.y_half + length).all()
    }

    /// Where a motion of the model takes it: a cell around that.
    pub fn moved(&self, motion: Pose) -> Self {
        let turn = motion.rotation;
        let widths = DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs());
        // What turns a box may leave it by rounding.
        let around = |half: DVec3| widths * half * (1.0 + 1e-12);
        Self {
            base: turn * self.base,
            v: turn * self.v,
            v_half: around(self.v_half) + 1e-12,
            y: motion.apply(self.y),
            y_half: around(self.y_half) + 1e-12 * self.y.length(),
            left: self.left.clone(),
            cuts: Vec::new(),
        }
    }

    /// `(exp(v) along)·(offset − dy)` about the middle, less its value there: what is linear in `d`, beside `−along·dy`,
    /// and a bound of the rest.
    pub fn turned(&self, along: DVec3, offset: DVec3) -> (DVec3, f64) {
        let about = left_jacobian(self.v).transpose() * along.cross(offset);
        let shift = self.y_half.length();
        let loose = self.looseness() * (offset.length() + shift) + chord(self.radius()) * shift;
        (about, loose)
    }
}

/// No valid pose of the cell has more of `about·d + direction·(y − y₀)`.
pub(super) fn most(linearized: &mut Linearized, about: DVec3, direction: DVec3) -> f64 {
    linearized.maximize(&[about.x, about.y, about.z, direction.x, direction.y, direction.z]).bound
}

/// How far a unit lever moves when turned.
pub(super) fn chord(angle: f64) -> f64 {
    2.0 * (0.5 * angle.min(std::f64::consts::PI)).sin()
}

fn widest(half: DVec3) -> usize {
    (0..3).max_by(|a, b| half[*a].total_cmp(&half[*b])).unwrap_or(0)
}
