//! Nothing true is lost, nothing false is kept.

mod common;

use std::time::Instant;

use common::{Noise, Problem, comb, contacts, star, uniform};
use fastrand::Rng;
use palpate::plane::Pose;
use palpate::{Feature, Settings, recognize};

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
        let normal = contact.normal.unwrap();
        let turned = pose.rotation.rotate(face.normal).angle_to(normal.direction).abs();
        angle = angle.max(turned - normal.error);
    }
    (length, angle)
}

#[test]
fn the_truth_is_never_lost_and_every_pose_returned_is_valid() {
    let started = Instant::now();
    for seed in 0..4000 {
        let problem = random_problem(seed);
        let found = recognize(&[problem.model.clone()], &problem.evidence, &Settings::default()).unwrap();
        let tau = 1e-6 * problem.model.size * 1.01;
        assert!(found.complete);
        assert!(
            found.hypotheses.iter().any(|one| one.poses.contains(problem.world_from_model)),
            "seed {seed}: true pose lost"
        );
        let truth = problem.model.symmetries.iter().map(|symmetry| symmetry.features(&problem.assignment));
        let truth: Vec<_> = truth.collect();
        let listed: Vec<_> =
            found.hypotheses.iter().flat_map(|one| one.interpretations().collect::<Vec<_>>()).collect();
        assert!(listed.iter().any(|one| truth.contains(&one.assignment)), "seed {seed}: assignment lost");
        for one in &listed {
            for pose in
                one.poses.sample(5, seed).into_iter().chain([one.poses.witness(), one.poses.largest_slack()])
            {
                let (length, angle) = worst_excess(&problem, &one.assignment, pose);
                assert!(length <= tau && angle <= 1.01e-6, "seed {seed}: {length} {angle}");
                assert!(one.poses.contains(pose), "seed {seed}: own sample not contained");
            }
        }
    }
    println!("{:?}", started.elapsed());
}

#[test]
fn a_200_gon_with_eight_contacts_is_one_hypothesis() {
    let mut random = Rng::with_seed(1);
    let noise = Noise { position_error: 4.0, normal_error: Some(15_f64.to_radians()), tip_radius: 0.0 };
    let problem = contacts(&mut random, common::regular(200, 50.0), 8, &noise);
    let started = Instant::now();
    let found = recognize(&[problem.model.clone()], &problem.evidence, &Settings::default()).unwrap();
    println!("{:?} {:?} boxes", started.elapsed(), found.reports);
    assert!(found.hypotheses.iter().any(|one| one.poses.contains(problem.world_from_model)));
    println!("{} hypotheses, {:?}", found.hypotheses.len(), found.interpretation_count());
    println!("{:?} {}", started.elapsed(), found.hypotheses[0].poses.rotation_bound());
}
