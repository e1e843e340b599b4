//! One more touch of a hypothesis that is thought to be the truth (thesis 6.2).

use std::cmp::Reverse;

use glam::DVec2;

use crate::Error;
use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::line::Line;
use crate::path::{Path, judged};
use crate::plan::{PlanSettings, check, checked_line};
use crate::scene::{Scene, Shadow};
use crate::sensor::Sensor;
use crate::why::Why;

/// Larger margins, in steps, are not told apart.
const MOST_STEPS: u32 = 1 << 20;

/// The margin is found to this share of m.
const STEP: f64 = 0.125;

/// The answer to [`verification_until`].
#[derive(Debug, Clone, PartialEq)]
pub struct Verification<V: Dimension = DVec2> {
    /// The path; `None`: none of the lines that were judged surely touches.
    pub path: Option<Path<V>>,
    /// [`Why::Searched`]: all lines that are tried were looked at. [`Why::Time`], [`Why::Effort`]: it was cut short.
    pub why: Why,
    /// How often a line was judged, with one margin.
    pub num_judged: u64,
}

/// A path that surely touches the hypothesis where no contact is assigned, of those that were tried the one with the largest
/// margin: so long as the line is not shifted farther, it is usable and touches. `None`: none of them does.
///
/// # Errors
/// As [`crate::plan()`].
pub fn verification_path<V: Dimension>(
    hypothesis: &Hypothesis<V>,
    sensor: &Sensor,
    settings: &PlanSettings<V>,
) -> Result<Option<Path<V>>, Error> {
    verification_until(hypothesis, sensor, settings, &|| false).map(|found| found.path)
}

/// The best path found before `late` says that time is up, or lines were judged as often as the effort allows.
///
/// What a line meets at single poses says how large its margin can be at most. The most promising are judged first, and
/// none that can't be better than the best.
///
/// # Errors
/// As [`crate::plan()`].
pub fn verification_until<V: Dimension>(
    hypothesis: &Hypothesis<V>,
    sensor: &Sensor,
    settings: &PlanSettings<V>,
    late: &dyn Fn() -> bool,
) -> Result<Verification<V>, Error> {
    let scene = scene(hypothesis, sensor, settings)?;
    let mut promising: Vec<(u32, usize, Line<V>)> = Vec::new();
    for (number, line) in V::verifying_lines(&scene).enumerate() {
        if late() {
            break;
        }
        let most = promise(&scene, &line);
        if most > 0 {
            promising.push((most, number, line));
        }
    }
    promising.sort_by_key(|(most, number, _)| (Reverse(*most), *number));
    let mut best: Option<(u32, usize, Line<V>)> = None;
    let (mut num_judged, mut why) = (0, Why::Searched);
    for (most, number, line) in promising {
        // Of lines with the same margin the first is taken, whatever the order in which they are judged.
        let needed = best.map_or(1, |(steps, first, _)| steps + u32::from(number > first));
        if most < needed {
            if best.is_some_and(|(steps, ..)| most < steps) {
                break;
            }
            continue;
        }
        why = if late() {
            Why::Time
        } else if num_judged >= settings.effort {
            Why::Effort
        } else {
            Why::Searched
        };
        if why != Why::Searched {
            break;
        }
        if !scene.views[0].iter().all(|pose| may_hold(&scene, &line, *pose, margin(&scene, needed))) {
            continue;
        }
        let mut judge = |steps| {
            num_judged += 1;
            holds(&scene, &line, steps)
        };
        if judge(needed) {
            best = Some((largest(needed, judge), number, line));
        }
    }
    let why = if late() { Why::Time } else { why };
    let path = best.map(|(steps, _, line)| verifying(&scene, &line, steps));
    Ok(Verification { path, why, num_judged })
}

/// The path of one line; `None` if it can't be used or does not surely touch. The line of a path gives that path again.
///
/// # Errors
/// As [`crate::judge()`].
pub fn verification_along<V: Dimension>(
    hypothesis: &Hypothesis<V>,
    sensor: &Sensor,
    line: Line<V>,
    settings: &PlanSettings<V>,
) -> Result<Option<Path<V>>, Error> {
    let scene = scene(hypothesis, sensor, settings)?;
    let line = checked_line(line, scene.size)?;
    let judge = |steps| holds(&scene, &line, steps);
    Ok(judge(1).then(|| verifying(&scene, &line, largest(1, judge))))
}

fn scene<V: Dimension>(
    hypothesis: &Hypothesis<V>,
    sensor: &Sensor,
    settings: &PlanSettings<V>,
) -> Result<Scene<V>, Error> {
    let settings = PlanSettings { avoid_assigned: true, ..settings.clone() };
    let hypotheses = std::slice::from_ref(hypothesis);
    check(hypotheses, sensor, &settings)?;
    Ok(Scene::new(hypotheses, sensor, &settings))
}

fn verifying<V: Dimension>(scene: &Scene<V>, line: &Line<V>, steps: u32) -> Path<V> {
    let mut path = judged(scene, &[0], line, None);
    path.margin = margin(scene, steps);
    path
}

fn margin<V: Dimension>(scene: &Scene<V>, steps: u32) -> f64 {
    STEP * f64::from(steps) * scene.margin
}

/// Whether the line is usable and surely touches, everything widened by so many steps.
fn holds<V: Dimension>(scene: &Scene<V>, line: &Line<V>, steps: u32) -> bool {
    scene.surely_touched(line, 0, margin(scene, steps))
}

