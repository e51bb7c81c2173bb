//! `billow table`: prints the summary table of a study's results.

use std::io::Write;

use super::Format;
use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::results::{self, Opened, StudyArgs};
use crate::analysis::compare::columns_of_error;
use crate::input::keys::numerical::SEED;
use crate::input::value::Value;
use crate::job::row::{ColumnId, SAME_JOB_AS};
use crate::platform::error::Result;
use crate::print::points::{PointTable, chosen_runs};
use crate::print::print_table;
use crate::print::{legend, notes};
use crate::store::table::{Column, Table};
use crate::study::{Meshes, Study};
use sort::{by_search, sorted};

mod borders;
mod columns;
mod sort;

/// Most characters in a line of the default table.
const MAX_LINE_WIDTH: usize = 120;
/// Most characters in such a line of points or with limits. Chosen: a range or a proportion takes twice the room
/// of a number.
const MAX_WIDE_LINE_WIDTH: usize = 160;

/// What a cell of a point holds.
const OF_POINTS: &str = "median [least to largest], smallest margin, k of n (95 % interval)";

/// Arguments of `billow table`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Only rows for which this condition holds, as in `N == 6 and final_pressure > '40 Pa'`. With
    /// replicates a condition on results is one on points; one that names a replicate chooses runs.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Columns, comma-separated, or "all" [default: parameters and main measures; all for csv and json]. A table has the
    /// parameters that vary before them, unless one of them is a parameter; csv and json have these columns alone.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Sort by these columns, comma-separated; NAME:desc sorts from the largest down. Empty cells
    /// come last.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub sort: Vec<String>,
    /// Print the first N rows only, in the order of the plan or of --sort.
    #[arg(long, value_name = "N")]
    pub limit: Option<usize>,
    /// One row per run in a study with replicates [default: one row per point, with the medians, ranges
    /// and proportions of its runs].
    #[arg(long)]
    pub runs: bool,
    /// One row per search of the study, with the border that it found.
    #[arg(long, conflicts_with_all = ["columns", "sort", "limit", "runs"])]
    borders: bool,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow table`.
///
/// # Errors
/// Results that cannot be read; an unknown column; an invalid condition.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    if args.borders {
        return borders::run(args, out);
    }
    let first = args.limit.filter(|_| args.condition.is_none() && args.sort.is_empty());
    let mut opened = results::open(&args.study, &args.set.set, &args.units, first)?;
    let stored_columns = opened.table.columns.len();
    opened.add_keys(&asked(args), args.condition.as_deref());
    let Opened { stored, table } = opened;
    let study = Some(&stored.study);
    let format = args.output.format();
    let replicates = match study {
        Some(study) if !args.runs => study.replicates(),
        _ => Vec::new(),
    };
    let rows =
        by_search(&table, chosen_runs(&table, args.condition.as_deref(), &replicates)?, study);
    let points = (!replicates.is_empty()).then(|| PointTable::of(&table, &rows, &replicates));
    let listed = match &points {
        Some(points) if format == Format::Table => &points.for_reader(),
        Some(points) => &points.table,
        None => &table,
    };
    // The order is that of the numbers, which a table for a reader does not have.
    let order = match &points {
        Some(points) => {
            for name in sorting(&args.sort) {
                columns::find(&points.table, &table, "--sort", name)?;
            }
            sorted(&points.table, (0..points.table.rows()).collect(), &args.sort)?
        }
        None => sorted(&table, rows.clone(), &args.sort)?,
    };
    let printed = &order[..args.limit.unwrap_or(order.len()).min(order.len())];
    let columns =
        columns::chosen(listed, (&table, stored.study.minimised()), (args, format), printed)?;
    print_table(listed, &columns, printed, format, out)?;
    if args.quiet.quiet {
        return Ok(());
    }
    let stand_alone = first.is_some() && stored.study.rows_stand_alone();
    let all = if stand_alone { stored.planned_runs() } else { order.len() };
    let left_out = all - printed.len();
    if left_out > 0 {
        eprintln!("{} of {all} rows: --limit leaves out {left_out}", printed.len());
    }
    if format == Format::Table {
        let all = match &points {
            Some(_) => columns::all(listed).len(),
            None => stored_columns,
        };
        for note in notes(args, study, (&table, &rows), points.as_ref(), &columns) {
            eprintln!("{note}");
        }
        eprintln!("{} of {all} columns (--columns all)", columns.len());
    }
    Ok(())
}

/// The columns that the options name.
fn asked(args: &Args) -> Vec<String> {
    let names = args.columns.iter().map(String::as_str).chain(sorting(&args.sort));
    names.map(|name| name.trim().to_owned()).collect()
}

/// The columns by which rows are sorted.
fn sorting(sort: &[String]) -> impl Iterator<Item = &str> {
    sort.iter().map(|key| key.split(':').next().unwrap_or_default().trim())
}

/// What a reader must know of the rows and columns printed.
fn notes(
    args: &Args,
    study: Option<&Study>,
    (table, rows): (&Table, &[usize]),
    points: Option<&PointTable<'_>>,
    columns: &[&Column],
) -> Vec<String> {
    let mut notes = Vec::new();
    let meshes = study.map(Study::meshes).unwrap_or_default();
    let replicates = study.map(Study::replicates).unwrap_or_default();
    let over_seeds = points.is_some() && replicates.iter().any(|name| name == SEED);
    if !over_seeds && notes::seed_matters(study) {
        notes.extend(noisy_note(columns));
    }
    if rows.is_empty() && args.condition.is_some() {
        notes.push(
            "billow: no row fulfils --where; a number without a unit is SI, a unit is written as in mass_flow_rate == \
             '5 g/s'"
                .to_owned(),
        );
    }
    let (all, jobs) = match points {
        Some(points) => {
            let count = points.table.rows();
            let text = legend::points(count, points.run_count(), &replicates, &meshes, OF_POINTS);
            notes.push(format!("{text}; --runs shows the runs"));
            ("runs", points.run_count())
        }
        None => ("rows", table.one_row_per_job(rows).len()),
    };
    if jobs < rows.len() {
        let same = rows.len() - jobs;
        let of = rows.len();
        notes.push(format!(
            "note: {same} of these {of} {all} are the same job as another ({SAME_JOB_AS})"
        ));
    }
    let has_error = |column: &&Column| {
        let errors = columns_of_error(table, &column.name);
        errors.is_some_and(|[below, _]| rows.iter().any(|row| below.cells[*row] != Value::Null))
    };
    let meshes = if args.runs { Meshes::default() } else { meshes };
    let shown = columns.iter().any(has_error).then_some(legend::UNCERTAINTY);
    notes.extend(legend::mesh_errors(shown, table, &meshes));
    notes
}

/// A note when noisy measures are among the printed columns.
fn noisy_note(columns: &[&Column]) -> Option<String> {
    let names = columns.iter().map(|column| column.name.as_str());
    let noisy: Vec<&str> =
        names.filter(|name| ColumnId::from_name(name).is_some_and(ColumnId::is_noisy)).collect();
    let measures = noisy.join(", ");
    (!noisy.is_empty()).then(|| {
        format!("note: noisy: {measures}; the seed alone changes them by more than 3 %, use several seeds")
    })
}
