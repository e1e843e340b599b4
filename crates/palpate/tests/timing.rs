mod common;
#[path = "common/parts.rs"]
mod parts;
use common::*;
use fastrand::Rng;
use palpate::{Settings, recognize};
use std::time::Instant;
#[test]
fn timing() {
    let models: Vec<_> = parts::OBJECTS.iter().map(|n| parts::part(n)).collect();
    let noise = Noise { position_error: 0.5, normal_error: Some(4f64.to_radians()), tip_radius: 0.0 };
    let mut problems = Vec::new();
    let mut random = Rng::with_seed(5);
    for k in 0..300 {
        problems.push(contacts(&mut random, models[k % 6].clone(), 2, &noise));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut times = Vec::new();
        let mut n = 0;
        let mut ni = 0;
        for p in &problems {
            let f = recognize(&models, &p.evidence, &Settings::default()).unwrap();
            let t = Instant::now();
            let f2 = recognize(&models, &p.evidence, &Settings::default()).unwrap();
            times.push(t.elapsed().as_secs_f64() * 1e3);
            n += f.hypotheses.len();
            ni += f2.interpretation_count().at_least;
        }
        times.sort_by(f64::total_cmp);
        println!(
            "median {} p90 {} max {} hyps {} interps {}",
            times[150],
            times[270],
            times[299],
            n as f64 / 300.,
            ni as f64 / 300.
        );
    });
}
