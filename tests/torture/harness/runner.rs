//! Runs the trials, shows progress, names bad trials.

use std::fs;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use super::options::Options;
use super::place::Place;
use super::random::Random;
use super::tally::{self, Tally};
use super::trial::{Kind, Trial};
use crate::kinds;

/// Pause between two lines of progress that are not on a terminal.
const PROGRESS_PAUSE: Duration = Duration::from_secs(30);

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
    println!("\n{}", tally::table(&tallies));
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
    let state = Mutex::new((Tally::new(name, kind.limit()), Progress::new(name, numbers.len())));
    let threads = if kind.parallel() { options.threads } else { 1 };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let trial = one_trial(options, kind, name, *number);
                    let mut state = state.lock().expect("no thread panicked");
                    let (tally, progress) = &mut *state;
                    tally.add(&trial);
                    progress.step(options, *number, &trial);
                }
            });
        }
    });
    state.into_inner().expect("no thread panicked").0
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

/// The line of progress of a kind.
struct Progress {
    name: String,
    total: usize,
    done: usize,
    bad: usize,
    started: Instant,
    last: Instant,
}

impl Progress {
    fn new(name: &str, total: usize) -> Self {
        let now = Instant::now();
        Self { name: name.to_owned(), total, done: 0, bad: 0, started: now, last: now }
    }

    fn step(&mut self, options: &Options, number: usize, trial: &Trial) {
        self.done += 1;
        let mut out = std::io::stdout().lock();
        if !trial.faults.is_empty() {
            self.bad += 1;
            let seed = options.seed;
            let folder = options.folder.join(&self.name).join(number.to_string());
            let _ = writeln!(out, "\rbad: {} {number} (seed {seed}): {}", self.name, trial.what);
            for (fault, text) in &trial.faults {
                let _ = writeln!(out, "  {}: {text}", fault.name());
            }
            let _ = writeln!(
                out,
                "  again: make torture TORTURE='--only {} --number {number} --seed {seed}'; files: {}",
                self.name,
                folder.display()
            );
        }
        let line = format!(
            "{}: {} of {} trials, {} bad, {:.0?}",
            self.name,
            self.done,
            self.total,
            self.bad,
            self.started.elapsed()
        );
        let finished = self.done == self.total;
        if out.is_terminal() {
            let _ = write!(out, "\r{line}{}", if finished { "\n" } else { "" });
            let _ = out.flush();
        } else if finished || self.last.elapsed() > PROGRESS_PAUSE {
            self.last = Instant::now();
            let _ = writeln!(out, "{line}");
        }
    }
}
