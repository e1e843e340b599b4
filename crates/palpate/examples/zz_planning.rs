//! Scratch figures of the planners.
#![allow(warnings)]
#![allow(clippy::all)]
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;
use common::{Noise, contacts};
use fastrand::Rng;
use palpate::*;
use std::time::Instant;

fn main() {
    let objects = parts::OBJECTS.map(parts::part);
    let mut random = Rng::with_seed(5);
    let noise = Noise { position_error: 0.5, normal_error: Some(4_f64.to_radians()), tip_radius: 0.0 };
    let sensor = Sensor::new(0.5, Some(4_f64.to_radians()), 60_f64.to_radians()).unwrap();
    let (low, high): (usize, usize) = (
        std::env::args().nth(1).map_or(20, |a| a.parse().unwrap()),
        std::env::args().nth(2).map_or(25, |a| a.parse().unwrap()),
    );
    let count: usize = std::env::args().nth(3).map_or(5, |a| a.parse().unwrap());
    let num_random: usize = std::env::args().nth(4).map_or(20000, |a| a.parse().unwrap());
    let mut done = 0;
    for k in 0.. {
        let problem = contacts(&mut random, objects[k % 6].clone(), 2, &noise);
        let found = recognize(&objects, &problem.evidence, &Settings::default()).unwrap();
        let n = found.hypotheses.len();
        if n < low || n > high {
            continue;
        }
        let started = Instant::now();
        let auto = plan(&found.hypotheses, &sensor, &PlanSettings::default()).unwrap();
        let auto_time = started.elapsed();
        let started = Instant::now();
        let settings = PlanSettings {
            planner: if std::env::var("AUTO").is_ok() { Planner::Auto } else { Planner::Complete },
            effort: 300_000,
            ..PlanSettings::default()
        };
        let complete = plan(&found.hypotheses, &sensor, &settings).unwrap();
        let complete_time = started.elapsed();
        let show = |p: &Plan| {
            p.path.as_ref().map(|p| {
                (
                    p.score,
                    (p.expected_score * 100.0).round() / 100.0,
                    (p.margin * 100.0).round() / 100.0,
                    p.classes.len(),
                )
            })
        };
        println!(
            "n {n} auto {:?} {auto_time:?} judged {} | complete {:?} {complete_time:?} judged {} boxes {} bound {:.3} proved {}",
            show(&auto),
            auto.num_judged,
            show(&complete),
            complete.num_judged,
            complete.num_boxes,
            complete.bound,
            complete.proved
        );
        let best = bench_random(
            &found.hypotheses,
            &sensor,
            num_random,
            complete.path.as_ref().map_or(f64::INFINITY, |p| p.score),
        );
        println!("    random {best:?}");
        done += 1;
        if done >= count {
            break;
        }
    }
}

fn bench_random(h: &[Hypothesis], sensor: &Sensor, count: usize, at_most: f64) -> (f64, f64) {
    let mut random = Rng::with_seed(9);
    let started = Instant::now();
    let (mut best, mut margin) = (f64::INFINITY, 0.0);
    let settings = PlanSettings::default();
    let prepared = palpate::plan::Prepared::new(h, sensor, &settings).unwrap();
    for _ in 0..count {
        let line = prepared.line(7.0 * random.f64(), (2.0 * random.f64() - 1.0) * prepared.radius()).unwrap();
        if let Some(score) = prepared.score(&line) {
            if score < best {
                best = score;
                if score < at_most {
                    margin = prepared.judge(&line).margin;
                }
            }
        }
    }
    println!("    {:?} per random line", started.elapsed() / count as u32);
    (best, margin)
}
