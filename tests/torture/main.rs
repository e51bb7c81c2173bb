//! Repeats what happens to a program in use, many times: kills, signals, full disks, changed files,
//! little memory, mutated input. It drives the program `billow` from outside, checks that nothing is
//! lost and nothing is silently wrong, and prints one table.
//!
//! ```text
//! make torture
//! cargo test --release --locked -p billow-study --test torture -- --only kill9,signals --trials 0.1
//! ```
//!
//! Every trial follows from the seed, its kind and its number. The folder of a bad trial is kept.
//! Exit code 1 if a trial is bad, 2 for a wrong option.

#![allow(clippy::disallowed_methods, reason = "the trials read and damage files directly")]

mod check;
mod kinds;
mod mutate;
mod program;
mod random;
mod studies;
mod trial;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use billow_study::input::value::Value;
use billow_study::print::Format;
use billow_study::print::print_rows;
use clap::Parser;
use clap::builder::PossibleValuesParser;
use rayon::prelude::*;

use kinds::{KINDS, Kind};
use program::Place;
use random::Random;
use trial::Trial;

const COLUMNS: [&str; 8] =
    ["kind", "trials", "detected", "survived", "bad", "longest (s)", "limit (s)", "notes"];

/// Torture billow: kills, signals, full disks, changed files, little memory, mutated input.
#[derive(Parser)]
struct Options {
    /// Only these kinds, comma-separated.
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(KINDS.map(|kind| kind.name)))]
    only: Vec<String>,
    /// Share of the trials of each kind, above 0 up to 1.
    #[arg(long = "trials", value_name = "SHARE", default_value_t = 1.0, value_parser = share)]
    share: f64,
    /// Only this trial of one kind.
    #[arg(long, requires = "only")]
    number: Option<usize>,
    /// Seed of all random choices.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| *share > 0.0 && *share <= 1.0);
    share.ok_or_else(|| "a number above 0 and up to 1 is needed".to_owned())
}

fn main() -> ExitCode {
    let started = Instant::now();
    let options = Options::parse();
    let (mut rows, mut all_bad) = (Vec::new(), 0);
    let chosen =
        |kind: &&Kind| options.only.is_empty() || options.only.iter().any(|name| name == kind.name);
    for kind in KINDS.iter().filter(chosen) {
        match run(&options, kind) {
            Ok((row, bad)) => {
                rows.push(row);
                all_bad += bad;
            }
            Err(problem) => {
                eprintln!("torture: {}: {problem}", kind.name);
                return ExitCode::from(2);
            }
        }
    }
    println!();
    if print_rows(&COLUMNS, &rows, Format::Table, &mut std::io::stdout().lock()).is_err() {
        return ExitCode::from(2);
    }
    let Options { seed, share, .. } = options;
    println!("{all_bad} bad trials; seed {seed}, share {share}, {:.0?}", started.elapsed());
    ExitCode::from(u8::from(all_bad > 0))
}

/// Makes the trials of a kind: its row of the table, and the number of bad trials.
fn run(options: &Options, kind: &Kind) -> Result<(Vec<Value>, usize), String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("torture").join(kind.name);
    let place = Place::new(&folder.join("prepare"));
    let prepared = (kind.prepare)(&place)?;
    let all = prepared.trials;
    let numbers = match options.number {
        Some(number) if number < all => vec![number],
        Some(number) => return Err(format!("--number {number}: there are {all} trials, from 0")),
        // The same ones for every seed.
        None => (0..all)
            .filter(|n| *n == 0 || Random::of_trial(0, "share", *n).fraction() < options.share)
            .collect(),
    };
    println!("{}: {} trials", kind.name, numbers.len());
    let make = |number: &usize| {
        let place = Place::new(&folder.join(number.to_string()));
        let mut trial = Trial { number: *number, ..Trial::default() };
        let mut random = Random::of_trial(options.seed, kind.name, *number);
        (prepared.make)(&mut trial, &mut random, &place);
        if trial.longest > Duration::from_secs(kind.limit) {
            trial.fault(format!("slow: {:.1?}", trial.longest));
        }
        if trial.faults.is_empty() {
            place.remove();
        } else {
            name_bad(options, kind, &trial, &folder);
        }
        trial
    };
    let trials: Vec<Trial> = if kind.one_by_one {
        numbers.iter().map(make).collect()
    } else {
        numbers.par_iter().map(make).collect()
    };
    place.remove();
    let bad = trials.iter().filter(|trial| !trial.faults.is_empty()).count();
    Ok((row(kind, &trials, bad), bad))
}

/// Names a bad trial, and how to repeat it.
fn name_bad(options: &Options, kind: &Kind, trial: &Trial, folder: &Path) {
    let (name, number, seed) = (kind.name, trial.number, options.seed);
    println!("bad: {name} {number} (seed {seed}): {}", trial.what);
    trial.faults.iter().for_each(|fault| println!("  {fault}"));
    let again = format!("--only {name} --number {number} --seed {seed}");
    let files = folder.join(number.to_string());
    println!("  again: make torture TORTURE='{again}'; files: {}", files.display());
}

/// The row of a kind.
fn row(kind: &Kind, trials: &[Trial], bad: usize) -> Vec<Value> {
    let made: Vec<&Trial> = trials.iter().filter(|trial| !trial.skipped).collect();
    let good = made.iter().filter(|trial| trial.faults.is_empty());
    let (detected, survived): (Vec<&Trial>, Vec<&Trial>) = good.partition(|trial| trial.detected);
    let longest = trials.iter().map(|trial| trial.longest).max().unwrap_or_default();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (name, number) in trials.iter().flat_map(|trial| &trial.counts) {
        *counts.entry(name).or_default() += number;
    }
    let notes: Vec<String> =
        counts.iter().map(|(name, number)| format!("{number} {name}")).collect();
    vec![
        kind.name.into(),
        made.len().into(),
        detected.len().into(),
        survived.len().into(),
        bad.into(),
        format!("{:.2}", longest.as_secs_f64()).into(),
        kind.limit.to_string().into(),
        notes.join("; ").into(),
    ]
}
