//! `billow bench`: what billow costs on this machine.

use std::io::{self, Write};
use std::path::Path;

use super::print::print_rows;
use super::{Format, Global, output_error};
use crate::bench::{self, Effort, LARGEST_RUN, Line, Part, Plan, Report};
use crate::input::value::{Value, brief_number, json_value};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::disk_error;
use crate::platform::stop::Stop;

/// Least share of its wall time a run has a core on a machine that does nothing else.
const QUIET: f64 = 0.95;

/// Arguments of `billow bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measure these parts only.
    #[arg(long, value_name = "PART", value_enum, value_delimiter = ',')]
    pub only: Vec<Part>,
    /// Meshes, as in 5,8 [default: 5,8,16,32; with --quick 5].
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=64))]
    pub subdivisions: Vec<u32>,
    /// Seconds instead of minutes: small meshes, short runs; most targets stay unmeasured.
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// The whole cases too: 1.5 s at n 8, 0.3 s at n 16.
    #[arg(long)]
    pub full: bool,
}

/// Runs `billow bench`. Targets that are missed are figures, no errors.
///
/// # Errors
/// A run that stops short, a disk that fails, a signal.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let parts = if args.only.is_empty() { Part::ALL.to_vec() } else { args.only.clone() };
    refuse_unmeasured(args, &parts)?;
    let plan = Plan {
        parts,
        subdivisions: args.subdivisions.clone(),
        effort: match (args.quick, args.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        },
        instruction_set: super::solve::instruction_set()?,
    };
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let report = bench::run(&plan, &stop, &mut |next| {
        if !global.quiet {
            eprintln!("billow: {next}");
        }
    })?;
    if let (Some(share), false) = (report.least_core_share(), global.quiet)
        && share < QUIET
    {
        eprintln!(
            "billow: something else used this machine: a run had a core for {:.0} % of its wall time \
             (core_share), so figures are too high",
            100.0 * share
        );
    }
    print(&report, global.format(), out)
}

/// A mesh of which nothing would be measured is a mistake.
fn refuse_unmeasured(args: &Args, parts: &[Part]) -> Result<()> {
    let large = args.subdivisions.iter().find(|n| **n > LARGEST_RUN);
    let way = !args.quick && parts.contains(&Part::Cases);
    let Some(n) = large.filter(|_| !way && !parts.contains(&Part::Stages)) else { return Ok(()) };
    Err(Error::Input(InputError {
        file: "--subdivisions".to_owned(),
        key: String::new(),
        value: n.to_string(),
        problem: format!("nothing of n {n} would be measured"),
        allowed: format!("up to {LARGEST_RUN} for kernels, and for cases with --quick"),
        hint: "add stages to --only: of larger meshes the stowed state is timed".to_owned(),
    }))
}

/// A report's tables, by name.
fn tables(report: &Report) -> [(&'static str, Vec<Line>); 6] {
    [
        ("machine", vec![report.machine.line()]),
        ("kernels", report.kernels.iter().map(bench::kernels::KernelRow::line).collect()),
        ("stages", report.stages.iter().map(bench::stages::StageRow::line).collect()),
        ("cases", report.cases.iter().map(bench::capsule::Case::line).collect()),
        ("jobs", report.jobs.iter().map(bench::jobs::JobsRow::line).collect()),
        ("targets", report.targets().iter().map(bench::targets::Target::line).collect()),
    ]
}

/// Prints a report: tables one below the other; one table of every cell as CSV; one JSON object.
///
/// # Errors
/// When the output cannot be written.
pub fn print(report: &Report, format: Format, out: &mut dyn Write) -> Result<()> {
    match format {
        Format::Table => readable(report, out),
        Format::Csv => print_rows(&["part", "row", "name", "value"], &cells(report), format, out),
        Format::Json => json(report, out).map_err(output_error),
    }
}

fn readable(report: &Report, out: &mut dyn Write) -> Result<()> {
    for (name, lines) in tables(report) {
        let Some(first) = lines.first() else { continue };
        writeln!(out, "{name}").map_err(output_error)?;
        if name == "machine" {
            let pair = |(key, value): &(&str, Value)| vec![text(key), brief(value)];
            let rows: Vec<Vec<Value>> = first.iter().map(pair).collect();
            print_rows(&["quantity", "value"], &rows, Format::Table, out)?;
        } else {
            let columns: Vec<&str> = first.iter().map(|(key, _)| *key).collect();
            let row = |line: &Line| line.iter().map(|(_, value)| brief(value)).collect();
            let rows: Vec<Vec<Value>> = lines.iter().map(row).collect();
            print_rows(&columns, &rows, Format::Table, out)?;
        }
        writeln!(out).map_err(output_error)?;
    }
    let open = report.not_measured();
    let open = if open.is_empty() {
        String::new()
    } else {
        format!(" (not measured: {})", open.join(", "))
    };
    let met = if report.targets_met() { "yes" } else { "no" };
    writeln!(out, "targets met: {met}{open}").map_err(output_error)
}

fn text(text: &str) -> Value {
    Value::Text(text.to_owned())
}

/// A cell for the eye: four digits are more than a clock gives.
fn brief(value: &Value) -> Value {
    match value {
        Value::Number(number) => brief_number(*number).parse().map_or(Value::Null, Value::Number),
        Value::Bool(met) => text(if *met { "yes" } else { "NO" }),
        other => other.clone(),
    }
}

/// Every cell with its place.
fn cells(report: &Report) -> Vec<Vec<Value>> {
    let mut cells = Vec::new();
    for (name, lines) in tables(report) {
        for (row, line) in lines.into_iter().enumerate() {
            let row = Value::Integer(i64::try_from(row).unwrap_or(i64::MAX));
            let cell = |(key, value)| vec![text(name), row.clone(), text(key), value];
            cells.extend(line.into_iter().map(cell));
        }
    }
    let met = Value::Bool(report.targets_met());
    cells.push(vec![text("targets"), Value::Null, text("targets_met"), met]);
    cells
}

/// One object, keys in the order of the tables.
fn json(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let row = |line: &Line| {
        let member = |(key, value): &(&str, Value)| {
            format!("{}: {}", serde_json::Value::from(*key), json_value(value))
        };
        format!("{{{}}}", line.iter().map(member).collect::<Vec<_>>().join(", "))
    };
    writeln!(out, "{{")?;
    writeln!(out, "\"effort\": \"{}\",", report.effort.name())?;
    for (name, lines) in tables(report) {
        let rows: Vec<String> = lines.iter().map(row).collect();
        match (name, rows.as_slice()) {
            ("machine", [machine]) => writeln!(out, "\"machine\": {machine},")?,
            (_, []) => writeln!(out, "\"{name}\": [],")?,
            (_, rows) => writeln!(out, "\"{name}\": [\n  {}\n],", rows.join(",\n  "))?,
        }
    }
    let open = serde_json::Value::from(report.not_measured());
    writeln!(out, "\"not_measured\": {open},")?;
    writeln!(out, "\"targets_met\": {}", report.targets_met())?;
    writeln!(out, "}}")
}
