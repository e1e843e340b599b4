//! The pose and the bounds of the thesis in space (2.2.3.1, 2.5), with the corrections of MATH 1.2.
//!
//! They answer for a nominal pose, not for the set of all poses: see `docs/theory.md` for where they are tight, where
//! loose and where wrong. Nothing here decides what is valid.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4, dvec3};

use super::case::Case;
use super::pose::Pose;
use super::site::angle;
use crate::feature::Feature;
use crate::polytope::{HalfSpace, Polytope};

/// Cells of roll, and of pitch, on each side of none (eq. 2.5).
const NUM_TILTS: i32 = 32;

/// Normals and triples of them that are independent by no more count as dependent.
const INDEPENDENT: f64 = 1e-9;

/// The thesis's description of one interpretation of faces with sensed normals.
#[derive(Debug, Clone, PartialEq)]
pub struct ThesisPose {
    /// The rotation by axis and angle, from the two data whose normals are nearest to a right angle (2.2.3.1, errata 20 to
    /// 27); `None`: their axis is not defined (erratum 22). What the thesis uses; errors may be amplified without bound
    /// (erratum 28).
    pub first_rotation: Option<DMat3>,
    /// The nominal rotation: the one that fits all normals best by least squares (erratum 28).
    pub rotation: DMat3,
    /// 2Φ: no two rotations that the normals of those two data leave differ by more; radians, at most π (2.5.1, errata 46
    /// and 47).
    pub residual_rotation: f64,
    /// The largest turn about the middle of those two normals, from the nominal rotation and after any roll and pitch, that
    /// leaves every normal within its error; radians, at most π (eq. 2.4 and 2.5, errata 48 to 51).
    pub rotation_error: f64,
    /// The nominal translation at `rotation`, from the three faces of the largest triple product (2.2.3.1, erratum 29).
    pub translation: DVec3,
    /// `E_T`: half the longest diagonal of those three faces' parallelepiped of translations (2.5.2, erratum 53).
    pub translation_error: f64,
    /// The corners of the translations at `rotation` that keep every contact within its bound of its face's plane (2.5.2,
    /// erratum 52), world frame, in no order. Empty: none does.
    pub translation_region: Vec<DVec3>,
}

/// A contact on a face: what the formulas need of it.
struct Match {
    /// N, sensed, world frame.
    sensed: DVec3,
    /// ψ.
    normal_error: f64,
    /// Z, of the face, and its plane `Z·x = p`, model frame.
    known: DVec3,
    offset: f64,
    /// C, less the tip's radius along the sensed normal, world frame.
    point: DVec3,
    /// ε.
    bound: f64,
}

impl ThesisPose {
    /// Of an assignment; `None` if a contact is not on a face, has no normal, or if no three faces are independent.
    pub(crate) fn new(case: &Case, assignment: &[Feature]) -> Option<Self> {
        let matches: Option<Vec<Match>> = assignment
            .iter()
            .enumerate()
            .map(|(contact, feature)| one_match(case, contact, *feature))
            .collect();
        let matches = matches?;
        let [l, m, n] = best_triple(&matches)?;
        let pair = best_pair(&matches)?;
        let rotation = fitted(&matches);
        let radius = radius(pair, rotation);
        // A T = h: each row is the normal of a placed face.
        let triple = [&matches[l], &matches[m], &matches[n]];
        let inverse = DMat3::from_cols_array_2d(&triple.map(|one| (rotation * one.known).to_array()))
            .transpose()
            .inverse();
        let height = |one: &Match| (rotation * one.known).dot(one.point) - one.offset;
        let translation = inverse * DVec3::from_array(triple.map(height));
        let bounds = DVec3::from_array(triple.map(|one| one.bound));
        let corners = (0..8).map(|bits| {
            let sign = |bit: u32| if bits >> bit & 1 == 1 { -1.0 } else { 1.0 };
            inverse * (bounds * dvec3(sign(0), sign(1), sign(2)))
        });
        let translation_error = corners.map(DVec3::length).fold(0.0, f64::max);
        let offset = |one: &Match| height(one) - (rotation * one.known).dot(translation);
        let strips = matches.iter().map(|one| (rotation * one.known, offset(one), one.bound));
        Some(Self {
            first_rotation: by_axis_and_angle(pair),
            rotation,
            residual_rotation: (2.0 * radius).min(PI),
            rotation_error: largest_turn(&matches, pair, rotation, radius),
            translation,
            translation_error,
            translation_region: region(strips, translation, translation_error),
        })
    }

