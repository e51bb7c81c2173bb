//! `billow table`: prints the summary table of a study's results.

use std::io::Write;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::points::{Points, chosen_runs};
use super::print::{Heading, print_quantities};
use super::results::{self, Opened, StudyArgs};
use super::{Format, best, legend, notes};
use crate::input::keys::numerical::SEED;
use crate::input::value::Value;
use crate::job::row::{ColumnId, SAME_JOB_AS};
use crate::platform::error::Result;
use crate::store::table::Table;
use crate::study::Study;
use columns::{chosen, heading, shown};
use sort::{by_search, sorted};

mod columns;
mod point_columns;
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
    /// Columns, comma-separated, or "all" [default: parameters and main measures; all for csv
    /// and json].
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
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// What is printed: columns, rows, and the notes about them.
struct Listing {
    headings: Vec<Heading>,
    cells: Vec<Vec<Value>>,
    noisy: Option<String>,
    notes: Vec<String>,
    /// Number of columns that `--columns all` shows.
    all_columns: usize,
}

/// Runs `billow table`.
///
/// # Errors
/// Results that cannot be read; an unknown column; an invalid condition.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let asked = asked(args);
    let mut opened = results::open(&args.study, &args.set.set, &args.units)?;
    let all_columns = opened.table.columns.len();
    opened.add_keys(&asked, args.condition.as_deref());
    let Opened { stored, table } = opened;
    print(args, Some(&stored.study), &table, all_columns, out)
}

/// The columns that the options name.
fn asked(args: &Args) -> Vec<String> {
    let sorts = args.sort.iter().map(|key| key.split(':').next().unwrap_or_default());
    let names = args.columns.iter().map(String::as_str).chain(sorts);
    names.map(|name| name.trim().to_owned()).collect()
}

/// Prints a table, of whose results `all_columns` is the number of columns.
fn print(
    args: &Args,
    study: Option<&Study>,
    table: &Table,
    all_columns: usize,
    out: &mut dyn Write,
) -> Result<()> {
    let replicates = match study {
        Some(study) if !args.runs => study.replicates(),
        _ => Vec::new(),
    };
    let rows = chosen_runs(table, args.condition.as_deref(), &replicates)?;
    let rows = by_search(table, rows, study);
    let format = args.output.format();
    let meshes = study.map(Study::meshes).unwrap_or_default();
    let mut listing = if replicates.is_empty() {
        runs(args, table, &rows, all_columns, notes::seed_matters(study))?
    } else {
        points(args, table, &rows, &replicates, &meshes)?
    };
    let all_rows = listing.cells.len();
    listing.cells.truncate(args.limit.unwrap_or(all_rows));
    print_quantities(&listing.headings, &listing.cells, format, out)?;
    let left_out = all_rows - listing.cells.len();
    if left_out > 0 && !args.quiet.quiet {
        eprintln!("{} of {all_rows} rows: --limit leaves out {left_out}", listing.cells.len());
    }
    if format == Format::Table && !args.quiet.quiet {
        if let Some(note) = &listing.noisy {
            eprintln!("{note}");
        }
        if rows.is_empty() && args.condition.is_some() {
            eprintln!(
                "billow: no row fulfils --where; a number without a unit is SI, a unit is written as in \
                 mass_flow_rate == '5 g/s'"
            );
        }
        eprintln!("{} of {} columns (--columns all)", listing.headings.len(), listing.all_columns);
        for note in &listing.notes {
            eprintln!("{note}");
        }
        let shown = listing.cells.iter().flatten().any(legend::has_mesh_error);
        let meshes = if args.runs { Vec::new() } else { meshes };
        for note in legend::mesh_errors(shown, table, &meshes) {
            eprintln!("{note}");
        }
        best::print(study, table, &rows);
    }
    Ok(())
}

/// One row per run.
fn runs(
    args: &Args,
    table: &Table,
    rows: &[usize],
    all_columns: usize,
    seed_matters: bool,
) -> Result<Listing> {
    let format = args.output.format();
    let rows = sorted(table, rows.to_vec(), &args.sort)?;
    let columns = chosen(table, &args.columns, &args.sort, format)?;
    let row =
        |row: &usize| columns.iter().map(|column| shown(table, column, *row, format)).collect();
    let mut notes = Vec::new();
    let jobs = table.one_row_per_job(&rows).len();
    if jobs < rows.len() {
        notes.push(format!(
            "note: {} of these {} rows are the same job as another row ({SAME_JOB_AS})",
            rows.len() - jobs,
            rows.len()
        ));
    }
    Ok(Listing {
        headings: columns.iter().map(|column| heading(column)).collect(),
        cells: rows.iter().map(row).collect(),
        noisy: noisy_note(columns.iter().map(|column| column.name.as_str()))
            .filter(|_| seed_matters),
        notes,
        all_columns,
    })
}

/// One row per point.
fn points(
    args: &Args,
    table: &Table,
    rows: &[usize],
    replicates: &[String],
    meshes: &[u32],
) -> Result<Listing> {
    let format = args.output.format();
    let points = Points::of(table, rows, replicates);
    for key in &args.sort {
        let name = key.split(':').next().unwrap_or_default();
        point_columns::find_point(&points, table, "--sort", name.trim())?;
    }
    let order = sorted(&points.table, (0..points.table.rows()).collect(), &args.sort)?;
    let columns = point_columns::chosen(&points, table, &args.columns, &args.sort, format)?;
    let row = |row: &usize| columns.iter().map(|column| column.cells[*row].clone()).collect();
    let text = legend::points(order.len(), points.run_count(), replicates, meshes, OF_POINTS);
    let mut notes = vec![format!("{text}; --runs shows the runs")];
    if points.run_count() < rows.len() {
        let same = rows.len() - points.run_count();
        notes.push(format!("note: {same} of {} runs are the same job as another run", rows.len()));
    }
    Ok(Listing {
        headings: columns.iter().map(|column| column.heading.clone()).collect(),
        cells: order.iter().map(row).collect(),
        noisy: if replicates.iter().any(|name| name == SEED) {
            None
        } else {
            noisy_note(columns.iter().map(|column| column.heading.name.as_str()))
        },
        notes,
        all_columns: point_columns::all(&points.table, format).len(),
    })
}

/// A note when noisy measures are among the printed columns.
fn noisy_note<'a>(columns: impl Iterator<Item = &'a str>) -> Option<String> {
    let noisy: Vec<&str> =
        columns.filter(|name| ColumnId::from_name(name).is_some_and(ColumnId::is_noisy)).collect();
    let measures = noisy.join(", ");
    (!noisy.is_empty()).then(|| {
        format!("note: noisy: {measures}; the seed alone changes them by more than 3 %, use several seeds")
    })
}
