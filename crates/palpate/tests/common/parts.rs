//! The bundled parts, read from the package's own files.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, dvec2};
use palpate::plane::Model;

/// The thesis's six objects, drawn anew.
pub const OBJECTS: [&str; 6] = ["robot-hand", "human-hand", "telephone", "boot", "camera", "beer-bottle"];

/// A bundled part by name.
pub fn part(name: &str) -> Arc<Model> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../python/palpate/parts");
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("bundled part");
    let value: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    let points = value["outer"].as_array().expect("an outline");
    let coordinate = |point: &serde_json::Value, axis: usize| point[axis].as_f64().expect("a number");
    let corners: Vec<DVec2> =
        points.iter().map(|point| dvec2(coordinate(point, 0), coordinate(point, 1))).collect();
    Arc::new(Model::polygon(name, &corners, &[], &[], 0.0, 0.0).expect("a valid outline"))
}
