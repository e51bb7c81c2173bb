//! Speed of billow on this machine: `billow-checks bench`.
//!
//! ```text
//! cost = wall time / (steps × elements)        ns per element and step
//! ```
//!
//! The paper's capsule under 5 g/s (`capsule`) is measured in three states: stowed, rising, at the
//! end. Parts: the machine itself (`machine`), the step without contact and a plain scalar reference (`kernels`),
//! stages of a step (`stages`), whole runs (`runs`), quiet filling with `explicit` and `hybrid`
//! (`quiet_filling`), static equilibria (`statics`). `targets` compares the results with the goals of the
//! project; a missed target is not an error.

use std::io::Write;

use billow_solver::platform::simd::InstructionSet;
use billow_study::cli::options::{OutputOptions, QuietOption};
use billow_study::cli::print::print_rows;
use billow_study::cli::{Format, instruction_set, output_error};
use billow_study::input::value::{Value, brief_number, json_value};
use billow_study::platform::error::Result;
use serde_json::json;

mod capsule;
mod kernels;
mod machine;
mod quiet_filling;
mod reference_step;
mod runs;
mod stages;
mod statics;
mod targets;

/// A row: names and values.
type Row = Vec<(&'static str, Value)>;

/// Rows of each part, by its name.
type Tables = Vec<(&'static str, Vec<Row>)>;

/// Time of the state `rising`, s.
const RISING: f64 = 0.03;
/// Time to which meshes of every size are run, s, to compare their costs.
const EARLY: f64 = 0.005;
/// Longest wall time of a run that is repeated, s. Chosen.
const MAX_REPEATED_WALL_TIME: f64 = 0.5;
/// Largest mesh whose kernels are timed and which runs beyond [`EARLY`], n.
const LARGEST_RUN: u32 = 16;
/// Least fraction of its wall time that a run has a core on an idle machine. Chosen: below it another
/// program has used the core.
const MIN_CORE_SHARE: f64 = 0.95;

/// A part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Speed of the machine.
    Machine,
    /// Steps without contact, and the scalar reference.
    Kernels,
    /// Stages of a step, in three states.
    Stages,
    /// Whole runs.
    Cases,
    /// Quiet filling, explicit against hybrid.
    Hybrid,
    /// Static equilibria.
    Statics,
}

/// Extent of a bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effort {
    /// Seconds: n 5, short runs.
    Quick,
    /// Minutes.
    Usual,
    /// As usual, and the whole cases.
    Full,
}

/// Arguments of `billow-checks bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measure only these parts.
    #[arg(long, value_name = "PART", value_enum, value_delimiter = ',')]
    only: Vec<Part>,
    /// Mesh subdivisions n, comma-separated [default: 5,8,16,32; with --quick 5].
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=64))]
    subdivisions: Vec<u32>,
    /// Take seconds instead of minutes: small meshes, short runs; most targets are not measured.
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Also run the full-length cases: 1.5 s at n = 8, 0.3 s at n = 16, quiet filling of 12 s at n = 8.
    #[arg(long)]
    full: bool,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// What to measure.
struct Plan<'a> {
    parts: &'a [Part],
    /// Which meshes, n; empty for the default ones.
    subdivisions: Vec<u32>,
    effort: Effort,
    instruction_set: InstructionSet,
    quiet: bool,
}

impl Plan<'_> {
    fn has(&self, part: Part) -> bool {
        self.parts.is_empty() || self.parts.contains(&part)
    }

    /// The meshes that were asked for, up to a limit; `usual` ones if none was.
    fn meshes(&self, usual: &[u32], limit: u32) -> Vec<u32> {
        let quick = self.effort == Effort::Quick;
        let meshes = match self.subdivisions.as_slice() {
            [] if quick => &usual[..1],
            [] => usual,
            named => named,
        };
        meshes.iter().copied().filter(|n| *n <= limit).collect()
    }

    /// How often something short is repeated.
    fn repeats(&self) -> usize {
        if self.effort == Effort::Quick { 2 } else { 3 }
    }

    /// Says on stderr what is measured next.
    fn note(&self, next: &str) {
        if !self.quiet {
            eprintln!("billow-checks: {next}");
        }
    }
}

/// Runs `billow-checks bench`. A missed target is a result, not an error. A signal ends it without figures.
///
/// # Errors
/// A run that stops before its end.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let mut subdivisions = args.subdivisions.clone();
    subdivisions.sort_unstable();
    subdivisions.dedup();
    let plan = Plan {
        parts: &args.only,
        subdivisions,
        effort: match (args.quick, args.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        },
        instruction_set: instruction_set::selected()?,
        quiet: args.quiet.quiet,
    };
    let tables = measure(&plan)?;
    let shares = tables.iter().flat_map(|(_, rows)| rows).flatten();
    let shares = shares.filter(|(name, _)| *name == "core_share");
    let least = shares.filter_map(|(_, value)| number(value)).reduce(f64::min);
    if let Some(share) = least.filter(|share| *share < MIN_CORE_SHARE && !plan.quiet) {
        eprintln!(
            "billow-checks: another program used this machine: a run had a core for {:.0} % of its wall time \
             (core_share); the times are too long",
            100.0 * share
        );
    }
    print(&plan, &tables, args.output.format(), out)
}

