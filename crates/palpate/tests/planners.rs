//! The thesis's planners: what they propose is usable, never better than what `complete` proves, and always the same.

mod common;
#[path = "common/parts.rs"]
mod parts;

use std::sync::Arc;

use common::{Noise, contacts};
use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::Line;
use palpate::plane::{Model, Pose};
use palpate::{
    Contact, EllisCounters, Evidence, Fault, Feature, Hypothesis, Normal, Plan, PlanSettings, Planner,
    Sensor, Settings, Stop, judge, plan, recognize,
};

const OF_THE_THESIS: [Planner; 3] = [Planner::Ellis, Planner::GRIMSON, Planner::SCHNEITER];

/// Boxes of `complete`: it proves most random problems with far fewer, and a test need not wait for the others.
const EFFORT: u64 = 20_000;

fn sensor() -> Sensor {
    Sensor::new(0.5, Some(4_f64.to_radians()), 60_f64.to_radians()).expect("a good sensor")
}

/// Pairs of contacts on the six objects that leave 2 to 12 hypotheses.
fn problems(seed: u64, tip_radius: f64) -> impl Iterator<Item = Vec<Hypothesis>> {
    let objects = parts::OBJECTS.map(parts::part);
    let noise = Noise { position_error: 0.5, normal_error: Some(4_f64.to_radians()), tip_radius };
    let mut random = Rng::with_seed(seed);
    (0..).filter_map(move |k: usize| {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &noise);
        let found =
            recognize(&objects, &problem.evidence, &Settings::default()).expect("a well-formed problem");
        (2..=12).contains(&found.hypotheses.len()).then_some(found.hypotheses)
    })
}

fn planned(hypotheses: &[Hypothesis], settings: &PlanSettings) -> Plan {
    plan(hypotheses, &sensor(), settings).expect("good settings")
}

fn by(planner: Planner) -> PlanSettings {
    PlanSettings { planner, effort: EFFORT, ..PlanSettings::default() }
}

/// One of the two parts of the keyhole problem: a slot that is `d` deeper below its mouth than the other's.
fn keyhole(d: f64) -> Arc<Model> {
    let corners = [
        (-3.0, -8.0),
        (13.0, -8.0),
        (13.0, 9.0),
        (5.6, 9.0),
        (5.6, 5.0),
        (10.0, 5.0),
        (10.0, -d),
        (0.0, -d),
        (0.0, 5.0),
        (4.5, 5.0),
        (4.5, 9.0),
        (-3.0, 9.0),
    ];
    let corners = corners.map(|(x, y)| dvec2(x, y));
    Arc::new(Model::polygon("keyhole", &corners, &[], &[], 0.0, 0.0).expect("a valid outline"))
}

/// Both keyhole parts at one pose, fixed by contacts far apart on the outside, which they share.
fn keyholes() -> Vec<Hypothesis> {
    let touch = |x: f64, y: f64, normal: DVec2| {
        let normal = Normal::new(normal, 1e-4).expect("a normal");
        Contact::new(dvec2(x, y), 0.0, 1e-3).expect("a contact").with_normal(normal)
    };
    let contacts = vec![
        touch(-2.0, -8.0, -DVec2::Y),
        touch(12.0, -8.0, -DVec2::Y),
        touch(-3.0, -7.0, -DVec2::X),
        touch(-3.0, 8.0, -DVec2::X),
        touch(13.0, 0.0, DVec2::X),
        touch(12.0, 9.0, DVec2::Y),
        // Where the mouth of the slot would be, were the parts upside down, and on both sides of it.
        touch(5.0, -8.0, -DVec2::Y),
        touch(5.7, 9.0, DVec2::Y),
        touch(4.4, 9.0, DVec2::Y),
    ];
    let evidence = Evidence { contacts, ..Evidence::default() };
    let found =
        recognize(&[keyhole(0.0), keyhole(3.0)], &evidence, &Settings::default()).expect("well formed");
    found.hypotheses
}

