//! The thesis's own pose and bounds in space against the exact pose set, as JSON.
//!
//! `make accuracy` writes docs/accuracy.md from them.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/sampled_space.rs"]
mod sampled_space;
#[path = "../tests/common/solids.rs"]
mod solids;
#[path = "../tests/common/thesis_scene.rs"]
mod thesis_scene;

use measure::spread;
use palpate::space::{Pose, ThesisPose};
use rayon::prelude::*;
use sampled_space::Measure;
use serde_json::{Value, json};
use thesis_scene::{Scene, scene};

/// The first so many interpretations are compared, of so many problems: some are not defined.
const NUM_INTERPRETATIONS: usize = 500;
const NUM_SEEDS: u64 = 1100;

/// One interpretation: what the thesis says, and what is so.
struct Compared {
    contacts: usize,
    nominal_valid: bool,
    /// The pose at the rotation by axis and angle; `None`: it has no axis.
    first_valid: Option<bool>,
    /// From the pose at that rotation to the nominal one, radians.
    first_away: Option<f64>,
    /// 2Φ over the sampled extent of rotations.
    residual: f64,
    /// Eq. 2.5 over the largest rotation that was sampled from the nominal one.
    turn: f64,
    /// `E_T` over the largest distance of a sampled translation at the nominal rotation; `None`: none was found there.
    translation: Option<f64>,
    /// palpate's bound over the sampled extent of rotations.
    bound: f64,
}

fn main() {
    let scenes = (0..NUM_SEEDS).into_par_iter().filter_map(|seed| scene(seed, 3..7));
    let mut all: Vec<Compared> = scenes.map(|scene| compare(&scene)).collect();
    all.truncate(NUM_INTERPRETATIONS);
    let mut rows: Vec<Value> = (3..7)
        .map(|count| {
            let some: Vec<&Compared> = all.iter().filter(|one| one.contacts == count).collect();
            row(&count.to_string(), &some)
        })
        .collect();
    rows.push(row("all", &all.iter().collect::<Vec<_>>()));
    measure::print(&json!({ "rows": rows, "interpretations": all.len() }));
}

fn compare(scene: &Scene) -> Compared {
    let Scene { one, thesis, .. } = scene;
    let nominal = thesis.world_from_model();
    let first = thesis.first_rotation.map(|rotation| scene.pose_at(rotation));
    let extent = scene.rotations();
    Compared {
        contacts: one.assignment.len(),
        nominal_valid: one.poses.contains(nominal),
        first_valid: first.map(|pose| one.poses.contains(pose)),
        first_away: first.map(|pose| Measure::Rotation.apart(pose, nominal)),
        residual: thesis.residual_rotation / extent,
        turn: thesis.rotation_error / scene.truth.reach(&scene.poses, Measure::Rotation, nominal),
        translation: translation(scene, thesis, nominal),
        bound: one.poses.rotation_bound() / extent,
    }
}

fn translation(scene: &Scene, thesis: &ThesisPose, nominal: Pose) -> Option<f64> {
    Some(thesis.translation_error / scene.farthest_translation(nominal)?)
}

fn row(contacts: &str, all: &[&Compared]) -> Value {
    let share = |test: &dyn Fn(&Compared) -> bool| {
        all.iter().filter(|one| test(one)).count() as f64 / all.len() as f64
    };
    let figures = |figure: &dyn Fn(&Compared) -> Option<f64>| {
        let mut values: Vec<f64> = all.iter().filter_map(|one| figure(one)).collect();
        if values.is_empty() { Value::Null } else { spread(&mut values) }
    };
    json!({
        "contacts": contacts,
        "interpretations": all.len(),
        "nominal_valid": share(&|one| one.nominal_valid),
        "first_valid": share(&|one| one.first_valid == Some(true)),
        "first_away_deg": figures(&|one| one.first_away.map(f64::to_degrees)),
        "residual": figures(&|one| Some(one.residual)),
        "residual_smaller": share(&|one| one.residual < 1.0),
        "turn": figures(&|one| Some(one.turn)),
        "turn_smaller": share(&|one| one.turn < 1.0),
        "translation": figures(&|one| one.translation),
        "translation_smaller": share(&|one| one.translation.is_some_and(|ratio| ratio < 1.0)),
        "none_at_nominal": share(&|one| one.translation.is_none()),
        "bound": figures(&|one| Some(one.bound)),
        "bound_smaller": share(&|one| one.bound < 1.0),
    })
}
