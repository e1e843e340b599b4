//! The contacts that are bundled with the parts, read from the package's own files.

use std::path::Path;

use glam::{DVec2, dvec2};
use palpate::{Contact, Evidence, Normal};
use serde_json::Value;

/// The bundled contacts of a part.
pub fn evidence(name: &str) -> Evidence {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../python/palpate/parts/contacts");
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("bundled contacts");
    let value: Value = serde_json::from_str(&text).expect("valid JSON");
    let contacts = value["contacts"].as_array().expect("contacts").iter().map(contact);
    Evidence { contacts: contacts.collect(), ..Evidence::default() }
}

fn contact(value: &Value) -> Contact {
    let number = |value: &Value| value.as_f64().expect("a number");
    let vector = |value: &Value| -> DVec2 { dvec2(number(&value[0]), number(&value[1])) };
    let normal_error = number(&value["normal_error_deg"]).to_radians();
    let normal = Normal::new(vector(&value["normal"]), normal_error).expect("a normal");
    let position_error = number(&value["position_error"]);
    Contact::new(vector(&value["center"]), 0.0, position_error).expect("a contact").with_normal(normal)
}
