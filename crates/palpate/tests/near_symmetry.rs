//! Parts that are symmetric but for a trifle lose nothing (`docs/theory.md`, T10); and equal contacts end soon (T8).

mod common;
#[expect(dead_code, reason = "one part is enough")]
#[path = "common/parts.rs"]
mod parts;

use std::sync::Arc;

use common::pose;
use fastrand::Rng;
use glam::dvec2;
use palpate::plane::Model;
use palpate::{Contact, Evidence, Normal, Settings, recognize};

/// A square, but for some 10⁻⁸: its quarter turns are taken for symmetries.
fn nearly_a_square() -> Arc<Model> {
    let corners =
        [dvec2(0.0, 0.0), dvec2(100.0, 0.0), dvec2(100.000_000_05, 100.000_000_02), dvec2(0.0, 100.0)];
    Arc::new(Model::polygon("square", &corners, &[], &[], 0.0, 0.0).expect("a polygon"))
}

#[test]
fn exact_contacts_on_a_part_that_is_nearly_symmetric_keep_the_truth() {
    let model = nearly_a_square();
    let mut random = Rng::with_seed(1);
    for round in 0..300 {
        let world_from_model = pose(&mut random);
        let contacts = (0..5).map(|k| {
            let face = &model.faces[if k < 4 { (k + round) % 4 } else { random.usize(0..4) }];
            let point = world_from_model.apply(face.start.lerp(face.end, random.f64()));
            let contact = Contact::new(point, 0.0, 0.0).expect("a contact");
            let normal = world_from_model.rotation.rotate(face.normal);
            if round % 2 == 0 {
                contact
            } else {
                contact.with_normal(Normal::new(normal, 0.0).expect("a normal"))
            }
        });
        let evidence = Evidence { contacts: contacts.collect(), ..Evidence::default() };
        let found = recognize(std::slice::from_ref(&model), &evidence, &Settings::default())
            .expect("a well-formed problem");
        let kept = found.hypotheses.iter().any(|one| one.poses.contains(world_from_model));
        assert!(kept, "round {round}: {} hypotheses", found.hypotheses.len());
    }
}

/// Boxes of poses that are examined for thirty equal contacts on the boot.
const MOST_BOXES: u64 = 500_000;

#[test]
fn thirty_equal_contacts_without_normals_end_soon_and_completely() {
    let boot = parts::part("boot");
    let contact = Contact::new(dvec2(3.0, -7.0), 0.0, 0.5).expect("a contact");
    let evidence = Evidence { contacts: vec![contact; 30], ..Evidence::default() };
    let found = recognize(std::slice::from_ref(&boot), &evidence, &Settings::default())
        .expect("a well-formed problem");
    let num_boxes: u64 = found.reports.iter().map(|report| report.num_boxes).sum();

    assert!(found.complete && !found.hypotheses.is_empty());
    assert!(num_boxes <= MOST_BOXES, "{num_boxes}");
}