/// It holds with no more steps than this: with one more, the first view would break a rule or be missed.
fn promise<V: Dimension>(scene: &Scene<V>, line: &Line<V>) -> u32 {
    let may_hold = |steps| may_hold(scene, line, scene.views[0][0], margin(scene, steps));
    if may_hold(1) { largest(1, may_hold) } else { 0 }
}

/// Whether the line and those at either end of its allowance, in each direction across, surely touch at one pose, and as the rules want it. It holds for
/// no hypothesis that has a pose where they don't.
fn may_hold<V: Dimension>(scene: &Scene<V>, line: &Line<V>, pose: V::Pose, margin: f64) -> bool {
    let model = scene.shadows[0].model();
    let aside = scene.sensor.path_error + V::position_slack(model) + margin;
    let steepest = scene.sensor.max_incidence - V::normal_slack(model) - margin / scene.size;
    let holds = |shift: V| {
        let shifted = Line { start: line.start + shift, ..*line };
        scene.contact(0, pose, &shifted).is_some_and(|met| {
            met.touchable
                && scene.unwanted(0, met.feature).is_none()
                && met.normal.angle_between(-line.direction) <= steepest
        })
    };
    let either_way = |across: V| holds(across * -aside) && holds(across * aside);
    holds(V::default()) && line.direction.across().into_iter().all(either_way)
}

/// The most steps with which it holds; it does with `low`.
fn largest(mut low: u32, mut holds: impl FnMut(u32) -> bool) -> u32 {
    let mut high = (2 * low).min(MOST_STEPS);
    while high < MOST_STEPS && holds(high) {
        (low, high) = (high, (2 * high).min(MOST_STEPS));
    }
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::sync::Arc;

    use glam::dvec2;

    use super::*;
    use crate::plane::Model;
    use crate::{Contact, Evidence, Normal, Settings, recognize};

    /// A block with a rounded corner, touched on its bottom and on its left.
    fn block() -> Hypothesis {
        let around = |k: i32| dvec2(50.0, 30.0) + 20.0 * DVec2::from_angle(PI / 22.0 * f64::from(k));
        let mut corners = vec![dvec2(0.0, 0.0), dvec2(70.0, 0.0)];
        corners.extend((0..12).map(around));
        corners.extend([dvec2(30.0, 50.0), dvec2(30.0, 20.0), dvec2(0.0, 20.0)]);
        let model = Arc::new(Model::polygon("block", &corners, &[], &[], 0.0, 0.0).expect("an outline"));
        let touched =
            [(dvec2(20.0, 0.0), -DVec2::Y), (dvec2(60.0, 0.0), -DVec2::Y), (dvec2(0.0, 10.0), -DVec2::X)];
        let contacts = touched.map(|(at, normal)| {
            let normal = Normal::new(normal, 0.07).expect("bounds are valid");
            Contact::new(at, 0.0, 0.5).expect("bounds are valid").with_normal(normal)
        });
        let evidence = Evidence { contacts: contacts.into(), ..Evidence::default() };
        let found = recognize(&[model], &evidence, &Settings::default()).expect("well-formed");
        found.hypotheses.into_iter().next().expect("it is among them")
    }

    fn sensors() -> [Sensor; 2] {
        let point = Sensor::new(0.5, Some(0.07), 1.0).expect("bounds are valid");
        [point, Sensor { tip_radius: 2.0, path_error: 0.2, ..point }]
    }

    /// Every line judged, in their order.
    fn by_all_lines(scene: &Scene) -> Option<(u32, Line)> {
        let mut best: Option<(u32, Line)> = None;
        for line in DVec2::verifying_lines(scene) {
            let known = best.map_or(0, |(steps, _)| steps);
            if holds(scene, &line, known + 1) {
                best = Some((largest(known + 1, |steps| holds(scene, &line, steps)), line));
            }
        }
        best
    }

    #[test]
    fn the_promising_first_is_the_same_as_all() {
        let (hypothesis, settings) = (block(), PlanSettings::default());
        for sensor in sensors() {
            let scene = scene(&hypothesis, &sensor, &settings).expect("well-formed");
            let (steps, line) = by_all_lines(&scene).expect("the corner is left");
            let all = DVec2::verifying_lines(&scene).count() as u64;
            let found = verification_until(&hypothesis, &sensor, &settings, &|| false).expect("well-formed");
            let path = found.path.expect("the same");
            assert_eq!((path.line, path.margin), (line, margin(&scene, steps)));
            assert!(found.why == Why::Searched && 2 * found.num_judged < all);
            let again = verification_along(&hypothesis, &sensor, path.line, &settings).expect("well-formed");
            assert_eq!(again, Some(path));
        }
    }

    #[test]
    fn effort_and_time_cut_it_short() {
        let (hypothesis, [sensor, _]) = (block(), sensors());
        let little = PlanSettings { effort: 1, ..PlanSettings::default() };
        let found = verification_until(&hypothesis, &sensor, &little, &|| false).expect("well-formed");
        assert_eq!(found.why, Why::Effort);
        let late = verification_until(&hypothesis, &sensor, &PlanSettings::default(), &|| true);
        let late = late.expect("well-formed");
        assert_eq!((late.path, late.why, late.num_judged), (None, Why::Time, 0));
    }

    /// A line that does not keep its promise would be left out wrongly.
    #[test]
    fn no_line_holds_with_more_than_it_promises() {
        let hypothesis = block();
        for sensor in sensors() {
            let scene = scene(&hypothesis, &sensor, &PlanSettings::default()).expect("well-formed");
            for line in DVec2::verifying_lines(&scene) {
                let most = promise(&scene, &line);
                assert!(!holds(&scene, &line, most + 1), "{line:?} holds with more than {most}");
            }
        }
    }
}
