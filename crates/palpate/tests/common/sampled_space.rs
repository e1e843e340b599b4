//! The poses of one assignment in space, and those of them that lie farthest apart: plain geometry, no part of what is
//! measured against it.
//!
//! A pose is valid if each contact lies within its bound of its face, a set of triangles, and the face's normal within its
//! cone. From valid poses a climb goes towards the largest rotation, or the farthest place of a point, and never leaves
//! what is valid: it maximizes the objective plus a small multiple of the sum of the logarithms of what is left of each
//! bound (Newton's method, the multiple ever smaller). Every pose on its way is tested; so what is found is a lower bound
//! of what there is.

#![allow(dead_code, reason = "each file uses its own part")]

use std::f64::consts::{PI, TAU};

use fastrand::Rng;
use glam::{DMat3, DVec3, dvec3};
use palpate::Feature;
use palpate::space::Pose;

use crate::solids::{Problem, direction};

/// Steps of a random walk over the set, and how many of them are starts of climbs.
const NUM_WALKED: usize = 160;
const NUM_STARTS: usize = 6;

/// The barrier's share of the objective falls by this factor, so many times.
const COOLING: f64 = 10.0;
const NUM_COOLED: usize = 7;

/// Newton steps between two of them at most.
const MOST_STEPS: usize = 25;

/// Pairs of poses that are driven apart, and rounds of that.
const NUM_PAIRS: usize = 6;
const NUM_ROUNDS: usize = 6;

/// One contact on one face.
#[derive(Debug, Clone)]
struct Match {
    center: DVec3,
    bound: f64,
    /// Sensed, world frame.
    sensed: DVec3,
    error: f64,
    /// Of the face, model frame.
    normal: DVec3,
    triangles: Vec<[DVec3; 3]>,
}

/// The poses that satisfy one assignment of contacts to faces.
#[derive(Debug, Clone)]
pub struct TrueSet {
    matches: Vec<Match>,
    /// Steps turn about it.
    pivot: DVec3,
    /// The size of the part: a turn moves it by so much.
    size: f64,
    /// Steps turn nothing.
    keeps_rotation: bool,
}

/// What two poses are compared by.
#[derive(Debug, Clone, Copy)]
pub enum Measure {
    /// The angle between their rotations.
    Rotation,
    /// The distance between the places of a model point.
    Place(DVec3),
}

/// A small motion: a turn about the pivot in units of one over the part's size, then a shift.
type Step = [f64; 6];

impl Measure {
    pub fn apart(self, a: Pose, b: Pose) -> f64 {
        match self {
            Self::Rotation => turn(a.rotation * b.rotation.transpose()).length(),
            Self::Place(point) => a.apply(point).distance(b.apply(point)),
        }
    }

    /// What is to grow so that `pose` gets away from `from`, and its gradient in the step.
    fn away(self, set: &TrueSet, pose: Pose, from: Pose) -> (f64, Step) {
        let apart = self.apart(pose, from);
        match self {
            Self::Rotation => {
                let axis = turn(pose.rotation * from.rotation.transpose()).normalize_or_zero();
                (apart, set.step(axis, DVec3::ZERO))
            }
            Self::Place(point) => {
                let place = pose.apply(point);
                let away = (place - from.apply(point)).normalize_or_zero();
                (apart, set.step((place - set.pivot).cross(away), away))
            }
        }
    }

    /// What is to grow so that `pose` goes along a direction from `from`, and its gradient.
    fn along(self, set: &TrueSet, pose: Pose, from: Pose, toward: DVec3) -> (f64, Step) {
        match self {
            Self::Rotation => {
                let v = turn(pose.rotation * from.rotation.transpose());
                // The inverse of the left Jacobian, transposed.
                let angle = v.length();
                let second = if angle < 1e-3 {
                    1.0 / 12.0
                } else {
                    1.0 / (angle * angle) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin())
                };
                let gradient = toward + 0.5 * v.cross(toward) + second * v.cross(v.cross(toward));
                (v.dot(toward), set.step(gradient, DVec3::ZERO))
            }
            Self::Place(point) => {
                let place = pose.apply(point);
                (toward.dot(place), set.step((place - set.pivot).cross(toward), toward))
            }
        }
    }
}

