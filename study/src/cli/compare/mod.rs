//! `billow compare`: compares the values of one parameter, all other parameters being equal.

use std::io::Write;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::points::{Points, chosen_runs};
use super::results::{self, StudyArgs};
use super::{Format, output_error};
use crate::analysis::compare::{self, Measure, Pair, Sets, Tolerance, measures_with};
use crate::input::fraction::fraction;
use crate::input::value::Value;
use crate::job::row::{BetterSide, DerivedColumn};
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::store::stored::Stored;
use crate::store::table::select::find;
use crate::store::table::{Column, Table};

mod notes;
mod pairs;
mod summary;

/// Measures that a table compares by default.
const DEFAULT_MEASURES: [&str; 2] = ["t_90_z_rim_since_release", "peak_kinetic_energy"];

/// Arguments of `billow compare`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// The parameter to compare by.
    #[arg(long, value_name = "PARAM")]
    pub by: String,
    /// The value that the other values are compared with; with its unit, as in "1 g/s".
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    pub base: String,
    /// Measures, comma-separated [default: `t_90_z_rim_since_release,peak_kinetic_energy` and, in a study
    /// with limits, `smallest_margin`; for csv and json all measures for which smaller or larger is better].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and M >= 3`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Relative difference up to which a pair is a tie, as in 1% [default: the larger spread of the
    /// measure, by seed or by method, and for points of several runs that their ranges overlap; without
    /// either the values are lower or higher, not better].
    #[arg(long, value_name = "FRACTION")]
    pub tie: Option<String>,
    /// Pair single runs in a study with replicates [default: points, with the medians of their runs; a
    /// replicate itself is always compared by single runs].
    #[arg(long)]
    pub runs: bool,
    /// Print only the summary: one row per value and measure.
    #[arg(long)]
    pub summary: bool,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// The pairs and measures to compare.
struct Comparison<'a> {
    /// The rows that are paired: single runs, or points as medians.
    table: &'a Table,
    /// The points, where they are paired.
    points: Option<&'a Points<'a>>,
    by: &'a Column,
    sets: Sets,
    pairs: Vec<Pair>,
    measures: Vec<Measure<'a>>,
    /// The parameters over which a point has its runs.
    replicates: Vec<String>,
    /// The meshes from which the values of a point are extrapolated; empty without any.
    meshes: Vec<u32>,
    /// Whether the summary has the intervals of its proportions.
    with_intervals: bool,
}

/// Runs `billow compare`: one row per pair, then a summary with one row per value and measure.
///
/// # Errors
/// An unknown parameter, value, measure or column; results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let condition = args.condition.as_deref();
    let mut opened = results::open(&args.study, &args.set.set, &args.units)?;
    opened.add_keys(&[], condition);
    let results::Opened { stored, table } = opened;
    print(args, &stored, &table, out)
}

/// Compares the rows of a table, and prints the result.
fn print(args: &Args, stored: &Stored<'_>, table: &Table, out: &mut dyn Write) -> Result<()> {
    let by = parameter(table, &args.by)?;
    let base = base(stored, by, &args.base)?;
    let format = args.output.format();
    let zipped = |name: &str| stored.study.zipped_with(name);
    let varied = stored.study.replicates();
    let single = args.runs || varied.contains(&by.name);
    let replicates = if single { Vec::new() } else { varied.clone() };
    let rows = chosen_runs(table, args.condition.as_deref(), &replicates)?;
    let points = (!replicates.is_empty()).then(|| Points::of(table, &rows, &replicates));
    let given = args.tie.as_deref().map(tie).transpose()?.map(Tolerance::given);
    // A compared replicate is no repetition.
    let repeated: Vec<String> = varied.iter().filter(|name| **name != by.name).cloned().collect();
    let paired = points.as_ref().map_or(table, |points| &points.condensed.table);
    let paired_rows: Vec<usize> = match &points {
        Some(points) => (0..points.condensed.runs.len()).collect(),
        None => rows.clone(),
    };
    let sets = Sets::new(paired, &paired_rows, &by.name, &zipped(&by.name));
    let (pairs, alone) = compare::pairs(paired, &sets, &by.name, &base);
    let measures = measures(paired, &args.measures, format)?
        .into_iter()
        .map(|column| match (given, &points) {
            (Some(given), _) => Measure::of_runs(column, given),
            (None, Some(points)) => {
                Measure::of_points(&points.condensed, &paired_rows, column, &zipped("seed"))
            }
            (None, None) => {
                let over = Tolerance::over(table, &rows, column, &repeated, &zipped("seed"));
                Measure::of_runs(column, over).with_errors(table)
            }
        })
        .collect();
    let comparison = Comparison {
        table: paired,
        points: points.as_ref(),
        by,
        sets,
        pairs,
        measures,
        replicates,
        meshes: stored.study.meshes(),
        with_intervals: !varied.is_empty() || !stored.study.result_limits().is_empty(),
    };
    if !args.summary {
        comparison.print_pairs(format, out)?;
    }
    if args.summary || format == Format::Table {
        if !args.summary {
            writeln!(out).map_err(output_error)?;
        }
        comparison.print_tallies(format, out)?;
    }
    if !args.quiet.quiet {
        comparison.print_notes(&base, &alone);
    }
    Ok(())
}

