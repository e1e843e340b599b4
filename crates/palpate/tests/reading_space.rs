//! How a file was written loses no truth: parts that are nearly symmetric, and triangles whose corners rounding parted
//! (`docs/theory.md`, T10).

use std::f64::consts::TAU;
use std::sync::Arc;

use fastrand::Rng;
use glam::{DMat3, DVec3, dvec3};
use palpate::space::{Model, Pose};
use palpate::{Contact, Evidence, Normal, Recognition, Settings, recognize};

type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

fn direction(random: &mut Rng) -> DVec3 {
    loop {
        let v = dvec3(random.f64(), random.f64(), random.f64()) * 2.0 - 1.0;
        if (1e-3..1.0).contains(&v.length_squared()) {
            return v / v.length();
        }
    }
}

fn motion(random: &mut Rng) -> Pose {
    Pose::new(direction(random) * 3.0 * random.f64(), 60.0 * direction(random))
}

/// Over a regular polygon.
fn prism(n: u32, radius: f64, height: f64) -> Shape {
    let at = |k: u32, z: f64| {
        let angle = TAU * f64::from(k) / f64::from(n);
        dvec3(radius * angle.cos(), radius * angle.sin(), z)
    };
    let corners = (0..n).map(|k| at(k, 0.0)).chain((0..n).map(|k| at(k, height))).collect();
    let fans = (1..n - 1).flat_map(|k| [[0, k + 1, k], [n, n + k, n + k + 1]]);
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, n + next], [k, n + next, n + k]]
    });
    (corners, fans.chain(sides).collect())
}

fn bracket() -> Shape {
    let outline = [(0.0, 0.0), (60.0, 0.0), (60.0, 15.0), (15.0, 15.0), (15.0, 40.0), (0.0, 40.0)];
    let corners = [0.0, 25.0].iter().flat_map(|&z| outline.map(|(x, y)| dvec3(x, y, z))).collect();
    let fans = (1..5).flat_map(|k| [[0, k + 1, k], [6, 6 + k, 7 + k]]);
    let sides = (0..6).flat_map(|k| {
        let next = (k + 1) % 6;
        [[k, next, 6 + next], [k, 6 + next, 6 + k]]
    });
    (corners, fans.chain(sides).collect())
}

fn mesh((vertices, triangles): &Shape, position_slack: f64) -> Arc<Model> {
    Arc::new(Model::mesh("part", vertices, triangles, &[], position_slack, 0.0).expect("a part"))
}

/// Of position, of normals, and the radius of the tip.
type Bounds = [f64; 3];

/// A reading of a point of a face, its errors as large as the bounds.
fn touch(random: &mut Rng, model: &Model, face: usize, pose: Pose, bounds: Bounds) -> Contact<DVec3> {
    let [position_error, normal_error, radius] = bounds;
    let of_face: Vec<_> = model.triangles.iter().filter(|(_, number)| *number as usize == face).collect();
    let (corners, _) = of_face[random.usize(..of_face.len())];
    let [a, b, c] = corners.map(|k| model.vertices[k as usize].point);
    let (u, v) = (random.f64(), random.f64());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let normal = pose.rotation * model.faces[face].normal;
    let center = pose.apply(a + u * (b - a) + v * (c - a)) + radius * normal;
    let center = center + position_error * direction(random);
    let axis = normal.cross(direction(random)).normalize_or_zero();
    let normal = DMat3::from_axis_angle(axis, normal_error) * normal;
    let contact = Contact::new(center, radius, position_error).expect("good input");
    contact.with_normal(Normal::new(normal, normal_error).expect("good input"))
}

/// Of a face each, as many as it takes to hold a part.
fn touches(random: &mut Rng, model: &Model, pose: Pose, bounds: Bounds) -> Vec<Contact<DVec3>> {
    let mut faces: Vec<usize> = (0..model.faces.len()).collect();
    random.shuffle(&mut faces);
    faces.truncate(6);
    faces.into_iter().map(|face| touch(random, model, face, pose, bounds)).collect()
}