#[test]
fn paths_are_usable_and_what_they_say_is_the_judges() {
    for hypotheses in problems(11, 0.0).take(25) {
        for planner in OF_THE_THESIS {
            let plan = planned(&hypotheses, &by(planner));
            let path = plan.path.expect("random problems have a path that can be used");
            assert_eq!(path.fault, None);
            assert!(path.score <= hypotheses.len() as f64 && path.length.is_finite());
            assert_eq!(plan.proved, path.score <= 1.0);
            let again = judge(&hypotheses, &sensor(), path.line, None, &PlanSettings::default())
                .expect("a good line");
            assert_eq!((again.score, again.classes), (path.score, path.classes));
        }
    }
}

#[test]
fn no_score_is_below_what_complete_proves() {
    let mut num_proved = 0;
    for hypotheses in problems(12, 0.0).take(25) {
        let complete = planned(&hypotheses, &by(Planner::Complete));
        num_proved += usize::from(complete.proved);
        for path in OF_THE_THESIS.iter().filter_map(|planner| planned(&hypotheses, &by(*planner)).path) {
            // The proof is about paths of margin ≥ m.
            let wide = path.margin >= 1e-3 * hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max);
            assert!(!wide || !complete.proved || path.score >= complete.bound - 1e-9);
        }
    }
    assert!(num_proved >= 20, "{num_proved} of 25");
}

#[test]
fn a_tip_with_a_radius_finds_paths_too() {
    let sensor = sensor().with_tip(2.0, 0.1).expect("a good tip");
    for hypotheses in problems(13, 2.0).take(8) {
        for planner in OF_THE_THESIS {
            let plan = plan(&hypotheses, &sensor, &by(planner)).expect("good settings");
            assert!(plan.path.is_some_and(|path| path.fault.is_none()));
        }
    }
}

#[test]
fn the_same_input_gives_the_same_path() {
    for hypotheses in problems(14, 0.0).take(5) {
        for planner in OF_THE_THESIS {
            assert_eq!(planned(&hypotheses, &by(planner)), planned(&hypotheses, &by(planner)));
        }
    }
}

#[test]
fn operation_counts_are_those_of_the_thesis() {
    for hypotheses in problems(15, 0.0).take(12) {
        // Nothing is good enough: all generators are searched.
        let settings = PlanSettings { stop: Stop::Unique(usize::MAX), ..by(Planner::Ellis) };
        let counters = planned(&hypotheses, &settings).counters.expect("those of `ellis`");
        assert_eq!(counters.inner_products, counters.predicted_inner_products());
        assert_eq!(counters.critical_points, counters.predicted_critical_points());
        let num_faces: usize = hypotheses.iter().map(|one| one.model.faces.len()).sum();
        assert_eq!(counters.unsensed + counters.sensed, num_faces as u64);
        assert!(counters.sensed <= 2 * hypotheses.len() as u64);
        assert!(counters.critical_kept <= counters.critical_points);
        assert!(counters.paths <= 2 * counters.critical_kept);
    }
}

#[test]
fn the_example_of_the_errata_has_85_inner_products() {
    let counters = EllisCounters { unsensed: 10, sensed: 4, ..EllisCounters::default() };
    assert_eq!(counters.predicted_inner_products(), 85);
}

#[test]
fn only_ellis_counts_operations() {
    let hypotheses = problems(16, 0.0).next().expect("problems without end");
    for planner in [Planner::Auto, Planner::Complete, Planner::GRIMSON, Planner::SCHNEITER] {
        assert_eq!(planned(&hypotheses, &by(planner)).counters, None);
    }
}

#[test]
fn a_lesser_path_is_found_sooner() {
    for hypotheses in problems(17, 0.0).take(10) {
        let all = planned(&hypotheses, &by(Planner::Ellis));
        let some = planned(&hypotheses, &PlanSettings { stop: Stop::Share(0.5), ..by(Planner::Ellis) });
        assert!(some.num_judged <= all.num_judged);
        let enough = some.path.expect("a path").num_unique() as f64 >= 0.5 * hypotheses.len() as f64;
        assert!(enough || some.num_judged == all.num_judged);
    }
}

