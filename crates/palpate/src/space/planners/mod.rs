//! Planners propose lines; the judge says what they are worth.

mod drawn;
mod polish;
mod rendering;
mod sweep;

use glam::DVec3;

use crate::best::Best;
use crate::plan::PlanSettings;

/// Offers lines to `best`, as the settings say.
pub(super) fn propose(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    drawn::draw(best, settings, late);
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
        let settings = PlanSettings { directions, ..PlanSettings::default() };
        let scene = Scene::new(&hypotheses, &sensor, &settings);
        let members = scene.everyone();
        let mut best = Best::new(&scene, &members);
        propose(&mut best, &settings, &|| false);
        let path = best.path.expect("from above they differ");
        assert_eq!(path.score, 1.0);
        assert!(path.line.direction.z <= -1.2_f64.cos() + 1e-9);

        let mut best = Best::new(&scene, &members);
        propose(&mut best, &settings, &|| true);
        assert_eq!(best.num_judged, 0);
    }
}
