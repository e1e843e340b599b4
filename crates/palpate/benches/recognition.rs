//! Times of the core on one core of the machine: from contacts to hypotheses with pose sets, and what they answer.
//!
//! Problems are taken in turn, so that a figure is a mean over them; docs/speed.md has medians (`make speed`).

#[path = "../tests/common/bundled.rs"]
mod bundled;
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../examples/measure/mod.rs"]
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/solids.rs"]
mod solids;

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

use common::{Noise, Problem, contacts, regular};
use criterion::{BatchSize, Criterion, criterion_main};
use fastrand::Rng;
use glam::{DVec2, DVec3, dvec2};
use palpate::plane::{Model, Pose};
use palpate::{Evidence, Line, Prior, Recognition, Settings, recognize, space};

/// ±0.5 and ±4°.
fn noise() -> Noise {
    Noise { position_error: 0.5, normal_error: Some(4_f64.to_radians()), tip_radius: 0.0 }
}

fn solve(models: &[Arc<Model>], evidence: &Evidence) -> Recognition {
    recognize(models, evidence, &Settings::default()).expect("a well-formed problem")
}

/// Random pairs of contacts on the six objects, each object as often as the others.
fn pairs(objects: &[Arc<Model>]) -> Vec<Problem> {
    let mut random = Rng::with_seed(11);
    (0..300).map(|k| contacts(&mut random, objects[k % 6].clone(), 2, &noise())).collect()
}

fn recognition(criterion: &mut Criterion) {
    let objects = parts::OBJECTS.map(parts::part);
    let problems = pairs(&objects);
    let mut group = criterion.benchmark_group("two contacts");
    let mut turn = problems.iter().cycle();
    let mut next = move || turn.next().expect("endless");
    group.bench_function("six objects", |bencher| bencher.iter(|| solve(&objects, &next().evidence)));
    let mut turn = problems.iter().cycle();
    let mut next = move || turn.next().expect("endless");
    group.bench_function("one object", |bencher| {
        bencher.iter(|| {
            let problem = next();
            solve(std::slice::from_ref(&problem.model), &problem.evidence)
        });
    });
    for name in parts::OBJECTS {
        let evidence = bundled::evidence(name);
        group.bench_function(format!("six objects, bundled contacts of {name}"), |bencher| {
            bencher.iter(|| solve(&objects, &evidence));
        });
    }
    group.finish();
}

fn explosion(criterion: &mut Criterion) {
    let noise = Noise { position_error: 4.0, normal_error: Some(15_f64.to_radians()), tip_radius: 0.0 };
    let problem = contacts(&mut Rng::with_seed(1), regular(200, 50.0), 8, &noise);
    let mut group = criterion.benchmark_group("many assignments");
    group.sample_size(20);
    group.bench_function("200-gon, eight contacts", |bencher| {
        bencher.iter(|| solve(std::slice::from_ref(&problem.model), &problem.evidence));
    });
    group.finish();
}

/// A model and its pair tables, which are made when it is first recognized; a prior far away leaves nothing else to do.
fn tables(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("model");
    let problem = contacts(&mut Rng::with_seed(1), regular(200, 50.0), 1, &noise());
    let far = Prior::new(Pose::new(0.0, dvec2(1e4, 0.0)), 1.0, 0.1).expect("a prior");
    let evidence = Evidence { prior: Some(far), ..problem.evidence };
    for num_faces in [12, 200] {
        let corners: Vec<_> = regular(num_faces, 50.0).vertices.iter().map(|vertex| vertex.point).collect();
        let model = || Model::polygon("part", &corners, &[], &[], 0.0, 0.0).expect("a polygon");
        group.bench_function(format!("read, {num_faces} faces"), |bencher| bencher.iter(model));
        group.bench_function(format!("pair tables, {num_faces} faces"), |bencher| {
            let fresh = || [Arc::new(model())];
            bencher.iter_batched(fresh, |models| solve(&models, &evidence), BatchSize::SmallInput);
        });
    }
    group.finish();
}

