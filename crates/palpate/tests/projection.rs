//! Projection spaces of the thesis's search: which generator, and what is refused.

mod common;
#[path = "common/parts.rs"]
mod parts;

use common::{Noise, contacts};
use fastrand::Rng;
use palpate::projection::{FaceOf, Projection};
use palpate::{
    Error, Hypothesis, PlanSettings, Planner, Sensor, Settings, Stop, plan, projection_space, recognize,
};

fn sensor() -> Sensor {
    Sensor::new(0.5, Some(4_f64.to_radians()), 60_f64.to_radians()).expect("a good sensor")
}

/// What is left of the six objects after two touches of one of them, where that is 2 to 8 hypotheses.
fn problem(object: usize) -> Vec<Hypothesis> {
    let objects = parts::OBJECTS.map(parts::part);
    let noise = Noise { position_error: 0.5, normal_error: Some(4_f64.to_radians()), tip_radius: 0.0 };
    let mut random = Rng::with_seed(31);
    let found = (0..).map(|_: usize| {
        let evidence = contacts(&mut random, objects[object].clone(), 2, &noise).evidence;
        recognize(&objects, &evidence, &Settings::default()).expect("a well-formed problem").hypotheses
    });
    found.into_iter().find(|found| (2..=8).contains(&found.len())).expect("problems without end")
}

/// No path is good enough: all lines through the generators are offered.
fn thorough() -> PlanSettings {
    PlanSettings { planner: Planner::Ellis, stop: Stop::Unique(usize::MAX), ..PlanSettings::default() }
}

fn through(hypotheses: &[Hypothesis], generator: Option<FaceOf>) -> Result<Projection, Error> {
    projection_space(hypotheses, &sensor(), generator, &thorough())
}

fn every_face(hypotheses: &[Hypothesis]) -> impl Iterator<Item = FaceOf> {
    let faces = hypotheses.iter().map(|one| one.model.faces.len()).enumerate();
    faces.flat_map(|(hypothesis, count)| (0..count).map(move |face| FaceOf { hypothesis, face }))
}

#[test]
fn the_best_path_of_the_search_is_the_best_of_all_generators() {
    for object in 0..3 {
        let hypotheses = problem(object);
        let best = plan(&hypotheses, &sensor(), &thorough()).expect("good settings").path;
        let of_generators = every_face(&hypotheses)
            .filter_map(|face| through(&hypotheses, Some(face)).ok()?.path)
            .map(|found| found.path.score)
            .min_by(f64::total_cmp);
        assert!(best.is_some());
        assert_eq!(best.as_ref().map(|path| path.score), of_generators);
        let chosen = through(&hypotheses, None).expect("a generator");
        assert_eq!(chosen.path.map(|found| found.path), best);
    }
}

#[test]
fn generators_are_the_faces_without_a_contact() {
    let hypotheses = problem(3);
    for face in every_face(&hypotheses) {
        let first = hypotheses[face.hypothesis].interpretations().next().expect("an interpretation");
        let sensed = first.assignment.contains(&palpate::Feature::Face(face.face as u32));
        let found = through(&hypotheses, Some(face));
        assert_eq!(found.is_err(), sensed);
        if let Ok(Projection { space, .. }) = found {
            let generator = space.generator();
            assert_eq!((generator.hypothesis, generator.face), (face.hypothesis, face.face));
            assert!(!generator.sensed && space.sheaves[1..].iter().any(|sheaf| sheaf.sensed));
        }
    }
}

#[test]
fn what_is_no_generator_is_refused() {
    let hypotheses = problem(4);
    let (count, faces) = (hypotheses.len(), hypotheses[0].model.faces.len());
    let said = |hypothesis, face| {
        through(&hypotheses, Some(FaceOf { hypothesis, face })).expect_err("no generator").to_string()
    };
    let expected = format!(
        "generator: there is no such hypothesis (got ({count}, 0)); give (hypothesis, face), the hypothesis below {count}"
    );
    assert_eq!(said(count, 0), expected);
    let expected =
        format!("generator: its part has no such face (got (0, {faces})); give a face below {faces}");
    assert_eq!(said(0, faces), expected);
    let error = through(&[], None).expect_err("no hypotheses");
    assert_eq!(error.argument, "hypotheses");
}