fn parameter<'a>(table: &'a Table, name: &str) -> Result<&'a Column> {
    let names = || table.parameters().map(|column| column.name.as_str());
    table.parameters().find(|column| column.name == name).ok_or_else(|| {
        let near = did_you_mean(name, names());
        let mut allowed = names().collect::<Vec<_>>().join(", ");
        if allowed.is_empty() {
            "none: the study varies no parameter".clone_into(&mut allowed);
        }
        let problem = "not a parameter the study varies";
        Error::invalid_option("--by", name, problem, allowed, near.unwrap_or_default())
    })
}

/// The base value, as in the table.
fn base(stored: &Stored<'_>, by: &Column, text: &str) -> Result<Value> {
    let values = compare::values(by, &(0..by.cells.len()).collect::<Vec<_>>());
    let wanted = stored.study.parameter_value(&by.name, text);
    let found = values.iter().find(|value| {
        // A column of texts and numbers stores its numbers as text.
        value.to_string() == text.trim()
            || wanted.as_ref().is_some_and(|wanted| {
                compare::canonical(value) == compare::canonical(wanted)
                    || value.to_string() == wanted.to_string()
            })
    });
    found.cloned().ok_or_else(|| {
        let values: Vec<String> = values.iter().map(|value| by.shown.quantity(value)).collect();
        let problem = format!("not a value of {} in this study", by.name);
        let near = did_you_mean(text, values.iter().map(String::as_str)).unwrap_or_default();
        Error::invalid_option("--base", text, problem, values.join(", "), near)
    })
}

fn measures<'a>(table: &'a Table, names: &[String], format: Format) -> Result<Vec<&'a Column>> {
    let existing = |names: &[&str]| -> Vec<&'a Column> {
        names.iter().filter_map(|name| table.column(name)).collect()
    };
    match names {
        [] if format == Format::Table => {
            Ok(existing(&[&DEFAULT_MEASURES[..], &[DerivedColumn::SmallestMargin.name()]].concat()))
        }
        [] => {
            let judged = [measures_with(BetterSide::Smaller), measures_with(BetterSide::Larger)];
            let mut measures = existing(&judged.concat());
            let is_margin = |column: &&Column| compare::is_margin(&column.name);
            measures.extend(table.columns.iter().filter(is_margin));
            Ok(measures)
        }
        names => names.iter().map(|name| measure(table, name.trim())).collect(),
    }
}

fn measure<'a>(table: &'a Table, name: &str) -> Result<&'a Column> {
    let column = find(table, "--measures", name)?;
    if compare::is_measure(column) {
        return Ok(column);
    }
    let numbers = table.columns.iter().filter(|column| compare::is_measure(column));
    let numbers: Vec<&str> = numbers.map(|column| column.name.as_str()).collect();
    let problem = "holds no numbers to compare";
    Err(Error::invalid_option("--measures", name, problem, numbers.join(", "), ""))
}

/// The relative difference of a tie, as 0.01 or "1%".
fn tie(text: &str) -> Result<f64> {
    fraction(text).filter(|number| (0.0..1.0).contains(number)).ok_or_else(|| {
        let allowed = "at least 0 and less than 1, as 0.01 or 1%";
        Error::invalid_option("--tie", text, "not a relative difference", allowed, "")
    })
}