#[test]
fn ellis_does_not_see_down_the_keyhole_and_complete_does() {
    let hypotheses = keyholes();
    assert_eq!(hypotheses.len(), 2);
    assert!(hypotheses.iter().all(|one| one.poses.contains(Pose::IDENTITY)));
    let sensor = Sensor::new(0.25, Some(2_f64.to_radians()), 60_f64.to_radians()).expect("a good sensor");
    let told = |planner: Planner| {
        let plan = plan(&hypotheses, &sensor, &by(planner)).expect("good settings");
        plan.path.expect("a path that can be used").classes.len()
    };
    assert_eq!(told(Planner::Ellis), 1);
    assert_eq!(told(Planner::Complete), 2);
}

#[test]
fn assigned_faces_are_avoided_if_asked() {
    for hypotheses in problems(18, 0.0).take(10) {
        for planner in OF_THE_THESIS {
            let plan = planned(&hypotheses, &PlanSettings { avoid_assigned: true, ..by(planner) });
            let Some(path) = plan.path else { continue };
            for (hypothesis, outcome) in hypotheses.iter().zip(&path.outcomes) {
                let assigned: Vec<Feature> =
                    hypothesis.interpretations().flat_map(|one| one.assignment).collect();
                assert!(outcome.touches.iter().all(|touch| !assigned.contains(&touch.feature)));
            }
        }
    }
}

#[test]
fn a_direction_that_is_not_allowed_is_not_taken() {
    let directions = Some((DVec2::X, 0.3));
    let mut num_paths = 0;
    for hypotheses in problems(19, 0.0).take(5) {
        for planner in OF_THE_THESIS {
            let plan = planned(&hypotheses, &PlanSettings { directions, ..by(planner) });
            let allowed = |path: &palpate::Path| path.line.direction.angle_to(DVec2::X).abs() <= 0.3 + 1e-9;
            num_paths += u32::from(plan.path.is_some());
            assert!(plan.path.as_ref().is_none_or(allowed));
        }
    }
    assert!(num_paths > 5, "{num_paths} of 15");
}

#[test]
fn effort_is_a_limit_of_lines_judged() {
    let hypotheses = keyholes();
    for planner in OF_THE_THESIS {
        let settings = PlanSettings { effort: 3, ..by(planner) };
        assert!(planned(&hypotheses, &settings).num_judged <= 3);
    }
}

#[test]
fn absurd_grids_are_refused() {
    let hypotheses = keyholes();
    let absurd = [
        (Planner::Grimson { cells: 0, directions: 72 }, "cells"),
        (Planner::Grimson { cells: 256, directions: 0 }, "directions_tried"),
        (Planner::Grimson { cells: usize::MAX, directions: 72 }, "cells"),
        (Planner::Schneiter { cells: 0 }, "cells"),
        (Planner::Schneiter { cells: 1 << 20 }, "cells"),
    ];
    for (planner, argument) in absurd {
        let error = plan(&hypotheses, &sensor(), &by(planner)).expect_err("an absurd grid");
        assert_eq!(error.argument, argument);
    }
}

#[test]
fn small_grids_and_parts_with_no_common_place_are_planned_for() {
    let hypotheses = keyholes();
    for planner in [Planner::Grimson { cells: 8, directions: 1 }, Planner::Schneiter { cells: 8 }] {
        let plan = planned(&hypotheses, &by(planner));
        assert!(!plan.proved && plan.path.is_none_or(|path| path.fault.is_none() && path.score >= 1.0));
    }
}

#[test]
fn identical_hypotheses_are_not_told_apart() {
    let twice: Vec<Hypothesis> = keyholes().into_iter().take(1).flat_map(|one| [one.clone(), one]).collect();
    for planner in OF_THE_THESIS {
        let plan = planned(&twice, &by(planner));
        assert!(plan.path.is_none_or(|path| path.classes.len() == 1 && !path.guaranteed()));
        assert!(!plan.proved);
    }
}