    /// `world_from_model`, nominal: rotation and translation.
    #[must_use]
    pub fn world_from_model(&self) -> Pose {
        Pose { rotation: self.rotation, translation: self.translation }
    }
}

fn one_match(case: &Case, contact: usize, feature: Feature) -> Option<Match> {
    let Feature::Face(number) = feature else { return None };
    let face = case.model.faces.get(number as usize)?;
    let datum = &case.data[contact];
    let (sensed, normal_error) = datum.reading.sensed?;
    Some(Match {
        sensed,
        normal_error,
        known: face.normal,
        offset: face.offset,
        point: case.pivot + datum.lever - datum.radius * sensed,
        bound: datum.bound,
    })
}

/// The two data whose sensed normals have the dot product of the smallest magnitude (2.2.3.1).
fn best_pair(matches: &[Match]) -> Option<[&Match; 2]> {
    let pairs = (0..matches.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    let slant = |[i, j]: [usize; 2]| matches[i].sensed.dot(matches[j].sensed).abs();
    let best = pairs.min_by(|a, b| slant(*a).total_cmp(&slant(*b)))?;
    Some(best.map(|k| &matches[k]))
}

/// The three data whose faces' normals have the largest triple product (2.2.3.1).
fn best_triple(matches: &[Match]) -> Option<[usize; 3]> {
    let count = matches.len();
    let triples = (0..count).flat_map(|n| (0..n).flat_map(move |m| (0..m).map(move |l| [l, m, n])));
    let volume = |[l, m, n]: [usize; 3]| matches[l].known.dot(matches[m].known.cross(matches[n].known)).abs();
    triples.max_by(|a, b| volume(*a).total_cmp(&volume(*b))).filter(|best| volume(*best) > INDEPENDENT)
}

/// Z to N: the axis `(Z_m − N_i) × (Z_n − N_j)` (erratum 21), and the angle by its sine and cosine (errata 23 to 26) from
/// the datum that is farther from the axis. The matrix is erratum 27's.
fn by_axis_and_angle([first, second]: [&Match; 2]) -> Option<DMat3> {
    let across = (first.known - first.sensed).cross(second.known - second.sensed);
    let axis = (across.length() > INDEPENDENT).then(|| across / across.length())?;
    let lever = |one: &Match| 1.0 - axis.dot(one.sensed) * axis.dot(one.known);
    let one = if lever(first) >= lever(second) { first } else { second };
    let sine = axis.cross(one.known).dot(one.sensed) / lever(one);
    let cosine = 1.0 - (1.0 - one.sensed.dot(one.known)) / lever(one);
    Some(DMat3::from_axis_angle(axis, sine.atan2(cosine)))
}

/// The rotation with the largest `Σ N·RZ` (Kabsch 1976; by quaternions, Horn 1987): its quaternion is the eigenvector of the
/// largest eigenvalue of a symmetric matrix.
fn fitted(matches: &[Match]) -> DMat3 {
    let mut sums = [DVec3::ZERO; 3];
    for one in matches {
        for (sum, axis) in sums.iter_mut().zip(DVec3::AXES) {
            *sum += one.known.dot(axis) * one.sensed;
        }
    }
    let [x, y, z] = sums;
    let skew = dvec3(y.z - z.y, z.x - x.z, x.y - y.x);
    // Above all eigenvalues' magnitudes, so that the largest one is that of the largest magnitude.
    let shift = matches.len() as f64;
    let mut power = DMat4::from_cols(
        DVec4::new(x.x + y.y + z.z, skew.x, skew.y, skew.z),
        DVec4::new(skew.x, x.x - y.y - z.z, x.y + y.x, x.z + z.x),
        DVec4::new(skew.y, x.y + y.x, y.y - x.x - z.z, y.z + z.y),
        DVec4::new(skew.z, x.z + z.x, y.z + z.y, z.z - x.x - y.y),
    ) + DMat4::from_diagonal(DVec4::splat(shift));
    for _ in 0..50 {
        let trace: f64 = (0..4).map(|k| power.col(k)[k]).sum();
        power *= 1.0 / trace;
        power *= power;
    }
    let columns = (0..4).map(|k| power.col(k));
    let longest = columns.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec4::X);
    DMat3::from_quat(DQuat::from_xyzw(longest.y, longest.z, longest.w, longest.x).normalize())
}

