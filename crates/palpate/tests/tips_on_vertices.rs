//! Tips with a radius on vertices (`docs/theory.md`, T9): arcs, not their hulls, and normals, against plain geometry.

use std::f64::consts::TAU;
use std::sync::Arc;

use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::plane::{Model, Pose};
use palpate::{Contact, Evidence, Feature, Normal, Settings, recognize};

const RADIUS: f64 = 12.0;
const POSITION_ERROR: f64 = 0.3;
const NORMAL_ERROR: f64 = 0.15;

/// What the other contacts leave of the pose moves the vertex by less, so that nothing is said nearer to a bound.
const UNSURE: f64 = 0.02;

/// A corner of 50° at the origin, the others far away.
fn wedge() -> Arc<Model> {
    let [low, high] = [-25_f64, 25.0].map(|angle| 150.0 * DVec2::from_angle(angle.to_radians()));
    Arc::new(Model::polygon("wedge", &[DVec2::ZERO, low, high], &[], &[], 0.0, 0.0).expect("a triangle"))
}

/// Contacts that leave next to nothing of the pose.
fn pins(model: &Model, world_from_model: Pose) -> Vec<Contact> {
    let touch = |face: usize, t: f64| {
        let face = &model.faces[face];
        let point = world_from_model.apply(face.start.lerp(face.end, t));
        let normal = Normal::new(world_from_model.rotation.rotate(face.normal), 1e-4).expect("a normal");
        Contact::new(point, 0.0, 1e-4).expect("a contact").with_normal(normal)
    };
    [(0, 0.2), (0, 0.9), (1, 0.3), (1, 0.6), (2, 0.2), (2, 0.7)].map(|(face, t)| touch(face, t)).to_vec()
}

/// The least distance of a centre from places of the tip's centre on the vertex, over the normals that are allowed by the cone,
/// widened by `slack`, and by what was sensed; infinite if there is none.
fn distance(model: &Model, center: DVec2, sensed: Option<f64>, slack: f64) -> f64 {
    let number = vertex(model);
    let cone = model.vertices[number].normals.expect("it sticks out");
    let allowed = |angle: &f64| {
        let off = |sensed: f64| (angle - sensed + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        sensed.is_none_or(|sensed| off(sensed).abs() <= NORMAL_ERROR + slack)
    };
    let angles =
        (0..=4_000).map(|k| cone.start - slack + (cone.width + 2.0 * slack) * f64::from(k) / 4_000.0);
    let place = |angle: f64| RADIUS * DVec2::from_angle(angle);
    angles.filter(allowed).map(|angle| center.distance(place(angle))).fold(f64::INFINITY, f64::min)
}

/// The vertex at the origin.
fn vertex(model: &Model) -> usize {
    model.vertices.iter().position(|vertex| vertex.point == DVec2::ZERO).expect("the corner")
}

fn assigned_to_the_vertex(model: &Arc<Model>, world_from_model: Pose, contact: Contact) -> bool {
    let mut contacts = pins(model, world_from_model);
    contacts.push(contact);
    let evidence = Evidence { contacts, ..Evidence::default() };
    let found = recognize(std::slice::from_ref(model), &evidence, &Settings::default()).expect("well formed");
    let wanted = Some(&Feature::Vertex(vertex(model) as u32));
    let assigned = |one: &palpate::Hypothesis| {
        one.poses.contains(world_from_model)
            && one.interpretations().any(|some| some.assignment.last() == wanted)
    };
    found.hypotheses.iter().any(assigned)
}

/// Accepted as plain geometry says, where it says so clearly.
fn check(random: &mut Rng, model: &Arc<Model>, center: DVec2, sensed: Option<f64>) -> Option<bool> {
    let surely = distance(model, center, sensed, -UNSURE) <= POSITION_ERROR - UNSURE;
    let surely_not = distance(model, center, sensed, UNSURE) > POSITION_ERROR + UNSURE;
    if !surely && !surely_not {
        return None;
    }
    let translation = dvec2(random.f64() - 0.5, random.f64() - 0.5) * 200.0;
    let world_from_model = Pose::new(TAU * random.f64(), translation);
    let mut contact =
        Contact::new(world_from_model.apply(center), RADIUS, POSITION_ERROR).expect("a contact");
    if let Some(angle) = sensed {
        let normal = world_from_model.rotation.rotate(DVec2::from_angle(angle));
        contact = contact.with_normal(Normal::new(normal, NORMAL_ERROR).expect("a normal"));
    }
    let assigned = assigned_to_the_vertex(model, world_from_model, contact);
    assert_eq!(assigned, surely, "{center} {sensed:?}");
    Some(assigned)
}

#[test]
fn a_contact_lies_on_a_vertex_if_its_centre_is_at_the_arc_and_its_normal_agrees() {
    let (model, mut random) = (wedge(), Rng::with_seed(1));
    let mut counts = [0, 0];
    for _ in 0..400 {
        // Around the arc, its ends, and the hollow that the arc's hull holds.
        let length = RADIUS * (0.5 + 0.6 * random.f64());
        let angle = TAU * (0.5 + 0.5 * (random.f64() - 0.5));
        let length = if random.bool() { RADIUS + 0.8 * (random.f64() - 0.5) } else { length };
        let center = length * DVec2::from_angle(angle);
        let sensed = random.bool().then(|| angle + 0.6 * (random.f64() - 0.5));
        if let Some(assigned) = check(&mut random, &model, center, sensed) {
            counts[usize::from(assigned)] += 1;
        }
    }
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
}

#[test]
fn the_middle_of_the_hull_is_not_on_the_arc() {
    let (model, mut random) = (wedge(), Rng::with_seed(2));
    let cone = model.vertices[vertex(&model)].normals.expect("it sticks out");
    let ends = [cone.start, cone.start + cone.width].map(|angle| RADIUS * DVec2::from_angle(angle));
    let middle = ends[0].midpoint(ends[1]);
    assert!(middle.length() < RADIUS - 2.0);
    assert_eq!(check(&mut random, &model, middle, None), Some(false));
    assert_eq!(check(&mut random, &model, RADIUS / middle.length() * middle, None), Some(true));
}
