//! Planners propose lines; the judge says what they are worth.

mod candidates;
mod decoupled;
mod linearized;
mod optimized;
mod polish;
mod rendering;
mod sweep;

use glam::DVec3;

pub use candidates::Chart;
pub use decoupled::predicted_hit_rate;
pub use linearized::{LinearizationError, linearization_error};

use crate::best::Best;
use crate::plan::PlanSettings;
use crate::planner::Planner;

/// Offers lines to `best`, as the settings say.
pub(super) fn propose(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    match settings.planner {
        Planner::Decoupled => decoupled::decoupled(best, settings, late),
        Planner::Linearized => linearized::linearized(best, settings, late),
        Planner::Optimized => optimized::optimized(best, settings, late),
        // `Auto`: the settings were checked.
        _ => sweep::sweep(best, settings, late),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::dvec3;

    use super::*;
    use crate::dimension::Poses;
    use crate::scene::Scene;
    use crate::space::Pose;
    use crate::space::shapes::{cuboid, mesh};
    use crate::{Contact, Evidence, Normal, Sensor, Settings, recognize};

    /// Two blocks, one higher than the other, both with a corner in the origin: a line from above tells them apart.
    #[test]
    fn what_tells_most_is_found() {
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
        let mut hypotheses = found.expect("well-formed").hypotheses;
        hypotheses.retain(|one| one.poses.contains(Pose::IDENTITY));
        assert!(hypotheses.len() == 2 && hypotheses.iter().all(|one| one.poses.proved()));

        let sensor = Sensor::new(0.1, Some(0.02), 1.0).expect("bounds are valid");
        let directions = Some((-DVec3::Z, 1.2));
        for planner in [Planner::Auto, Planner::Decoupled, Planner::Linearized, Planner::Optimized] {
            let settings = PlanSettings { planner, directions, ..PlanSettings::default() };
            let scene = Scene::new(&hypotheses, &sensor, &settings);
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
}