fn pose_sets(criterion: &mut Criterion) {
    let objects = parts::OBJECTS.map(parts::part);
    let problems = pairs(&objects);
    let found: Vec<_> = problems
        .iter()
        .map(|problem| {
            let all = solve(std::slice::from_ref(&problem.model), &problem.evidence).hypotheses;
            let mut all = all.into_iter();
            all.find(|one| one.poses.contains(problem.world_from_model)).expect("the true pose is never lost")
        })
        .collect();
    let mut turn = problems.iter().zip(&found).cycle();
    let mut next = move || turn.next().expect("endless");
    let mut group = criterion.benchmark_group("pose set");
    group.bench_function("contains", |bencher| {
        bencher.iter(|| {
            let (problem, one) = next();
            one.poses.contains(problem.world_from_model)
        });
    });
    group.bench_function("sample of 100", |bencher| bencher.iter(|| next().1.poses.sample(100, 0)));
    group.bench_function("rotation bound", |bencher| bencher.iter(|| next().1.poses.rotation_bound()));
    group.bench_function("excursion", |bencher| bencher.iter(|| next().1.poses.excursion(dvec2(50.0, 20.0))));
    group.bench_function("largest slack", |bencher| {
        // It is found once for each set: a fresh one each time.
        let fresh = || {
            let problem = next().0;
            solve(std::slice::from_ref(&problem.model), &problem.evidence)
        };
        let first = |found: Recognition| found.hypotheses.first().map(|one| one.poses.largest_slack());
        bencher.iter_batched(fresh, first, BatchSize::SmallInput);
    });
    group.finish();
}

/// A torus with bumps, so that no two of its triangles are in one plane; of a prism where few faces are asked for.
fn solid(num_faces: u32) -> space::Model {
    let (across, around) = match num_faces {
        300 => (10, 15),
        5000 => (50, 50),
        _ => (0, num_faces - 2),
    };
    let turn = |k: u32, count: u32| TAU * f64::from(k) / f64::from(count);
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for k in 0..around {
        let out = DVec2::from_angle(turn(k, around)).extend(0.0);
        if across == 0 {
            points.extend([50.0 * out, 50.0 * out + 60.0 * DVec3::Z]);
            let [a, b] = [2 * k, 2 * ((k + 1) % around)];
            triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            triangles.extend(if k > 1 { vec![[0, a, a - 2], [1, a - 1, a + 1]] } else { vec![] });
            continue;
        }
        for j in 0..across {
            let bump = 30.0 + 3.0 * f64::from((7 * k + 5 * j) % 11) / 10.0;
            let place = bump * DVec2::from_angle(turn(j, across));
            points.push((65.0 + place.x) * out + place.y * DVec3::Z);
            let at = |k: u32, j: u32| (k % around) * across + j % across;
            let [a, b, c, d] = [at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    space::Model::mesh("solid", &points, &triangles, &[], 0.0, 0.0).expect("a closed surface")
}

/// Lines towards a part, most of which meet it, at a random pose.
fn first_contacts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("first contact in space");
    for num_faces in [12, 300, 5000] {
        let model = solid(num_faces);
        assert_eq!((model.faces.len(), model.closed), (num_faces as usize, true));
        let mut random = Rng::with_seed(1);
        let pose = solids::pose(&mut random);
        let lines: Vec<_> = (0..1000)
            .map(|_| {
                let start = 1.5 * model.size * solids::direction(&mut random);
                let target = 0.5 * model.size * random.f64() * solids::direction(&mut random);
                let direction = (target - start).try_normalize().expect("they differ");
                Line { start: pose.apply(start), direction: pose.rotation * direction }
            })
            .collect();
        for radius in [0.0, 3.0, 30.0] {
            let mut turn = lines.iter().cycle();
            let mut next = move || turn.next().expect("endless");
            group.bench_function(format!("{num_faces} faces, tip of radius {radius}"), |bencher| {
                bencher.iter(|| model.first_contact(pose, next(), radius));
            });
        }
    }
    group.finish();
}

fn benches() {
    measure::use_one_core();
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .configure_from_args();
    recognition(&mut criterion);
    explosion(&mut criterion);
    tables(&mut criterion);
    pose_sets(&mut criterion);
    first_contacts(&mut criterion);
    criterion.final_summary();
}

criterion_main!(benches);
