//! Expected touches of several ways to choose the next path, on the same problems, as JSON.
//!
//! `cargo run --release --example touches [problems] [effort]`

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/planning.rs"]
mod planning;

use std::f64::consts::TAU;
use std::sync::Arc;

use common::{Noise, regular, star, uniform};
use fastrand::Rng;
use glam::{DVec2, dvec2};
use palpate::plan::Prepared;
use palpate::plane::Model;
use palpate::{
    AmbiguityTree, Hypothesis, Path, PlanSettings, Planner, Sensor, TreeMethod, TreeSettings, plan_tree,
};
use planning::{coarse, fine, left_by_contacts, sensor};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

/// Random lines among which the most telling is chosen.
const NUM_LINES: usize = 500;

/// Random lines are drawn until one tells something, so many at most.
const NUM_TRIES: usize = 500;

/// Hypotheses of a problem, so that the best tree can be found.
const MOST: usize = 12;

const FAMILIES: [&str; 4] = ["six objects", "±4 and ±5°", "one face differs", "nearly symmetric"];

/// A set of hypotheses without coordinates: their numbers.
type Members = Vec<usize>;

fn main() {
    let given =
        |k: usize, or: u64| std::env::args().nth(k).map_or(or, |text| text.parse().expect("a number"));
    let (problems, effort) = (given(1, 200), given(2, 20_000));
    let families: Map<String, Value> = FAMILIES
        .iter()
        .enumerate()
        .map(|(k, name)| ((*name).to_owned(), family(k, problems, effort)))
        .collect();
    measure::print(&json!({ "problems": problems, "effort": effort, "families": families }));
}

fn family(family: usize, problems: u64, effort: u64) -> Value {
    let rows: Vec<Row> = (0..problems).into_par_iter().map(|number| row(family, number, effort)).collect();
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let worst = rows.iter().map(|row| row.touches[0] / row.touches[2]).fold(0.0, f64::max);
    let means: Map<String, Value> = WAYS
        .iter()
        .enumerate()
        .map(|(k, way)| ((*way).to_owned(), json!(mean(&|row| row.touches[k]))))
        .collect();
    json!({
        "mean": means,
        "hypotheses": mean(&|row| row.hypotheses as f64),
        "greedy_over_optimal": mean(&|row| row.touches[0]) / mean(&|row| row.touches[2]),
        "worst_greedy_over_optimal": worst,
        "greedy_is_optimal": rows.iter().filter(|row| row.touches[0] <= row.touches[2] + 1e-9).count(),
        "proved_optimal": rows.iter().filter(|row| row.touches[2] <= row.lower_bound + 1e-9).count(),
        "optimal_is_beaten": rows.iter().filter(|row| row.touches[3].min(row.touches[4]) < row.touches[2] - 1e-9).count(),
        "solved": rows.iter().filter(|row| row.solved).count(),
    })
}

const WAYS: [&str; 7] = ["greedy", "ahead", "optimal", "ellis", "best of 500", "one line", "entropy"];

struct Row {
    hypotheses: usize,
    /// In the order of `WAYS`.
    touches: [f64; 7],
    lower_bound: f64,
    solved: bool,
}

fn row(family: usize, number: u64, effort: u64) -> Row {
    let mut random = Rng::with_seed(1_000_003 * family as u64 + number);
    let (hypotheses, sensor) = problem(&mut random, family);
    let settings = PlanSettings { planner: Planner::Complete, effort, ..PlanSettings::default() };
    let tree = |planner: Planner, method: TreeMethod| -> AmbiguityTree {
        let tree_settings = TreeSettings { method, ..TreeSettings::default() };
        plan_tree(&hypotheses, &sensor, &PlanSettings { planner, ..settings.clone() }, &tree_settings)
            .expect("hypotheses")
    };
    let greedy = tree(Planner::Complete, TreeMethod::Greedy);
    let ahead = tree(Planner::Complete, TreeMethod::Ahead);
    let optimal = tree(Planner::Complete, TreeMethod::Optimal);
    let ellis = tree(Planner::Ellis, TreeMethod::Greedy);
    let by_gain = drawn(&hypotheses, &sensor, &settings, &mut random, NUM_LINES);
    let by_chance = drawn(&hypotheses, &sensor, &settings, &mut random, 1);
    Row {
        hypotheses: hypotheses.len(),
        touches: [
            greedy.expected_touches,
            ahead.expected_touches,
            optimal.expected_touches,
            ellis.expected_touches,
            by_gain,
            by_chance,
            optimal.entropy_bound,
        ],
        lower_bound: optimal.lower_bound,
        solved: optimal.solved(),
    }
}

