#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/smooth.rs"]
mod smooth;
use common::{Noise, contacts, star};
use fastrand::Rng;
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let faces: usize = a[2].parse().unwrap();
    let k: usize = a[3].parse().unwrap();
    let only: Option<usize> = a.get(4).map(|s| s.parse().unwrap());
    let mut random = Rng::with_seed(faces as u64);
    let model = if a[1] == "star" { star(&mut random, faces) } else { smooth::pebble(faces) };
    let noise = Noise { position_error: 0.5, normal_error: Some(4f64.to_radians()), tip_radius: 0.0 };
    measure::on_one_core(|| {
        for n in 0..25 {
            let p = contacts(&mut random, model.clone(), k, &noise);
            if only.is_some_and(|o| o != n) {
                continue;
            }
            let t = Instant::now();
            let f = measure::solve(&p);
            eprintln!(
                "{n} {:?} boxes {} hyp {} {:?}",
                t.elapsed(),
                f.reports[0].num_boxes,
                f.hypotheses.len(),
                f.reports[0].counters
            );
        }
    });
}
