use fastrand::Rng;
use glam::dvec2;

use super::*;

fn uniform(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

/// A star-shaped outline with corners that stick in, sometimes with a hole, or its faces alone.
fn part(random: &mut Rng) -> Model {
    let corner = |k: usize, low: f64, high: f64, random: &mut Rng| {
        uniform(random, low, high) * DVec2::from_angle(std::f64::consts::TAU * k as f64 / 9.0)
    };
    let outer: Vec<DVec2> = (0..9).map(|k| corner(k, 30.0, 90.0, random)).collect();
    if random.u8(0..4) == 0 {
        let faces: Vec<[DVec2; 2]> = (0..9).map(|k| [outer[k], outer[(k + 1) % 9]]).collect();
        return Model::segments("loose", &faces, &[], &[], 0.0, 0.0).expect("loose faces");
    }
    let hole: Vec<DVec2> = (0..9).map(|k| corner(k, 5.0, 20.0, random)).collect();
    let holes = if random.bool() { vec![hole] } else { Vec::new() };
    Model::polygon("star", &outer, &holes, &[], 0.0, 0.0).expect("a star")
}

/// Whether a point is no nearer than the clearance, at the pose that leaves it where it is.
fn clear(model: &Model, point: DVec2, clearance: f64) -> bool {
    model.signed_distance(point) >= clearance
}

#[test]
fn a_point_that_is_too_near_leaves_by_one_of_its_walls() {
    let mut random = Rng::with_seed(17);
    let (mut walled, mut free, mut sealed) = (0, 0, 0);
    for _ in 0..16_000 {
        let model = part(&mut random);
        let clearance =
            [0.0, uniform(&mut random, 0.1, 12.0), uniform(&mut random, -12.0, -0.1)][random.usize(0..3)];
        let lever = dvec2(uniform(&mut random, -70.0, 70.0), uniform(&mut random, -70.0, 70.0));
        let sweep = Sweep { start: lever, end: lever, clearance };
        let pose = PivotPose { angle: 0.0, y: DVec2::ZERO };
        let motion = [0.3, 2.0, 8.0][random.usize(0..3)];
        let Some(escapes) = sweep.escapes(&model, lever, pose, motion, 0.0) else { continue };
        assert!(!clear(&model, lever, clearance));
        walled += 1;
        sealed += usize::from(escapes.is_empty());
        for _ in 0..60 {
            let away = motion * random.f64().sqrt() * DVec2::from_angle(uniform(&mut random, 0.0, 7.0));
            let moved = lever + away;
            if clear(&model, moved, clearance) {
                free += 1;
                let beyond = |wall: &Wall| wall.normal.dot(moved) >= wall.height - 1e-9;
                assert!(
                    escapes.iter().any(beyond),
                    "{moved} from {lever}, clearance {clearance}: {escapes:?}"
                );
            }
        }
    }
    assert!(walled > 1000 && free > 10_000 && sealed > 100, "{walled} {free} {sealed}");
}

#[test]
fn a_stretch_does_not_change_sides() {
    let mut random = Rng::with_seed(19);
    let (mut stretches, mut free) = (0, 0);
    for _ in 0..20_000 {
        // A bar, a little wider than twice the depth, and a sweep that crosses it or runs along it.
        let depth = uniform(&mut random, 1.0, 6.0);
        let half = depth + [0.0, 0.01, 0.3][random.usize(0..3)] + 1e-6;
        let lean = uniform(&mut random, -0.05, 0.05);
        let corners =
            [dvec2(-40.0, -half), dvec2(40.0, -half - lean), dvec2(40.0, half), dvec2(-40.0, half + lean)];
        let model = Model::polygon("bar", &corners, &[], &[], 0.0, 0.0).expect("a bar");
        let middle = dvec2(uniform(&mut random, -30.0, 30.0), uniform(&mut random, -0.3, 0.3));
        let way = uniform(&mut random, 0.1, 15.0) * DVec2::from_angle(uniform(&mut random, 0.0, 7.0));
        let sweep = Sweep { start: middle - way, end: middle + way, clearance: -depth };
        let pose = PivotPose { angle: 0.0, y: DVec2::ZERO };
        let (intrusion, lever) = sweep.intrusion(&model, pose);
        let motion = [0.01, 0.3, 1.5][random.usize(0..3)];
        let escapes = sweep.escapes(&model, lever, pose, motion, 0.0);
        let Some([first, second]) = escapes.as_deref().and_then(|walls| <[Wall; 2]>::try_from(walls).ok())
        else {
            continue;
        };
        let Some(ends) = sweep.stretch(&model, [first, second], pose, motion, 0.0) else { continue };
        assert!(intrusion > 0.0);
        stretches += 1;
        for _ in 0..40 {
            // A small turn and a shift by which no point of the sweep moves more than `motion`.
            let turn = uniform(&mut random, -0.5, 0.5) * motion / sweep.reach();
            let shift =
                0.5 * motion * random.f64().sqrt() * DVec2::from_angle(uniform(&mut random, 0.0, 7.0));
            let moved = PivotPose { angle: turn, y: shift };
            if sweep.free(&model, moved, 0.0) {
                free += 1;
                let place = |lever: DVec2| shift + DVec2::from_angle(-turn).rotate(lever);
                let beyond =
                    |wall: &Wall| ends.iter().all(|end| wall.normal.dot(place(*end)) >= wall.height - 1e-9);
                assert!(beyond(&first) || beyond(&second));
            }
        }
    }
    assert!(stretches > 1000 && free > 1000, "{stretches} {free}");
}

#[test]
fn the_worst_point_is_as_near_as_the_nearest_of_many() {
    let mut random = Rng::with_seed(18);
    for _ in 0..600 {
        let model = part(&mut random);
        let mut place = || dvec2(uniform(&mut random, -100.0, 100.0), uniform(&mut random, -100.0, 100.0));
        let sweep = Sweep { start: place(), end: place(), clearance: -1.0 };
        let pose = PivotPose { angle: 0.3, y: dvec2(2.0, -3.0) };
        let (intrusion, lever) = sweep.intrusion(&model, pose);
        let at = |lever: DVec2| model.signed_distance(pose.y + DVec2::from_angle(-pose.angle).rotate(lever));
        assert!((sweep.clearance - at(lever) - intrusion).abs() < 1e-6);
        let sampled = (0..=2000).map(|k| at(sweep.start.lerp(sweep.end, f64::from(k) / 2000.0)));
        let least = sampled.fold(f64::INFINITY, f64::min);
        let missed = sweep.clearance - least;
        assert!(missed <= 0.0 || intrusion >= 0.94 * missed - 1e-6, "{intrusion} but {missed}");
        assert_eq!(sweep.free(&model, pose, 0.0), intrusion <= 0.0 || missed.abs() < 1e-6);
    }
}
