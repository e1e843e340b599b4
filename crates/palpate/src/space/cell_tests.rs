//! Cells against a pose that they hold, with every error at its bound: no discard takes it, no bound cuts it off.

use std::f64::consts::{PI, TAU};
use std::sync::Arc as Shared;

use glam::{DMat3, DVec3};

use super::case::{Case, PivotPose};
use super::cell::{Cell, Conditions};
use super::first_cells::first_cells;
use super::hypotheses::sensed;
use super::pose::{rotation, vector};
use super::sensed::sensed_range;
use super::shapes::{Cells, Random, Shape, hull, mesh};
use super::tables::Kinds;
use super::{Lying, Model, Pose, Prior, solve, subdivide};
use crate::contact::{Contact, Evidence, Miss, Normal};
use crate::feature::Feature;
use crate::recognize::Settings;
use crate::tree::FeaturePairs;

/// Random evidence of a model at a pose.
struct Problem {
    evidence: Evidence<DVec3>,
    pose: Pose,
    /// Of each contact what it lies on, and some features more.
    truths: Vec<Feature>,
    choices: Vec<Vec<Feature>>,
    tip: bool,
}

fn one_of<T: Copy, const N: usize>(random: &mut Random, all: [T; N]) -> T {
    all[random.below(N as u32) as usize]
}

/// In half of all cases as much as there is.
fn share(random: &mut Random) -> f64 {
    let some = random.next();
    one_of(random, [1.0 - 1e-12, some])
}

/// A pyramid with a front of many faces and two behind: its apex has most normals on one side.
fn blade(random: &mut Random) -> Shape {
    let wide = one_of(random, [2.0, 8.0, 20.0]);
    let mut points: Vec<DVec3> = (-4..5)
        .map(|k| {
            let (sine, cosine) = f64::to_radians(wide * f64::from(k) / 4.0).sin_cos();
            DVec3::new(10.0 * cosine + 2.0, 480.0 / wide * sine, 0.0)
        })
        .collect();
    points.push(DVec3::new(random.within(-42.0, -12.0), 0.0, 0.0));
    points.push(DVec3::new(3.0, 0.0, random.within(5.0, 65.0)));
    let bottom = (1..9).map(|k| [0, k + 1, k]);
    let sides = (0..10).map(|k| [k, (k + 1) % 10, 10]);
    (points, bottom.chain(sides).collect())
}

/// A place on a feature that can be touched, often at its end, with one of its normals.
fn place(random: &mut Random, model: &Model, faces_only: bool) -> (Feature, DVec3, DVec3) {
    let at = |k: u32| model.vertices[k as usize].point;
    loop {
        match if faces_only { 0 } else { random.below(3) } {
            0 => {
                let (corners, face) = &model.triangles[random.below(model.triangles.len() as u32) as usize];
                let [a, b, c] = corners.map(at);
                let (u, v) = (random.next(), random.next());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let (u, v) = one_of(random, [(u, v), (u, v), (0.0, v), (0.0, 0.0)]);
                let point = a + u * (b - a) + v * (c - a);
                return (Feature::Face(*face), point, model.faces[*face as usize].normal);
            }
            1 => {
                let number = random.below(model.edges.len() as u32);
                let edge = &model.edges[number as usize];
                let Some([a, b]) = edge.normals else { continue };
                let [along, across] = [(); 2].map(|()| {
                    let some = random.next();
                    one_of(random, [0.0, 1.0, some, some])
                });
                let Some(normal) = a.lerp(b, across).try_normalize() else { continue };
                let [from, to] = edge.ends.map(at);
                return (Feature::Edge(number), from.lerp(to, along), normal);
            }
            _ => {
                let number = random.below(model.vertices.len() as u32);
                let Some(corners) = &model.vertices[number as usize].normals else { continue };
                let power = one_of(random, [0, 1, 8, 30]);
                let normal: DVec3 = corners.iter().map(|one| random.next().powi(power) * *one).sum();
                let Some(normal) = normal.try_normalize() else { continue };
                return (Feature::Vertex(number), at(number), normal);
            }
        }
    }
}

/// A direction so far from another.
fn beside(random: &mut Random, from: DVec3, angle: f64) -> DVec3 {
    DMat3::from_axis_angle(from.cross(random.direction()).normalize(), angle) * from
}