/// Expected touches if at each node so many random lines are drawn and the one of the largest information gain is taken,
/// hypotheses taken as equally likely. Lines that tell nothing or can't be used are drawn anew, some times.
fn drawn(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    settings: &PlanSettings,
    random: &mut Rng,
    count: usize,
) -> f64 {
    let mut open: Vec<(Members, usize)> = vec![((0..hypotheses.len()).collect(), 0)];
    let mut touches = 0;
    while let Some((members, level)) = open.pop() {
        let some: Vec<Hypothesis> = members.iter().map(|k| hypotheses[*k].clone()).collect();
        let path =
            (members.len() > 1).then(|| most_telling(&some, sensor, settings, random, count)).flatten();
        match path {
            Some(classes) => {
                let of_class = |class: Members| (class.iter().map(|k| members[*k]).collect(), level + 1);
                open.extend(classes.into_iter().map(of_class));
            }
            None => touches += members.len() * (level + members.len() - 1),
        }
    }
    touches as f64 / hypotheses.len() as f64
}

fn most_telling(
    hypotheses: &[Hypothesis],
    sensor: &Sensor,
    settings: &PlanSettings,
    random: &mut Rng,
    count: usize,
) -> Option<Vec<Members>> {
    let prepared = Prepared::new(hypotheses, sensor, settings).expect("hypotheses");
    let mut best: Option<(f64, Path)> = None;
    for number in 0..count.max(NUM_TRIES) {
        if number >= count && best.is_some() {
            break;
        }
        let (angle, share) = (TAU * random.f64(), uniform(random, -1.0, 1.0));
        let Some(line) = prepared.line(angle, prepared.radius() * share) else { continue };
        if prepared.score(&line).is_none_or(|score| score >= hypotheses.len() as f64) {
            continue;
        }
        let path = prepared.judge(&line);
        let gain = gain(&path.classes);
        if path.classes.len() > 1 && best.as_ref().is_none_or(|(known, _)| gain > *known) {
            best = Some((gain, path));
        }
    }
    best.map(|(_, path)| path.classes)
}

/// n times the expected information, less a constant.
fn gain(classes: &[Members]) -> f64 {
    -classes.iter().map(|class| class.len() as f64 * (class.len() as f64).ln()).sum::<f64>()
}

fn problem(random: &mut Rng, family: usize) -> (Vec<Hypothesis>, Sensor) {
    let noise: Noise = if family == 1 { coarse() } else { fine(0.0) };
    loop {
        let models = match family {
            2 => one_face_differs(random),
            3 => vec![nearly_symmetric(random)],
            _ => parts::OBJECTS.map(parts::part).to_vec(),
        };
        let chosen = Arc::clone(&models[random.usize(0..models.len())]);
        let num_contacts = if family == 2 { 3 } else { 2 };
        let hypotheses = left_by_contacts(random, &models, chosen, num_contacts, &noise);
        if (2..=MOST).contains(&hypotheses.len()) {
            return (hypotheses, sensor(&noise, 0.0));
        }
    }
}

/// A star and two more, each with another face moved a little: only that face tells.
fn one_face_differs(random: &mut Rng) -> Vec<Arc<Model>> {
    let first = star(random, 9);
    let corners: Vec<DVec2> = first.faces.iter().map(|face| face.start).collect();
    let mut models = vec![first];
    while models.len() < 3 {
        let mut moved = corners.clone();
        let k = random.usize(0..moved.len());
        let by = uniform(random, 6.0, 12.0) * DVec2::from_angle(TAU * random.f64());
        let next = (k + 1) % moved.len();
        moved[k] += by;
        moved[next] += by;
        models.extend(Model::polygon("moved", &moved, &[], &[], 0.0, 0.0).ok().map(Arc::new));
    }
    models
}

/// A regular polygon with a notch in one face.
fn nearly_symmetric(random: &mut Rng) -> Arc<Model> {
    let whole = regular(3 + random.usize(0..4), 60.0);
    let mut corners: Vec<DVec2> = whole.faces.iter().map(|face| face.start).collect();
    let (start, end) = (corners[0], corners[1]);
    let along = (end - start) / end.distance(start);
    let inward = dvec2(-along.y, along.x);
    let (at, width, depth) =
        (uniform(random, 0.3, 0.5), uniform(random, 5.0, 9.0), uniform(random, 3.0, 6.0));
    let mouth = start.lerp(end, at);
    let notch =
        [mouth, mouth + depth * inward, mouth + depth * inward + width * along, mouth + width * along];
    corners.splice(1..1, notch);
    Arc::new(Model::polygon("notched", &corners, &[], &[], 0.0, 0.0).expect("a notched polygon"))
}
