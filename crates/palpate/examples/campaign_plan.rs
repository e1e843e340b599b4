//! `complete` against random lines and the other planners, on many random problems.
//!
//! `cargo run --release --example campaign_plan [problems] [lines] [effort] [file]`: each problem is one line of JSON in the file,
//! in order of number. Killed and started again, it goes on where it was; the file is the same for any number of threads.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program that reports")]

#[path = "../tests/common/against.rs"]
mod against;
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/parts.rs"]
mod parts;
#[path = "../tests/common/planning.rs"]
mod planning;

use std::fs::{File, OpenOptions, create_dir_all, read_to_string};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use rayon::prelude::*;
use serde_json::{Value, json};

/// So many problems are worked on between two writings.
const CHUNK: u64 = 8;

fn main() -> ExitCode {
    let given =
        |k: usize, or: u64| std::env::args().nth(k).map_or(or, |text| text.parse().expect("a number"));
    let (problems, lines, effort) = (given(1, 1_000), given(2, 200_000), given(3, 2_000_000));
    let default = "target/figures/campaign_plan.jsonl";
    let path = PathBuf::from(std::env::args().nth(4).unwrap_or_else(|| default.to_owned()));
    let header = json!({ "work": "campaign-plan", "lines": lines, "effort": effort }).to_string();
    let (mut file, mut done) = resumed(&path, &header);
    let mut worse: usize = done.iter().filter(|text| is_worse(text)).count();
    while (done.len() as u64) < problems {
        let first = done.len() as u64;
        let numbers = first..problems.min(first + CHUNK);
        let texts: Vec<String> =
            numbers.into_par_iter().map(|number| examined(number, lines, effort)).collect();
        for text in texts {
            writeln!(file, "{text}").expect("the file can be written");
            worse += usize::from(is_worse(&text));
            done.push(text);
        }
        eprintln!(
            "{} of {problems} problems, {worse} with a path that is better than that of complete",
            done.len()
        );
    }
    println!("{problems} problems, {lines} random lines each: {worse} with a better path than complete's");
    if worse == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn examined(number: u64, lines: u64, effort: u64) -> String {
    let case = planning::case(number);
    against::against(&case, number, lines, effort).to_json(&case, number).to_string()
}

fn is_worse(text: &str) -> bool {
    let value: Value = serde_json::from_str(text).expect("a line of this program");
    value["better"].as_array().is_some_and(|better| !better.is_empty())
}

/// The file, open at its end, and its whole lines so far; anew if it is of other work.
fn resumed(path: &Path, header: &str) -> (File, Vec<String>) {
    if let Some(folder) = path.parent() {
        create_dir_all(folder).expect("the folder can be made");
    }
    let old = read_to_string(path).unwrap_or_default();
    let whole = &old[..old.rfind('\n').map_or(0, |end| end + 1)];
    let mut lines = whole.lines().map(str::to_owned);
    let done: Vec<String> =
        if lines.next().as_deref() == Some(header) { lines.collect() } else { Vec::new() };
    let mut text = format!("{header}\n");
    for line in &done {
        text.extend([line, "\n"]);
    }
    std::fs::write(path, text).expect("the file can be written");
    (OpenOptions::new().append(true).open(path).expect("the file is there"), done)
}
