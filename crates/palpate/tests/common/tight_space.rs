//! Random problems in space, and how much larger the bounds are than what sampling of the true set finds.

#![allow(dead_code, reason = "each file uses its own part")]

use fastrand::Rng;
use glam::DVec3;
use palpate::space::{Pose, PoseSet};
use palpate::{Feature, Hypothesis, Settings, recognize};

use crate::common::{Noise, uniform};
use crate::sampled_space::{Measure, TrueSet, diameter};
use crate::solids::{Problem, contacts, solid};

/// What is valid within it counts as valid: the true set has its bounds enlarged by it.
const TOLERANCE: f64 = 1e-6;

/// Interpretations of a hypothesis that are sampled; those with more are left out.
const MOST_INTERPRETATIONS: usize = 40;

/// A bound over what sampling found: 1 is exact, less than 1 is wrong.
#[derive(Debug, Clone, Copy)]
pub struct Ratios {
    pub rotation: f64,
    pub excursion: f64,
    /// What sampling found of the rotation, radians.
    pub turn: f64,
}

/// What one problem gave.
pub struct Measured {
    /// Of the true interpretation, or of the one that a symmetry of the part makes of it; `None`: nothing sampled.
    pub interpretation: Option<Ratios>,
    /// Of the hypothesis that holds it; `None`: it has too many interpretations.
    pub hypothesis: Option<Ratios>,
}

/// Three to eight contacts on a random solid; position errors 0.05 to 2, normal errors 0.5° to 8°.
pub fn problem(seed: u64) -> Problem {
    let mut random = Rng::with_seed(seed);
    let model = solid(&mut random);
    let noise = Noise {
        position_error: 10_f64.powf(uniform(&mut random, 0.05_f64.log10(), 2_f64.log10())),
        normal_error: Some(uniform(&mut random, 0.5, 8.0).to_radians()),
        tip_radius: 0.0,
    };
    let count = random.usize(3..9);
    contacts(&mut random, model, count, &noise)
}

/// The bounds on the rotation, and on the way of the vertex farthest from the contacts, over the sampled ones.
pub fn measure(problem: &Problem) -> Measured {
    let models = std::slice::from_ref(&problem.model);
    let found = recognize(models, &problem.evidence, &Settings::default()).expect("a well-formed problem");
    let point = farthest_vertex(problem);
    let images: Vec<Vec<Feature>> =
        problem.model.symmetries.iter().map(|symmetry| symmetry.features(&problem.assignment)).collect();
    let holds = |one: &&Hypothesis<DVec3>| one.poses.contains(problem.world_from_model);
    let hypothesis = found.hypotheses.iter().find(holds).expect("the true pose is never lost");
    let interpretations: Vec<_> = hypothesis.interpretations().take(MOST_INTERPRETATIONS + 1).collect();
    let own = interpretations.iter().find(|one| images.contains(&one.assignment));
    let interpretation = own.and_then(|one| {
        let truth = sampled(problem, &one.assignment, &one.poses, one.poses.witness(), point)?;
        Some(ratios(&one.poses, &[truth], point))
    });
    // Interpretations joined over a symmetry are sampled where the hypothesis has them.
    let near = hypothesis.poses.witness();
    let all: Option<Vec<_>> = (interpretations.len() <= MOST_INTERPRETATIONS)
        .then(|| {
            interpretations
                .iter()
                .map(|one| sampled(problem, &one.assignment, &one.poses, near, point))
                .collect()
        })
        .flatten();
    let hypothesis = all.filter(|all| !all.is_empty()).map(|all| ratios(&hypothesis.poses, &all, point));
    Measured { interpretation, hypothesis }
}

/// The true set of an assignment, or of the image under a symmetry that has the witness nearest to `near`, and poses of
/// it; `None`: none of the starts is valid.
fn sampled(
    problem: &Problem,
    assignment: &[Feature],
    poses: &PoseSet,
    near: Pose,
    point: DVec3,
) -> Option<(TrueSet, Vec<Pose>)> {
    let witness = poses.witness();
    let moved = |pose: Pose, motion: Pose| pose.compose(motion.inverse());
    let away = |motion: Pose| Measure::Rotation.apart(moved(witness, motion), near);
    let symmetries = problem.model.symmetries.iter();
    let image = symmetries.min_by(|a, b| away(a.motion).total_cmp(&away(b.motion)))?;
    let mut starts = poses.sample(4, 1);
    starts.extend([witness, poses.largest_slack()]);
    let starts: Vec<Pose> = starts.into_iter().map(|start| moved(start, image.motion)).collect();
    let truth = TrueSet::new(problem, &image.features(assignment), TOLERANCE)?;
    let poses = truth.spread(&starts, &[Measure::Rotation, Measure::Place(point)], 1);
    (!poses.is_empty()).then_some((truth, poses))
}

fn ratios(poses: &PoseSet, sets: &[(TrueSet, Vec<Pose>)], point: DVec3) -> Ratios {
    let turn = diameter(sets, Measure::Rotation);
    Ratios {
        rotation: poses.rotation_bound() / turn,
        excursion: poses.excursion(point) / diameter(sets, Measure::Place(point)),
        turn,
    }
}

pub fn farthest_vertex(problem: &Problem) -> DVec3 {
    let inverse = problem.world_from_model.inverse();
    let centers = problem.evidence.contacts.iter().map(|contact| inverse.apply(contact.center));
    let middle = centers.sum::<DVec3>() / problem.evidence.contacts.len() as f64;
    let points = problem.model.vertices.iter().map(|vertex| vertex.point);
    points.max_by(|a, b| a.distance(middle).total_cmp(&b.distance(middle))).expect("a part has vertices")
}
