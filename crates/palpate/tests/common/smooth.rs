//! Smooth parts from many small faces, on which assignments explode.

#![allow(dead_code, reason = "each file uses its own part")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::{DVec2, dvec2};
use palpate::plane::Model;

fn polygon(name: &str, corners: &[DVec2]) -> Arc<Model> {
    Arc::new(Model::polygon(name, corners, &[], &[], 0.0, 0.0).expect("a convex outline"))
}

/// Points of an arc around `middle`, both ends included.
fn arc(middle: DVec2, radius: f64, from: f64, turn: f64, chords: usize) -> impl Iterator<Item = DVec2> {
    (0..=chords).map(move |k| middle + radius * DVec2::from_angle(from + turn * k as f64 / chords as f64))
}

/// An ellipse with the given half axes, from chords of equal parameter.
pub fn ellipse(faces: usize, half_axes: DVec2) -> Arc<Model> {
    let corner = |k| half_axes * DVec2::from_angle(TAU * k as f64 / faces as f64);
    polygon("ellipse", &(0..faces).map(corner).collect::<Vec<_>>())
}

/// An ellipse 130 by 90 with a bulge that leaves it no symmetry.
pub fn pebble(faces: usize) -> Arc<Model> {
    let corner = |k: usize| {
        let at = TAU * k as f64 / faces as f64;
        (1.0 + 0.08 * (3.0 * at + 0.7).sin()) * dvec2(65.0, 45.0) * DVec2::from_angle(at)
    };
    polygon("pebble", &(0..faces).map(corner).collect::<Vec<_>>())
}

/// A rectangle whose corners are quarter circles of that many chords each.
pub fn rounded_rectangle(size: DVec2, radius: f64, chords: usize) -> Arc<Model> {
    let inner = 0.5 * size - radius;
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| inner * dvec2(x, y));
    let round = corners
        .iter()
        .enumerate()
        .flat_map(|(k, middle)| arc(*middle, radius, FRAC_PI_2 * k as f64, FRAC_PI_2, chords));
    polygon("rounded-rectangle", &round.collect::<Vec<_>>())
}

/// Two half circles of that many chords each, and two straight sides.
pub fn stadium(straight: f64, radius: f64, chords: usize) -> Arc<Model> {
    let right = arc(dvec2(0.5 * straight, 0.0), radius, -FRAC_PI_2, PI, chords);
    let left = arc(dvec2(-0.5 * straight, 0.0), radius, FRAC_PI_2, PI, chords);
    polygon("stadium", &right.chain(left).collect::<Vec<_>>())
}