/// Runs every part of a plan, and compares the results with the targets.
fn measure(plan: &Plan<'_>) -> Result<Tables> {
    let set = plan.instruction_set;
    let (mut kernels, mut hybrid, mut statics) = (Vec::new(), Vec::new(), Vec::new());
    let mut machine = machine::row(set);
    if plan.has(Part::Machine) {
        plan.note("machine");
        machine.extend(machine::speed(plan));
    }
    let meshes = plan.meshes(&[5, 8, 16, 32], u32::MAX);
    if plan.has(Part::Kernels) {
        for n in meshes.iter().copied().filter(|n| *n <= LARGEST_RUN) {
            plan.note(&format!("kernels, n {n}"));
            kernels.extend(kernels::measure(n, plan)?);
        }
    }
    let (mut stages, mut cases) = (Vec::new(), Vec::new());
    if plan.has(Part::Stages) || plan.has(Part::Cases) {
        for n in meshes {
            runs::measure(n, plan, &mut stages, &mut cases)?;
        }
    }
    if plan.has(Part::Hybrid) {
        for n in quiet_filling::meshes(plan) {
            hybrid.extend(quiet_filling::measure(n, plan)?);
        }
    }
    if plan.has(Part::Statics) {
        for n in plan.meshes(&[4, 8, 16], LARGEST_RUN) {
            plan.note(&format!("static equilibria, n {n}"));
            statics.push(statics::measure(n, plan)?);
        }
    }
    let mut tables = vec![
        ("machine", vec![machine]),
        ("kernels", kernels),
        ("stages", stages),
        ("cases", cases),
        ("hybrid", hybrid),
        ("statics", statics),
    ];
    let targets = targets::rows(&tables, set);
    tables.push(("targets", targets));
    Ok(tables)
}

/// The number in a cell.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

/// The value of a column of a row.
fn cell<'a>(row: &'a Row, column: &str) -> Option<&'a Value> {
    row.iter().find(|(name, _)| *name == column).map(|(_, value)| value)
}

/// Prints the tables: one below the other, as one CSV table of all cells, or as one JSON object.
fn print(plan: &Plan<'_>, tables: &Tables, format: Format, out: &mut dyn Write) -> Result<()> {
    let met = |row: &Row| cell(row, "met").cloned().unwrap_or(Value::Null);
    let targets =
        || tables.iter().filter(|(name, _)| *name == "targets").flat_map(|(_, rows)| rows);
    let all_met = targets().all(|row| met(row) == Value::Bool(true));
    let unmeasured = targets().filter(|row| met(row) == Value::Null);
    let unmeasured: Vec<String> =
        unmeasured.filter_map(|row| cell(row, "target")).map(ToString::to_string).collect();
    match format {
        Format::Table => {
            for (name, rows) in tables.iter().filter(|(_, rows)| !rows.is_empty()) {
                writeln!(out, "{name}").map_err(output_error)?;
                readable(rows, out)?;
                writeln!(out).map_err(output_error)?;
            }
            let missing = if unmeasured.is_empty() {
                String::new()
            } else {
                format!(" (not measured: {})", unmeasured.join(", "))
            };
            let met = if all_met { "yes" } else { "no" };
            writeln!(out, "targets met: {met}{missing}").map_err(output_error)
        }
        Format::Csv => {
            let cells = tables.iter().flat_map(|(part, rows)| {
                rows.iter().enumerate().flat_map(move |(index, row)| {
                    row.iter().map(move |(name, value)| {
                        vec![(*part).into(), index.into(), (*name).into(), value.clone()]
                    })
                })
            });
            print_rows(&["part", "row", "name", "value"], &cells.collect::<Vec<_>>(), format, out)
        }
        Format::Json => {
            let row = |row: &Row| -> serde_json::Value {
                row.iter().map(|(name, value)| ((*name).to_owned(), json_value(value))).collect()
            };
            let mut object = json!({
                "effort": format!("{:?}", plan.effort).to_lowercase(),
                "not_measured": unmeasured,
                "targets_met": all_met,
            });
            for (name, rows) in tables {
                object[name] = rows.iter().map(row).collect();
            }
            writeln!(out, "{object:#}").map_err(output_error)
        }
    }
}

/// Prints rows with four significant digits, fewer than a clock gives; a single row as pairs.
fn readable(rows: &[Row], out: &mut dyn Write) -> Result<()> {
    let brief = |value: &Value| match value {
        Value::Number(number) => brief_number(*number).parse().map_or(Value::Null, Value::Number),
        Value::Bool(met) => if *met { "yes" } else { "NO" }.into(),
        other => other.clone(),
    };
    if let [row] = rows {
        let pairs: Vec<Vec<Value>> =
            row.iter().map(|(name, value)| vec![(*name).into(), brief(value)]).collect();
        return print_rows(&["quantity", "value"], &pairs, Format::Table, out);
    }
    let columns: Vec<&str> = rows[0].iter().map(|(name, _)| *name).collect();
    let cells = |row: &Row| row.iter().map(|(_, value)| brief(value)).collect();
    print_rows(&columns, &rows.iter().map(cells).collect::<Vec<_>>(), Format::Table, out)
}
