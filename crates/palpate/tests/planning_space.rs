//! Planning in space, as far as it does not depend on what lines tell.

use std::sync::Arc;

use glam::{DVec3, dvec3};
use palpate::space::Model;
use palpate::{
    Contact, Evidence, Hypothesis, Line, Move, Normal, PlanSettings, Planner, Sensor, Settings, Status, Stem,
    TreeSettings, Why, judge, plan, plan_tree, recognize, refuting_moves,
};

/// What is left of a block of sides 30, 20 and 10 that was touched from above, on its top and on one side.
fn hypotheses() -> Vec<Hypothesis<DVec3>> {
    let corners: Vec<DVec3> = (0..8)
        .map(|k| dvec3(f64::from(k & 1) * 30.0, f64::from(k >> 1 & 1) * 20.0, f64::from(k >> 2) * 10.0))
        .collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> =
        sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let model = Arc::new(Model::mesh("block", &corners, &triangles, &[], 0.0, 0.0).expect("a clean solid"));
    let touched = [(dvec3(15.0, 10.0, 10.0), DVec3::Z), (dvec3(30.0, 10.0, 5.0), DVec3::X)];
    let contacts = touched.map(|(at, normal)| {
        let normal = Normal::new(normal, 0.02).expect("bounds are valid");
        Contact::new(at, 0.0, 0.1).expect("bounds are valid").with_normal(normal)
    });
    let evidence = Evidence { contacts: contacts.into(), ..Evidence::default() };
    recognize(&[model], &evidence, &Settings::default()).expect("well-formed").hypotheses
}

fn sensor() -> Sensor {
    Sensor::new(0.1, Some(0.02), 1.0).expect("bounds are valid")
}

fn down() -> Line<DVec3> {
    Line { start: dvec3(15.0, 10.0, 90.0), direction: -DVec3::Z }
}

#[test]
fn planners_of_the_plane_are_refused() {
    let hypotheses = hypotheses();
    for planner in [Planner::Complete, Planner::Ellis] {
        let settings = PlanSettings { planner, ..PlanSettings::default() };
        let error = plan(&hypotheses, &sensor(), &settings).expect_err("of the plane");
        assert_eq!(error.argument, "planner");
        let (problem, value) = (error.problem.as_str(), format!("'{}'", planner.name()));
        assert_eq!((problem, error.value), ("there is no such planner in space", value));
        assert!(error.remedy.starts_with("give \"auto\""));
    }
}

#[test]
fn planners_are_found_by_their_names() {
    let names = ["auto", "complete", "ellis", "optimized", "linearized", "decoupled", "grimson", "schneiter"];
    for name in names {
        assert_eq!(Planner::named::<DVec3>(name).map(Planner::name), Some(name));
    }
    assert_eq!(Planner::named::<DVec3>("best"), None);
}

#[test]
fn one_hypothesis_is_solved() {
    let hypotheses = &hypotheses()[..1];
    let settings = PlanSettings::default();
    let found = plan(hypotheses, &sensor(), &settings).expect("well-formed");
    assert_eq!((found.path.is_none(), found.proved), (true, true));
    assert_eq!(found.why(hypotheses, &settings, false), Why::Solved);
    let tree = plan_tree(hypotheses, &sensor(), &settings, &TreeSettings::default()).expect("well-formed");
    assert_eq!((tree.num_nodes(), tree.root().status), (1, Status::Solved));
    assert_eq!(tree.names, ["block"]);
}

#[test]
fn bad_settings_are_refused_by_name() {
    let hypotheses = hypotheses();
    let refused = |sensor: &Sensor, settings: PlanSettings<DVec3>| {
        plan(&hypotheses, sensor, &settings).expect_err("a bad setting").argument
    };
    let usual = PlanSettings::default;
    let flat = Some([DVec3::ZERO, dvec3(9.0, 9.0, 0.0)]);
    assert_eq!(refused(&sensor(), PlanSettings { workspace: flat, ..usual() }), "workspace");
    let nowhere = Some((DVec3::ZERO, 1.0));
    assert_eq!(refused(&sensor(), PlanSettings { directions: nowhere, ..usual() }), "directions");
    let stem = Stem::new(DVec3::Z, 1.0, 1e12).expect("a rod");
    assert_eq!(refused(&Sensor { stem: Some(stem), ..sensor() }, usual()), "stem");
    let line = Line { direction: DVec3::ZERO, ..down() };
    let error = judge(&hypotheses, &sensor(), line, None, &usual()).expect_err("no direction");
    assert_eq!(error.argument, "direction");
}

#[test]
fn a_line_is_judged_as_it_is_given() {
    let hypotheses = hypotheses();
    let path = judge(&hypotheses, &sensor(), down(), None, &PlanSettings::default()).expect("a good line");
    assert_eq!((path.line, path.outcomes.len()), (down(), hypotheses.len()));
    let again = judge(&hypotheses, &sensor(), path.line, Some(path.length), &PlanSettings::default());
    assert_eq!(again.expect("a good line"), path);
}

/// The top was touched: what is met there refutes nothing, whatever is known of the sides.
#[test]
fn the_truth_is_not_refuted() {
    let hypotheses = hypotheses();
    let truth = hypotheses.iter().position(|one| one.poses.contains(palpate::space::Pose::IDENTITY));
    let met = Some((dvec3(15.0, 10.0, 10.05), None));
    let moves = [Move { line: down(), length: 100.0, sensor: sensor(), met }];
    let refuted = refuting_moves(&hypotheses, &moves).expect("well-formed");
    assert_eq!((refuted.len(), refuted[truth.expect("the truth")]), (hypotheses.len(), None));
}
