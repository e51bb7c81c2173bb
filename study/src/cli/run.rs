//! `billow run`: runs what is missing of a study.

use std::io::{self, Write};
use std::num::NonZero;
use std::path::{Path, PathBuf};

use super::{Format, Global, notes, output_error};
use crate::error::{Error, InputError, Result};
use crate::executor::Solver;
use crate::files::{Disk, disk_error};
use crate::plan;
use crate::progress::{self, Loudness};
use crate::references::References;
use crate::results::Results;
use crate::row;
use crate::runner::{self, Run, Summary};
use crate::stop::Stop;
use crate::study::Study;

/// Arguments of `billow run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file.
    pub study: PathBuf,
}

/// Runs `billow run`: jobs that are finished are kept, the rest is run; stopped at any moment, the
/// same command goes on. A study whose grid has changed keeps the jobs it still plans.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let study = Study::load(&args.study, &global.set)?;
    let root = results_folder(global, &study);
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let loudness = match global {
        Global { quiet: true, .. } => Loudness::Quiet,
        Global { verbose: true, .. } => Loudness::Verbose,
        _ => Loudness::Normal,
    };
    let results = Results::new(&Disk, &root);
    let summary = runner::run(
        &Run {
            name: &study.name,
            study: &study.to_json(),
            planner: &|finished| plan::next_jobs(&study, finished),
            unit: &|name| study.unit(name).to_owned(),
            executor: &Solver { references: References::load(&results) },
            results,
            threads: threads(global)?,
            stop,
        },
        progress::reporter(loudness).as_mut(),
    )?;
    print(&study.name, &root, &summary, global.format(), out).map_err(output_error)?;
    if !global.quiet {
        notes::print(&study);
    }
    match (summary.signal, summary.failed()) {
        (Some(signal), _) => Err(Error::Signal(signal)),
        (None, 0) => Ok(()),
        (None, failed) => Err(Error::JobsFailed(format!(
            "{failed} {} failed\n  next: billow table {} --columns job,status,reason,stop_time,\
             stop_place",
            plural(failed, "job"),
            root.display()
        ))),
    }
}

/// Where the results of a study lie.
pub fn results_folder(global: &Global, study: &Study) -> PathBuf {
    global.results.clone().unwrap_or_else(|| Path::new("results").join(&study.name))
}

fn plural(count: usize, word: &str) -> String {
    format!("{word}{}", if count == 1 { "" } else { "s" })
}

/// The number of threads asked for.
///
/// # Errors
/// Where nought is asked for.
pub fn threads(global: &Global) -> Result<Option<NonZero<usize>>> {
    let Some(threads) = global.threads else { return Ok(None) };
    let refused = || InputError {
        file: "--threads".to_owned(),
        key: String::new(),
        value: threads.to_string(),
        problem: "no thread would run".to_owned(),
        allowed: "1 or more; leave it out for one a core".to_owned(),
        hint: String::new(),
    };
    Ok(Some(NonZero::new(threads).ok_or_else(refused)?))
}

/// As many threads as asked for; one a core where nobody asks.
///
/// # Errors
/// Where nought is asked for, or the system gives none.
pub fn pool(global: &Global) -> Result<rayon::ThreadPool> {
    let threads = threads(global)?.map_or(0, NonZero::get);
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    built.map_err(|error| Error::Disk {
        path: "threads".into(),
        problem: format!("cannot start: {error}\n  next: ask for fewer with --threads N"),
    })
}

fn print(
    name: &str,
    root: &Path,
    summary: &Summary,
    format: Format,
    out: &mut dyn Write,
) -> io::Result<()> {
    if format == Format::Json {
        let json = serde_json::json!({
            "study": name,
            "results": root.display().to_string(),
            "ran": summary.ran,
            "failed": summary.failed(),
            "status": summary.status,
            "verdict": summary.verdict,
        });
        return writeln!(out, "{json}");
    }
    let points: usize = summary.status.values().sum();
    let without_job = summary.status.get(row::INFEASIBLE).copied().unwrap_or(0);
    let pending = summary.status.get(row::PENDING).copied().unwrap_or(0);
    if summary.ran == 0 && pending == 0 {
        writeln!(out, "{name}: nothing to run, all {} jobs are finished", points - without_job)?;
    } else {
        let (jobs, of) = (plural(summary.ran, "job"), plural(points, "point"));
        writeln!(out, "{name}: {} {jobs} run, {points} {of}", summary.ran)?;
    }
    let list = |counts: &std::collections::BTreeMap<String, usize>| {
        let parts: Vec<String> = counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
        parts.join(", ")
    };
    writeln!(out, "  status   {}", list(&summary.status))?;
    if !summary.verdict.is_empty() {
        writeln!(out, "  verdict  {}", list(&summary.verdict))?;
    }
    writeln!(out, "  results  {}", root.display())?;
    writeln!(out, "  next     billow table {}", root.display())
}
