//! `billow report`: writes one file that answers a study.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::options::{QuietOption, SetOption, UnitsOption};
use super::results::{self, Opened, StudyArgs};
use super::{changes, chart, output_error};
use crate::analysis::answer::Answer;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, disk_error, write_output};
use crate::report::{Before, DEFAULT_SIZE, Report};
use crate::store::stored::{Stored, planned};
use crate::store::table::Table;
use crate::study::Study;

/// Time between two reports of a running study. Chosen: a reader sees the last jobs, and writing takes less.
const INTERVAL: Duration = Duration::from_secs(5);
/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;

/// Arguments of `billow report`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// File to write, .html [default: report.html in the folder of the results].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Size of the file: above it the report has fewer curves, jobs with shapes, and frames, and says so. The numbers stay.
    #[arg(long, value_name = "MB")]
    size: Option<f64>,
    /// Write the report again while the study runs; an open page follows it.
    #[arg(long)]
    watch: bool,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow report`: prints the path of the file.
///
/// # Errors
/// Results that cannot be read; a file that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let size = match args.size {
        None => DEFAULT_SIZE,
        Some(megabytes) if megabytes > 0.0 && megabytes.is_finite() => MEGABYTE * megabytes,
        Some(other) => {
            let problem = "is no size of a file";
            let allowed = "a number of megabytes above 0, as in --size 40";
            return Err(Error::invalid_option("--size", &other.to_string(), problem, allowed, ""));
        }
    };
    if let Some(path) = &args.out
        && path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("html"))
    {
        let (value, problem) = (path.display().to_string(), "is no page");
        let allowed = "a file name that ends in .html";
        return Err(Error::invalid_option("--out", &value, problem, allowed, ""));
    }
    loop {
        let Opened { stored, table } =
            results::open(&args.study, &args.set.set, &args.units, None)?;
        let is_running = stored.results.is_running()?;
        let answer = Answer::of(&stored, &table);
        let path = args.out.clone().unwrap_or_else(|| stored.results.report_path());
        let notes = write((&stored, &table, &answer), size, is_running, &path)?;
        if !args.watch || !is_running {
            for note in notes.iter().filter(|_| !args.quiet.quiet) {
                eprintln!("note: {note}");
            }
            return writeln!(out, "{}", path.display()).map_err(output_error);
        }
        std::thread::sleep(INTERVAL);
    }
}

/// Writes the report of some results; returns what it leaves out.
///
/// # Errors
/// A history that cannot be read; a file that cannot be written.
pub(super) fn write(
    (stored, table, answer): (&Stored<'_>, &Table, &Answer),
    size: f64,
    is_running: bool,
    path: &Path,
) -> Result<Vec<String>> {
    let charts = chart::of_answer((stored, table, answer))?;
    let before = before(stored, table);
    let (page, notes) =
        Report { stored, table, answer, charts, before, size, is_running }.html()?;
    write_output(&Disk, path, page.as_bytes()).map_err(|error| disk_error(path, &error))?;
    Ok(notes)
}

/// What the run before had, where it was of another form of the study.
fn before(stored: &Stored<'_>, table: &Table) -> Option<Before> {
    let study = Study::load(&stored.results.previous_path(), &[]).ok()?;
    // At the end of a run only the records of its jobs are known.
    let journal = stored.results.journal().ok()?;
    let points = planned(&study, &journal);
    let mut before = Table::of_study(&study, &points, &journal.records);
    let names = |table: &Table| -> Vec<String> {
        table.parameters().map(|column| column.name.clone()).collect()
    };
    // A key that one of the two varies has one value in the other.
    let mut now = Table { columns: table.parameters().cloned().collect() };
    let (ours, others) = (names(&now), names(&before));
    results::add_keys(&stored.study, &mut now, &stored.units, &others, None);
    results::add_keys(&study, &mut before, &stored.units, &ours, None);
    let all: Vec<String> = ours.into_iter().chain(others).collect();
    let changes = changes::between(&study, &stored.study);
    Some(Before::of(table, &now, &before, &all, changes))
}
