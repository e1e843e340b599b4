//! The thesis's own pose and bounds against the exact pose set, as JSON.
//!
//! `make accuracy` writes docs/accuracy.md from them.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/sampled.rs"]
mod sampled;

use std::f64::consts::TAU;

use common::{Noise, Problem, contacts, uniform};
use fastrand::Rng;
use glam::DVec2;
use measure::spread;
use palpate::plane::{Pose, ThesisPose};
use palpate::{Contact, Feature, Hypothesis, Interpretation, Normal};
use rayon::prelude::*;
use sampled::{TrueSet, width};
use serde_json::{Value, json};

/// Position error, and normal error in degrees.
const BOUNDS: [(f64, f64); 3] = [(0.1, 1.0), (0.5, 4.0), (4.0, 5.0)];

/// Interpretations behind each row.
const NUM_PROBLEMS: u64 = 500;

/// Ranges that differ by less, relative, count as equal.
const EQUAL: f64 = 0.01;

/// One interpretation: what the thesis says, and what is so.
struct Compared {
    /// γ over the exact range of rotations.
    rotation: f64,
    nominal_valid: bool,
    first_valid: bool,
    /// `E_T` over the largest distance of an exact translation at φ from the nominal one; `None`: there is none at φ.
    translation: Option<f64>,
    /// `E_q` over the exact excursion of the vertex farthest from the contacts.
    excursion: f64,
    /// palpate's bound over the same.
    bound: f64,
}

fn main() {
    let mut rows = Vec::new();
    for bounds in BOUNDS {
        for num_contacts in 2..=4 {
            let seeds = (0..NUM_PROBLEMS).into_par_iter();
            let all = seeds.filter_map(|seed| compare(seed, bounds, num_contacts)).collect::<Vec<_>>();
            rows.push(row(bounds, num_contacts, &all));
        }
    }
    measure::print(&json!({ "rows": rows, "equal_within": EQUAL, "problems": NUM_PROBLEMS }));
}

/// One random interpretation of a random problem; nothing where the thesis's formulas are not defined.
fn compare(
    seed: u64,
    (position_error, normal_error_deg): (f64, f64),
    num_contacts: usize,
) -> Option<Compared> {
    let mut random = Rng::with_seed(seed);
    let model = parts::part(parts::OBJECTS[random.usize(0..6)]);
    let exact = Noise { position_error: 0.0, normal_error: Some(0.0), tip_radius: 0.0 };
    let mut problem = contacts(&mut random, model, num_contacts, &exact);
    for contact in &mut problem.evidence.contacts {
        *contact = disturbed(&mut random, *contact, position_error, normal_error_deg.to_radians());
    }
    let found = measure::solve(&problem);
    let all: Vec<Interpretation> = found.hypotheses.iter().flat_map(Hypothesis::interpretations).collect();
    let one = &all[random.usize(0..all.len())];
    let thesis = one.poses.thesis_pose()?;
    let mut truth = TrueSet::new(&problem, &one.assignment, 0.0)?;
    let reach = 1.001 * one.poses.rotation_bound() + 1e-9;
    let rotations = truth.rotations(one.poses.witness().angle(), reach)?;
    let point = farthest_vertex(&problem);
    let places = truth.places(rotations, point);
    let at_nominal = truth.translations(thesis.rotation);
    let deviations = at_nominal.iter().map(|translation| translation.distance(thesis.translation));
    Some(Compared {
        rotation: thesis.residual_rotation / rotations.width(),
        nominal_valid: one.poses.contains(thesis.world_from_model()),
        first_valid: one.poses.contains(first_pose(&problem, &one.assignment, &thesis)),
        translation: (!at_nominal.is_empty())
            .then(|| thesis.translation_error / deviations.fold(0.0, f64::max)),
        excursion: thesis.excursion(point) / width(&places),
        bound: one.poses.excursion(point) / width(&places),
    })
}

