//! `billow merge`: joins what several runs have stored.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::options::OutputOptions;
use super::run::listed;
use super::{Format, output_error};
use crate::job::row::Counts;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, disk_error};
use crate::platform::quote;
use crate::platform::stop::Stop;
use crate::print::count;
use crate::run::merge::{self, Merged};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::Study;

/// Arguments of `billow merge`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folders of results of one study. One alone, without --results, gets the results of the tasks of `billow submit`.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Folder into which the jobs of the others are copied; it may be new.
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow merge`. Folders that are read stay as they are; a merge that was stopped goes on where it was.
///
/// # Errors
/// Folders of different studies; [`Error::JobsFailed`] (exit code 1) when one job has different bits in two folders, or
/// a history is damaged.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let (target, merged) = match (&args.results, args.folders.as_slice()) {
        (None, [only]) => (only, copy(&parts(only)?, only, &stop)?),
        (None, _) => return Err(no_target()),
        (Some(target), sources) => (target, copy(sources, target, &stop)?),
    };
    if let Some(signal) = stop.requested() {
        let next = "what was copied is kept, the same command copies the rest".to_owned();
        return Err(Error::Interrupted { signal, next });
    }
    print(target, &merged, args.output.format(), out)?;
    result(&merged)
}

fn no_target() -> Error {
    Error::invalid_option(
        "billow merge",
        "",
        "several folders, and none into which they are joined",
        "billow merge FOLDER… --results DIR",
        "DIR may be a new folder or one of them",
    )
}

/// Copies the jobs of folders into another one.
fn copy(sources: &[PathBuf], target: &Path, stop: &Stop) -> Result<Merged> {
    let sources: Vec<Results<'_>> =
        sources.iter().map(|folder| existing(folder)).collect::<Result<_>>()?;
    let Some(first) = sources.first() else { return Err(no_target()) };
    let study = Study::load(&first.study_path(), &[])?;
    let others: Vec<Results<'_>> =
        sources.into_iter().filter(|source| source.root() != target).collect();
    let target = Results::new(&Disk, target);
    merge::merge(&others, &target, (&study.name, study.file()), stop)
}

/// The folders of the tasks of `billow submit`.
fn parts(folder: &Path) -> Result<Vec<PathBuf>> {
    let parts = existing(folder)?.parts()?;
    let paths: Vec<PathBuf> = parts.iter().map(|part| part.root().to_owned()).collect();
    if paths.is_empty() {
        let problem = "no results of tasks here (parts/)\n  next: billow submit, or name the folders to merge and --results DIR";
        return Err(Error::Disk { path: folder.to_owned(), problem: problem.to_owned() });
    }
    Ok(paths)
}

/// The results in a folder.
fn existing(folder: &Path) -> Result<Results<'static>> {
    let results = Results::new(&Disk, folder);
    if results.owner()?.is_some() {
        return Ok(results);
    }
    let problem = "no results here: no study.json\n  next: name the folders of runs of one study";
    Err(Error::Disk { path: folder.to_owned(), problem: problem.to_owned() })
}

fn print(folder: &Path, merged: &Merged, format: Format, out: &mut dyn Write) -> Result<()> {
    let results = existing(folder)?;
    let stored = Stored::read(results)?;
    let mut counts = Counts::default();
    for point in stored.points.iter() {
        counts.add_cells(&stored.cells(point));
    }
    let root = quote::path(folder);
    if format == Format::Json {
        let json = serde_json::json!({
            "study": stored.study.name,
            "results": folder.display().to_string(),
            "copied": merged.copied,
            "same_bits": merged.same,
            "other_bits": merged.different.iter().map(JobId::as_str).collect::<Vec<_>>(),
            "damaged": merged.damaged.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "status": counts.status,
            "verdict": counts.verdict,
        });
        return writeln!(out, "{json}").map_err(output_error);
    }
    let next = match counts.of(Status::Pending) {
        0 => format!("billow report {root}"),
        pending => format!("billow run {root} runs the {} that are missing", count(pending, "job")),
    };
    let same = match merged.same {
        0 => String::new(),
        same => format!(", {same} there already with the same bits"),
    };
    let copied = count(merged.copied, "job");
    let mut lines = vec![format!("{}: {copied} copied{same}", stored.study.name)];
    lines.push(format!("  status   {}", listed(&counts.status)));
    if !counts.verdict.is_empty() {
        lines.push(format!("  verdict  {}", listed(&counts.verdict)));
    }
    lines.push(format!("  results  {root}"));
    lines.push(format!("  next     {next}"));
    writeln!(out, "{}", lines.join("\n")).map_err(output_error)
}

/// The error of a merge, if it has one.
fn result(merged: &Merged) -> Result<()> {
    if !merged.different.is_empty() {
        let ids: Vec<&str> = merged.different.iter().map(JobId::short).collect();
        return Err(Error::JobsFailed(format!(
            "{} with different bits in two folders; the first result was kept: {}\n  next: billow job JOB in each \
             folder; compare program_version, commit and physics_version",
            count(ids.len(), "job"),
            ids.join(", ")
        )));
    }
    let Some(first) = merged.damaged.first() else { return Ok(()) };
    Err(Error::JobsFailed(format!(
        "{} with a damaged or missing history were left out; the first is {}\n  next: billow doctor --repair in its \
         folder, billow run there, then merge again",
        count(merged.damaged.len(), "job"),
        first.display()
    )))
}
