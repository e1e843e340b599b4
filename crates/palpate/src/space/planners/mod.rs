//! Planners propose lines; the judge says what they are worth.

use glam::DVec3;
use rayon::prelude::*;

use super::scene::places;
use crate::best::Best;
use crate::line::Line;
use crate::plan::PlanSettings;
use crate::scene::Scene;

/// Directions that are tried, if all are allowed.
const NUM_DIRECTIONS: usize = 96;

/// So many lines are looked at from one view of each hypothesis, at most.
const MOST_LINES: usize = 20_000;

/// So many are looked at from all views, at most.
const MOST_LOOKED_AT: usize = 600;

/// So many are judged, at most, unless the search is to be thorough.
const MOST_JUDGED: usize = 48;

/// Offers lines to `best`: in evenly spread directions through places of all faces, those that tell most at a few poses
/// first.
pub(super) fn propose(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    let (scene, members) = (best.scene, best.members);
    let mut proposals = promising(scene, members, lines(scene, members), 1);
    proposals.truncate(MOST_LOOKED_AT);
    let proposals = proposals.into_iter().map(|(_, line)| line).collect();
    let proposals = promising(scene, members, proposals, usize::MAX);
    let most = if best.thorough { MOST_LOOKED_AT } else { MOST_JUDGED };
    for (left, line) in proposals.iter().take(most) {
        let spent = best.num_judged >= settings.effort || late();
        if best.enough(settings.stop) || best.hopeless(*left) || spent {
            return;
        }
        best.offer(line);
    }
}

/// Through each place that looks toward it, in each direction; if those are too many, some of them.
fn lines(scene: &Scene<DVec3>, members: &[usize]) -> Vec<Line<DVec3>> {
    let steepest = scene.sensor.max_incidence.cos();
    let mut lines = Vec::new();
    for &member in members {
        let places: Vec<_> = places(scene.shadows[member].model(), scene.views[member][0]).collect();
        for direction in scene.directions(NUM_DIRECTIONS) {
            let toward = places.iter().filter(|(_, normal)| -normal.dot(direction) >= steepest);
            lines.extend(toward.filter_map(|(place, _)| scene.line(direction, *place)));
        }
    }
    let step = lines.len().div_ceil(MOST_LINES).max(1);
    lines.into_iter().step_by(step).collect()
}

/// Those that seem usable from so many views, and how many pairs they seem to leave; the fewest first.
fn promising(
    scene: &Scene<DVec3>,
    members: &[usize],
    lines: Vec<Line<DVec3>>,
    num_views: usize,
) -> Vec<(usize, Line<DVec3>)> {
    let looked_at = |line: Line<DVec3>| Some((scene.glance(&line, members, num_views)?, line));
    let mut proposals: Vec<_> = lines.into_par_iter().filter_map(looked_at).collect();
    proposals.sort_by_key(|(left, _)| *left);
    proposals
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::dvec3;

    use super::*;
    use crate::dimension::Poses;
    use crate::space::Pose;
    use crate::space::shapes::{cuboid, mesh};
    use crate::{Contact, Evidence, Normal, Sensor, Settings, recognize};

    /// Two blocks, one higher than the other, both with a corner in the origin: what tells them apart is offered first.
    #[test]
    fn the_most_promising_lines_are_offered_first() {
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
        let mut offered = Vec::new();
        let mut keep = |line: &Line<DVec3>| offered.push(*line);
        let members = scene.everyone();
        let mut best = Best::new(&scene, &members);
        best.listener = Some(&mut keep);
        propose(&mut best, &settings, &|| false);
        let left = offered.iter().map(|line| scene.glance(line, &members, usize::MAX).expect("it is usable"));
        let left: Vec<usize> = left.collect();
        assert!(left.first() == Some(&2) && left.is_sorted() && left.len() <= MOST_JUDGED);
        assert!(offered.iter().all(|line| line.direction.z <= -1.2_f64.cos() + 1e-9));

        let mut best = Best::new(&scene, &members);
        propose(&mut best, &settings, &|| true);
        assert_eq!(best.num_judged, 0);
    }
}
