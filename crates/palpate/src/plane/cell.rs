//! A cell of pose space: an interval of rotations, a box of pivot points, and a polytope around what is left in it.
//!
//! For θ = mid + d and s = sin d, a lever turns as `R(−θ)c = cos d · a − s · Ja` with `a = R(−mid)c` and J the
//! quarter turn. As `cos d` is within ρ = (1−cos h)/2 of μ = (1+cos h)/2 for |d| ≤ h, every condition
//! `u·(y + R(−θ)c) ≤ b` implies `u·y − s u·Ja ≤ b − μ u·a + ρ|u·a|`: linear in (s, y), and loose by no more than
//! `2ρ|a| ≈ h²|a|/2`. (P3 of MATH 2.1.1 is loose by `h|a|`; the second order is what makes few cells tight.)

use glam::{DVec2, dvec2};

use super::arc::{Arc, wrap};
use super::case::{Case, PivotPose};
use super::free::{Escapes, Wall};
use super::pose::Pose;
use super::site::Site;
use crate::feature::Feature;
use crate::polytope::{HalfSpace, Polytope};
use crate::sweep::Sweep;

/// Above this half width, radians, a cell is only a box: the linear conditions say too little there.
const WIDEST_POLYTOPE: f64 = 0.35;

/// A cell is divided by ways out of the part this often, at most.
const MOST_WALLS: usize = 48;

/// A part of pose space.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    pub mid: f64,
    pub half: f64,
    pub y_low: DVec2,
    pub y_high: DVec2,
    /// Swept points and sides on which they must stay: the cell is that part of its box.
    walls: Vec<Wall>,
    polytope: Polytope,
}

/// Contacts on sites: the conditions that a pose must satisfy together.
#[derive(Debug)]
pub(crate) struct Conditions<'a> {
    pub case: &'a Case,
    pub sites: Vec<(usize, Site)>,
    /// The rotations that normals and prior leave, widened by the tolerance.
    pub rotations: Vec<Arc>,
    /// Added to every bound: nothing where a certificate is sought that no pose is valid, τ where every pose that is
    /// valid up to τ must be enclosed.
    pub slack: f64,
}

impl<'a> Conditions<'a> {
    /// That contact `i` lies on feature `f`, for each pair; `None` if normals and prior leave no rotation.
    pub fn new(case: &'a Case, pairs: impl Iterator<Item = (usize, Feature)>) -> Option<Self> {
        let sites: Option<Vec<_>> =
            pairs.map(|(contact, feature)| Some((contact, case.site(contact, feature)?))).collect();
        Self::with_slack(case, sites?, 0.0, case.angle_tolerance)
    }

    /// The same conditions with every bound enlarged by τ.
    pub fn relaxed(&self) -> Option<Self> {
        let (length, angle) = (2.0 * self.case.length_tolerance, 2.0 * self.case.angle_tolerance);
        Self::with_slack(self.case, self.sites.clone(), length, angle)
    }

    fn with_slack(case: &'a Case, sites: Vec<(usize, Site)>, slack: f64, angle: f64) -> Option<Self> {
        let mut rotations = vec![case.prior.map_or(Arc::FULL, |prior| {
            Arc::around(prior.world_from_model.angle(), prior.rotation).widen(angle)
        })];
        for (contact, site) in &sites {
            let own = case.rotations(*contact, site, angle);
            rotations = rotations.iter().flat_map(|arc| arc.intersect(own)).collect();
            if rotations.is_empty() {
                return None;
            }
        }
        Some(Self { case, sites, rotations, slack })
    }

    /// Whether the pose satisfies all of them, bounds enlarged by `length` and `angle`.
    pub fn satisfied(&self, pose: PivotPose, length: f64, angle: f64) -> bool {
        self.sites.iter().all(|(contact, site)| self.case.excess(*contact, site, pose, angle) <= length)
            && self.case.allows(pose, length)
    }

    /// By how much the pose misses the worst of contacts, prior and free space, a length: a measure, not a bound.
    pub fn miss(&self, pose: PivotPose) -> f64 {
        let contacts = self
            .sites
            .iter()
            .map(|(contact, site)| self.case.excess(*contact, site, pose, self.case.angle_tolerance));
        let sweeps = self.case.sweeps.iter().map(|sweep| sweep.intrusion(&self.case.model, pose).0);
        contacts.chain(sweeps).fold(self.case.prior_excess(pose), f64::max)
    }

