//! What a line is said to meet, against what it meets at sampled poses.

use std::sync::atomic::AtomicBool;

use glam::{DMat3, DVec3, dvec2};

use super::Model;
use super::shadow::Shadow;
use super::shapes::{Cells, Random, Shape, cuboid, extruded, hull, mesh, regular, tetrahedron};
use crate::contact::{Contact, Evidence, Normal};
use crate::judge::{Fault, Normals, Outcome, Rules};
use crate::line::Line;
use crate::recognize::{Settings, recognize};
use crate::scene::Question;
use crate::sensor::{Sensor, Stem};
use crate::space::{Pose, PoseSet};

/// Rounding of the oracle and of the test, as a share of the size.
const ROUNDING: f64 = 1e-8;

fn shape(random: &mut Random, number: usize) -> Shape {
    match number % 6 {
        0 => extruded(&[regular(3 + random.below(5) as usize, 50.0)], random.within(20.0, 100.0)),
        1 => extruded(
            &[[(0., 0.), (90., 0.), (90., 30.), (40., 30.), (40., 100.), (0., 100.)]
                .map(|(x, y)| dvec2(x, y))
                .into()],
            35.0,
        ),
        2 => Cells::random(random, 5, 0.6).shape(),
        3 => hull(random, 12),
        4 => tetrahedron(),
        _ => cuboid(DVec3::ZERO, random.point(20.0, 120.0)),
    }
}

/// One of the shapes, or some of its triangles as loose faces.
fn model(random: &mut Random, number: usize, loose: bool) -> Model {
    let (points, triangles) = shape(random, number);
    if !loose {
        return mesh(&(points, triangles));
    }
    let some = triangles.iter().step_by(3).take(5);
    let faces: Vec<Vec<Vec<DVec3>>> =
        some.map(|corners| vec![corners.iter().map(|k| points[*k as usize]).collect()]).collect();
    Model::facets("loose", &faces, &[], &[], 0.0, 0.0).expect("clean faces")
}

/// A place on a face, and the face's normal.
fn place(random: &mut Random, model: &Model) -> (DVec3, DVec3) {
    let (corners, face) = &model.triangles[random.below(model.triangles.len() as u32) as usize];
    let [a, b, c] = corners.map(|k| model.vertices[k as usize].point);
    let (u, v) = (random.next(), random.next());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    (a + u * (b - a) + v * (c - a), model.faces[*face as usize].normal)
}

/// Contacts of a part at a pose, with errors within their bounds.
fn evidence(random: &mut Random, model: &Model, pose: Pose, count: usize) -> Evidence<DVec3> {
    let (position, turn) = (0.002 * model.size * random.next(), 0.1 * random.next());
    let contacts = (0..count).map(|_| {
        let (point, normal) = place(random, model);
        let axis = normal.cross(random.direction()).normalize();
        let normal = DMat3::from_axis_angle(axis, turn * random.next()) * normal;
        let error = position * random.next() * random.direction();
        Contact {
            center: pose.apply(point) + error,
            tip_radius: 0.0,
            position_error: position,
            normal: Some(Normal { direction: pose.rotation * normal, error: turn }),
            approach: None,
            start: None,
        }
    });
    Evidence { contacts: contacts.collect(), misses: Vec::new(), prior: None }
}

/// Where a ball on a line first is its radius away from a part, and the way there from the nearest point: by spheres, each as
/// large as the part leaves it (Hart 1996). A point: by rays. Nothing of the judge's own.
fn first_contact(model: &Model, pose: Pose, line: &Line<DVec3>, radius: f64) -> Option<(f64, DVec3)> {
    let back = pose.inverse();
    let (start, direction) = (back.apply(line.start), back.rotation * line.direction);
    if radius == 0.0 {
        let hit = model.first_hit(start, direction)?;
        let normal = model.faces[hit.face as usize].normal;
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        return Some((hit.distance, pose.rotation * normal));
    }
    let (mut depth, far) = (0.0, start.length() + 4.0 * model.size);
    while depth < far {
        let at = start + depth * direction;
        let nearest = model.nearest(at);
        let clear = nearest.distance - radius;
        if clear < 1e-11 * model.size {
            return Some((depth, pose.rotation * ((at - nearest.point) / nearest.distance)));
        }
        depth += clear;
    }
    None
}

/// Whether a stem touches a part before the tip does, seen at many places.
fn stem_touches(model: &Model, pose: Pose, line: &Line<DVec3>, stem: &Stem, radius: f64, depth: f64) -> bool {
    let back = pose.inverse();
    let near = radius - stem.radius;
    (0..=24).any(|k| {
        (0..=24).any(|j| {
            let tip = line.at(depth * f64::from(k) / 24.0);
            let at = tip + stem.direction * (near + (stem.length - near) * f64::from(j) / 24.0);
            model.signed_distance(back.apply(at)) < stem.radius - 1e-9
        })
    })
}

fn holds(outcome: &Outcome<DVec3>, depth: f64, normal: DVec3, rounding: f64, turn: f64) -> bool {
    outcome.touches.iter().any(|touch| {
        touch.depth.low - rounding <= depth
            && depth <= touch.depth.high + rounding
            && touch.normals.angle_to(normal) <= turn
    })
}

