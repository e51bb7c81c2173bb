//! Runs the trials, names bad trials.

use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::options::Options;
use super::place::Place;
use super::random::Random;
use super::tally::{self, Tally};
use super::trial::{Kind, Trial};
use crate::kinds;

/// Runs all chosen kinds and prints the table. Returns whether every trial is good.
pub fn run(options: &Options) -> Result<bool, String> {
    fs::create_dir_all(&options.folder)
        .map_err(|error| format!("{}: {error}", options.folder.display()))?;
    let started = Instant::now();
    let chosen = kinds::NAMES
        .iter()
        .filter(|name| options.only.is_empty() || options.only.iter().any(|only| only == *name));
    let mut tallies = Vec::new();
    for name in chosen {
        tallies.push(run_kind(options, name)?);
    }
    println!();
    tally::print(&tallies).map_err(|error| error.to_string())?;
    let bad: usize = tallies.iter().map(Tally::bad).sum();
    let share = options.share;
    println!("{bad} faults; seed {}, share {share}, {:.0?}", options.seed, started.elapsed());
    Ok(bad == 0)
}

fn run_kind(options: &Options, name: &str) -> Result<Tally, String> {
    let folder = options.folder.join(name);
    let place = Place::new(&folder.join("prepare")).map_err(|error| error.to_string())?;
    let kind = kinds::prepare(name, &place).map_err(|problem| format!("{name}: {problem}"))?;
    let all = kind.trials();
    let numbers: Vec<usize> = match options.number {
        Some(number) if number < all => vec![number],
        Some(number) => return Err(format!("--number {number}: {name} has {all} trials, from 0")),
        None => chosen_numbers(all, options.share),
    };
    let mut tally = run_trials(options, kind.as_ref(), name, &numbers);
    tally.note = kind.note();
    place.remove();
    let _ = fs::remove_dir(&folder);
    Ok(tally)
}

/// That share of the numbers below `all`, at least one: the same ones for every seed.
fn chosen_numbers(all: usize, share: f64) -> Vec<usize> {
    let wanted = (1..=all).find(|wanted| *wanted as f64 >= share * all as f64).unwrap_or(all);
    let mut numbers: Vec<usize> = (0..all).collect();
    let mut random = Random::of_trial(0, "share", all);
    for index in 0..wanted {
        numbers.swap(index, index + random.below(all - index));
    }
    numbers.truncate(wanted);
    numbers.sort_unstable();
    numbers
}

fn run_trials(options: &Options, kind: &dyn Kind, name: &str, numbers: &[usize]) -> Tally {
    let next = AtomicUsize::new(0);
    let tally = Mutex::new(Tally::new(name, kind.limit()));
    println!("{name}: {} trials", numbers.len());
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let asked = options.threads.map_or_else(cores, usize::from);
    let threads = if kind.parallel() { asked } else { 1 };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let trial = one_trial(options, kind, name, *number);
                    let mut tally = tally.lock().expect("no thread panicked");
                    tally.add(&trial);
                    if !trial.faults.is_empty() {
                        name_bad(options, name, *number, &trial);
                    }
                }
            });
        }
    });
    tally.into_inner().expect("no thread panicked")
}

fn one_trial(options: &Options, kind: &dyn Kind, name: &str, number: usize) -> Trial {
    let root = options.folder.join(name).join(number.to_string());
    let place = match Place::new(&root) {
        Ok(place) => place,
        Err(error) => {
            let skipped = Some(format!("{}: {error}", root.display()));
            return Trial { skipped, ..Trial::default() };
        }
    };
    let mut random = Random::of_trial(options.seed, name, number);
    let trial = kind.trial(number, &mut random, &place);
    if trial.faults.is_empty() && !options.keep {
        place.remove();
    }
    trial
}

/// Names a bad trial, and how to repeat it.
fn name_bad(options: &Options, kind: &str, number: usize, trial: &Trial) {
    let seed = options.seed;
    println!("bad: {kind} {number} (seed {seed}): {}", trial.what);
    for (fault, text) in &trial.faults {
        println!("  {}: {text}", fault.name());
    }
    let folder = options.folder.join(kind).join(number.to_string());
    let again = format!("--only {kind} --number {number} --seed {seed}");
    println!("  again: make torture TORTURE='{again}'; files: {}", folder.display());
}
