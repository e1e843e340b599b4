//! Smooth parts on which assignments explode: time, memory, hypotheses and interpretations, as JSON.
//!
//! Each case runs in a process of its own, so that its peak memory is its own. Without arguments: all cases.

#[path = "../tests/common/mod.rs"]
mod common;
mod measure;
#[path = "../tests/common/smooth.rs"]
mod smooth;

use std::io::Read;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use common::{Noise, contacts, regular};
use fastrand::Rng;
use glam::dvec2;
use palpate::plane::Model;
use serde_json::{Value, json};

/// A case that takes longer is stopped, and its row says so.
const LONGEST: Duration = Duration::from_secs(120);

/// Random problems in a case.
const NUM_PROBLEMS: u64 = 5;

const PARTS: [&str; 5] = ["200-gon", "ellipse", "pebble", "rounded-rectangle", "stadium"];

/// Position error, and normal error in degrees.
const BOUNDS: [(f64, f64); 2] = [(0.5, 4.0), (4.0, 15.0)];

const CONTACTS: [usize; 4] = [3, 5, 8, 12];

/// So small bounds that hardly anything fits.
const EXACT: Noise = Noise { position_error: 1e-3, normal_error: Some(1e-3), tip_radius: 0.0 };

fn part(name: &str) -> Arc<Model> {
    match name {
        "200-gon" => regular(200, 50.0),
        "ellipse" => smooth::ellipse(300, dvec2(70.0, 50.0)),
        "pebble" => smooth::pebble(300),
        "rounded-rectangle" => smooth::rounded_rectangle(dvec2(120.0, 80.0), 20.0, 50),
        _ => smooth::stadium(60.0, 30.0, 100),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [name, position_error, normal_error_deg, num_contacts] = arguments.as_slice() {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let bounds = (number(position_error), number(normal_error_deg));
        measure::use_one_core();
        one_case(name, bounds, num_contacts.parse().expect("a count"));
        return;
    }
    let mut rows = Vec::new();
    for name in PARTS {
        for bounds in BOUNDS {
            rows.extend(CONTACTS.map(|num_contacts| in_own_process(name, bounds, num_contacts)));
        }
    }
    measure::print(&json!({ "cases": rows, "longest": LONGEST.as_secs(), "problems": NUM_PROBLEMS }));
}

/// Prints one line for each problem, as soon as it is solved.
#[expect(clippy::print_stdout, clippy::disallowed_methods, reason = "it measures time")]
fn one_case(name: &str, (position_error, normal_error_deg): (f64, f64), num_contacts: usize) {
    let model = part(name);
    let normal_error = Some(normal_error_deg.to_radians());
    let noise = Noise { position_error, normal_error, tip_radius: 0.0 };
    // Pair tables are made with the first recognition.
    measure::solve(&contacts(&mut Rng::with_seed(0), model.clone(), 4, &EXACT));
    for seed in 0..NUM_PROBLEMS {
        let problem = contacts(&mut Rng::with_seed(seed), model.clone(), num_contacts, &noise);
        let started = Instant::now();
        let found = measure::solve(&problem);
        let recognized = started.elapsed().as_secs_f64();
        let listed = Instant::now();
        let num_listed: usize =
            found.hypotheses.iter().map(|one| one.interpretations().take(10).count()).sum();
        let listing = listed.elapsed().as_secs_f64();
        let count = found.interpretation_count();
        let line = json!({
            "seed": seed,
            "seconds": recognized,
            "listing": { "listed": num_listed, "seconds": listing },
            "boxes": found.reports[0].num_boxes,
            "nodes": found.reports[0].counters.nodes,
            "hypotheses": found.hypotheses.len(),
            "interpretations": count.at_least,
            "exact": count.exact,
            "complete": found.complete,
            "true_pose_contained": found.hypotheses.iter().any(|one| one.poses.contains(problem.world_from_model)),
            "peak_bytes": peak_bytes(),
        });
        println!("{line}");
    }
}

/// The most memory that this process has held; where the system does not say, nothing.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}

/// The lines of a case, and whether it ended in time.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn in_own_process(name: &str, bounds: (f64, f64), num_contacts: usize) -> Value {
    let own = std::env::current_exe().expect("the path of this program");
    let arguments = [name.into(), bounds.0.to_string(), bounds.1.to_string(), num_contacts.to_string()];
    let mut child =
        Command::new(own).args(arguments).stdout(Stdio::piped()).spawn().expect("this program runs");
    let started = Instant::now();
    let in_time = loop {
        if child.try_wait().expect("a state of the child").is_some() {
            break true;
        }
        if started.elapsed() > LONGEST {
            child.kill().expect("the child ends");
            child.wait().expect("the child has ended");
            break false;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let mut text = String::new();
    child.stdout.take().expect("its output").read_to_string(&mut text).expect("text");
    let problems: Vec<Value> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    json!({
        "part": name,
        "position_error": bounds.0,
        "normal_error_deg": bounds.1,
        "contacts": num_contacts,
        "in_time": in_time,
        "problems": problems,
    })
}