/// The vector of a rotation.
fn turn(rotation: DMat3) -> DVec3 {
    let skew = 0.5
        * dvec3(
            rotation.y_axis.z - rotation.z_axis.y,
            rotation.z_axis.x - rotation.x_axis.z,
            rotation.x_axis.y - rotation.y_axis.x,
        );
    let cosine = 0.5 * (rotation.x_axis.x + rotation.y_axis.y + rotation.z_axis.z - 1.0);
    let angle = skew.length().atan2(cosine);
    if skew.length() > 1e-9 {
        return angle * skew.normalize_or_zero();
    }
    if cosine > 0.0 {
        return skew;
    }
    // Half a turn: the axis is the longest column of R + I.
    let columns = [0, 1, 2].map(|k| rotation.col(k) + DVec3::AXES[k]);
    let longest = columns.into_iter().max_by(|a, b| a.length().total_cmp(&b.length()));
    angle * longest.unwrap_or(DVec3::X).normalize_or_zero()
}

/// The point of a triangle nearest to one, and the projection onto what the offset may change in to first order.
fn nearest_of([a, b, c]: [DVec3; 3], point: DVec3) -> (DVec3, DMat3) {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let outer = |u: DVec3| DMat3::from_cols(u * u.x, u * u.y, u * u.z);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| (*to - *from).cross(point - *from).dot(normal) >= 0.0) {
        return (point - (point - a).dot(normal) * normal, outer(normal));
    }
    let on_side = |(from, to): (DVec3, DVec3)| {
        let way = to - from;
        let share = (point - from).dot(way) / way.length_squared();
        let projection = match share {
            s if s <= 0.0 || s >= 1.0 => DMat3::IDENTITY,
            _ => DMat3::IDENTITY - outer(way.normalize_or_zero()),
        };
        (from + share.clamp(0.0, 1.0) * way, projection)
    };
    let near = |(foot, _): &(DVec3, DMat3)| foot.distance_squared(point);
    sides.map(on_side).into_iter().min_by(|a, b| near(a).total_cmp(&near(b))).expect("three sides")
}

impl TrueSet {
    /// `tolerance` as a share of the part's size; `None` if a contact has no normal or is not on a face.
    pub fn new(problem: &Problem, assignment: &[Feature], tolerance: f64) -> Option<Self> {
        let model = &problem.model;
        let contacts = &problem.evidence.contacts;
        let matches: Option<Vec<Match>> = contacts
            .iter()
            .zip(assignment)
            .map(|(contact, feature)| {
                let (Feature::Face(number), Some(sensed)) = (feature, contact.normal) else { return None };
                let normal = model.faces[*number as usize].normal;
                let lifted = |k: u32| model.vertices[k as usize].point + contact.tip_radius * normal;
                let own = model.triangles.iter().filter(|(_, face)| face == number);
                Some(Match {
                    center: contact.center,
                    bound: contact.position_error + tolerance * model.size,
                    sensed: sensed.direction,
                    error: sensed.error + tolerance,
                    normal,
                    triangles: own.map(|(corners, _)| corners.map(lifted)).collect(),
                })
            })
            .collect();
        let pivot = contacts.iter().map(|contact| contact.center).sum::<DVec3>() / contacts.len() as f64;
        Some(Self { matches: matches?, pivot, size: model.size, keeps_rotation: false })
    }

    /// The same set, of which only poses with the rotation of the start are looked for.
    pub fn at_one_rotation(&self) -> Self {
        Self { keeps_rotation: true, ..self.clone() }
    }

    fn step(&self, turn: DVec3, shift: DVec3) -> Step {
        let turn = if self.keeps_rotation { DVec3::ZERO } else { turn / self.size };
        [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z]
    }

    /// How a lever's end moves, seen from the part, by component `k` of the turn.
    fn turned(&self, k: usize, lever: DVec3) -> DVec3 {
        if self.keeps_rotation { DVec3::ZERO } else { lever.cross(DVec3::AXES[k]) / self.size }
    }

