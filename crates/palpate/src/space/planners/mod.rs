//! Planners propose lines; the judge says what they are worth.

mod blocking;
mod candidates;
mod decoupled;
mod drawn;
mod grimson;
mod linearized;
mod optimized;
mod polish;
mod rendering;
mod schneiter;

use std::cell::OnceCell;

use glam::DVec3;

pub use candidates::Chart;
use candidates::Generator;
pub use decoupled::predicted_hit_rate;
pub use linearized::{LinearizationError, linearization_error};

use crate::best::Best;
use crate::plan::{PlanSettings, Planner};

/// Offers lines to `best`, as the settings say.
pub(super) fn propose(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    match settings.planner {
        Planner::Auto => auto(best, settings, late),
        planner => ask(best, planner, &OnceCell::new(), settings, late),
    }
}

/// Offers lines of one of the thesis's planners; what the last three look for they share.
fn ask(
    best: &mut Best<'_, DVec3>,
    planner: Planner,
    generators: &OnceCell<Vec<Generator>>,
    settings: &PlanSettings<DVec3>,
    late: &dyn Fn() -> bool,
) {
    let (scene, members) = (best.scene, best.members);
    let generators = || generators.get_or_init(|| candidates::generators(scene, members));
    match planner {
        Planner::Grimson { cells, directions } => grimson::grimson(best, [cells, directions], settings, late),
        Planner::Schneiter { cells } => schneiter::schneiter(best, cells, settings, late),
        Planner::Decoupled => decoupled::decoupled(best, generators(), settings, late),
        Planner::Linearized => linearized::linearized(best, generators(), settings, late),
        Planner::Optimized => optimized::optimized(best, generators(), settings, late),
        _ => unreachable!("the settings were checked"),
    }
}

/// The planner of first choice: some drawn lines; where these are not good enough the thesis's ways, those first that find most in
/// their time; then many more drawn lines. None of them is the best on every problem.
fn auto(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    if drawn::draw(best, settings, late, 0..1) {
        return;
    }
    let ways = [
        Planner::named::<DVec3>("grimson").expect("space has it"),
        Planner::Linearized,
        Planner::named::<DVec3>("schneiter").expect("space has it"),
        Planner::Optimized,
        Planner::Decoupled,
    ];
    let generators = OnceCell::new();
    // Where the search is to be thorough, drawn lines show all kinds.
    for planner in ways.into_iter().take(if best.thorough { 0 } else { usize::MAX }) {
        ask(best, planner, &generators, settings, late);
        if best.enough(settings.stop) || best.num_judged >= settings.effort || late() {
            return;
        }
    }
    drawn::draw(best, settings, late, 1..drawn::NUM_ROUNDS);
}

#[cfg(test)]
pub(in crate::space) mod tests {
    use std::sync::Arc;
    use std::sync::atomic::Ordering::Relaxed;

    use glam::dvec3;

    use super::*;
    use crate::dimension::{Dimension, Poses};
    use crate::recognize::Halt;
    use crate::scene::Scene;
    use crate::space::Pose;
    use crate::space::shapes::{cuboid, mesh};
    use crate::{Contact, Evidence, Hypothesis, Normal, Sensor, Settings, plan, recognize};

    /// What is left of two blocks, one higher than the other, that were touched on three sides, at the corner in the origin.
    pub(super) fn blocks() -> Vec<Hypothesis<DVec3>> {
        let block = |height: f64| Arc::new(mesh(&cuboid(DVec3::ZERO, dvec3(30.0, 20.0, height))));
        let touched = [
            (dvec3(0.0, 10.0, 6.0), -DVec3::X),
            (dvec3(15.0, 0.0, 6.0), -DVec3::Y),
            (dvec3(15.0, 10.0, 0.0), -DVec3::Z),
        ];
        let contacts = touched.map(|(at, normal)| {
            let normal = Normal::new(normal, 0.02).expect("bounds are valid");
            Contact::new(at, 0.0, 0.3).expect("bounds are valid").with_normal(normal)
        });
        let evidence = Evidence { contacts: contacts.into(), ..Evidence::default() };
        let found = recognize(&[block(12.0), block(16.0)], &evidence, &Settings::default());
        found.expect("well-formed").hypotheses
    }

    pub(super) fn sensor() -> Sensor {
        Sensor::new(0.1, Some(0.02), 1.0).expect("bounds are valid")
    }

    /// A line from above tells the two blocks that stand alike apart.
    #[test]
    fn what_tells_most_is_found() {
        let mut hypotheses = blocks();
        hypotheses.retain(|one| one.poses.contains(Pose::IDENTITY));
        assert!(hypotheses.len() == 2 && hypotheses.iter().all(|one| one.poses.proved()));
        let directions = Some((-DVec3::Z, 1.2));
        for planner in DVec3::PLANNERS.iter().map(|name| Planner::named::<DVec3>(name).expect("it exists")) {
            let settings = PlanSettings { planner, directions, ..PlanSettings::default() };
            let scene = Scene::new(&hypotheses, &sensor(), &settings);
            let members = scene.everyone();
            let mut best = Best::new(&scene, &members);
            propose(&mut best, &settings, &|| false);
            let path = best.path.expect("from above they differ");
            assert_eq!(path.score, 1.0, "{planner:?}");
            assert!(path.line.direction.z <= -1.2_f64.cos() + 1e-9);

            let mut best = Best::new(&scene, &members);
            propose(&mut best, &settings, &|| true);
            assert_eq!(best.num_judged, 0);
        }
    }

    /// The same answer with the same settings, and no more lines judged than are allowed.
    #[test]
    fn answers_repeat_and_effort_is_heeded() {
        let hypotheses = blocks();
        for name in DVec3::PLANNERS {
            let planner = Planner::named::<DVec3>(name).expect("it exists");
            let plan = |effort: u64| {
                let settings = PlanSettings { planner, effort, ..PlanSettings::default() };
                plan(&hypotheses, &sensor(), &settings).expect("well-formed")
            };
            let full = plan(1_000);
            assert!(full.path.is_some(), "{name} finds none");
            assert_eq!(full, plan(1_000), "{name}");
            assert!(plan(3).num_judged <= 3, "{name}");
        }
    }

    /// Once nobody waits, a line that is being judged is none; the same settings without that give the same answer as ever.
    #[test]
    fn what_is_halted_is_no_path() {
        let hypotheses = blocks();
        let settings = PlanSettings::default();
        let halt = Halt::default();
        let scene = Scene::new(&hypotheses, &sensor(), &settings).until(&halt);
        let members = scene.everyone();
        let mut best = Best::new(&scene, &members);
        propose(&mut best, &settings, &|| false);
        let path = best.path.expect("there is one");
        assert!(scene.outcomes(&path.line, &members, 0.0).is_some());

        halt.store(true, Relaxed);
        assert!(scene.outcomes(&path.line, &members, 0.0).is_none());
        let mut best = Best::new(&scene, &members);
        assert!(!best.offer(&path.line) && best.path.is_none());
        propose(&mut best, &settings, &|| scene.is_halted());
        assert!(best.path.is_none());
    }
}
