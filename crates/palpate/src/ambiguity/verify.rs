//! One more touch of a hypothesis that is thought to be the truth (thesis 6.2).

use std::f64::consts::PI;

use glam::DVec2;

use crate::Error;
use crate::hypothesis::Hypothesis;
use crate::path::{Path, judged};
use crate::plan::{PlanSettings, check};
use crate::plane::{Line, Scene};
use crate::sensor::Sensor;

/// Evenly spaced directions that are tried; those straight at a face come on top.
const NUM_DIRECTIONS: usize = 72;

/// Larger margins, in steps, are not told apart.
const MOST_STEPS: u32 = 1 << 20;

/// The margin is found to this share of m.
const STEP: f64 = 0.125;

/// A path that surely touches the hypothesis where no contact is assigned, of those that were tried the one with the largest
/// margin: so long as the line is not shifted farther, it is usable and touches. `None`: none of them does.
///
/// # Errors
/// As [`crate::plan()`].
pub fn verification_path(
    hypothesis: &Hypothesis,
    sensor: &Sensor,
    settings: &PlanSettings,
) -> Result<Option<Path>, Error> {
    let settings = PlanSettings { avoid_assigned: true, ..settings.clone() };
    let hypotheses = std::slice::from_ref(hypothesis);
    check(hypotheses, sensor, &settings)?;
    let scene = Scene::new(hypotheses, sensor, &settings);
    let mut best: Option<(u32, Line)> = None;
    for line in candidates(&scene) {
        let known = best.map_or(0, |(steps, _)| steps);
        if holds(&scene, &line, known + 1) {
            best = Some((largest(&scene, &line, known + 1), line));
        }
    }
    Ok(best.map(|(steps, line)| {
        let mut path = judged(&scene, &[0], &line, None);
        path.margin = margin(&scene, steps);
        path
    }))
}

fn margin(scene: &Scene, steps: u32) -> f64 {
    STEP * f64::from(steps) * scene.margin
}

/// Whether the line is usable and surely touches, everything widened by so many steps.
fn holds(scene: &Scene, line: &Line, steps: u32) -> bool {
    scene
        .outcomes(line, &[0], margin(scene, steps))
        .is_ok_and(|outcomes| outcomes.iter().all(|one| !one.may_miss))
}

/// The most steps with which it holds; it does with `low`.
fn largest(scene: &Scene, line: &Line, mut low: u32) -> u32 {
    let mut high = 2 * low;
    while high < MOST_STEPS && holds(scene, line, high) {
        (low, high) = (high, 2 * high);
    }
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if holds(scene, line, middle) { low = middle } else { high = middle }
    }
    low
}

/// At the pose with the largest slack: in each direction one line between every two vertices that follow one another across.
fn candidates(scene: &Scene) -> impl Iterator<Item = Line> + '_ {
    let (model, pose) = (scene.shadows[0].model(), scene.views[0][0]);
    let straight = model.faces.iter().map(move |face| (pose.rotation.rotate(face.normal)).to_angle() + PI);
    straight.chain(scene.directions(NUM_DIRECTIONS).0).flat_map(move |angle| {
        let aside = DVec2::from_angle(angle).perp();
        let place = |at: DVec2| aside.dot(pose.apply(at) - scene.middle);
        let mut places: Vec<f64> = model.vertices.iter().map(|vertex| place(vertex.point)).collect();
        places.sort_by(f64::total_cmp);
        let between: Vec<f64> = places.windows(2).map(|two| 0.5 * (two[0] + two[1])).collect();
        between.into_iter().filter_map(move |aside| scene.line(angle, aside))
    })
}