    /// The largest distance found from a pose, valid or not, to one of the set; `poses` are valid.
    pub fn reach(&self, poses: &[Pose], measure: Measure, from: Pose) -> f64 {
        let apart = |pose: Pose| measure.apart(pose, from);
        let mut order: Vec<Pose> = poses.to_vec();
        order.sort_by(|a, b| apart(*b).total_cmp(&apart(*a)));
        let ends = order.iter().take(NUM_PAIRS).map(|pose| {
            let climbed = self.farthest(*pose, &|pose| measure.away(self, pose, from));
            apart(climbed).max(apart(*pose))
        });
        ends.fold(0.0, f64::max)
    }

    fn moved(&self, pose: Pose, step: &Step, share: f64) -> Pose {
        let turn = share / self.size * dvec3(step[0], step[1], step[2]);
        let shift = share * dvec3(step[3], step[4], step[5]);
        let turned = Pose::new(turn, DVec3::ZERO).rotation;
        Pose {
            rotation: turned * pose.rotation,
            translation: self.pivot + turned * (pose.translation - self.pivot) + shift,
        }
    }

    /// The nearest point of the placed face to the contact, as the offset to the contact in the world, and the projection
    /// there.
    fn offset(one: &Match, pose: Pose) -> (DVec3, DMat3) {
        let place = pose.rotation.transpose() * (one.center - pose.translation);
        let nearest = one.triangles.iter().map(|corners| nearest_of(*corners, place));
        let near = |(foot, _): &(DVec3, DMat3)| foot.distance_squared(place);
        let (foot, projection) = nearest.min_by(|a, b| near(a).total_cmp(&near(b))).expect("a triangle");
        (pose.rotation * (place - foot), pose.rotation * projection * pose.rotation.transpose())
    }

