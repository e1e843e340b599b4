//! Nothing true is lost, nothing false is kept.

mod common;

use common::{Noise, Problem, comb, contacts, star, uniform};
use fastrand::Rng;
use glam::DVec2;
use palpate::plane::Pose;
use palpate::{Feature, Hypothesis, Recognition, Settings, recognize};

fn random_problem(seed: u64) -> Problem {
    let mut random = Rng::with_seed(seed);
    let model = if random.bool() {
        let count = random.usize(3..14);
        star(&mut random, count)
    } else {
        let count = random.usize(1..6);
        comb(&mut random, count)
    };
    let noise = Noise {
        position_error: 10_f64.powf(uniform(&mut random, -2.0, 0.6)),
        normal_error: Some(10_f64.powf(uniform(&mut random, -1.0, 1.176)).to_radians()),
        tip_radius: if random.u8(0..3) == 0 { 1.5 } else { 0.0 },
    };
    let count = random.usize(2..9);
    contacts(&mut random, model, count, &noise)
}

/// The worst excess of a pose over the bounds for an assignment, by plain geometry.
fn worst_excess(problem: &Problem, assignment: &[Feature], pose: Pose) -> (f64, f64) {
    let (mut length, mut angle) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for (contact, feature) in problem.evidence.contacts.iter().zip(assignment) {
        let Feature::Face(number) = feature else { continue };
        let face = &problem.model.faces[*number as usize];
        let offset = contact.tip_radius * face.normal;
        let (a, b) = (pose.apply(face.start + offset), pose.apply(face.end + offset));
        let t = ((contact.center - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        length = length.max(contact.center.distance(a.lerp(b, t)) - contact.position_error);
        let normal = contact.normal.expect("every contact has a normal");
        let turned = pose.rotation.rotate(face.normal).angle_to(normal.direction).abs();
        angle = angle.max(turned - normal.error);
    }
    (length, angle)
}

fn explained(problem: &Problem) -> Recognition {
    recognize(std::slice::from_ref(&problem.model), &problem.evidence, &Settings::default())
        .expect("a valid problem")
}

#[test]
fn the_truth_is_never_lost_and_every_pose_returned_is_valid() {
    for seed in 0..1500 {
        let problem = random_problem(seed);
        let found = explained(&problem);
        let tolerance = 1e-6 * problem.model.size;
        assert!(found.complete);
        assert!(
            found.hypotheses.iter().any(|one| one.poses.contains(problem.world_from_model)),
            "seed {seed}: true pose lost"
        );
        let symmetries = problem.model.symmetries.iter();
        let truth: Vec<_> = symmetries.map(|symmetry| symmetry.features(&problem.assignment)).collect();
        let listed: Vec<_> = found.hypotheses.iter().flat_map(Hypothesis::interpretations).collect();
        assert!(listed.iter().any(|one| truth.contains(&one.assignment)), "seed {seed}: assignment lost");
        for one in &listed {
            let returned = [one.poses.witness(), one.poses.largest_slack()];
            for pose in one.poses.sample(5, seed).into_iter().chain(returned) {
                let (length, angle) = worst_excess(&problem, &one.assignment, pose);
                assert!(length <= tolerance && angle <= 1e-6, "seed {seed}: {length} {angle}");
                assert!(one.poses.contains(pose), "seed {seed}: own pose not contained");
            }
        }
    }
}

#[test]
fn samples_spread_over_the_set() {
    for seed in 0..200 {
        let problem = random_problem(seed);
        for one in explained(&problem).hypotheses.iter().filter(|one| !one.marginal()) {
            let angles = one.poses.sample(500, seed).into_iter().map(Pose::angle);
            let middle = one.poses.witness().angle();
            let turns = angles.map(|angle| DVec2::from_angle(angle - middle).to_angle());
            let (low, high) = turns.fold((f64::MAX, f64::MIN), |(low, high), t| (low.min(t), high.max(t)));
            let share = (high - low) / one.poses.rotation_bound();
            // Short of a half only where the set is thin and bent.
            assert!(share > 0.5 || one.poses.rotation_bound() < 0.01, "seed {seed}: {share}");
        }
    }
}

#[test]
fn a_200_gon_with_eight_contacts_has_few_hypotheses() {
    for seed in 0..8 {
        let mut random = Rng::with_seed(seed);
        let noise = Noise { position_error: 4.0, normal_error: Some(15_f64.to_radians()), tip_radius: 0.0 };
        let problem = contacts(&mut random, common::regular(200, 50.0), 8, &noise);
        let found = explained(&problem);
        assert!(found.complete);
        // Mostly one; where the contacts hardly agree, slivers beside the main set have interpretations of their own.
        assert!(found.hypotheses.len() <= 3, "seed {seed}: {} hypotheses", found.hypotheses.len());
        assert!(found.hypotheses.iter().any(|one| one.poses.contains(problem.world_from_model)));
        let count = found.interpretation_count();
        assert!(count.at_least > 200, "{count:?}");
        let listed = found.hypotheses.iter().flat_map(Hypothesis::interpretations);
        assert_eq!(listed.take(100).count(), 100);
    }
}