/// Φ: no rotation that leaves both normals within their errors is further from `rotation`, radians, at most π (errata 46,
/// 47): `Φ = 2 asin(min(1, sin((ψ + e)/2) / sin(θ/2)))`, where θ is the acute angle between the lines of the faces' normals,
/// and e the larger of what the rotation misses the sensed ones by.
fn radius(pair: [&Match; 2], rotation: DMat3) -> f64 {
    let [first, second] = pair;
    let apart = angle(first.known, second.known);
    let acute = apart.min(PI - apart);
    let miss = |one: &Match| one.normal_error + angle(rotation * one.known, one.sensed);
    let worst = miss(first).max(miss(second)).min(PI);
    2.0 * ((0.5 * worst).sin() / (0.5 * acute).sin()).min(1.0).asin()
}

/// Eq. 2.5: the largest over roll and pitch of the smallest turn that takes a normal out of its cap (erratum 50), about the
/// middle of the lines of two sensed normals.
///
/// Any rotation within Φ of the nominal one is a roll and a pitch by no more than Φ, then such a turn: `cos φ cos θ` is the
/// cosine of what the axis is tilted by. They are taken in cells, the caps widened by what a cell moves a normal (erratum 51).
fn largest_turn(matches: &[Match], pair: [&Match; 2], rotation: DMat3, radius: f64) -> f64 {
    if radius >= FRAC_PI_2 {
        return PI;
    }
    let [first, second] = pair.map(|one| one.sensed);
    let second = if first.dot(second) < 0.0 { -second } else { second };
    let z = (first + second).normalize_or(first);
    let x = (first - z.dot(first) * z).normalize_or(z.any_orthonormal_vector());
    let aligned = DMat3::from_cols(x, z.cross(x), z).transpose();
    let half = radius / f64::from(2 * NUM_TILTS + 1);
    let tilts = || (-NUM_TILTS..=NUM_TILTS).map(|k| 2.0 * half * f64::from(k));
    let of_tilt = |pitch: f64, roll: f64| {
        let tilt = DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll) * aligned * rotation;
        let (mut low, mut high) = (-PI, PI);
        for one in matches {
            let (from, to) = turns(aligned * one.sensed, tilt * one.known, one.normal_error + 2.0 * half)?;
            (low, high) = (low.max(from), high.min(to));
        }
        (low <= high).then(|| high.max(-low))
    };
    let all = tilts().flat_map(|pitch| tilts().filter_map(move |roll| of_tilt(pitch, roll)));
    all.fold(0.0, f64::max)
}

/// Turns about the Z axis that take `normal` into the cap around `sensed` (eq. 2.4, erratum 49): an interval, or all;
/// `None`: none does.
fn turns(sensed: DVec3, normal: DVec3, error: f64) -> Option<(f64, f64)> {
    let across = sensed.truncate().length() * normal.truncate().length();
    let reach = error.min(PI).cos() - sensed.z * normal.z;
    if reach > across {
        return None;
    }
    if reach <= -across {
        return Some((-PI, PI));
    }
    let half = (reach / across).acos();
    let middle = normal.truncate().angle_to(sensed.truncate());
    // An interval that runs over half a turn leaves turns of either sign.
    if middle.abs() + half > PI { Some((-PI, PI)) } else { Some((middle - half, middle + half)) }
}

/// The corners of what lies between all pairs of planes `normal·d = offset ± bound` about the nominal translation. The
/// planes of three of them leave nothing farther than `reach`.
fn region(strips: impl Iterator<Item = (DVec3, f64, f64)>, nominal: DVec3, reach: f64) -> Vec<DVec3> {
    let reach = 1.001 * reach;
    let mut polytope = Polytope::boxed([-reach; 3], [reach; 3]);
    for (normal, offset, bound) in strips {
        let scale = 2.0 * reach + offset.abs() + bound;
        polytope.cut(&HalfSpace { normal: normal.to_array(), offset: offset + bound }, scale);
        polytope.cut(&HalfSpace { normal: (-normal).to_array(), offset: bound - offset }, scale);
    }
    polytope.corners().map(|corner| nominal + DVec3::from_array(corner)).collect()
}
