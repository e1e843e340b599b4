//! Where the thesis's own pose and bounds (2.2.3, 2.4) agree with the exact pose set, and where they do not.
//! The shares are in docs/accuracy.md; `make accuracy` writes it.

mod common;
#[path = "common/parts.rs"]
mod parts;
#[path = "common/sampled.rs"]
mod sampled;

use common::{Noise, Problem, contacts, pose};
use fastrand::Rng;
use palpate::plane::{Face, Model, ThesisPose};
use palpate::{Contact, Evidence, Feature, Hypothesis, Interpretation, Normal, Settings, recognize};
use sampled::{Rotations, TrueSet, width};

const BOUNDS: [(f64, f64); 3] = [(0.1, 1.0), (0.5, 4.0), (4.0, 5.0)];

/// The true interpretation of a problem, the thesis's view of it, and all its poses, sampled.
struct Scene {
    problem: Problem,
    one: Interpretation,
    thesis: ThesisPose,
    truth: TrueSet,
    rotations: Rotations,
}

/// Nothing where the thesis's formulas are not defined: parallel faces.
fn scene(problem: Problem) -> Option<Scene> {
    let models = std::slice::from_ref(&problem.model);
    let found = recognize(models, &problem.evidence, &Settings::default()).expect("a well-formed problem");
    let images: Vec<_> =
        problem.model.symmetries.iter().map(|symmetry| symmetry.features(&problem.assignment)).collect();
    let mut all = found.hypotheses.iter().flat_map(Hypothesis::interpretations);
    let one = all.find(|one| images.contains(&one.assignment)).expect("the true interpretation");
    let thesis = one.poses.thesis_pose()?;
    let mut truth = TrueSet::new(&problem, &one.assignment, 0.0)?;
    let reach = 1.001 * one.poses.rotation_bound() + 1e-9;
    let rotations = truth.rotations(one.poses.witness().angle(), reach)?;
    Some(Scene { problem, one, thesis, truth, rotations })
}

/// True interpretations of two to four random contacts on the six objects.
fn scenes() -> impl Iterator<Item = Scene> {
    (0..150).filter_map(|seed| {
        let mut random = Rng::with_seed(seed);
        let model = parts::part(parts::OBJECTS[random.usize(0..6)]);
        let (position_error, normal_error_deg) = BOUNDS[random.usize(0..3)];
        let normal_error = Some(normal_error_deg.to_radians());
        let count = random.usize(2..5);
        scene(contacts(&mut random, model, count, &Noise { position_error, normal_error, tip_radius: 0.0 }))
    })
}

/// Exact contacts in the middle of a part's longest face and of the longest that is not nearly parallel to it.
fn in_the_middle_of_long_faces(name: &str) -> Problem {
    let model = parts::part(name);
    let longest = |model: &Model, test: &dyn Fn(&Face) -> bool| {
        let faces = (0..model.faces.len()).filter(|k| test(&model.faces[*k]));
        faces.max_by(|a, b| model.faces[*a].length().total_cmp(&model.faces[*b].length())).expect("a face")
    };
    let first = longest(&model, &|_| true);
    let normal = model.faces[first].normal;
    let second = longest(&model, &|face| face.normal.perp_dot(normal).abs() > 0.5);
    let world_from_model = pose(&mut Rng::with_seed(7));
    let touch = |number: usize| {
        let face = &model.faces[number];
        let center = world_from_model.apply(face.start.midpoint(face.end));
        let toward = world_from_model.rotation.rotate(face.normal);
        let normal = Normal::new(toward, 2_f64.to_radians()).expect("a normal");
        Contact::new(center, 0.0, 0.2).expect("a contact").with_normal(normal)
    };
    let evidence = Evidence { contacts: [first, second].map(touch).into(), ..Evidence::default() };
    let assignment = [first, second].map(|number| Feature::Face(number as u32)).into();
    Problem { model, evidence, world_from_model, assignment }
}

#[test]
fn residual_rotation_is_never_less_than_the_exact_range() {
    for scene in scenes() {
        assert!(scene.thesis.residual_rotation >= scene.rotations.width() - 1e-9);
    }
}

#[test]
fn residual_rotation_is_the_exact_range_in_the_middle_of_two_long_faces() {
    for name in parts::OBJECTS {
        let scene = scene(in_the_middle_of_long_faces(name)).expect("two faces that are not parallel");
        let difference = scene.thesis.residual_rotation - scene.rotations.width();
        assert!(difference.abs() < 1e-6, "{name}: {difference}");
        assert!(scene.one.poses.contains(scene.thesis.world_from_model()), "{name}");
    }
}

#[test]
fn the_nominal_pose_puts_two_contacts_on_their_lines() {
    for scene in scenes().filter(|scene| scene.one.assignment.len() == 2) {
        let nominal = scene.thesis.world_from_model();
        for (contact, feature) in scene.problem.evidence.contacts.iter().zip(&scene.one.assignment) {
            let face = &scene.problem.model.faces[feature.number() as usize];
            let offset = contact.center - nominal.apply(face.start);
            assert!(offset.dot(nominal.rotation.rotate(face.normal)).abs() < 1e-9);
        }
    }
}

#[test]
fn translation_error_is_half_the_long_diagonal_of_the_rhombus() {
    for scene in scenes().filter(|scene| scene.one.assignment.len() == 2) {
        let corners = &scene.thesis.translation_region;
        let farthest = corners.iter().map(|corner| corner.distance(scene.thesis.translation));
        let half_diagonal = farthest.fold(0.0, f64::max);
        assert_eq!(corners.len(), 4);
        assert!((scene.thesis.translation_error / half_diagonal - 1.0).abs() < 1e-7);
    }
}

#[test]
fn translation_error_is_never_less_than_the_exact_spread_at_the_nominal_rotation() {
    for scene in scenes() {
        for translation in scene.truth.translations(scene.thesis.rotation) {
            assert!(translation.distance(scene.thesis.translation) <= scene.thesis.translation_error + 1e-9);
        }
    }
}

#[test]
fn the_nominal_pose_is_often_invalid_and_the_chord_often_too_short() {
    let (mut count, mut num_invalid, mut num_too_short) = (0, 0, 0);
    for scene in scenes() {
        count += 1;
        num_invalid += usize::from(!scene.one.poses.contains(scene.thesis.world_from_model()));
        let point = scene.problem.model.vertices[0].point;
        let found = width(&scene.truth.places(scene.rotations, point));
        num_too_short += usize::from(scene.thesis.excursion(point) < found);
        assert!(scene.one.poses.excursion(point) >= found);
    }
    assert!(num_invalid > count / 10, "{num_invalid} of {count}");
    assert!(num_too_short > count / 10, "{num_too_short} of {count}");
}