/// A prior that allows a pose.
fn prior(random: &mut Random, pose: Pose, size: f64) -> Prior {
    let (most, away) = (1.5 * random.next(), 0.3 * size * random.next());
    let (turned, shifted) = (most * share(random), away * share(random));
    if random.below(2) == 0 {
        let back = rotation(random.direction() * turned);
        let shift = DVec3::new(shifted, -shifted, shifted);
        let middle = Pose { rotation: back * pose.rotation, translation: pose.translation + shift };
        return Prior::new(middle, away, most).expect("good input");
    }
    let normal = random.direction();
    let across = normal.cross(random.direction()).normalize();
    let (tilt, height) = (0.4 * random.next(), 0.1 * size * random.next());
    let motion = rotation(normal * turned) * rotation(across * (tilt * share(random)));
    let shift = across * shifted + normal * (height * share(random));
    let middle = Pose { rotation: motion.transpose() * pose.rotation, translation: pose.translation + shift };
    Prior {
        lying: Some(Lying { normal, height, tilt }),
        ..Prior::new(middle, away, most).expect("good input")
    }
}

/// A way that a tip just passes.
fn miss(random: &mut Random, model: &Model, pose: Pose) -> Option<Miss<DVec3>> {
    const STEPS: i32 = 1000;
    let from = pose.translation + random.direction() * model.size;
    let to = from + random.direction() * model.size;
    let at = |k: i32| pose.inverse().apply(from.lerp(to, f64::from(k) / f64::from(STEPS)));
    let nearest = (0..=STEPS).map(|k| model.signed_distance(at(k))).fold(f64::INFINITY, f64::min);
    let clear = nearest - 0.5 * model.size / f64::from(STEPS);
    (clear > 0.0).then(|| Miss::new(from, to, clear, 0.0).expect("good input"))
}

fn problem(random: &mut Random, model: &Model) -> Problem {
    let size = model.size;
    let angle = 3.0 * random.next();
    let turn = random.direction() * one_of(random, [PI, angle, 1e-7]);
    let pose = Pose::new(turn, random.direction() * size * random.next());
    let tip = random.below(2) == 1;
    let radius = if tip { size * one_of(random, [0.01, 0.05, 0.5]) } else { 0.0 };
    let error = size * one_of(random, [0.0, 1e-6, 1e-3, 0.02]);
    let turn = one_of(random, [0.0, 1e-6, 0.05, 0.3, 1.2]);
    let (mut contacts, mut truths, mut choices) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..=random.below(5) {
        let (feature, point, normal) = place(random, model, !tip);
        let share = share(random);
        let center = pose.apply(point + radius * normal) + random.direction() * error * share;
        let normal = pose.rotation * normal;
        let mut contact = Contact::new(center, radius, error).expect("good input");
        if random.below(4) > 0 {
            let sensed = beside(random, normal, turn * share);
            contact = contact.with_normal(Normal::new(sensed, turn).expect("good input"));
        }
        if random.below(2) == 0 {
            let oblique = 1.57 * random.next();
            contact = contact.with_approach(beside(random, -normal, oblique)).expect("good input");
        }
        contacts.push(contact);
        let more = (0..random.below(4)).map(|_| place(random, model, !tip).0);
        let mut choice: Vec<Feature> = more.chain([feature]).collect();
        choice.sort_unstable();
        choice.dedup();
        truths.push(feature);
        choices.push(choice);
    }
    let prior = (random.below(3) == 0).then(|| prior(random, pose, size));
    let misses =
        if random.below(3) == 0 { miss(random, model, pose).into_iter().collect() } else { Vec::new() };
    Problem { evidence: Evidence { contacts, misses, prior }, pose, truths, choices, tip }
}

/// The tables allow the features that were touched.
fn check_tables(case: &Case, problem: &Problem) {
    let tables = case.model.feature_tables(Kinds { faces: true, edges: problem.tip, vertices: problem.tip });
    let (candidates, all) = (subdivide::candidates(case, &tables), tables.features());
    let number = |one: &Feature| all.iter().position(|other| other == one).expect("it can be touched");
    let numbers: Vec<usize> = problem.truths.iter().map(number).collect();
    let of = |contact: usize| sensed(case, &case.data[contact]);
    for (k, number) in numbers.iter().enumerate() {
        assert!(candidates[k].contains(number));
        for (j, other) in numbers[..k].iter().enumerate() {
            let range = sensed_range(&of(j), &of(k));
            assert!(range.meets(&tables.pair(*other, *number)));
            if let Some(mut near) = tables.near_angle(*other, range.angle) {
                assert!(near.any(|one| one == *number));
            }
        }
    }
}

/// A cell of any size and chart that holds a pose, often at a corner; and the pose's vector in its chart.
fn cell_about(random: &mut Random, conditions: &Conditions<'_>, truth: PivotPose) -> (Cell, DVec3) {
    let scale = 2.0 * 10_f64.powf(-8.0 * random.next());
    let v_half = random.point(0.0, scale);
    let y_half = random.point(0.0, scale * conditions.case.model.size);
    let away = one_of(random, [0.1, 1.0, 3.1, PI]);
    let base = rotation(random.direction() * away) * truth.rotation;
    let v = vector(truth.rotation * base.transpose());
    let v = if random.below(4) == 0 { v - v.normalize_or_zero() * TAU } else { v };
    let mut corner = || {
        DVec3::from_array([(); 3].map(|()| {
            let some = random.within(-1.0, 1.0);
            one_of(random, [-1.0, 1.0, some]) * (1.0 - 1e-12)
        }))
    };
    let (turn, shift) = (corner(), corner());
    let left = solve::all_sites(conditions);
    let y = truth.y + shift * y_half;
    (Cell { base, v: v + turn * v_half, v_half, y, y_half, left, cuts: Vec::new() }, v)
}