    /// What is left of each bound, as shares; all are positive inside.
    fn left(&self, pose: Pose) -> impl Iterator<Item = f64> + '_ {
        self.matches.iter().flat_map(move |one| {
            let (offset, _) = Self::offset(one, pose);
            let cosine = one.sensed.dot(pose.rotation * one.normal);
            [1.0 - offset.length_squared() / (one.bound * one.bound), share_of_cone(one, cosine)]
        })
    }

    pub fn contains(&self, pose: Pose) -> bool {
        self.left(pose).all(|left| left > 0.0)
    }

    fn barrier(&self, pose: Pose) -> f64 {
        self.left(pose).map(|left| if left > 0.0 { left.ln() } else { f64::NEG_INFINITY }).sum()
    }

    /// Gradient of the sum of logarithms, and its Hessian's negative, of the first order where a face is curved no more
    /// than its bound.
    fn slopes(&self, pose: Pose) -> (Step, [[f64; 6]; 6]) {
        let (mut gradient, mut hessian) = ([0.0; 6], [[0.0; 6]; 6]);
        let mut add = |left: f64, slope: Step, curvature: &dyn Fn(usize, usize) -> f64| {
            for j in 0..6 {
                gradient[j] += slope[j] / left;
                for k in 0..6 {
                    hessian[j][k] += slope[j] * slope[k] / (left * left) + curvature(j, k) / left;
                }
            }
        };
        for one in &self.matches {
            let (offset, projection) = Self::offset(one, pose);
            let lever = one.center - self.pivot;
            let square = one.bound * one.bound;
            let left = 1.0 - offset.length_squared() / square;
            let slope = self.step(lever.cross(offset) * 2.0 / square, offset * 2.0 / square);
            // How the contact moves in the face's frame, for each component of the step.
            let ways: [DVec3; 6] =
                std::array::from_fn(|k| if k < 3 { self.turned(k, lever) } else { -DVec3::AXES[k - 3] });
            add(left, slope, &|j, k| 2.0 * ways[j].dot(projection * ways[k]) / square);
            let (sensed, normal) = (one.sensed, pose.rotation * one.normal);
            let scale = 1.0 / (1.0 - one.error.cos());
            let cosine = sensed.dot(normal);
            let slope = self.step(scale * normal.cross(sensed), DVec3::ZERO);
            add(share_of_cone(one, cosine), slope, &|j, k| {
                if j >= 3 || k >= 3 || self.keeps_rotation {
                    return 0.0;
                }
                let mixed = 0.5 * (sensed[j] * normal[k] + normal[j] * sensed[k]);
                scale * (f64::from(j == k) * cosine - mixed) / (self.size * self.size)
            });
        }
        (gradient, hessian)
    }

    /// Newton's method on `weight · objective + Σ ln(left)`, from a valid pose.
    fn climb(&self, mut pose: Pose, weight: f64, objective: &dyn Fn(Pose) -> (f64, Step)) -> Pose {
        let value = |pose: Pose| weight * objective(pose).0 + self.barrier(pose);
        let mut now = value(pose);
        for _ in 0..MOST_STEPS {
            let (mut gradient, hessian) = self.slopes(pose);
            let (_, slope) = objective(pose);
            for k in 0..6 {
                gradient[k] += weight * slope[k];
            }
            let step = solve(hessian, gradient);
            let gain: f64 = step.iter().zip(&gradient).map(|(a, b)| a * b).sum();
            let mut share = 1.0;
            let next = loop {
                let next = self.moved(pose, &step, share);
                let then = value(next);
                if then >= now + 0.1 * share * gain || share < 1e-6 {
                    break (then > now).then_some((next, then));
                }
                share *= 0.5;
            };
            match next {
                Some((next, then)) => (pose, now) = (next, then),
                None => break,
            }
            if gain < 1e-3 {
                break;
            }
        }
        pose
    }

    /// The middle, as the barrier sees it.
    fn centred(&self, pose: Pose) -> Pose {
        self.climb(pose, 0.0, &|_| (0.0, [0.0; 6]))
    }

    /// From a valid pose to where the objective is largest, as far as a climb goes.
    fn farthest(&self, start: Pose, objective: &dyn Fn(Pose) -> (f64, Step)) -> Pose {
        let mut pose = start;
        let (_, slope) = objective(pose);
        let (_, hessian) = self.slopes(pose);
        // By so much the objective grows within an ellipsoid that the set holds, roughly.
        let reach: f64 = solve(hessian, slope).iter().zip(&slope).map(|(a, b)| a * b).sum::<f64>().sqrt();
        if !(reach > 0.0 && reach.is_finite()) {
            return pose;
        }
        let mut weight = 1.0 / reach;
        for _ in 0..NUM_COOLED {
            pose = self.climb(pose, weight, objective);
            weight *= COOLING;
        }
        pose
    }

    /// Poses all over the set, from valid ones: walks in random directions, each as far as the set reaches.
    fn walked(&self, starts: &[Pose], random: &mut Rng) -> Vec<Pose> {
        let mut poses: Vec<Pose> = starts.iter().map(|start| self.centred(*start)).collect();
        let mut at = 0;
        for _ in 0..NUM_WALKED {
            let pose = poses[at];
            // Long ways find the ends of wide sets, short ones those of narrow sets.
            let scale = self.size * 10_f64.powf(-4.0 * random.f64());
            let (turn, shift) = (PI * scale * random.f64() * direction(random), scale * direction(random));
            let step = [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z];
            let (mut low, mut high) = (-1.0, 1.0);
            for _ in 0..30 {
                let share = low + (high - low) * random.f64();
                let next = self.moved(pose, &step, share);
                if self.contains(next) {
                    poses.push(next);
                    at = poses.len() - 1;
                    break;
                }
                if share < 0.0 { low = share } else { high = share }
            }
        }
        poses
    }

    /// Poses at the ends of the set, and some between; empty if none of the starts is valid.
    pub fn spread(&self, starts: &[Pose], measures: &[Measure], seed: u64) -> Vec<Pose> {
        let random = &mut Rng::with_seed(seed);
        let valid: Vec<Pose> = starts.iter().copied().filter(|start| self.contains(*start)).collect();
        if valid.is_empty() {
            return Vec::new();
        }
        let mut poses = self.walked(&valid, random);
        let centre = poses[0];
        let starts: Vec<Pose> = (0..NUM_STARTS)
            .map(|k| if k == 0 { centre } else { self.centred(poses[random.usize(..poses.len())]) })
            .collect();
        for measure in measures {
            for (k, toward) in directions().enumerate() {
                let start = starts[k % starts.len()];
                for toward in [toward, -toward] {
                    let objective = |pose: Pose| measure.along(self, pose, centre, toward);
                    poses.push(self.farthest(start, &objective));
                }
            }
        }
        poses
    }
}

