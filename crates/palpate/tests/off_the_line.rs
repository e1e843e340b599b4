//! What `complete` and the judge say where the tip's centre passes beside what it touches: off its line by a large path error,
//! or as the middle of a large ball (`docs/theory.md`, T11 d, T13).

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DVec2, dvec2};
use palpate::plan::Prepared;
use palpate::plane::{Model, Pose};
use palpate::{
    Contact, Evidence, Hypothesis, Normal, Plan, PlanSettings, Planner, Sensor, Settings, plan, recognize,
};

/// Two parts at one pose, nearly exact, from contacts that both explain.
fn both(parts: &[Vec<DVec2>; 2], contacts: &[(DVec2, DVec2)]) -> Vec<Hypothesis> {
    let models = parts
        .each_ref()
        .map(|corners| Arc::new(Model::polygon("part", corners, &[], &[], 0.0, 0.0).expect("a part")));
    let contact = |(at, normal): &(DVec2, DVec2)| {
        let normal = Normal::new(*normal, 1e-5).expect("a normal");
        Contact::new(*at, 0.0, 1e-5).expect("a contact").with_normal(normal)
    };
    let evidence = Evidence { contacts: contacts.iter().map(contact).collect(), ..Evidence::default() };
    let found = recognize(&models, &evidence, &Settings::default()).expect("well formed").hypotheses;
    let left: Vec<Hypothesis> = found.into_iter().filter(|one| one.poses.contains(Pose::IDENTITY)).collect();
    assert_eq!(left.len(), 2);
    left
}

/// All lines within `half` of straight down, turned by `turn`.
fn downward(turn: f64, half: f64, margin: f64) -> PlanSettings {
    let directions = Some((DVec2::from_angle(-FRAC_PI_2 - turn), half));
    PlanSettings { planner: Planner::Complete, margin, directions, ..PlanSettings::default() }
}

fn is_perfect(plan: &Plan) -> bool {
    plan.path.as_ref().is_some_and(|path| path.score <= 1.0)
}

/// Its floor to the right of a step is at this height.
fn step(height: f64) -> Vec<DVec2> {
    let corners = [
        (0.0, 0.0),
        (100.0, 0.0),
        (100.0, height),
        (40.0, height),
        (40.0, 80.0),
        (0.0, 80.0),
        (0.0, 25.0),
        (5.0, 25.0),
        (5.0, 15.0),
        (0.0, 15.0),
    ];
    corners.map(|(x, y)| dvec2(x, y)).to_vec()
}

#[test]
fn a_tip_far_off_its_line_leaves_lines_that_tell() {
    // The floors differ by just more than what path and position error blur on a line that is turned by half a radian, so that
    // lines tell at one end of the cone and not at the other.
    let (path_error, position_error, turn) = (15.0, 0.02, 0.5_f64);
    let apart = (position_error + 2.0 * path_error * turn.tan()) * turn.cos();
    let contacts = [
        (dvec2(10.0, 0.0), -DVec2::Y),
        (dvec2(90.0, 0.0), -DVec2::Y),
        (dvec2(0.0, 5.0), -DVec2::X),
        (dvec2(100.0, 30.0), DVec2::X),
    ];
    let hypotheses = both(&[step(40.0), step(40.0 + apart)], &contacts);
    let sensor = Sensor::new(position_error, Some(0.07), 0.8).and_then(|one| one.with_tip(0.0, path_error));
    let sensor = sensor.expect("a good sensor");
    let settings = downward(turn, 0.008, 3e-4);
    let prepared = Prepared::new(&hypotheses, &sensor, &settings).expect("hypotheses");
    let m = 3e-4 * hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max);
    let tells = |k: u32, j: i32| {
        let angle = -FRAC_PI_2 - turn - 0.008 + 0.016 * f64::from(k) / 40.0;
        let line = prepared.line(angle, prepared.radius() * f64::from(j) / 100.0)?;
        let path = prepared.judge(&line);
        (path.fault.is_none() && path.score <= 1.0 && path.margin >= m).then_some(())
    };
    assert!((0..=40).any(|k| (-100..=100).any(|j| tells(k, j).is_some())), "a grid of lines has one");
    assert!(is_perfect(&plan(&hypotheses, &sensor, &settings).expect("good settings")));
}

/// A plate with a notch below, its upper right corner cut off by so much.
fn plate(cut: f64) -> Vec<DVec2> {
    let mut corners =
        vec![(-100.0, 0.0), (-40.0, 0.0), (-40.0, 4.0), (-30.0, 4.0), (-30.0, 0.0), (100.0, 0.0)];
    if cut > 0.0 {
        corners.extend([(100.0, 20.0 - cut), (100.0 - cut, 20.0)]);
    } else {
        corners.push((100.0, 20.0));
    }
    corners.push((-100.0, 20.0));
    corners.into_iter().map(|(x, y)| dvec2(x, y)).collect()
}

#[test]
fn a_ball_whose_centre_passes_by_touches_all_the_same() {
    let contacts = [
        (dvec2(-35.0, 4.0), -DVec2::Y),
        (dvec2(90.0, 0.0), -DVec2::Y),
        (dvec2(-100.0, 5.0), -DVec2::X),
        (dvec2(100.0, 5.0), DVec2::X),
        (dvec2(-95.0, 0.0), -DVec2::Y),
    ];
    let hypotheses = both(&[plate(0.0), plate(1.0)], &contacts);
    let sensor = Sensor::new(0.4, None, 1.1).and_then(|one| one.with_tip(30.0, 0.0)).expect("a good sensor");
    let settings = downward(0.0, 0.0, 1e-4);
    let prepared = Prepared::new(&hypotheses, &sensor, &settings).expect("hypotheses");
    // The line passes the corner at less than the radius, and all vertices on one side.
    let aside = 122.0;
    assert!(aside > prepared.radius());
    let path = prepared.judge(&prepared.line(-FRAC_PI_2, aside).expect("all lines are allowed"));
    assert!(path.fault.is_none() && path.outcomes.iter().all(|outcome| !outcome.may_miss));
    for (hypothesis, outcome) in hypotheses.iter().zip(&path.outcomes) {
        for pose in hypothesis.poses.sample(200, 1) {
            let met = hypothesis.model.first_contact(pose, &path.line, 30.0).expect("it is touched");
            let within =
                |touch: &palpate::Touch| touch.depth.low <= met.depth && met.depth <= touch.depth.high;
            assert!(outcome.touches.iter().any(within), "{}", met.depth);
        }
    }
    assert!(path.score <= 1.0, "{}", path.score);
    assert!(is_perfect(&plan(&hypotheses, &sensor, &settings).expect("good settings")));
}
