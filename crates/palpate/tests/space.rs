//! Recognition in space against its own definition: random parts, poses and contacts with errors at their bounds.

use std::sync::Arc;

use glam::{DVec3, dvec3};
use palpate::recognize::recognize_until;
use palpate::space::{Model, Pose};
use palpate::{Contact, Evidence, Normal, Recognition, Settings, recognize};

struct Random(fastrand::Rng);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0.f64()
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = dvec3(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0;
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v / v.length();
            }
        }
    }

    fn pose(&mut self) -> Pose {
        let turn = self.direction() * self.unit() * std::f64::consts::PI;
        Pose::new(turn, self.direction() * 100.0 * self.unit())
    }
}

/// A prism over a polygon, counter-clockwise, as a mesh.
fn prism(name: &str, outline: &[[f64; 2]], height: f64) -> Arc<Model> {
    let count = outline.len() as u32;
    let bottom = outline.iter().map(|[x, y]| dvec3(*x, *y, 0.0));
    let top = outline.iter().map(|[x, y]| dvec3(*x, *y, height));
    let vertices: Vec<DVec3> = bottom.chain(top).collect();
    let mut triangles = Vec::new();
    for k in 1..count - 1 {
        triangles.push([0, k + 1, k]);
        triangles.push([count, count + k, count + k + 1]);
    }
    for k in 0..count {
        let next = (k + 1) % count;
        triangles.push([k, next, count + next]);
        triangles.push([k, count + next, count + k]);
    }
    Arc::new(Model::mesh(name, &vertices, &triangles, &[], 0.0, 0.0).expect("good input"))
}

/// An outline that is convex, so that fans triangulate it.
fn outline(random: &mut Random) -> Vec<[f64; 2]> {
    let count = 4 + random.0.usize(..4);
    let mut angles: Vec<f64> = (0..count).map(|k| (k as f64 + 0.6 * random.unit()) / count as f64).collect();
    angles.sort_by(f64::total_cmp);
    let (a, b) = (60.0 + 40.0 * random.unit(), 40.0 + 40.0 * random.unit());
    angles.iter().map(|t| (t * std::f64::consts::TAU).sin_cos()).map(|(s, c)| [a * c, b * s]).collect()
}

/// A contact of a tip on an edge or a vertex that can be touched, with errors within the bounds.
fn touch_with_tip(random: &mut Random, model: &Model, pose: Pose, bounds: Bounds) -> Option<Contact<DVec3>> {
    let (point, normal) = if random.0.bool() {
        let edge = &model.edges[random.0.usize(..model.edges.len())];
        let [a, b] = edge.normals?;
        let [from, to] = edge.ends.map(|k| model.vertices[k as usize].point);
        (from.lerp(to, random.unit()), a.lerp(b, random.unit()).normalize_or_zero())
    } else {
        let vertex = &model.vertices[random.0.usize(..model.vertices.len())];
        let corners = vertex.normals.as_ref()?;
        let mixed: DVec3 = corners.iter().map(|corner| random.unit() * *corner).sum();
        (vertex.point, mixed.normalize_or_zero())
    };
    Some(reading(random, point, normal, pose, bounds))
}

#[derive(Clone, Copy)]
struct Bounds {
    radius: f64,
    position: f64,
    turn: Option<f64>,
}

/// What a tip reads of a surface point of the model with such a normal.
fn reading(random: &mut Random, point: DVec3, normal: DVec3, pose: Pose, bounds: Bounds) -> Contact<DVec3> {
    let share = if random.0.bool() { 1.0 - 1e-9 } else { random.unit() };
    let center = pose.apply(point + bounds.radius * normal) + random.direction() * bounds.position * share;
    let contact = Contact::new(center, bounds.radius, bounds.position).expect("good input");
    let normal = pose.rotation * normal;
    match bounds.turn {
        Some(turn) => {
            let axis = normal.cross(random.direction()).normalize_or_zero();
            let tilted = glam::DMat3::from_axis_angle(axis, turn * share) * normal;
            contact.with_normal(Normal::new(tilted, turn).expect("good input"))
        }
        None => contact.with_approach(-normal).expect("good input"),
    }
}

/// A contact on a face.
fn touch_face(random: &mut Random, model: &Model, pose: Pose, bounds: Bounds) -> Contact<DVec3> {
    let (corners, face) = &model.triangles[random.0.usize(..model.triangles.len())];
    let [a, b, c] = corners.map(|k| model.vertices[k as usize].point);
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    let normal = model.faces[*face as usize].normal;
    reading(random, a + u * (b - a) + v * (c - a), normal, pose, bounds)
}

