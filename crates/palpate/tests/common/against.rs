//! `complete` against random lines and against the other planners, on one problem.

#![allow(dead_code, reason = "each program uses its own part")]

use std::f64::consts::TAU;

use fastrand::Rng;
use palpate::plan::Prepared;
use palpate::{Path, Plan, PlanSettings, Planner, plan};
use serde_json::{Value, json};

use crate::common::uniform;
use crate::planning::{Case, PLANNERS};

/// Scores are whole numbers over n.
const ROUNDING: f64 = 1e-9;

/// Lines that the planners of the thesis may judge.
const MOST_JUDGED: u64 = 100_000;

/// A path that `complete` should have been as good as.
#[derive(Debug)]
pub struct Better {
    pub from: String,
    pub score: f64,
    pub line: palpate::Line,
}

/// What came out on one problem.
pub struct Outcome {
    pub complete: Plan,
    /// The plans of the other planners, in order.
    pub others: Vec<Plan>,
    /// Random lines that were drawn, and of these the ones that needed the judge.
    pub num_lines: u64,
    pub num_judged: u64,
    pub better: Vec<Better>,
}

/// The score of a plan; without a path more than any.
pub fn score(case: &Case, plan: &Plan) -> f64 {
    plan.path.as_ref().map_or(case.hypotheses.len() as f64 + 1.0, |path| path.score)
}

/// `complete`, with so many boxes, against the others and against so many random lines.
pub fn against(case: &Case, number: u64, num_lines: u64, effort: u64) -> Outcome {
    let mut plans = PLANNERS.iter().map(|(_, planner)| {
        let effort = if *planner == Planner::Complete { effort } else { effort.min(MOST_JUDGED) };
        let settings = PlanSettings { planner: *planner, effort, ..case.settings.clone() };
        plan(&case.hypotheses, &case.sensor, &settings).expect("good settings")
    });
    let complete = plans.next().expect("complete is the first");
    let others: Vec<Plan> = plans.collect();
    let least = score(case, &complete);
    let is_better = |path: &Path| path.score < least - ROUNDING && path.margin >= case.margin();
    let mut better = Vec::new();
    for ((name, _), other) in PLANNERS[1..].iter().zip(&others) {
        if let Some(path) = other.path.as_ref().filter(|path| is_better(path)) {
            better.push(Better { from: (*name).to_owned(), score: path.score, line: path.line });
        }
    }
    let mut num_judged = 0;
    let prepared = Prepared::new(&case.hypotheses, &case.sensor, &case.settings).expect("hypotheses");
    let mut random = Rng::with_seed(number);
    for _ in 0..num_lines {
        let (angle, share) = (TAU * random.f64(), uniform(&mut random, -1.0, 1.0));
        // Nothing is better than perfect.
        if least <= 1.0 {
            break;
        }
        let Some(line) = prepared.line(angle, prepared.radius() * share) else { continue };
        if prepared.least_score(&line) >= least - ROUNDING {
            continue;
        }
        num_judged += 1;
        if prepared.score(&line).is_some_and(|score| score < least - ROUNDING) {
            let path = prepared.judge(&line);
            if is_better(&path) {
                better.push(Better { from: "a random line".to_owned(), score: path.score, line });
            }
        }
    }
    Outcome { complete, others, num_lines, num_judged, better }
}

impl Outcome {
    /// For the campaign's file; no times, so that it is the same on every machine.
    pub fn to_json(&self, case: &Case, number: u64) -> Value {
        let planner = |plan: &Plan| {
            json!({
                "score": plan.path.as_ref().map(|path| path.score),
                "wide": plan.path.as_ref().is_some_and(|path| path.margin >= case.margin()),
            })
        };
        let names = PLANNERS[1..].iter().map(|(name, _)| (*name).to_owned());
        let others: serde_json::Map<String, Value> = names.zip(self.others.iter().map(planner)).collect();
        let better: Vec<Value> = self
            .better
            .iter()
            .map(|one| {
                let (start, direction) = (one.line.start, one.line.direction);
                json!({ "from": one.from, "score": one.score,
                    "start": [start.x, start.y], "direction": [direction.x, direction.y] })
            })
            .collect();
        json!({
            "number": number,
            "family": case.family,
            "hypotheses": case.hypotheses.len(),
            "complete": planner(&self.complete),
            "proved": self.complete.proved,
            "bound": self.complete.bound,
            "boxes": self.complete.num_boxes,
            "others": others,
            "lines": self.num_lines,
            "judged": self.num_judged,
            "better": better,
        })
    }
}
