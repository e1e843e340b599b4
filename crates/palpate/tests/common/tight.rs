//! Random problems, and how much larger the bounds are than what dense sampling finds.

#![allow(dead_code, reason = "each file uses its own part")]

use std::sync::Arc;

use fastrand::Rng;
use glam::DVec2;
use palpate::plane::{Model, PoseSet};
use palpate::{Feature, Hypothesis, Settings, recognize};

use crate::common::{Noise, Problem, comb, contacts, star, uniform};
use crate::parts;
use crate::sampled::{Rotations, TrueSet, width};

/// What is valid within it counts as valid: the true set has its bounds enlarged by it.
const TOLERANCE: f64 = 1e-6;

/// Interpretations of a hypothesis that are sampled; those with more are left out.
const MOST_INTERPRETATIONS: usize = 40;

/// A bound over what sampling found: 1 is exact, less than 1 is wrong.
#[derive(Debug, Clone, Copy)]
pub struct Ratios {
    pub rotation: f64,
    pub excursion: f64,
}

/// What one problem gave.
pub struct Measured {
    /// Of the true interpretation, or of the one that a symmetry of the part makes of it; `None`: nothing sampled.
    pub interpretation: Option<Ratios>,
    /// Of the hypothesis that holds it; `None`: it has too many interpretations.
    pub hypothesis: Option<Ratios>,
}

/// Two to five contacts on a bundled part, a star or a comb; position errors 0.01 to 4, normal errors 0.1° to 15°.
pub fn problem(seed: u64) -> Problem {
    let mut random = Rng::with_seed(seed);
    let model: Arc<Model> = match random.u8(0..4) {
        0 => star(&mut random, 9),
        1 => comb(&mut random, 4),
        _ => parts::part(parts::OBJECTS[random.usize(0..6)]),
    };
    let noise = Noise {
        position_error: 10_f64.powf(uniform(&mut random, -2.0, 0.6)),
        normal_error: Some(10_f64.powf(uniform(&mut random, -1.0, 1.176)).to_radians()),
        tip_radius: 0.0,
    };
    let count = random.usize(2..6);
    contacts(&mut random, model, count, &noise)
}

/// The bounds on the rotation, and on the way of the vertex farthest from the contacts, over the sampled ones.
pub fn measure(problem: &Problem) -> Measured {
    let models = std::slice::from_ref(&problem.model);
    let found = recognize(models, &problem.evidence, &Settings::default()).expect("a well-formed problem");
    let point = farthest_vertex(problem);
    let images: Vec<Vec<Feature>> =
        problem.model.symmetries.iter().map(|symmetry| symmetry.features(&problem.assignment)).collect();
    let holds = |one: &&Hypothesis| one.poses.contains(problem.world_from_model);
    let hypothesis = found.hypotheses.iter().find(holds).expect("the true pose is never lost");
    let interpretations: Vec<_> = hypothesis.interpretations().take(MOST_INTERPRETATIONS + 1).collect();
    let own = interpretations.iter().find(|one| images.contains(&one.assignment));
    let sampled = |assignment: &[Feature], poses: &PoseSet| sample(problem, assignment, poses, point);
    let interpretation = own.and_then(|one| {
        let (rotations, places) = sampled(&one.assignment, &one.poses)?;
        Some(ratios(&one.poses, rotations, &places, point))
    });
    let all: Option<Vec<_>> = (interpretations.len() <= MOST_INTERPRETATIONS)
        .then(|| interpretations.iter().map(|one| sampled(&one.assignment, &one.poses)).collect())
        .flatten();
    let hypothesis = all.filter(|all| !all.is_empty()).map(|all| {
        // Interpretations joined over a symmetry lie elsewhere on the circle: their bound is of the set as it is.
        let anchor = all[0].0.low;
        let near = |angle: f64| anchor + wrap(angle - anchor);
        let low = all.iter().map(|(rotations, _)| near(rotations.low)).fold(f64::INFINITY, f64::min);
        let high = all
            .iter()
            .map(|(rotations, _)| near(rotations.low) + rotations.width())
            .fold(f64::NEG_INFINITY, f64::max);
        let places: Vec<DVec2> = all.into_iter().flat_map(|(_, places)| places).collect();
        ratios(&hypothesis.poses, Rotations { low, high }, &places, point)
    });
    Measured { interpretation, hypothesis }
}

fn wrap(angle: f64) -> f64 {
    (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

fn sample(
    problem: &Problem,
    assignment: &[Feature],
    poses: &PoseSet,
    point: DVec2,
) -> Option<(Rotations, Vec<DVec2>)> {
    let mut truth = TrueSet::new(problem, assignment, TOLERANCE)?;
    // Nothing valid lies outside of the bound (another test's law); sampling looks a little further all the same.
    let reach = 1.001 * poses.rotation_bound() + 1e-9;
    let rotations = truth.rotations(poses.witness().angle(), reach)?;
    Some((rotations, truth.places(rotations, point)))
}

fn ratios(poses: &PoseSet, rotations: Rotations, places: &[DVec2], point: DVec2) -> Ratios {
    Ratios {
        rotation: poses.rotation_bound() / rotations.width(),
        excursion: poses.excursion(point) / width(places),
    }
}

fn farthest_vertex(problem: &Problem) -> DVec2 {
    let inverse = problem.world_from_model.inverse();
    let centers = problem.evidence.contacts.iter().map(|contact| inverse.apply(contact.center));
    let middle = centers.sum::<DVec2>() / problem.evidence.contacts.len() as f64;
    let points = problem.model.vertices.iter().map(|vertex| vertex.point);
    points.max_by(|a, b| a.distance(middle).total_cmp(&b.distance(middle))).expect("a part has vertices")
}
