//! `billow compare`: compares the values of a parameter, all other parameters being equal, or ranks them.

use std::io::Write;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption, parameter_name};
use super::results::{self, Opened, StudyArgs};
use super::{Format, output_error};
use crate::analysis::compare::{self, Comparison, Measure, Sets, Tolerance, measures_with};
use crate::analysis::replicates::Condensed;
use crate::input::fraction::fraction;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::result_limit::ResultLimit;
use crate::job::row::{BetterSide, ColumnId, DerivedColumn};
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::print::points::chosen_runs;
use crate::print::{is_part, print_table};
use crate::store::stored::Stored;
use crate::store::table::select::find;
use crate::store::table::{Column, Table};

mod notes;
mod rank;

/// Measures that a table compares by default.
const DEFAULT_MEASURES: [ColumnId; 2] =
    [ColumnId::T90ZRimSinceRelease, ColumnId::PeakKineticEnergy];

/// Arguments of `billow compare`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// The parameter to compare by; with --rank one or more, comma-separated [default there: strategy if it varies,
    /// otherwise every parameter].
    #[arg(
        long,
        value_name = "PARAM",
        value_delimiter = ',',
        required_unless_present = "rank",
        value_parser = parameter_name
    )]
    by: Vec<String>,
    /// The value that the other values are compared with; with its unit, as in "1 g/s".
    #[arg(
        long,
        value_name = "VALUE",
        allow_hyphen_values = true,
        required_unless_present = "rank",
        conflicts_with = "rank"
    )]
    base: Option<String>,
    /// Order the values by limits and measures, the best one first: fewest points not safe, fewest runs not safe, then
    /// the medians of the measures. Margins order where --measures names `smallest_margin`.
    #[arg(long, conflicts_with_all = ["tie", "runs", "summary"])]
    rank: bool,
    /// Measures, comma-separated [default: `t_90_z_rim_since_release,peak_kinetic_energy`, in a study with limits
    /// those that it limits and `smallest_margin`; for csv and json all measures for which smaller or larger is
    /// better; with --rank
    /// those that the study limits, then `peak_vz,peak_kinetic_energy,t_90_z_rim_since_release`].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    measures: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and M >= 3`.
    #[arg(long = "where", value_name = "CONDITION")]
    condition: Option<String>,
    /// Relative difference up to which a pair is a tie, as in 1% [default: the larger spread of the
    /// measure, by seed or by method, and for points of several runs that their ranges overlap; without
    /// either the values are lower or higher, not better].
    #[arg(long, value_name = "FRACTION")]
    tie: Option<String>,
    /// Pair single runs in a study with replicates [default: points, with the medians of their runs; a
    /// replicate itself is always compared by single runs].
    #[arg(long)]
    runs: bool,
    /// Print only the summary: one row per value and measure.
    #[arg(long)]
    summary: bool,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow compare`: one row per pair, then a summary with one row per value and measure; with --rank one row per
/// value.
///
/// # Errors
/// An unknown parameter, value, measure or column; results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let condition = args.condition.as_deref();
    let mut opened = results::open(&args.study, &args.set.set, &args.units, None)?;
    opened.add_keys(&[], condition);
    let Opened { stored, table } = opened;
    let Some(base) = &args.base else { return rank::run(args, &stored, &table, out) };
    let by = parameter(&table, &args.by.join(","))?;
    let base = self::base(&stored, by, base)?;
    let format = args.output.format();
    let zipped = |name: &str| stored.study.zipped_with(name);
    let varied = stored.study.replicates_of_samples();
    let single = args.runs || varied.contains(&by.name);
    let replicates = if single { Vec::new() } else { varied.clone() };
    let rows = chosen_runs(&table, condition, &replicates)?;
    let points = (!replicates.is_empty()).then(|| Condensed::of(&table, &rows, &replicates));
    let given = args.tie.as_deref().map(tie).transpose()?.map(Tolerance::given);
    // A compared replicate is no repetition.
    let repeated: Vec<String> = varied.into_iter().filter(|name| *name != by.name).collect();
    let paired = points.as_ref().map_or(&table, |points| &points.table);
    let paired_rows: Vec<usize> = match &points {
        Some(points) => (0..points.runs.len()).collect(),
        None => rows.clone(),
    };
    let sets = Sets::new(paired, &paired_rows, &by.name, &zipped(&by.name));
    let (pairs, alone) = compare::pairs(paired, &sets, &by.name, &base);
    let measure = |column| match (given, &points) {
        (Some(given), _) => Measure::of_runs(column, given),
        (None, Some(points)) => Measure::of_points(points, &paired_rows, column, &zipped("seed")),
        (None, None) => {
            let over = Tolerance::over(&table, &rows, column, &repeated, &zipped("seed"));
            Measure::of_runs(column, over).with_errors(&table)
        }
    };
    let columns = measures(paired, &args.measures, stored.study.result_limits(), format)?;
    let measures = columns.into_iter().map(measure).collect();
    let comparison =
        Comparison { table: paired, points: points.as_ref(), by, sets, pairs, measures };
    if !args.summary {
        print(&comparison.pairs(), &is_for_reader(&comparison), format, out)?;
    }
    if args.summary || format == Format::Table {
        if !args.summary {
            writeln!(out).map_err(output_error)?;
        }
        // A table has no columns for outcomes that no pair has, and differences only where a measure has no ratio.
        let is_signed = comparison.measures.iter().any(Measure::is_signed);
        let is_shown = |column: &Column| match column.name.as_str() {
            "other_better" | "base_better" | "ties" => true,
            name if name.ends_with("_difference") => is_signed,
            name => name.ends_with("_ratio") || !column.is_empty(),
        };
        print(&comparison.summary(format == Format::Table), &is_shown, format, out)?;
    }
    if !args.quiet.quiet {
        let meshes = stored.study.meshes();
        notes::print(&comparison, &base, &alone, &replicates, &meshes);
    }
    Ok(())
}

/// Prints a whole table; to a reader only some columns.
fn print(
    table: &Table,
    is_shown: &dyn Fn(&Column) -> bool,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let for_reader = |column: &&Column| !is_part(table, column) && is_shown(column);
    let columns =
        table.columns.iter().filter(|column| format != Format::Table || for_reader(column));
    let rows: Vec<usize> = (0..table.rows()).collect();
    print_table(table, &columns.collect::<Vec<_>>(), &rows, format, out)
}

/// The columns of pairs that a reader sees: no jobs, a status only where a job is not done, the ratio of a measure, or the
/// difference where it has none.
fn is_for_reader(comparison: &Comparison<'_>) -> impl Fn(&Column) -> bool {
    let done = |row: usize| comparison.table.status(row) == Some(Status::Done);
    let all_done = comparison.pairs.iter().all(|pair| done(pair.base) && done(pair.other));
    let signed: Vec<String> = comparison
        .measures
        .iter()
        .map(|measure| {
            let hidden = if measure.is_signed() { "ratio" } else { "difference" };
            format!("{}_{hidden}", measure.column.name)
        })
        .collect();
    move |column| match column.name.as_str() {
        "base_job" | "other_job" | "base_verdict" | "other_verdict" => false,
        "base_status" | "other_status" => !all_done,
        "base_deployed" | "other_deployed" => !column.is_empty(),
        name => !signed.iter().any(|hidden| hidden == name),
    }
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

/// The measures to compare. A reader sees what is limited before the smallest margin, else the times and loads.
fn measures<'a>(
    table: &'a Table,
    names: &[String],
    limits: &[ResultLimit],
    format: Format,
) -> Result<Vec<&'a Column>> {
    let existing = |names: &[&str]| -> Vec<&'a Column> {
        names.iter().filter_map(|name| table.column(name)).collect()
    };
    match names {
        [] if format == Format::Table => {
            let mut limited: Vec<&str> = limits.iter().map(|limit| limit.measure.name()).collect();
            limited.dedup();
            let mut shown: Vec<&'a Column> = existing(&limited);
            shown.retain(|column| compare::is_measure(column));
            if shown.is_empty() {
                let measures = DEFAULT_MEASURES.map(|id| table.of_any_film(id).name());
                shown = existing(&measures);
            }
            shown.extend(table.column(DerivedColumn::SmallestMargin.name()));
            Ok(shown)
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
