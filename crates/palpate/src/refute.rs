//! What guarded moves refute: hypotheses that can't have been met as they were (`docs/theory.md`, T15).

use std::sync::atomic::AtomicBool;

use glam::DVec2;
use rayon::prelude::*;

use crate::Error;
use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::judge::{Reading, Rules};
use crate::line::Line;
use crate::plan::{PlanSettings, check, checked_line};
use crate::scene::{Question, Shadow};
use crate::sensor::Sensor;

/// A guarded move that was made, and what was met first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move<V = DVec2> {
    /// The line; its direction of any length but zero.
    pub line: Line<V>,
    /// How far the tip was to go at most.
    pub length: f64,
    /// Bounds of this reading.
    pub sensor: Sensor,
    /// Sensed centre of the tip, and normal if it was sensed, world frame; `None`: nothing was met.
    pub met: Option<(V, Option<V>)>,
}

/// Of each hypothesis the number of the first move that it can't have answered so, if there is one.
///
/// The same as `judge(...).outcome_of(...)` of each move says, without what else a path tells.
///
/// # Errors
/// No hypotheses, a direction of no length, numbers that are not finite or too large.
pub fn refuting_moves<V: Dimension>(
    hypotheses: &[Hypothesis<V>],
    moves: &[Move<V>],
) -> Result<Vec<Option<usize>>, Error> {
    let size = hypotheses.iter().map(|one| V::size(&one.model)).fold(0.0, f64::max);
    let settings = PlanSettings::default();
    let made: Vec<Move<V>> = moves
        .iter()
        .map(|one| {
            check(hypotheses, &one.sensor, &settings)?;
            Ok(Move { line: checked_line(one.line, size)?, ..*one })
        })
        .collect::<Result<_, Error>>()?;
    if made.is_empty() {
        return Ok(vec![None; hypotheses.len()]);
    }
    let first = |one: &Hypothesis<V>| {
        let shadow = V::Shadow::new(&one.poses);
        made.iter().position(|one| !answers(&shadow, one))
    };
    Ok(hypotheses.par_iter().map(first).collect())
}

fn answers<V: Dimension>(shadow: &V::Shadow, one: &Move<V>) -> bool {
    let Move { line, length, sensor, met } = one;
    let rules = Rules { faces: true, edges: true, vertices: true, avoid_assigned: false };
    let halt = &AtomicBool::new(false);
    let ask = Question { line, sensor, rules, margin: 0.0, angle_margin: 0.0, length: *length, halt };
    let outcome = shadow.outcome(&ask);
    let reading = met.map(|(center, normal)| Reading::new(line, center, normal));
    outcome.may_answer(reading, sensor)
}
