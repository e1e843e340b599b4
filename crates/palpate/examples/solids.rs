//! How long solids take to make: `cargo run --release --example solids`.
#![allow(clippy::disallowed_methods, clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use std::f64::consts::{PI, TAU};
use std::time::Instant;

use glam::{DVec3, dvec3};
use palpate::space::{Model, Pose};

type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

/// A closed ring of rings, each with so many corners.
fn turned(profile: &[(f64, f64)], sides: u32) -> Shape {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for &(radius, height) in profile {
        let corner = |k: u32| (radius, TAU * f64::from(k) / f64::from(sides), height);
        points.extend((0..sides).map(corner).map(|(r, turn, z)| dvec3(r * turn.cos(), r * turn.sin(), z)));
    }
    for ring in 0..profile.len() as u32 {
        let above = (ring + 1) % profile.len() as u32;
        for k in 0..sides {
            let [a, b] = [k, (k + 1) % sides].map(|k| ring * sides + k);
            let [c, d] = [k, (k + 1) % sides].map(|k| above * sides + k);
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (points, triangles)
}

/// Its own triangles, without common vertices, as an STL file has them.
fn soup((points, triangles): &Shape, pose: Pose) -> Shape {
    let corners = triangles.iter().flatten().map(|&k| pose.apply(points[k as usize]));
    (corners.collect(), (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn main() {
    let mut random = fastrand::Rng::with_seed(1);
    let ring = |count: u32, radius: f64| -> Vec<(f64, f64)> {
        let at = |k: u32| TAU * f64::from(k) / f64::from(count);
        (0..count).map(|k| (60.0 + radius * at(k).cos(), radius * at(k).sin())).collect()
    };
    let mut shake = |mut shape: Shape| {
        for point in &mut shape.0 {
            *point += 0.2 * dvec3(random.f64(), random.f64(), random.f64());
        }
        shape
    };
    let shapes = [
        ("ring, 300 faces, symmetric", turned(&ring(15, 20.0), 20)),
        ("ring, 300 faces, uneven", shake(turned(&ring(10, 20.0), 15))),
        ("ring, 5000 faces, symmetric", turned(&ring(50, 20.0), 100)),
        ("ring, 5000 faces, uneven", shake(turned(&ring(50, 20.0), 50))),
        ("tube of 200 sides", turned(&[(20.0, 0.0), (30.0, 0.0), (30.0, 50.0), (20.0, 50.0)], 200)),
    ];
    for (name, shape) in shapes {
        let (points, triangles) = soup(&shape, Pose::new(dvec3(0.3, PI, 0.1), dvec3(10.0, 20.0, 30.0)));
        let make = || Model::mesh(name, &points, &triangles, &[], 0.0, 0.0).unwrap();
        let mut times: Vec<f64> = (0..11)
            .map(|_| {
                let start = Instant::now();
                let model = make();
                let time = 1e3 * start.elapsed().as_secs_f64();
                assert!(model.closed);
                time
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let model = make();
        let middle =
            model.vertices.iter().map(|vertex| vertex.point).sum::<DVec3>() / model.vertices.len() as f64;
        let start = Instant::now();
        let mut inside = 0;
        for k in 0..5000_u32 {
            let turn = 0.7 * f64::from(k);
            let point =
                middle + 0.016 * f64::from(k) * dvec3(turn.cos(), turn.sin(), 0.1 * (3.0 * turn).sin());
            inside += usize::from(model.signed_distance(point) < 0.0);
        }
        let micro = 1e6 * start.elapsed().as_secs_f64() / 5000.0;
        println!(
            "{name}: {} faces, {} motions: {:.1} ms (median of 11); a signed distance {micro:.1} us, {inside} inside",
            model.faces.len(),
            model.symmetries.len(),
            times[5],
        );
    }
}