/// Recognizes, and checks that the truth is there and that what is said of each hypothesis holds.
fn check(number: usize, models: &[Arc<Model>], evidence: &Evidence<DVec3>, pose: Pose) -> (usize, bool) {
    let found = recognize(models, evidence, &Settings::default()).expect("good input");
    check_found(number, models, &found, pose)
}

fn check_found(
    number: usize,
    models: &[Arc<Model>],
    found: &Recognition<DVec3>,
    pose: Pose,
) -> (usize, bool) {
    let model = &models[0];
    let kept = found.hypotheses.iter().any(|one| one.model_number == 0 && one.poses.contains(pose));
    assert!(
        kept,
        "problem {number}: the truth is lost among {} hypotheses, complete: {}",
        found.hypotheses.len(),
        found.complete
    );
    for one in &found.hypotheses {
        assert!(one.proved() || !found.complete, "problem {number}");
        if !one.proved() {
            continue;
        }
        assert!(one.poses.contains(one.poses.witness()), "problem {number}");
        assert!(one.poses.contains(one.world_from_model()), "problem {number}");
        let samples = one.poses.sample(8, 1);
        assert!(samples.iter().all(|one_of| one.poses.contains(*one_of)), "problem {number}");
        let bound = one.poses.rotation_bound();
        let corner = model.vertices[0].point;
        let excursion = one.poses.excursion(corner);
        for a in &samples {
            for b in &samples {
                assert!(a.inverse().compose(*b).angle() <= bound + 1e-9, "problem {number}");
                let moved = a.apply(corner).distance(b.apply(corner));
                assert!(moved <= excursion + 1e-9, "problem {number}: {moved} > {excursion}");
            }
        }
    }
    (found.hypotheses.len(), found.complete)
}

#[test]
fn faces_with_normals() {
    let mut random = Random(fastrand::Rng::with_seed(11));
    for number in 0..150 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds {
            radius: 0.0,
            position: 0.05 + random.unit() * random.unit(),
            turn: Some((0.5 + 7.0 * random.unit()).to_radians()),
        };
        let count = 3 + random.0.usize(..5);
        let contacts = (0..count).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        check(number, &[model], &Evidence { contacts, ..Evidence::default() }, pose);
    }
}

#[test]
fn tips_on_edges_and_vertices() {
    let mut random = Random(fastrand::Rng::with_seed(12));
    for number in 0..20 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds {
            radius: 1.0 + 4.0 * random.unit(),
            position: 0.05 + 0.5 * random.unit(),
            turn: Some((0.5 + 4.0 * random.unit()).to_radians()),
        };
        let mut contacts = vec![touch_face(&mut random, &model, pose, bounds)];
        while contacts.len() < 6 {
            contacts.extend(touch_with_tip(&mut random, &model, pose, bounds));
        }
        check(number, &[model], &Evidence { contacts, ..Evidence::default() }, pose);
    }
}

/// Whatever effort is spent, and wherever a search is stopped, the truth stays in a hypothesis, and what is proved is valid
/// (theory, T20).
#[test]
fn a_search_that_ends_loses_nothing() {
    let mut random = Random(fastrand::Rng::with_seed(19));
    let mut num_incomplete = 0;
    for number in 0..9 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds {
            radius: 1.0 + 4.0 * random.unit(),
            position: 0.5 + random.unit(),
            turn: Some((2.0 + 6.0 * random.unit()).to_radians()),
        };
        let mut contacts = vec![touch_face(&mut random, &model, pose, bounds)];
        while contacts.len() < 3 + number % 3 {
            contacts.extend(touch_with_tip(&mut random, &model, pose, bounds));
        }
        let evidence = Evidence { contacts, ..Evidence::default() };
        let models = [model];
        for effort in [1, 300] {
            let settings = Settings { effort: Some(effort), ..Settings::default() };
            let found = recognize(&models, &evidence, &settings).expect("good input");
            num_incomplete += usize::from(!check_found(number, &models, &found, pose).1);
        }
        let stopped = Arc::new(true.into());
        let found = recognize_until(&models, &evidence, &Settings::default(), &stopped).expect("good input");
        assert!(!check_found(number, &models, &found, pose).1);
    }
    assert!(num_incomplete > 3, "{num_incomplete}");
}