    /// Whether the set at one rotation is convex, so that only rotations need be divided.
    pub fn convex(&self) -> bool {
        self.case.sweeps.is_empty()
            && self.case.prior.is_none()
            && self.sites.iter().all(|(_, site)| site.convex())
    }

    /// The largest lever among the contacts, to the far side of the tip, and the sweeps.
    pub fn reach(&self) -> f64 {
        let lever = |contact: usize| self.case.data[contact].lever.length() + self.case.data[contact].radius;
        let contacts = self.sites.iter().map(|(contact, _)| lever(*contact));
        contacts.chain(self.case.sweeps.iter().map(Sweep::reach)).fold(0.0, f64::max)
    }
}

impl Cell {
    /// Everything with a rotation within `half` of `mid`.
    pub fn whole(mid: f64, half: f64) -> Self {
        let infinite = DVec2::INFINITY;
        let (walls, polytope) = (Vec::new(), Polytope::default());
        Self { mid, half, y_low: -infinite, y_high: infinite, walls, polytope }
    }

    /// The cell within a box of pivot points.
    pub fn within(self, y_low: DVec2, y_high: DVec2) -> Self {
        Self { y_low, y_high, ..self }
    }

    /// The corners of the polytope as `(s, y)`.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = (f64, DVec2)> + '_ {
        self.polytope.corners().map(|[s, x, y]| (s, dvec2(x, y)))
    }

    /// Half the sizes of the box.
    pub fn y_half(&self) -> DVec2 {
        0.5 * (self.y_high - self.y_low)
    }

    pub fn y_mid(&self) -> DVec2 {
        0.5 * (self.y_high + self.y_low)
    }

    /// How far a point at `reach` from the pivot moves in the model's frame, at most, from the middle of the cell.
    pub fn motion(&self, reach: f64) -> f64 {
        self.y_half().length() + 2.0 * (0.5 * self.half).sin() * reach
    }

    /// A pose in the middle of what is left of the cell.
    pub fn candidate(&self) -> PivotPose {
        if self.polytope.is_empty() {
            return PivotPose { angle: self.mid, y: self.y_mid() };
        }
        let [s, x, y] = self.polytope.mean();
        self.pose(s, dvec2(x, y))
    }

    /// The pose of a point of the polytope.
    pub fn pose(&self, s: f64, y: DVec2) -> PivotPose {
        PivotPose { angle: self.mid + s.clamp(-1.0, 1.0).asin(), y }
    }

    /// The box of the cell with so much more at either end.
    pub fn widened(&self, length: f64, angle: f64) -> Self {
        let half = self.half + angle;
        Self::whole(self.mid, half).within(self.y_low - length, self.y_high + length)
    }

    /// Whether the cell may hold `pose`, within `length` and `angle`.
    pub fn holds(&self, pose: PivotPose, length: f64, angle: f64) -> bool {
        wrap(pose.angle - self.mid).abs() <= self.half + angle
            && pose.y.cmpge(self.y_low - length).all()
            && pose.y.cmple(self.y_high + length).all()
    }

    /// Whether the cell and `other`, moved by a symmetry of the model, may hold the same placed part, within `length`.
    ///
    /// `pose` and `pose * motion⁻¹` place the same part: θ turns back by the motion's angle, y moves with it.
    pub fn meets(&self, other: &Self, motion: Pose, length: f64, angle: f64) -> bool {
        let turned = wrap(other.mid - motion.angle() - self.mid).abs();
        let gap = (motion.apply(other.y_mid()) - self.y_mid()).abs();
        let turn = motion.rotation.abs();
        let half = other.y_half();
        let spread =
            self.y_half() + dvec2(turn.x * half.x + turn.y * half.y, turn.y * half.x + turn.x * half.y);
        turned <= self.half + other.half + angle && gap.cmple(spread + length).all()
    }

    /// The cell where a symmetry of the model moves it: `pose * motion⁻¹` for each of its poses.
    pub fn moved(&self, motion: Pose) -> Self {
        let turn = motion.rotation.abs();
        let half = self.y_half();
        let spread = dvec2(turn.x * half.x + turn.y * half.y, turn.y * half.x + turn.x * half.y);
        let middle = motion.apply(self.y_mid());
        Self {
            mid: self.mid - motion.angle(),
            half: self.half,
            y_low: middle - spread,
            y_high: middle + spread,
            walls: Vec::new(),
            polytope: self.polytope.mapped(|[s, x, y]| {
                let y = motion.apply(dvec2(x, y));
                [s, y.x, y.y]
            }),
        }
    }

    /// Shrinks the cell to what the conditions leave of it; `false` if they leave nothing.
    pub fn contract(&mut self, conditions: &Conditions<'_>) -> bool {
        if !self.contract_box(conditions) {
            return false;
        }
        if self.half > WIDEST_POLYTOPE {
            return true;
        }
        let outward = conditions.case.outward();
        let reach = self.half.sin() + outward / conditions.case.scale;
        let (low, high) = (self.y_low - outward, self.y_high + outward);
        self.polytope = Polytope::boxed([-reach, low.x, low.y], [reach, high.x, high.y]);
        for (contact, site) in &conditions.sites {
            let Some(site) = self.restrict(conditions, *contact, site) else { return false };
            for direction in site.directions() {
                self.cut(conditions, *contact, &site, direction);
            }
            if self.polytope.is_empty() {
                return false;
            }
        }
        self.cut_prior(conditions);
        for k in 0..self.walls.len() {
            self.cut_wall(conditions.case, self.walls[k]);
        }
        self.cut_free(conditions, PivotPose { angle: self.mid, y: self.y_mid() });
        self.shrink_to_polytope(conditions.case)
    }

    /// Intersects the box with what each contact leaves of it on its own.
    fn contract_box(&mut self, conditions: &Conditions<'_>) -> bool {
        let turn = DVec2::from_angle(-self.mid);
        let chord = 2.0 * (0.5 * self.half).sin();
        for (contact, site) in &conditions.sites {
            let datum = &conditions.case.data[*contact];
            let (middle, half) = site.bounds();
            let middle = middle - turn.rotate(datum.lever);
            let slack =
                datum.bound + conditions.slack + chord * datum.lever.length() + conditions.case.outward();
            self.y_low = self.y_low.max(middle - half - slack);
            self.y_high = self.y_high.min(middle + half + slack);
        }
        self.y_low.cmple(self.y_high).all()
    }

    /// The part of a site that contact `i` can reach within the cell; `None` if it can reach none of it.
    fn restrict(&self, conditions: &Conditions<'_>, contact: usize, site: &Site) -> Option<Site> {
        let case = conditions.case;
        let Site::Arc { middle, radius, .. } = *site else { return Some(*site) };
        if radius == 0.0 {
            return Some(*site);
        }
        let datum = &case.data[contact];
        let allowed = datum
            .normals
            .map(|normals| normals.widen(self.half + 2.0 * case.angle_tolerance).turn(-self.mid));
        let site = site.restrict_hull(allowed)?;
        // Seen from the vertex, the true centre of the tip lies within `spread` of the middle's place.
        let offset = self.y_mid() + DVec2::from_angle(-self.mid).rotate(datum.lever) - middle;
        let spread = self.motion(datum.lever.length()) + datum.bound + conditions.slack + case.outward();
        let sector = (spread < offset.length()).then(|| {
            Arc::around(offset.to_angle(), (spread / offset.length()).asin() + case.angle_tolerance)
        });
        let site = site.restrict_hull(sector)?;
        // The hollow of the arc, which its convex hull fills.
        let x = middle + offset;
        (site.nearest(x).distance(x) <= spread).then_some(site)
    }

    /// Cuts with the tangent of contact `i`'s site, grown by its bound, that has the outward normal `direction`.
    fn cut(&mut self, conditions: &Conditions<'_>, contact: usize, site: &Site, direction: DVec2) {
        let datum = &conditions.case.data[contact];
        let reach = site.support(direction) + datum.bound + conditions.slack;
        self.cut_beyond(conditions.case, datum.lever, direction, reach);
    }

    /// Cuts with `direction · (y + R(−θ) lever) <= reach`.
    fn cut_beyond(&mut self, case: &Case, lever: DVec2, direction: DVec2, reach: f64) {
        let arm = DVec2::from_angle(-self.mid).rotate(lever);
        let (middle, spread) = self.cosine();
        let along = direction.dot(arm);
        let normal = [-direction.dot(arm.perp()), direction.x, direction.y];
        let offset = reach - middle * along + spread * along.abs() + case.outward();
        self.polytope.cut(&HalfSpace { normal, offset }, case.scale);
    }

    /// Cuts with each sweep whose worst point at `pose` has one way out of the part; nothing is left if it has none.
    fn cut_free(&mut self, conditions: &Conditions<'_>, pose: PivotPose) {
        for sweep in &conditions.case.sweeps {
            let lever = sweep.intrusion(&conditions.case.model, pose).1;
            match self.escapes(conditions, sweep, lever, pose).as_deref() {
                Some([]) => self.polytope = Polytope::default(),
                Some([wall]) => self.cut_wall(conditions.case, *wall),
                _ => {}
            }
        }
    }

    fn cut_wall(&mut self, case: &Case, wall: Wall) {
        self.cut_beyond(case, wall.lever, -wall.normal, -wall.height);
    }

    /// The ways out that a swept point has which is too near at `pose`, a pose of the cell.
    fn escapes(
        &self,
        conditions: &Conditions<'_>,
        sweep: &Sweep<DVec2>,
        lever: DVec2,
        pose: PivotPose,
    ) -> Option<Escapes> {
        let motion = self.motion_from(pose, lever.length()) + conditions.case.outward();
        sweep.escapes(&conditions.case.model, lever, pose, motion, conditions.slack)
    }

    /// The cell in parts that together hold all its valid poses, one for each way out that the worst swept point at
    /// `pose` has, contracted. `None` if free space is not what `pose` misses most, or if it would not be left out.
    pub fn split_by_escapes(&self, conditions: &Conditions<'_>, pose: PivotPose) -> Option<Vec<Self>> {
        let case = conditions.case;
        let intrusions = case.sweeps.iter().map(|sweep| (sweep, sweep.intrusion(&case.model, pose)));
        let (sweep, (depth, lever)) = intrusions.max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        if self.walls.len() >= MOST_WALLS || depth < conditions.miss(pose) {
            return None;
        }
        let escapes = self.escapes(conditions, sweep, lever, pose)?;
        let place = pose.place(lever);
        let loose = self.looseness(lever.length()) + 2.0 * case.outward();
        if escapes.iter().any(|wall| wall.normal.dot(place) + loose > wall.height) {
            return None;
        }
        let stretch = match escapes[..] {
            [first, second] => {
                let reach = sweep.reach();
                let motion = self.motion_from(pose, reach) + case.outward();
                sweep.stretch(&case.model, [first, second], pose, motion, conditions.slack)
            }
            _ => None,
        };
        let part = |wall: &Wall| {
            let mut part = self.clone();
            part.walls.push(*wall);
            part.walls.extend(stretch.iter().flatten().map(|end| Wall { lever: *end, ..*wall }));
            part.contract(conditions).then_some(part)
        };
        Some(escapes.iter().filter_map(part).collect())
    }

    /// How far a point at `reach` from the pivot moves within the cell, at most, from where `pose` has it.
    fn motion_from(&self, pose: PivotPose, reach: f64) -> f64 {
        let away = (self.y_high - pose.y).max(pose.y - self.y_low);
        let turn = (self.half + wrap(pose.angle - self.mid).abs()).min(std::f64::consts::PI);
        away.length() + 2.0 * (0.5 * turn).sin() * reach
    }

    /// Cuts with the box of translations. The condition is bilinear in (s, y): its product of deviations from the
    /// middle of the box is bounded, the rest is linear.
    fn cut_prior(&mut self, conditions: &Conditions<'_>) {
        let case = conditions.case;
        let Some(prior) = case.prior.filter(|prior| prior.translation.is_finite()) else { return };
        let turn = DVec2::from_angle(-self.mid);
        let (middle, spread) = self.cosine();
        let half = self.y_half();
        for axis in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y] {
            // axis·T ≤ axis·T₀ + a with T = pivot − R(θ)y.
            let bound = axis.dot(prior.world_from_model.translation - case.pivot) + prior.translation;
            let inner = turn.rotate(axis);
            let across = inner.perp();
            let largest = inner.dot(self.y_mid()).abs() + inner.abs().dot(half);
            let slack = conditions.slack
                + spread * largest
                + self.half.sin() * across.abs().dot(half)
                + case.outward();
            let normal = [across.dot(self.y_mid()), -middle * inner.x, -middle * inner.y];
            self.polytope.cut(&HalfSpace { normal, offset: bound + slack }, case.scale);
        }
    }

    /// `cos d` for |d| ≤ half: its middle μ, and how far it may be from it, ρ.
    fn cosine(&self) -> (f64, f64) {
        let cosine = self.half.cos();
        (0.5 * (1.0 + cosine), 0.5 * (1.0 - cosine))
    }

    /// By how much the linear conditions may be loose: a length.
    pub fn looseness(&self, reach: f64) -> f64 {
        2.0 * self.cosine().1 * reach
    }

    /// Cuts each site at the corners that stick out over it by more than `share` of its bound.
    pub fn trim(&mut self, conditions: &Conditions<'_>, share: f64) -> bool {
        let (middle, _) = self.cosine();
        for (contact, site) in &conditions.sites {
            let Some(site) = self.restrict(conditions, *contact, site) else { return false };
            let datum = &conditions.case.data[*contact];
            let arm = DVec2::from_angle(-self.mid).rotate(datum.lever);
            let mut directions = Vec::new();
            for (s, y) in self.corners() {
                let x = y + middle * arm - s * arm.perp();
                let outside = x - site.nearest(x);
                if outside.length() > (1.0 + share) * datum.bound
                    && let Some(direction) = outside.try_normalize()
                {
                    directions.push(direction);
                }
            }
            for direction in directions {
                self.cut(conditions, *contact, &site, direction);
            }
        }
        self.shrink_to_polytope(conditions.case)
    }

    /// Cuts at a pose of the cell with the site that it misses most; `false` if nothing is left.
    pub fn cut_at(&mut self, conditions: &Conditions<'_>, pose: PivotPose) -> bool {
        let case = conditions.case;
        let mut worst: Option<(f64, usize, Site, DVec2)> = None;
        for (contact, site) in &conditions.sites {
            let Some(site) = self.restrict(conditions, *contact, site) else { return false };
            let x = case.place(*contact, pose);
            let outside = x - site.nearest(x);
            let excess = outside.length() - case.data[*contact].bound;
            if worst.as_ref().is_none_or(|(most, ..)| excess > *most) {
                worst = Some((excess, *contact, site, outside));
            }
        }
        if let Some((_, contact, site, outside)) = worst
            && let Some(direction) = outside.try_normalize()
        {
            self.cut(conditions, contact, &site, direction);
        }
        self.cut_free(conditions, pose);
        self.shrink_to_polytope(case)
    }

    /// Shrinks interval and box to the polytope, outward; `false` if it is empty.
    fn shrink_to_polytope(&mut self, case: &Case) -> bool {
        if self.polytope.is_empty() {
            return false;
        }
        let (low, high) = self.polytope.bounds();
        let outward = case.outward();
        self.y_low = self.y_low.max(dvec2(low[1], low[2]) - outward);
        self.y_high = self.y_high.min(dvec2(high[1], high[2]) + outward);
        true
    }

    /// The interval of rotations that the polytope leaves, radians.
    pub fn rotations(&self) -> Arc {
        if self.polytope.is_empty() {
            return Arc::around(self.mid, self.half);
        }
        let (low, high) = self.polytope.bounds();
        let [from, to] = [low[0], high[0]].map(|s| s.clamp(-1.0, 1.0).asin());
        let (from, to) = (from.max(-self.half), to.min(self.half));
        Arc { start: self.mid + from, width: (to - from).max(0.0) }
    }

    /// The cell cut in two across its rotations, which shrink to what is left first.
    pub fn split_rotations(&self) -> [Self; 2] {
        let left = self.rotations();
        let quarter = 0.25 * left.width;
        [-quarter, quarter].map(|offset| Self {
            mid: left.middle() + offset,
            half: quarter + f64::EPSILON * std::f64::consts::TAU,
            walls: self.walls.clone(),
            polytope: Polytope::default(),
            ..*self
        })
    }

    /// The cell cut in two across the longer side of its box.
    pub fn split_box(&self) -> [Self; 2] {
        let middle = self.y_mid();
        let wide = self.y_half().x >= self.y_half().y;
        let cut = |low: DVec2, high: DVec2| {
            let left = self.rotations();
            Self {
                mid: left.middle(),
                half: left.half_width() + f64::EPSILON * std::f64::consts::TAU,
                y_low: low,
                y_high: high,
                walls: self.walls.clone(),
                polytope: Polytope::default(),
            }
        };
        if wide {
            [cut(self.y_low, dvec2(middle.x, self.y_high.y)), cut(dvec2(middle.x, self.y_low.y), self.y_high)]
        } else {
            [cut(self.y_low, dvec2(self.y_high.x, middle.y)), cut(dvec2(self.y_low.x, middle.y), self.y_high)]
        }
    }
}