/// An exact contact read with errors that are evenly spread within their bounds. (At the bounds γ is often nothing at
/// all, and ratios say little.)
fn disturbed(random: &mut Rng, exact: Contact, position_error: f64, normal_error: f64) -> Contact {
    let shift = position_error * random.f64().sqrt() * DVec2::from_angle(uniform(random, 0.0, TAU));
    let turn = DVec2::from_angle(normal_error * uniform(random, -1.0, 1.0));
    let exact_normal = exact.normal.expect("asked for").direction;
    let normal = Normal { direction: turn.rotate(exact_normal), error: normal_error };
    Contact { center: exact.center + shift, position_error, normal: Some(normal), ..exact }
}

/// The pose at θ, the rotation of the first normal, as the thesis's model test uses it: eq. 2.1 (erratum 37) for the
/// pair of faces nearest to a right angle.
fn first_pose(problem: &Problem, assignment: &[Feature], thesis: &ThesisPose) -> Pose {
    let face = |contact: usize| problem.model.faces[assignment[contact].number() as usize];
    let count = assignment.len();
    let pairs = (0..count).flat_map(|j| (0..j).map(move |i| (i, j)));
    let sine = |(i, j): (usize, usize)| face(i).normal.perp_dot(face(j).normal);
    let steepest = pairs.max_by(|a, b| sine(*a).abs().total_cmp(&sine(*b).abs()));
    let (i, j) = steepest.expect("two contacts at least");
    let turn = DVec2::from_angle(thesis.first_rotation);
    let height = |contact: usize| {
        let offset = problem.evidence.contacts[contact].center - turn.rotate(face(contact).start);
        turn.rotate(face(contact).normal).dot(offset)
    };
    let along = |contact: usize| turn.rotate(-face(contact).normal.perp());
    let translation = (along(i) * height(j) - along(j) * height(i)) / sine((i, j));
    Pose::new(thesis.first_rotation, -translation)
}

fn farthest_vertex(problem: &Problem) -> DVec2 {
    let inverse = problem.world_from_model.inverse();
    let first = inverse.apply(problem.evidence.contacts[0].center);
    let points = problem.model.vertices.iter().map(|vertex| vertex.point);
    points.max_by(|a, b| a.distance(first).total_cmp(&b.distance(first))).expect("a part has vertices")
}

fn row((position_error, normal_error_deg): (f64, f64), num_contacts: usize, all: &[Compared]) -> Value {
    let share = |test: &dyn Fn(&Compared) -> bool| {
        all.iter().filter(|one| test(one)).count() as f64 / all.len() as f64
    };
    let figures = |figure: &dyn Fn(&Compared) -> Option<f64>| {
        let mut values: Vec<f64> = all.iter().filter_map(figure).collect();
        if values.is_empty() { Value::Null } else { spread(&mut values) }
    };
    json!({
        "position_error": position_error,
        "normal_error_deg": normal_error_deg,
        "contacts": num_contacts,
        "interpretations": all.len(),
        "rotation": {
            "ratio": figures(&|one| Some(one.rotation)),
            "equal": share(&|one| (one.rotation - 1.0).abs() <= EQUAL),
            "larger": share(&|one| one.rotation > 1.0 + EQUAL),
            "smaller": share(&|one| one.rotation < 1.0 - EQUAL),
        },
        "nominal_invalid": share(&|one| !one.nominal_valid),
        "first_invalid": share(&|one| !one.first_valid),
        "translation": {
            "ratio": figures(&|one| one.translation),
            "none_at_nominal": share(&|one| one.translation.is_none()),
            "equal": share(&|one| one.translation.is_some_and(|ratio| (ratio - 1.0).abs() <= EQUAL)),
            "smaller": share(&|one| one.translation.is_some_and(|ratio| ratio < 1.0 - EQUAL)),
        },
        "excursion": {
            "exact_over_printed": figures(&|one| Some(1.0 / one.excursion)),
            "underestimates": share(&|one| one.excursion < 1.0),
            "less_than_half": share(&|one| one.excursion < 0.5),
            "bound_over_exact": figures(&|one| Some(one.bound)),
        },
    })
}