/// A line towards some point of a part at a pose, with an offset across, that begins outside of everything or not.
fn line(random: &mut Random, model: &Model, pose: Pose, shadow: &Shadow) -> Line<DVec3> {
    let (aim, normal) = place(random, model);
    let direction = (random.direction() - 1.5 * random.next() * (pose.rotation * normal)).normalize();
    let aim = pose.apply(aim);
    let back = if random.below(4) == 0 { 0.6 * model.size * random.next() } else { 3.0 * shadow.radius };
    Line { start: aim - back * direction, direction }
}

struct Seen {
    readings: usize,
    single: usize,
    faults: usize,
    stems: usize,
}

fn check(seed: u64, problems: usize, radius_share: f64, with_stem: bool, loose: bool) -> Seen {
    let mut random = Random(seed);
    let rules = Rules { faces: true, edges: true, vertices: true, avoid_assigned: false };
    let mut seen = Seen { readings: 0, single: 0, faults: 0, stems: 0 };
    for number in 0..problems {
        let model = std::sync::Arc::new(model(&mut random, number, loose));
        let pose = random.pose();
        let count = 2 + random.below(5) as usize;
        let evidence = evidence(&mut random, &model, pose, count);
        let settings = Settings { effort: Some(2_000), ..Settings::default() };
        let found = recognize(&[std::sync::Arc::clone(&model)], &evidence, &settings).expect("good input");
        for hypothesis in found.hypotheses.iter().take(2) {
            let poses: &PoseSet = &hypothesis.poses;
            let shadow = Shadow::new(poses);
            let mut samples = poses.sample(8, seed);
            samples.push(pose);
            samples.retain(|pose| poses.contains(*pose));
            if samples.is_empty() {
                continue;
            }
            for _ in 0..12 {
                let radius = radius_share * model.size * random.next();
                let path_error = 0.003 * model.size * random.next();
                let margin = 0.002 * model.size * random.next();
                let turn = margin / model.size;
                let stem = with_stem.then(|| Stem {
                    direction: random.direction(),
                    radius: 0.4 * radius,
                    length: model.size * random.next(),
                });
                let sensor = Sensor {
                    position_error: 0.1,
                    normal_error: Some(0.05),
                    max_incidence: 1.0,
                    tip_radius: radius,
                    path_error,
                    stem,
                };
                let at = samples[random.below(samples.len() as u32) as usize];
                let line = line(&mut random, &model, at, &shadow);
                let (line, sensor) = (&line, &sensor);
                let (angle_margin, length) = (turn, f64::INFINITY);
                let halt = &AtomicBool::new(false);
                let ask = Question { line, sensor, rules, margin, angle_margin, length, halt };
                let outcome = shadow.outcome(&ask, |_| false);
                seen.single += usize::from(outcome.touches.len() == 1 && !outcome.may_miss);
                seen.faults += usize::from(outcome.fault.is_some());
                for pose in &samples {
                    let across = random.direction();
                    let across = across - line.direction * across.dot(line.direction);
                    let off = (path_error + margin) * across.normalize_or_zero();
                    let moved = Line { start: line.start + off, ..*line };
                    let rounding = ROUNDING * model.size;
                    let begin = model.signed_distance(pose.inverse().apply(moved.start));
                    if begin <= radius {
                        assert_eq!(outcome.fault, Some(Fault::Start), "problem {number} of {seed}");
                        continue;
                    }
                    seen.readings += 1;
                    let met = first_contact(&model, *pose, &moved, radius);
                    // A tip that passes a part by no more than rounding may be said to touch it or not.
                    let Some((depth, normal)) = met else {
                        assert!(outcome.may_miss, "problem {number} of {seed}: {line:?} {outcome:?}");
                        continue;
                    };
                    assert!(
                        holds(&outcome, depth, normal, rounding, 1e-5),
                        "problem {number} of {seed}, r {radius}: {depth} {normal} {outcome:?}"
                    );
                    if let Some(stem) = &stem
                        && stem_touches(&model, *pose, &moved, stem, radius, depth)
                    {
                        seen.stems += 1;
                        assert!(outcome.fault.is_some(), "problem {number} of {seed}: {stem:?}");
                    }
                }
            }
        }
    }
    seen
}

#[test]
fn no_reading_of_a_point_is_left_out() {
    let seen = check(1, 60, 0.0, false, false);
    println!("{} readings, {} single, {} faults", seen.readings, seen.single, seen.faults);
    assert!(seen.readings > 3_000 && seen.single > 20);
}

#[test]
fn no_reading_of_a_ball_is_left_out() {
    let seen = check(2, 60, 0.1, false, false);
    println!("{} readings, {} single, {} faults", seen.readings, seen.single, seen.faults);
    assert!(seen.readings > 3_000 && seen.single > 20);
}

/// Faces that nothing joins can be met from behind; of few contacts sets are wide, so that some poses show the one side and some
/// the other.
#[test]
fn no_reading_of_loose_faces_is_left_out() {
    for (seed, radius) in [(4, 0.0), (5, 0.1)] {
        let seen = check(seed, 24, radius, false, true);
        println!("{} readings, {} single, {} faults", seen.readings, seen.single, seen.faults);
        assert!(seen.readings > 1_000 && seen.faults > 20);
    }
}

#[test]
fn no_stem_touches_unseen() {
    let seen = check(3, 30, 0.05, true, false);
    println!(
        "{} readings, {} single, {} faults, {} stems",
        seen.readings, seen.single, seen.faults, seen.stems
    );
    assert!(seen.stems > 100);
}