#[test]
fn without_normals_within_a_prior() {
    let mut random = Random(fastrand::Rng::with_seed(13));
    for number in 0..4 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds { radius: if number % 2 == 0 { 0.0 } else { 2.0 }, position: 0.3, turn: None };
        let contacts: Vec<_> = (0..6).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        let turn = random.direction() * 15_f64.to_radians() * random.unit();
        let off = random.direction() * 20.0 * random.unit();
        let middle = Pose {
            rotation: Pose::new(turn, DVec3::ZERO).rotation * pose.rotation,
            translation: pose.translation + off,
        };
        let prior = palpate::space::Prior::new(middle, 20.0, 15_f64.to_radians()).expect("good input");
        let evidence = Evidence { contacts, prior: Some(prior), ..Evidence::default() };
        check(number, &[model], &evidence, pose);
    }
}

/// Readings without any error, and with errors far below τ: closed sets that are a single pose, or thin.
#[test]
fn exact_readings() {
    let mut random = Random(fastrand::Rng::with_seed(16));
    for number in 0..18 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let error = [0.0, 1e-9, 1e-4][number % 3];
        let bounds = Bounds {
            radius: if number % 2 == 0 { 0.0 } else { 2.0 },
            position: error,
            turn: Some([0.0, 1e-9, 1e-6][number / 3 % 3]),
        };
        let contacts = (0..6).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        check(number, &[model], &Evidence { contacts, ..Evidence::default() }, pose);
    }
}

/// All normals nearly along one line: the part can slide, and turn about it.
#[test]
fn nearly_parallel_normals() {
    let mut random = Random(fastrand::Rng::with_seed(17));
    for number in 0..30 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds { radius: 0.0, position: 0.5, turn: Some(0.07) };
        let mut contacts = Vec::new();
        while contacts.len() < 3 {
            let (corners, face) = &model.triangles[random.0.usize(..model.triangles.len())];
            let normal = model.faces[*face as usize].normal;
            // Top and bottom.
            if normal.z.abs() > 0.5 {
                let point = model.vertices[corners[0] as usize].point * 0.5
                    + model.vertices[corners[1] as usize].point * 0.5;
                contacts.push(reading(&mut random, point, normal, pose, bounds));
            }
        }
        check(number, &[model], &Evidence { contacts, ..Evidence::default() }, pose);
    }
}

/// Ways and misses that keep clear of the part refute no truth, and what is returned keeps clear of them as well.
#[test]
fn free_space() {
    let mut random = Random(fastrand::Rng::with_seed(18));
    for number in 0..20 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds { radius: 0.0, position: 0.5, turn: Some(0.07) };
        let start = |contact: Contact<DVec3>| {
            let normal = contact.normal.expect("it has one").direction;
            contact.with_start(contact.center + 80.0 * normal).expect("good input")
        };
        let clear = |from: DVec3, to: DVec3, least: f64| {
            let at = |k: i32| pose.inverse().apply(from.lerp(to, f64::from(k) / 400.0));
            (0..=400).all(|k| model.signed_distance(at(k)) > least)
        };
        let mut contacts = Vec::new();
        while contacts.len() < 5 {
            let contact = touch_face(&mut random, &model, pose, bounds);
            let away = contact.normal.expect("it has one").direction;
            let began = contact.center + 80.0 * away;
            contacts.push(if clear(began, contact.center + 2.0 * away, 1.0) {
                start(contact)
            } else {
                contact
            });
        }
        let mut misses = Vec::new();
        while misses.len() < 2 {
            let middle = pose.apply(model.vertices[0].point) + random.direction() * 40.0;
            let way = random.direction() * 100.0;
            if clear(middle - way, middle + way, 2.0) {
                misses.push(palpate::Miss::new(middle - way, middle + way, 1.0, 0.2).expect("good input"));
            }
        }
        let evidence = Evidence { contacts, misses, ..Evidence::default() };
        check(number, &[Arc::clone(&model)], &evidence, pose);
        let found = recognize(&[Arc::clone(&model)], &evidence, &Settings::default()).expect("good input");
        for one in found.hypotheses {
            for sample in one.poses.sample(4, 1) {
                for miss in &evidence.misses {
                    let at = |k: i32| miss.start.lerp(miss.end, f64::from(k) / 400.0);
                    let nearest = (0..=400).map(|k| model.signed_distance(sample.inverse().apply(at(k))));
                    assert!(nearest.fold(f64::INFINITY, f64::min) >= 0.8 - 2e-4, "problem {number}");
                }
            }
        }
    }
}

