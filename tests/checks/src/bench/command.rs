//! `billow-checks bench`: measures the speed of billow on this machine.

use std::io::{self, Write};
use std::path::Path;

use crate::bench::{self, Effort, LARGEST_RUN, Line, Part, Plan, Report};
use billow_study::cli::options::{OutputOptions, QuietOption};
use billow_study::cli::print::print_rows;
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::{Value, brief_number, json_value};
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::disk_error;
use billow_study::platform::stop::Stop;

/// Least fraction of its wall time that a run has a core on an idle machine. Chosen: below it another
/// program has used the core.
const MIN_CORE_SHARE: f64 = 0.95;

/// Arguments of `billow-checks bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measure only these parts.
    #[arg(long, value_name = "PART", value_enum, value_delimiter = ',')]
    pub only: Vec<Part>,
    /// Mesh subdivisions n, comma-separated [default: 5,8,16,32; with --quick 5].
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=64))]
    pub subdivisions: Vec<u32>,
    /// Take seconds instead of minutes: small meshes, short runs; most targets are not measured.
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// Also run the full-length cases: 1.5 s at n = 8, 0.3 s at n = 16, quiet filling of 12 s at n = 8.
    #[arg(long)]
    pub full: bool,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow-checks bench`. A missed target is a result, not an error.
///
/// # Errors
/// A run that stops before its end, a disk error, a signal.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let plan = Plan {
        parts: if args.only.is_empty() { Part::ALL.to_vec() } else { args.only.clone() },
        subdivisions: args.subdivisions.clone(),
        effort: match (args.quick, args.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        },
        instruction_set: instruction_set::selected()?,
    };
    refuse_unmeasured(&plan)?;
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let report = bench::run(&plan, &stop, &mut |next| {
        if !args.quiet.quiet {
            eprintln!("billow-checks: {next}");
        }
    })?;
    if let (Some(share), false) = (report.least_core_share(), args.quiet.quiet)
        && share < MIN_CORE_SHARE
    {
        eprintln!(
            "billow-checks: another program used this machine: a run had a core for {:.0} % of its wall time \
             (core_share); the times are too long",
            100.0 * share
        );
    }
    print(&report, args.output.format(), out)
}

/// Refuses a mesh for which none of the parts measures anything.
fn refuse_unmeasured(plan: &Plan) -> Result<()> {
    let unmeasured = |n: &&u32| !plan.parts.iter().any(|part| plan.measures(*part, **n));
    let Some(n) = plan.subdivisions.iter().find(unmeasured) else { return Ok(()) };
    Err(Error::invalid_option(
        "--subdivisions",
        &n.to_string(),
        format!("no part measures n = {n}"),
        format!(
            "up to {LARGEST_RUN} for kernels, statics, cases with --quick and hybrid with --full, up to 8 for \
             hybrid"
        ),
        "add stages to --only: it measures the stowed state of larger meshes",
    ))
}

/// Tables of a report, by name.
fn tables(report: &Report) -> [(&'static str, Vec<Line>); 7] {
    [
        ("machine", vec![report.machine.line()]),
        ("kernels", report.kernels.iter().map(bench::kernels::KernelRow::line).collect()),
        ("stages", report.stages.iter().map(bench::stages::StageRow::line).collect()),
        ("cases", report.cases.iter().map(bench::capsule::Case::line).collect()),
        ("hybrid", report.hybrid.iter().map(bench::quiet_filling::QuietRow::line).collect()),
        ("statics", report.statics.iter().map(bench::statics::StaticsRow::line).collect()),
        ("targets", report.targets().iter().map(bench::targets::Target::line).collect()),
    ]
}

/// Prints a report: as tables one below the other, as one CSV table of all cells, or as one JSON object.
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
    let missing = report.not_measured();
    let missing = if missing.is_empty() {
        String::new()
    } else {
        format!(" (not measured: {})", missing.join(", "))
    };
    let met = if report.targets_met() { "yes" } else { "no" };
    writeln!(out, "targets met: {met}{missing}").map_err(output_error)
}

fn text(text: &str) -> Value {
    Value::Text(text.to_owned())
}

/// A cell of a readable table: a clock gives fewer than four significant digits.
fn brief(value: &Value) -> Value {
    match value {
        Value::Number(number) => brief_number(*number).parse().map_or(Value::Null, Value::Number),
        Value::Bool(met) => text(if *met { "yes" } else { "NO" }),
        other => other.clone(),
    }
}

/// Every cell with its table, row and name.
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
    let missing = serde_json::Value::from(report.not_measured());
    writeln!(out, "\"not_measured\": {missing},")?;
    writeln!(out, "\"targets_met\": {}", report.targets_met())?;
    writeln!(out, "}}")
}