/// Other charts and other frames hold the pose as well.
fn check_charts(random: &mut Random, cell: &Cell, truth: PivotPose, size: f64) {
    let other = rotation(random.direction() * random.next()) * truth.rotation;
    if let Some(rebased) = cell.rebased(other) {
        let v = rebased.coordinates(truth.rotation);
        assert!((v - rebased.v).abs().cmple(rebased.v_half).all());
    }
    let angle = 3.0 * random.next();
    let motion = Pose::new(random.direction() * angle, random.direction() * size);
    let moved = PivotPose { rotation: motion.rotation * truth.rotation, y: motion.apply(truth.y) };
    assert!(cell.moved(motion).holds(moved, 1e-10 * size, 0.0));
}

/// What is discarded of a cell does not hold the pose, whose vector is `v`.
fn check_cell(random: &mut Random, conditions: &Conditions<'_>, mut cell: Cell, truth: PivotPose, v: DVec3) {
    let size = conditions.case.model.size;
    assert!(cell.restrict(conditions));
    for _ in 0..random.below(3) {
        let turn = rotation(random.direction() * 0.3 * random.next());
        let y = truth.y + random.direction() * 0.2 * size * random.next();
        cell.cut_at(conditions, PivotPose { rotation: turn * truth.rotation, y }, &mut Vec::new());
    }
    let (turn, shift) = (v - cell.v, truth.y - cell.y);
    if cell.is_narrow() {
        let rows = cell.rows(conditions, false);
        for row in &rows {
            let x = [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, 0.0];
            let value: f64 = row.normal.iter().zip(x).map(|(a, b)| a * b).sum();
            assert!(value <= row.bound + 1e-13 * size);
        }
        assert!(cell.candidate(&rows).is_some());
    }
    let left = solve::contracted(conditions, cell.clone()).expect("it holds a pose");
    assert!((v - left.v).abs().cmple(left.v_half + 1e-11).all());
    assert!((truth.y - left.y).abs().cmple(left.y_half + 1e-10 * size).all());
    // Where a point is placed, along an axis.
    let (point, axis) = (random.direction() * size, random.direction());
    let (along, offset) = (cell.rotation() * axis, point - cell.y);
    let (about, loose) = cell.turned(along, offset);
    let value = (truth.rotation * axis).dot(point - truth.y) - along.dot(offset);
    assert!((value - about.dot(turn) + along.dot(shift)).abs() <= loose + 1e-10 * size);
    if random.below(20) == 0 {
        assert!(solve::witness_within(conditions, &[cell], &mut 30).is_some());
    }
}

#[test]
fn no_cell_loses_a_pose_that_it_holds() {
    let mut random = Random(5);
    let mut narrow = 0;
    for round in 0..120 {
        let shape = match round % 4 {
            0 => hull(&mut random, 8 + round / 4),
            1 => Cells::random(&mut random, 3, 0.5).shape(),
            2 => hull(&mut random, 5),
            _ => blade(&mut random),
        };
        let model = Shared::new(mesh(&shape));
        let problem = problem(&mut random, &model);
        let case = Case::new(&model, &problem.evidence, &Settings::default(), &Shared::default());
        check_tables(&case, &problem);
        let features = problem.choices.iter().enumerate().map(|(contact, one)| (contact, one.as_slice()));
        let conditions = Conditions::new(&case, features).expect("all can be touched");
        let truth = case.pivot_pose(problem.pose);
        assert!(conditions.satisfied(truth, 1e-9 * model.size, 1e-9), "problem {round}");
        let conditions = if random.below(4) == 0 { conditions.relaxed() } else { conditions };
        let first: Vec<_> = first_cells(&conditions).collect();
        assert!(first.iter().any(|cell| cell.holds(truth, 1e-12 * model.size, 0.0)), "problem {round}");
        for _ in 0..40 {
            let (cell, v) = cell_about(&mut random, &conditions, truth);
            assert!(cell.holds(truth, 1e-12 * model.size, 0.0));
            check_charts(&mut random, &cell, truth, model.size);
            narrow += u32::from(cell.is_narrow());
            check_cell(&mut random, &conditions, cell, truth, v);
        }
    }
    assert!(narrow > 3000, "{narrow}");
}