/// A part on a table: it turns about the table's normal, tilts a little and slides.
#[test]
fn on_a_table() {
    let mut random = Random(fastrand::Rng::with_seed(19));
    for number in 0..6 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let table = random.direction();
        let middle = random.pose();
        let (turn, tilt) = (0.25, 0.02);
        let across = table.cross(random.direction()).normalize_or_zero();
        let turned = Pose::new((2.0 * random.unit() - 1.0) * turn * table, DVec3::ZERO).rotation
            * Pose::new(random.unit() * tilt * across, DVec3::ZERO).rotation;
        let shift = 15.0 * random.unit() * table.cross(random.direction()).normalize_or_zero();
        let pose = Pose {
            rotation: turned * middle.rotation,
            translation: middle.translation + shift + (random.unit() - 0.5) * table,
        };
        let bounds = Bounds { radius: 0.0, position: 0.3, turn: None };
        let contacts = (0..6).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        let prior = palpate::space::Prior::new(middle, 20.0, turn)
            .and_then(|prior| prior.on_plane(table, 1.0, tilt))
            .expect("good input");
        let evidence = Evidence { contacts, prior: Some(prior), ..Evidence::default() };
        check(number, &[model], &evidence, pose);
    }
}

/// A drum of 24 sides, round and oval: neighbouring sides explain the same contact, and all of these interpretations are
/// one hypothesis where they meet.
#[test]
fn finely_faceted() {
    let mut random = Random(fastrand::Rng::with_seed(14));
    for (number, depth) in [35.0, 50.0].into_iter().enumerate() {
        let turns = (0..24).map(|k| (std::f64::consts::TAU * f64::from(k) / 24.0).sin_cos());
        let outline: Vec<[f64; 2]> = turns.map(|(sine, cosine)| [50.0 * cosine, depth * sine]).collect();
        let model = prism("drum", &outline, 60.0);
        let pose = random.pose();
        let bounds = Bounds { radius: 0.0, position: 0.5, turn: Some(4_f64.to_radians()) };
        let contacts = (0..5).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        check(number, &[model], &Evidence { contacts, ..Evidence::default() }, pose);
    }
}

/// Whether a point contact with a normal is explained at a pose: some triangle is near enough and faces the right way. Shares
/// nothing with the core.
fn explained(model: &Model, pose: Pose, contact: &Contact<DVec3>, slack: f64) -> bool {
    let sensed = contact.normal.expect("these contacts have normals");
    model.triangles.iter().any(|(corners, _)| {
        let [a, b, c] = corners.map(|k| pose.apply(model.vertices[k as usize].point));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let apart = normal.dot(sensed.direction).clamp(-1.0, 1.0).acos();
        apart <= sensed.error + slack
            && to_triangle(contact.center, [a, b, c]) <= contact.position_error + 200.0 * slack
    })
}

/// The distance to a triangle: to its plane where the foot is inside, else to the nearest side.
fn to_triangle(point: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| (*to - *from).cross(point - *from).dot(normal) >= 0.0) {
        return (point - a).dot(normal).abs();
    }
    let to_side = |(from, to): (DVec3, DVec3)| {
        let way = to - from;
        let share = ((point - from).dot(way) / way.dot(way)).clamp(0.0, 1.0);
        (from + share * way).distance(point)
    };
    sides.into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}

#[test]
fn what_is_returned_explains_every_contact() {
    let mut random = Random(fastrand::Rng::with_seed(15));
    for number in 0..60 {
        let outline = outline(&mut random);
        let model = prism("part", &outline, 20.0 + 60.0 * random.unit());
        let pose = random.pose();
        let bounds = Bounds { radius: 0.0, position: 0.5, turn: Some(0.07) };
        let contacts: Vec<_> = (0..4).map(|_| touch_face(&mut random, &model, pose, bounds)).collect();
        let evidence = Evidence { contacts, ..Evidence::default() };
        let found = recognize(&[Arc::clone(&model)], &evidence, &Settings::default()).expect("good input");
        for one in found.hypotheses {
            let samples = one.poses.sample(6, number);
            for pose in samples.into_iter().chain([one.poses.witness(), one.world_from_model()]) {
                let all = evidence.contacts.iter().all(|contact| explained(&model, pose, contact, 2e-6));
                assert!(all, "problem {number}");
            }
        }
    }
}
