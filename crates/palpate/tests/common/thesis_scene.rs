//! True interpretations in space, the thesis's view of them, and all their poses, sampled.

#![allow(dead_code, reason = "each file uses its own part")]

use std::ops::Range;

use fastrand::Rng;
use glam::{DMat3, DVec3};
use palpate::space::{Pose, ThesisPose};
use palpate::{Contact, Hypothesis, Interpretation, Normal, Settings, recognize};

use crate::common::{Noise, uniform};
use crate::sampled_space::{Measure, TrueSet, diameter};
use crate::solids::{Problem, contacts, direction, solid};

/// Places within the thesis's region of translations that are tried for a valid one.
const NUM_TRIED: usize = 400;

pub struct Scene {
    pub problem: Problem,
    pub one: Interpretation<DVec3>,
    pub thesis: ThesisPose,
    pub truth: TrueSet,
    /// Valid ones, at the ends of the set among them.
    pub poses: Vec<Pose>,
}

/// So many contacts on a random solid, position errors 0.05 to 2, normal errors 0.5° to 8°, evenly spread within their
/// bounds. Nothing where the thesis's formulas are not defined: no three faces independent.
pub fn scene(seed: u64, counts: Range<usize>) -> Option<Scene> {
    let mut random = Rng::with_seed(seed);
    let model = solid(&mut random);
    let position_error = 10_f64.powf(uniform(&mut random, 0.05_f64.log10(), 2_f64.log10()));
    let normal_error = uniform(&mut random, 0.5, 8.0).to_radians();
    let exact = Noise { position_error: 0.0, normal_error: Some(0.0), tip_radius: 0.0 };
    let count = random.usize(counts);
    let mut problem = contacts(&mut random, model, count, &exact);
    for contact in &mut problem.evidence.contacts {
        *contact = disturbed(&mut random, *contact, position_error, normal_error);
    }
    of_problem(problem)
}

/// The true interpretation of a problem.
pub fn of_problem(problem: Problem) -> Option<Scene> {
    let models = std::slice::from_ref(&problem.model);
    let found = recognize(models, &problem.evidence, &Settings::default()).expect("a well-formed problem");
    let images: Vec<_> =
        problem.model.symmetries.iter().map(|symmetry| symmetry.features(&problem.assignment)).collect();
    let mut all = found.hypotheses.iter().flat_map(Hypothesis::interpretations);
    let one = all.find(|one| images.contains(&one.assignment)).expect("the true interpretation");
    let thesis = one.poses.thesis_pose()?;
    let truth = TrueSet::new(&problem, &one.assignment, 0.0)?;
    let starts = [one.poses.witness(), one.poses.largest_slack(), thesis.world_from_model()];
    let poses = truth.spread(&starts, &[Measure::Rotation], 1);
    (!poses.is_empty()).then_some(Scene { problem, one, thesis, truth, poses })
}

/// An exact contact read with errors that are evenly spread within their bounds.
fn disturbed(
    random: &mut Rng,
    exact: Contact<DVec3>,
    position_error: f64,
    normal_error: f64,
) -> Contact<DVec3> {
    let shift = position_error * random.f64().cbrt() * direction(random);
    let known = exact.normal.expect("asked for").direction;
    let axis = known.cross(direction(random)).normalize_or(known.any_orthonormal_vector());
    let sensed = DMat3::from_axis_angle(axis, normal_error * random.f64().sqrt()) * known;
    let normal = Normal { direction: sensed, error: normal_error };
    Contact { center: exact.center + shift, position_error, normal: Some(normal), ..exact }
}

impl Scene {
    /// The extent of the rotations that were found.
    pub fn rotations(&self) -> f64 {
        diameter(&[(self.truth.clone(), self.poses.clone())], Measure::Rotation)
    }

    /// At a rotation, the pose that puts the three contacts whose faces are nearest to right angles on their planes.
    pub fn pose_at(&self, rotation: DMat3) -> Pose {
        let face = |k: usize| &self.problem.model.faces[self.one.assignment[k].number() as usize];
        let count = self.one.assignment.len();
        let triples = (0..count).flat_map(|n| (0..n).flat_map(move |m| (0..m).map(move |l| [l, m, n])));
        let volume = |t: [usize; 3]| face(t[0]).normal.dot(face(t[1]).normal.cross(face(t[2]).normal));
        let best = triples.max_by(|a, b| volume(*a).abs().total_cmp(&volume(*b).abs()));
        let [l, m, n] = best.expect("three contacts at least");
        let placed = |k: usize| rotation * face(k).normal;
        let height = |k: usize| placed(k).dot(self.problem.evidence.contacts[k].center) - face(k).offset;
        // The thesis's solution for T (2.2.3.1).
        let sum = height(l) * placed(m).cross(placed(n))
            + height(m) * placed(n).cross(placed(l))
            + height(n) * placed(l).cross(placed(m));
        Pose { rotation, translation: sum / volume([l, m, n]) }
    }

    /// The largest distance from the nominal translation to a valid one at the nominal rotation; `None`: none was found.
    pub fn farthest_translation(&self, nominal: Pose) -> Option<f64> {
        let mut random = Rng::with_seed(1);
        let corners = &self.thesis.translation_region;
        let mut mixed = || {
            let shares: Vec<f64> = corners.iter().map(|_| -random.f64().ln()).collect();
            let sum: f64 = shares.iter().sum();
            corners.iter().zip(&shares).map(|(corner, share)| *share / sum * *corner).sum::<DVec3>()
        };
        let tried = (0..if corners.is_empty() { 0 } else { NUM_TRIED }).map(|_| mixed());
        let poses = tried.chain([nominal.translation]).map(|translation| Pose { translation, ..nominal });
        let valid: Vec<Pose> = poses.filter(|pose| self.truth.contains(*pose)).collect();
        let place = Measure::Place(DVec3::ZERO);
        (!valid.is_empty()).then(|| self.truth.at_one_rotation().reach(&valid, place, nominal))
    }
}
