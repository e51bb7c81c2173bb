//! Speed of billow on this machine: `billow-checks bench`.
//!
//! ```text
//! cost = wall time / (steps × elements)        ns per element and step
//! ```
//!
//! The film is the paper's capsule under 5 g/s (`capsule`). Each number is the smallest of several repeats of the same
//! work: other load on the machine only adds time.

use std::io::Write;
use std::path::Path;

use billow_solver::platform::simd::InstructionSet;
use billow_study::cli::print::print_rows;
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::{Value, brief_number};
use billow_study::platform::error::Result;
use billow_study::platform::files::{Disk, Files};
use billow_study::platform::provenance;

mod capsule;
mod stages;

use crate::output::Options;
use capsule::{Capsule, Progress};

/// A row: names and values.
type Row = Vec<(&'static str, Value)>;

/// Time of the state `rising`, s.
const RISING: f64 = 0.03;
/// Times at which the cost so far is a row of `runs`, s, beside the end of a run.
const TIMES: [f64; 4] = [0.005, 0.1, 0.3, 1.5];
/// Number of times that a run or the steps of a state are repeated.
const REPEATS: u32 = 3;
/// Longest wall time of a whole run that is repeated, s. Chosen.
const MAX_REPEATED_WALL_TIME: f64 = 0.5;
/// A part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Stages of a step, in three states.
    Stages,
    /// Whole runs.
    Runs,
}

/// Arguments of `billow-checks bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measure only these parts.
    #[arg(long, value_name = "PART", value_enum, value_delimiter = ',')]
    only: Vec<Part>,
    /// Mesh subdivisions n, comma-separated.
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "5,8,16",
        value_parser = clap::value_parser!(u32).range(1..=64))]
    subdivisions: Vec<u32>,
    /// Simulated time of the runs, s [default: 0.3 up to n 8, 0.1 above].
    #[arg(long, value_name = "SECONDS")]
    end_time: Option<f64>,
    /// Override a key of scenes/capsule.json, as in --set solver.integrator=hybrid; can be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    options: Options,
}

impl Args {
    fn has(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }
}

/// Runs `billow-checks bench`. A signal ends it without figures.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let set = instruction_set::selected()?;
    let (mut stages, mut runs) = (Vec::new(), Vec::new());
    for n in args.subdivisions.iter().copied() {
        measure(args, &Capsule::new(n, &args.set, set)?, &mut stages, &mut runs)?;
    }
    let parts = [("machine", vec![machine(set)]), ("stages", stages), ("runs", runs)];
    print(&parts, args.options.format(), out)
}

/// What the machine and the program are.
fn machine(set: InstructionSet) -> Row {
    let cores = std::thread::available_parallelism().ok().map(std::num::NonZero::get);
    let bytes = Disk.read(Path::new("/proc/cpuinfo")).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let model = text.lines().find(|line| line.starts_with("model name"));
    let cpu = model.and_then(|line| Some(line.split_once(':')?.1.trim()));
    vec![
        ("cpu", cpu.into()),
        ("cores", cores.into()),
        ("instruction_set", set.name().into()),
        ("program_version", provenance::PROGRAM_VERSION.into()),
        ("commit", provenance::COMMIT.into()),
    ]
}

/// Runs one mesh: its cost to each time, and the stages of a step from three states.
fn measure(
    args: &Args,
    capsule: &Capsule,
    stages: &mut Vec<Row>,
    runs: &mut Vec<Row>,
) -> Result<()> {
    let n = capsule.subdivisions;
    let end = args.end_time.unwrap_or(if n <= 8 { 0.3 } else { 0.1 });
    args.options.note(&format!("run, n {n}, {end} s"));
    let mut progress = Progress::of(capsule)?;
    let mut states = vec![("stowed", progress.film.clone())];
    let mut times: Vec<f64> =
        TIMES.into_iter().chain([RISING]).filter(|time| *time < end).collect();
    times.push(end);
    times.sort_by(f64::total_cmp);
    for time in times {
        progress.run_to(time)?;
        if time.to_bits() == RISING.to_bits() {
            states.push(("rising", progress.film.clone()));
        } else if args.has(Part::Runs) {
            runs.push(fastest(capsule, &progress, time)?);
        }
    }
    states.push(("end", progress.film));
    for (name, film) in states.iter().filter(|_| args.has(Part::Stages)) {
        args.options.note(&format!("stages, n {n}, {name}"));
        stages.push(stages::measure(capsule, name, film)?);
    }
    Ok(())
}

/// The cost to a time; a short run, which other processes disturb most, is repeated and the fastest kept.
fn fastest(capsule: &Capsule, run: &Progress<'_>, time: f64) -> Result<Row> {
    let (mut row, mut wall) = (run.row(time), run.wall);
    for _ in (1..REPEATS).filter(|_| run.wall <= MAX_REPEATED_WALL_TIME) {
        let mut repeat = Progress::of(capsule)?;
        repeat.run_to(time)?;
        if repeat.wall < wall {
            (row, wall) = (repeat.row(time), repeat.wall);
        }
    }
    Ok(row)
}

/// Prints the parts: tables one below the other with four significant digits, or every cell in one table.
fn print(parts: &[(&'static str, Vec<Row>)], format: Format, out: &mut dyn Write) -> Result<()> {
    if format != Format::Table {
        let cells = parts.iter().flat_map(|(part, rows)| {
            rows.iter().enumerate().flat_map(move |(index, row)| {
                let cell = |(name, value): &(&'static str, Value)| (*name, value.clone());
                row.iter().map(cell).map(move |(name, value)| {
                    vec![(*part).into(), index.into(), name.into(), value]
                })
            })
        });
        let columns = ["part", "row", "name", "value"];
        return print_rows(&columns, &cells.collect::<Vec<_>>(), format, out);
    }
    let brief = |(_, value): &(&str, Value)| match value {
        Value::Number(number) => brief_number(*number).parse().map_or(Value::Null, Value::Number),
        other => other.clone(),
    };
    for (part, rows) in parts.iter().filter(|(_, rows)| !rows.is_empty()) {
        writeln!(out, "{part}").map_err(output_error)?;
        let columns: Vec<&str> = rows[0].iter().map(|(name, _)| *name).collect();
        let rows: Vec<Vec<Value>> =
            rows.iter().map(|row| row.iter().map(brief).collect()).collect();
        print_rows(&columns, &rows, format, out)?;
        writeln!(out).map_err(output_error)?;
    }
    Ok(())
}

/// The cost of a number of steps that took this wall time (s), ns per element and step.
fn cost(seconds: f64, steps: u64, elements: usize) -> f64 {
    1e9 * seconds / (steps as f64 * elements as f64)
}