#[test]
fn moving_the_world_does_not_change_what_ellis_tells() {
    for seed in 0..6 {
        let objects = parts::OBJECTS.map(parts::part);
        let mut random = Rng::with_seed(100 + seed);
        let noise = Noise { position_error: 0.5, normal_error: Some(0.07), tip_radius: 0.0 };
        let problem = contacts(&mut random, objects[seed as usize].clone(), 2, &noise);
        let new_from_old = Pose::new(1.0, dvec2(30.0, -80.0));
        let mut moved = problem.evidence.clone();
        for contact in &mut moved.contacts {
            contact.center = new_from_old.apply(contact.center);
            let normal = contact.normal.expect("contacts have normals");
            let turned = new_from_old.rotation.rotate(normal.direction);
            contact.normal = Some(Normal::new(turned, normal.error).expect("a normal"));
        }
        let scores = [&problem.evidence, &moved].map(|evidence| {
            let found = recognize(&objects, evidence, &Settings::default()).expect("well formed");
            planned(&found.hypotheses, &by(Planner::Ellis)).path.map(|path| path.score)
        });
        assert_eq!(scores[0], scores[1]);
    }
}

/// Two loose faces that meet in a corner which sticks out, at a pose that contacts fix well.
fn loose_corner() -> Vec<Hypothesis> {
    let [far, corner, end] = [dvec2(0.0, 10.0), DVec2::ZERO, dvec2(10.0, 0.0)];
    let model = Model::segments("corner", &[[far, corner], [corner, end]], &[], &[], 0.0, 0.0);
    let touch = |x: f64, y: f64, normal: DVec2| {
        let normal = Normal::new(normal, 1e-4).expect("a normal");
        Contact::new(dvec2(x, y), 0.0, 1e-3).expect("a contact").with_normal(normal)
    };
    let contacts = vec![touch(1.0, 0.0, -DVec2::Y), touch(9.0, 0.0, -DVec2::Y), touch(0.0, 9.0, -DVec2::X)];
    let evidence = Evidence { contacts, ..Evidence::default() };
    let models = [Arc::new(model.expect("two faces"))];
    recognize(&models, &evidence, &Settings::default()).expect("well formed").hypotheses
}

#[test]
fn the_back_of_a_loose_face_is_in_the_way_of_a_ball() {
    let hypotheses = loose_corner();
    let sensor = sensor().with_tip(2.0, 0.0).expect("a good tip");
    // Into the corner from the inside: the ball meets the backs, which its radius moves inward.
    let direction = DVec2::from_angle(240_f64.to_radians());
    let line = Line { start: dvec2(0.5, 0.0) - 40.0 * direction, direction };
    let path = judge(&hypotheses, &sensor, line, None, &PlanSettings::default()).expect("a good line");
    assert!(matches!(path.fault, Some((_, Fault::Untouchable))), "{path:?}");
}

#[test]
fn a_path_that_may_end_too_soon_has_no_margin_and_may_miss() {
    for hypotheses in problems(8, 0.0).take(20) {
        let Some(path) = planned(&hypotheses, &PlanSettings::default()).path else { continue };
        let again = |length| judge(&hypotheses, &sensor(), path.line, Some(length), &PlanSettings::default());
        let whole = again(path.length).expect("a good line");
        assert_eq!((whole.margin, &whole.classes), (path.margin, &path.classes));
        let last = |k: &usize| {
            let touches = path.outcomes[*k].touches.iter();
            touches.map(|touch| touch.depth.high).fold(f64::NEG_INFINITY, f64::max)
        };
        let farthest = (0..hypotheses.len()).max_by(|a, b| last(a).total_cmp(&last(b))).expect("hypotheses");
        let short = again(last(&farthest) - 0.1).expect("a good line");
        assert_eq!(short.margin, 0.0);
        assert!(short.no_contact.contains(&farthest));
    }
}