fn share_of_cone(one: &Match, cosine: f64) -> f64 {
    (cosine - one.error.cos()) / (1.0 - one.error.cos())
}

/// Directions on half of the sphere, evenly.
fn directions() -> impl Iterator<Item = DVec3> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    (0..20).map(|k| {
        let z = (f64::from(k) + 0.5) / 20.0;
        let around = TAU * GOLDEN * f64::from(k);
        let radius = (1.0 - z * z).sqrt();
        dvec3(radius * around.cos(), radius * around.sin(), z)
    })
}

/// The largest distance found between two poses of sets, each with poses of its own to begin with.
pub fn diameter(sets: &[(TrueSet, Vec<Pose>)], measure: Measure) -> f64 {
    let all: Vec<(usize, Pose)> = sets
        .iter()
        .enumerate()
        .flat_map(|(k, (_, poses))| poses.iter().map(move |pose| (k, *pose)))
        .collect();
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for k in 0..all.len() {
        for j in 0..k {
            let apart = measure.apart(all[j].1, all[k].1);
            if pairs.len() < NUM_PAIRS || apart > pairs[pairs.len() - 1].0 {
                // One pair for each first pose, so that pairs differ.
                match pairs.iter().position(|pair| pair.1 == k || pair.2 == j) {
                    Some(at) if pairs[at].0 < apart => pairs[at] = (apart, k, j),
                    Some(_) => {}
                    None => pairs.push((apart, k, j)),
                }
                pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
                pairs.truncate(NUM_PAIRS);
            }
        }
    }
    let mut largest = 0.0_f64;
    for (_, k, j) in pairs {
        let mut pair = [all[k], all[j]];
        let mut apart = measure.apart(pair[0].1, pair[1].1);
        for _ in 0..NUM_ROUNDS {
            for mover in 0..2 {
                let (set, other) = (&sets[pair[mover].0].0, pair[1 - mover].1);
                for start in [pair[mover].1, set.centred(pair[mover].1)] {
                    let found = set.farthest(start, &|pose| measure.away(set, pose, other));
                    if measure.apart(found, other) > measure.apart(pair[mover].1, other) {
                        pair[mover].1 = found;
                    }
                }
            }
            let then = measure.apart(pair[0].1, pair[1].1);
            if then <= apart * (1.0 + 1e-6) {
                break;
            }
            apart = then;
        }
        largest = largest.max(measure.apart(pair[0].1, pair[1].1));
    }
    largest
}

/// `hessian · step = gradient`, by elimination, a little regularized.
fn solve(mut hessian: [[f64; 6]; 6], gradient: Step) -> Step {
    let mut right = gradient;
    let trace: f64 = (0..6).map(|k| hessian[k][k]).sum();
    for (k, row) in hessian.iter_mut().enumerate() {
        row[k] += 1e-12 * trace;
    }
    for k in 0..6 {
        let pivot = (k..6).max_by(|a, b| hessian[*a][k].abs().total_cmp(&hessian[*b][k].abs()));
        let pivot = pivot.expect("not empty");
        hessian.swap(k, pivot);
        right.swap(k, pivot);
        let own = hessian[k];
        for row in k + 1..6 {
            let factor = hessian[row][k] / own[k];
            for (entry, above) in hessian[row].iter_mut().zip(own) {
                *entry -= factor * above;
            }
            right[row] -= factor * right[k];
        }
    }
    for k in (0..6).rev() {
        let known: f64 = (k + 1..6).map(|column| hessian[k][column] * right[column]).sum();
        right[k] = (right[k] - known) / hessian[k][k];
    }
    right
}