fn found(model: &Arc<Model>, contacts: Vec<Contact<DVec3>>) -> Recognition<DVec3> {
    let evidence = Evidence { contacts, ..Evidence::default() };
    recognize(std::slice::from_ref(model), &evidence, &Settings::default()).expect("a well-formed problem")
}

#[test]
fn exact_contacts_on_a_part_that_is_nearly_symmetric_keep_the_truth() {
    let mut random = Rng::with_seed(1);
    let mut seen = [0; 2];
    for round in 0..240 {
        let n = [3, 4, 6, 8][round % 4];
        let (corners, triangles) = prism(n, 40.0, 30.0);
        let placed = motion(&mut random);
        let noise = 100.0 * 10_f64.powf(-9.0 + 4.0 * random.f64());
        let shake = |point: &DVec3| placed.apply(*point) + noise * direction(&mut random);
        let corners: Vec<DVec3> = corners.iter().map(shake).collect();
        let slack = if round % 3 == 0 { 1e-3 } else { 0.0 };
        let model = mesh(&(corners, triangles), slack);
        let pose = motion(&mut random);
        let contacts = touches(&mut random, &model, pose, [0.0, 0.0, if round % 5 == 0 { 4.0 } else { 0.0 }]);
        let found = found(&model, contacts);
        let kept = found.hypotheses.iter().any(|one| one.poses.contains(pose));
        assert!(kept, "round {round}: {n} sides, {noise:e}, {} symmetries", model.symmetries.len());
        for one in found.hypotheses.iter().filter(|one| one.proved()) {
            let poses =
                one.poses.sample(6, 1).into_iter().chain([one.poses.witness(), one.world_from_model()]);
            for (k, pose) in poses.enumerate() {
                assert!(one.poses.contains(pose), "round {round}: {noise:e} {k}");
            }
        }
        seen[usize::from(
            model.symmetries.len() == 2 * n as usize || n == 4 && model.symmetries.len() == 8,
        )] += 1;
    }
    assert!(seen.iter().all(|&count| count > 30), "{seen:?}");
}

#[test]
fn parts_from_files_have_the_hypotheses_of_the_parts() {
    let mut random = Rng::with_seed(2);
    for round in 0..60 {
        let shape = [prism(6, 25.0, 40.0), prism(48, 25.0, 40.0), bracket()][round % 3].clone();
        let placed = motion(&mut random);
        let truth: Shape = (shape.0.iter().map(|point| placed.apply(*point)).collect(), shape.1.clone());
        // As a binary STL has it, each triangle with corners of its own.
        let noise = [0.0, 1e-6, 5e-6][round % 9 / 3];
        let corners = truth.1.iter().flatten().map(|&k| {
            let point = truth.0[k as usize] + noise * direction(&mut random);
            point.as_vec3().as_dvec3()
        });
        let corners: Vec<DVec3> = corners.collect();
        let numbers = (0..truth.1.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let (drawn, read) = (mesh(&truth, 0.0), mesh(&(corners, numbers), 0.0));
        assert_eq!(read.faces.len(), drawn.faces.len(), "round {round}: {:?}", read.mends);
        assert!(read.closed && read.symmetries.len() == drawn.symmetries.len(), "round {round}");

        let pose = motion(&mut random);
        let contacts = touches(&mut random, &drawn, pose, [0.5, 0.07, 0.0]);
        let [of_drawn, of_read] = [&drawn, &read].map(|model| found(model, contacts.clone()));
        assert!(of_read.hypotheses.iter().any(|one| one.poses.contains(pose)), "round {round}");
        assert_eq!(of_read.hypotheses.len(), of_drawn.hypotheses.len(), "round {round}");
        for one in &of_read.hypotheses {
            assert!(one.poses.sample(4, 1).iter().all(|sample| one.poses.contains(*sample)), "round {round}");
        }
    }
}
