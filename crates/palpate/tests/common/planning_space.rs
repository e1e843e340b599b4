//! Random planning problems in space: hypotheses that a few contacts leave, and the sensor of the next touch.

#![allow(dead_code, reason = "each program uses its own part")]

use std::sync::Arc;

use fastrand::Rng;
use glam::{DVec3, dvec3};
use palpate::space::Model;
use palpate::{Hypothesis, PlanSettings, Sensor, Settings, recognize};

use crate::common::{Noise, uniform};
use crate::solids::{contacts, solid};

/// A problem is of the family of its number, one after the other.
pub const FAMILIES: [&str; 5] = ["one solid", "two solids", "mirror images", "a pocket", "nearly symmetric"];

/// A planning problem.
pub struct Case {
    pub family: &'static str,
    pub hypotheses: Vec<Hypothesis<DVec3>>,
    pub sensor: Sensor,
    pub settings: PlanSettings<DVec3>,
}

/// The problem of a number: 2 to 40 hypotheses.
pub fn case(number: u64) -> Case {
    let family = (number % FAMILIES.len() as u64) as usize;
    let mut random = Rng::with_seed(0x7061_6c71 + number);
    loop {
        let models = models(&mut random, family);
        let tip = if random.u8(0..3) == 0 { uniform(&mut random, 0.5, 3.0) } else { 0.0 };
        let noise = Noise {
            position_error: uniform(&mut random, 0.05, 1.0),
            normal_error: Some(uniform(&mut random, 0.5, 5.0).to_radians()),
            tip_radius: tip,
        };
        let chosen = Arc::clone(&models[random.usize(0..models.len())]);
        let count = random.usize(3..6);
        let evidence = contacts(&mut random, chosen, count, &noise).evidence;
        let settings = Settings { effort: Some(2_000), ..Settings::default() };
        let found = recognize(&models, &evidence, &settings).expect("a well-formed problem");
        if found.complete && (2..=40).contains(&found.hypotheses.len()) {
            let sensor = Sensor::new(noise.position_error, noise.normal_error, 60_f64.to_radians())
                .and_then(|sensor| sensor.with_tip(tip, [0.0, 0.3][random.usize(0..2)]))
                .expect("bounds are valid");
            let hypotheses = found.hypotheses;
            return Case { family: FAMILIES[family], hypotheses, sensor, settings: PlanSettings::default() };
        }
    }
}

fn models(random: &mut Rng, family: usize) -> Vec<Arc<Model>> {
    match family {
        0 => vec![solid(random)],
        1 => vec![solid(random), solid(random)],
        2 => {
            let one = solid(random);
            let other = mirrored(&one);
            vec![one, other]
        }
        3 => {
            let [a, b, c] = [0, 1, 2].map(|_| uniform(random, 60.0, 150.0));
            let depth = uniform(random, 0.1, 0.8);
            let place = [0, 1].map(|_| uniform(random, 0.1, 0.5));
            [depth, 0.5 * depth, 0.0].map(|depth| pocketed(dvec3(a, b, c), place, depth)).to_vec()
        }
        _ => {
            let [a, b] = [0, 1].map(|_| uniform(random, 60.0, 150.0));
            vec![pocketed(dvec3(a, a + uniform(random, 0.5, 8.0), b), [0.2, 0.2], 0.0)]
        }
    }
}

/// The same part seen in a mirror.
fn mirrored(model: &Model) -> Arc<Model> {
    let points: Vec<DVec3> =
        model.vertices.iter().map(|vertex| vertex.point * dvec3(-1.0, 1.0, 1.0)).collect();
    let triangles: Vec<[u32; 3]> = model.triangles.iter().map(|([a, b, c], _)| [*a, *c, *b]).collect();
    Arc::new(Model::mesh("mirror", &points, &triangles, &[], 0.0, 0.0).expect("a clean solid"))
}

/// A box with a square pocket in its top, so deep as a share of its height; 0: none.
fn pocketed(size: DVec3, [x, y]: [f64; 2], depth: f64) -> Arc<Model> {
    let corner = |k: usize| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][k];
    let level = |low: [f64; 2], side: [f64; 2], z: f64| {
        (0..4).map(move |k| dvec3(low[0] + side[0] * corner(k)[0], low[1] + side[1] * corner(k)[1], z))
    };
    let (outer, inner) = ([size.x, size.y], [0.4 * size.x, 0.4 * size.y]);
    let low = [x * size.x, y * size.y];
    let mut points: Vec<DVec3> = level([0.0; 2], outer, 0.0).chain(level([0.0; 2], outer, size.z)).collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2]];
    let band = |a: u32, b: u32| {
        (0..4).flat_map(move |k| {
            let next = (k + 1) % 4;
            [[a + k, a + next, b + next], [a + k, b + next, b + k]]
        })
    };
    triangles.extend(band(0, 4));
    if depth > 0.0 {
        points.extend(level(low, inner, size.z));
        points.extend(level(low, inner, size.z * (1.0 - depth)));
        triangles.extend(band(4, 8));
        triangles.extend(band(8, 12));
        triangles.extend([[12, 13, 14], [12, 14, 15]]);
    } else {
        triangles.extend([[4, 5, 6], [4, 6, 7]]);
    }
    Arc::new(Model::mesh("box", &points, &triangles, &[], 0.0, 0.0).expect("a clean solid"))
}
