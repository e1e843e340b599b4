//! The pose and the bounds of the thesis (2.2.3, 2.4), with the corrections of MATH 1.2.
//!
//! They answer for a nominal pose, not for the set of all poses: see `docs/theory.md` for where they are tight, where
//! loose and where wrong. Nothing here decides what is valid.

use glam::DVec2;

use super::arc::{Arc, wrap};
use super::case::Case;
use super::pose::Pose;
use super::pose_set::PoseSet;
use crate::feature::Feature;

/// The thesis's description of one interpretation of faces with sensed normals.
#[derive(Debug, Clone, PartialEq)]
pub struct ThesisPose {
    /// θ: the rotation that takes the first face's normal to its sensed one (2.4).
    pub first_rotation: f64,
    /// φ: the refined nominal rotation, the middle of all that the normals leave (eq. 2.2, erratum 40).
    pub rotation: f64,
    /// γ: the width of the rotations that the normals leave (2.4.1, erratum 39). Negative: they contradict each other.
    pub residual_rotation: f64,
    /// The nominal translation at φ, from the pair of faces nearest to a right angle (eq. 2.1, erratum 37).
    pub translation: DVec2,
    /// `E_T`: the half diagonal of that pair's rhombus of translations (2.4.2, erratum 43).
    pub translation_error: f64,
    /// The translations at φ that keep every contact within its bound of its face's line (figure 2.6), world frame,
    /// counter-clockwise. Empty: none does.
    pub translation_region: Vec<DVec2>,
    low: Pose,
    high: Pose,
}

/// A contact on a face: what the formulas need of it.
struct Match {
    /// ν, the angle of the sensed normal.
    sensed: f64,
    /// δ.
    normal_error: f64,
    /// ζ, the angle of the face's normal.
    known: f64,
    /// The face's first end and unit normal, model frame.
    start: DVec2,
    normal: DVec2,
    /// C, less the tip's radius along the sensed normal, world frame.
    point: DVec2,
    /// ε.
    bound: f64,
}

impl ThesisPose {
    /// Of an assignment; `None` if a contact is not on a face, has no normal, or if all faces are parallel.
    pub(crate) fn new(case: &Case, assignment: &[Feature]) -> Option<Self> {
        let matches: Option<Vec<Match>> = assignment
            .iter()
            .enumerate()
            .map(|(contact, feature)| one_match(case, contact, *feature))
            .collect();
        let matches = matches?;
        let first = matches.first()?;
        let first_rotation = wrap(first.sensed - first.known);
        // Δ, sensed less model, about θ: the true rotation is within δ of each.
        let deviations =
            matches.iter().map(|one| (wrap(one.sensed - one.known - first_rotation), one.normal_error));
        let (low, high) = deviations
            .fold((f64::NEG_INFINITY, f64::INFINITY), |(low, high), (deviation, error)| {
                (low.max(deviation - error), high.min(deviation + error))
            });
        let rotation = first_rotation + 0.5 * (low + high);
        let (i, j) = steepest_pair(&matches)?;
        let at = |angle: f64| Pose::new(angle, translation(&matches[i], &matches[j], angle));
        let sine = matches[i].normal.perp_dot(matches[j].normal).abs();
        let cosine = matches[i].normal.dot(matches[j].normal).abs();
        // ω is the acute angle between the lines; sin²(ω/2) = (1 − cos ω)/2, by the half that does not cancel.
        let half_sine = sine / (2.0 * (1.0 + cosine)).sqrt();
        let error = matches[i].bound.max(matches[j].bound) / half_sine;
        Some(Self {
            first_rotation,
            rotation: wrap(rotation),
            residual_rotation: high - low,
            translation: at(rotation).translation,
            translation_error: error,
            translation_region: region(&matches, rotation, at(rotation).translation, 2.0 * error),
            low: at(first_rotation + low),
            high: at(first_rotation + high),
        })
    }

    /// `world_from_model`, nominal: φ and the nominal translation.
    #[must_use]
    pub fn world_from_model(&self) -> Pose {
        Pose::new(self.rotation, self.translation)
    }

    /// `E_q`: how far the model point moves between the two extreme rotations, each with its own nominal translation
    /// (eq. 2.3). A chord, not a bound (erratum 41).
    #[must_use]
    pub fn excursion(&self, point_model: DVec2) -> f64 {
        self.low.apply(point_model).distance(self.high.apply(point_model))
    }
}

