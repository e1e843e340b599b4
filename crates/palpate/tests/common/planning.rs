//! Random planning problems: hypotheses that a few contacts leave, and the sensor of the next touch.

#![allow(dead_code, reason = "each program uses its own part")]

use std::sync::Arc;

use fastrand::Rng;
use palpate::plane::Model;
use palpate::{Hypothesis, PlanSettings, Planner, Sensor, Settings, recognize};

use crate::common::{Noise, comb, contacts, star, uniform};
use crate::parts;

/// A problem is of the family of its number, one after the other.
pub const FAMILIES: [&str; 6] = ["six objects", "stars", "combs", "±4 and ±5°", "tips", "path errors"];

/// The planners of the table, `complete` first.
pub const PLANNERS: [(&str, Planner); 5] = [
    ("complete", Planner::Complete),
    ("auto", Planner::Auto),
    ("ellis", Planner::Ellis),
    ("grimson", Planner::GRIMSON),
    ("schneiter", Planner::SCHNEITER),
];

/// A planning problem.
pub struct Case {
    pub family: &'static str,
    pub hypotheses: Vec<Hypothesis>,
    pub sensor: Sensor,
    pub settings: PlanSettings,
}

impl Case {
    /// m, as a length.
    pub fn margin(&self) -> f64 {
        self.settings.margin * self.hypotheses.iter().map(|one| one.model.size).fold(0.0, f64::max)
    }
}

/// The problem of a number: 2 to 30 hypotheses.
pub fn case(number: u64) -> Case {
    let family = (number % FAMILIES.len() as u64) as usize;
    let mut random = Rng::with_seed(0x7061_6c70 + number);
    let (noise, num_contacts, path_error) = noise(&mut random, family);
    loop {
        let models = models(&mut random, family);
        let chosen = Arc::clone(&models[random.usize(0..models.len())]);
        let hypotheses = left_by_contacts(&mut random, &models, chosen, num_contacts, &noise);
        if (2..=30).contains(&hypotheses.len()) {
            let sensor = sensor(&noise, path_error);
            let settings = PlanSettings { vertices: Some(noise.tip_radius > 0.0), ..PlanSettings::default() };
            return Case { family: FAMILIES[family], hypotheses, sensor, settings };
        }
    }
}

/// Hypotheses that some contacts of one of the models leave.
pub fn left_by_contacts(
    random: &mut Rng,
    models: &[Arc<Model>],
    chosen: Arc<Model>,
    num_contacts: usize,
    noise: &Noise,
) -> Vec<Hypothesis> {
    let problem = contacts(random, chosen, num_contacts, noise);
    recognize(models, &problem.evidence, &Settings::default()).expect("a well-formed problem").hypotheses
}

/// The sensor of the next touch is that of the contacts; Ω is 60°.
pub fn sensor(noise: &Noise, path_error: f64) -> Sensor {
    Sensor::new(noise.position_error, noise.normal_error, 60_f64.to_radians())
        .and_then(|sensor| sensor.with_tip(noise.tip_radius, path_error))
        .expect("bounds are valid")
}

/// ±0.5 and ±4°, unless told otherwise.
pub fn fine(tip_radius: f64) -> Noise {
    Noise { position_error: 0.5, normal_error: Some(4_f64.to_radians()), tip_radius }
}

/// ±4 and ±5°: the thesis's hardware.
pub fn coarse() -> Noise {
    Noise { position_error: 4.0, normal_error: Some(5_f64.to_radians()), tip_radius: 0.0 }
}

fn noise(random: &mut Rng, family: usize) -> (Noise, usize, f64) {
    match family {
        3 => (coarse(), 2 + random.usize(0..2), 0.0),
        4 => (fine(uniform(random, 0.5, 3.0)), 2, 0.0),
        5 => (fine(0.0), 2, uniform(random, 0.1, 1.0)),
        _ => (fine(0.0), 2, 0.0),
    }
}

fn models(random: &mut Rng, family: usize) -> Vec<Arc<Model>> {
    match family {
        1 => [8, 10, 12].map(|corners| star(random, corners)).to_vec(),
        2 => [2, 3, 4].map(|teeth| comb(random, teeth)).to_vec(),
        _ => parts::OBJECTS.map(parts::part).to_vec(),
    }
}
