//! Arcs of directions against sampling (`docs/theory.md`, T2).

use std::f64::consts::{PI, TAU};

use fastrand::Rng;
use palpate::plane::Arc;

/// Angles nearer than this to an end are not asked for.
const NEAR: f64 = 1e-9;

/// Narrow, wide and nearly full arcs, anywhere on the line of angles.
fn random_arc(random: &mut Rng) -> Arc {
    let width = match random.u8(0..4) {
        0 => 0.3 * random.f64(),
        1 => TAU - 0.3 * random.f64(),
        _ => TAU * random.f64(),
    };
    Arc { start: 30.0 * (random.f64() - 0.5), width }
}

/// By going from the start; `None` near an end.
fn holds(arc: Arc, angle: f64) -> Option<bool> {
    let way = (angle - arc.start).rem_euclid(TAU);
    let near = !(NEAR..=TAU - NEAR).contains(&way) || (way - arc.width).abs() < NEAR;
    (!near).then_some(way < arc.width)
}

#[test]
fn an_intersection_holds_what_both_hold_in_one_part_or_two() {
    let mut random = Rng::with_seed(1);
    let mut in_parts = [0; 3];
    for _ in 0..20_000 {
        let (a, b) = (random_arc(&mut random), random_arc(&mut random));
        let parts = a.intersect(b);
        in_parts[parts.len()] += 1;
        for k in 0..90 {
            let angle = 0.07 * f64::from(k) + 0.07 * random.f64();
            let (Some(in_a), Some(in_b)) = (holds(a, angle), holds(b, angle)) else { continue };
            let of_parts: Vec<bool> = parts.iter().filter_map(|part| holds(*part, angle)).collect();
            assert_eq!(of_parts.iter().filter(|one| **one).count(), usize::from(in_a && in_b), "{a:?} {b:?}");
        }
        assert_eq!(parts.len(), b.intersect(a).len(), "{a:?} {b:?}");
        assert!(parts.len() < 2 || a.width + b.width >= TAU, "two parts only if both cover the circle");
    }
    assert!(in_parts.iter().all(|count| *count > 1_000), "{in_parts:?}");
}

#[test]
fn the_distance_to_an_arc_is_that_to_its_nearest_member() {
    let mut random = Rng::with_seed(2);
    for _ in 0..2_000 {
        let (arc, angle) = (random_arc(&mut random), 20.0 * random.f64());
        let members = (0..=4_000).map(|k| arc.start + arc.width * f64::from(k) / 4_000.0);
        let to = |member: f64| PI - ((member - angle).rem_euclid(TAU) - PI).abs();
        let nearest = members.map(to).fold(PI, f64::min);
        assert!((arc.distance(angle) - nearest).abs() < 1e-3, "{arc:?} {angle}");
    }
}