fn one_match(case: &Case, contact: usize, feature: Feature) -> Option<Match> {
    let Feature::Face(number) = feature else { return None };
    let face = case.model.faces.get(number as usize)?;
    let datum = &case.data[contact];
    let sensed: Arc = datum.sensed()?;
    let outward = DVec2::from_angle(sensed.middle());
    Some(Match {
        sensed: sensed.middle(),
        normal_error: sensed.half_width(),
        known: face.normal.to_angle(),
        start: face.start,
        normal: face.normal,
        point: case.pivot + datum.lever - datum.radius * outward,
        bound: datum.bound,
    })
}

/// The pair of faces nearest to a right angle.
fn steepest_pair(matches: &[Match]) -> Option<(usize, usize)> {
    let pairs = (0..matches.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let sine = |(i, j): (usize, usize)| matches[i].normal.perp_dot(matches[j].normal).abs();
    pairs.max_by(|a, b| sine(*a).total_cmp(&sine(*b))).filter(|pair| sine(*pair) > 1e-9)
}

/// The translation that puts both contacts on the lines of their faces at `angle` (eq. 2.1, erratum 37).
fn translation(first: &Match, second: &Match, angle: f64) -> DVec2 {
    let turn = DVec2::from_angle(angle);
    let [n1, n2] = [first, second].map(|one| turn.rotate(one.normal));
    let [h1, h2] =
        [(n1, first), (n2, second)].map(|(normal, one)| normal.dot(one.point - turn.rotate(one.start)));
    // n1·T = h1, n2·T = h2
    DVec2::new(h1 * n2.y - h2 * n1.y, h2 * n1.x - h1 * n2.x) / n1.perp_dot(n2)
}

/// Strips `|n·(C − T) − p| ≤ ε` intersected, within `reach` of the nominal translation: twice the half diagonal of the
/// rhombus of two of them.
fn region(matches: &[Match], angle: f64, nominal: DVec2, reach: f64) -> Vec<DVec2> {
    let turn = DVec2::from_angle(angle);
    let signs = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut corners: Vec<DVec2> = signs.map(|(x, y)| nominal + reach * DVec2::new(x, y)).into();
    for one in matches {
        let normal = turn.rotate(one.normal);
        let height = normal.dot(one.point - turn.rotate(one.start));
        corners = super::region::clip(&corners, normal, height + one.bound);
        corners = super::region::clip(&corners, -normal, one.bound - height);
    }
    corners
}

/// Where the thesis's search places a hypothesis (3.3.1).
#[derive(Debug)]
pub(crate) struct Placement {
    /// The nominal pose.
    pub nominal: Pose,
    /// At the least and the largest rotation, each with its own nominal translation.
    pub extremes: [Pose; 2],
    /// Half the range of rotations.
    pub half: f64,
    /// Faces that a contact is assigned to.
    pub sensed: Vec<bool>,
}

impl Placement {
    /// Of the first interpretation; where the thesis's formulas are not defined, of the `views`: the first of them, and
    /// those turned farthest from it either way.
    pub fn new(poses: &PoseSet, views: &[Pose]) -> Self {
        let mut sensed = vec![false; poses.model().faces.len()];
        let assignment = poses.assignments().next().unwrap_or_default();
        for feature in &assignment {
            if let Feature::Face(number) = feature {
                sensed[*number as usize] = true;
            }
        }
        if let Some(thesis) = poses.thesis_pose() {
            let half = 0.5 * thesis.residual_rotation.max(0.0);
            let extremes = [thesis.low, thesis.high];
            return Self { nominal: thesis.world_from_model(), extremes, half, sensed };
        }
        let nominal = views.first().copied().unwrap_or(Pose::IDENTITY);
        let turned = |pose: &Pose| wrap(pose.angle() - nominal.angle());
        let compare = |a: &&Pose, b: &&Pose| turned(a).total_cmp(&turned(b));
        let low = views.iter().min_by(compare).copied().unwrap_or(nominal);
        let high = views.iter().max_by(compare).copied().unwrap_or(nominal);
        Self { nominal, extremes: [low, high], half: 0.5 * (turned(&high) - turned(&low)), sensed }
    }
}
