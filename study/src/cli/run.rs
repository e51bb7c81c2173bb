//! `billow run`: runs what is missing of a study.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::num::NonZero;
use std::path::{Path, PathBuf};

use super::instruction_set::instruction_set;
use super::print::count;
use super::{Format, Global, memory, notes, output_error};
use crate::analysis::answer::Answer;
use crate::job::executor::Solver;
use crate::job::references::References;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Disk, disk_error};
use crate::platform::stop::Stop;
use crate::run::progress::{self, Loudness};
use crate::run::runner::{self, Run, Summary};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::Study;
use crate::study::plan;

/// Arguments of `billow run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file.
    pub study: PathBuf,
}

/// Runs `billow run`: jobs that are finished are kept, the rest is run; stopped at any moment, the
/// same command goes on. A study whose grid has changed keeps the jobs it still plans.
///
/// # Errors
/// A study that is not sound, a disk that fails, jobs that failed, a signal.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let study = Study::load(&args.study, &global.set)?;
    memory::check(&args.study.display().to_string(), &study)?;
    let root = results_folder(global, &study);
    run_study(&study, &root, None, global, out)
}

/// Runs what is missing of a study, or some of its jobs again, and says what came of it.
///
/// # Errors
/// As [`run`], and jobs that gave other bits than before.
pub(super) fn run_study(
    study: &Study,
    root: &Path,
    again: Option<&BTreeSet<JobId>>,
    global: &Global,
    out: &mut dyn Write,
) -> Result<()> {
    let instruction_set = instruction_set()?;
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let loudness = match global {
        Global { quiet: true, .. } => Loudness::Quiet,
        Global { verbose: true, .. } => Loudness::Verbose,
        _ => Loudness::Normal,
    };
    let results = Results::new(&Disk, root);
    let summary = runner::run(
        &Run {
            name: &study.name,
            study: &study.resolved(),
            planner: &|finished| plan::next_jobs(study, finished),
            unit: &|name| study.unit(name).to_owned(),
            executor: &Solver {
                instruction_set,
                references: References::known(results.references()),
            },
            results: results.clone(),
            threads: threads(global)?,
            stop,
            rerun: again,
        },
        progress::reporter(loudness).as_mut(),
    )?;
    let answer = Answer::of(&Stored::read(results)?);
    print(&study.name, root, &summary, &answer, global.format(), out).map_err(output_error)?;
    if !global.quiet {
        notes::print(study);
    }
    // A signal that came when all was done has ended nothing.
    let open = summary.counts.of(Status::Pending) > 0;
    match (summary.signal.filter(|_| open), summary.counts.failed()) {
        (Some(signal), _) => Err(Error::Signal(signal)),
        (None, _) if !summary.different.is_empty() => Err(Error::JobsFailed(format!(
            "{} gave other bits than before: {}\n  next: billow show JOB; same program, same \
             physics version?",
            count(summary.different.len(), "job"),
            summary.different.iter().map(JobId::short).collect::<Vec<_>>().join(", ")
        ))),
        (None, 0) => Ok(()),
        (None, failed) => Err(Error::JobsFailed(format!(
            "{} failed\n  next: billow table {} --columns job,status,reason,stop_time,\
             stop_location",
            count(failed, "job"),
            root.display()
        ))),
    }
}

/// Where the results of a study lie.
pub fn results_folder(global: &Global, study: &Study) -> PathBuf {
    global.results.clone().unwrap_or_else(|| Path::new("results").join(&study.name))
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
    answer: &Answer,
    format: Format,
    out: &mut dyn Write,
) -> io::Result<()> {
    let counts = &summary.counts;
    if format == Format::Json {
        let mut json = serde_json::json!({
            "study": name,
            "results": root.display().to_string(),
            "ran": summary.ran,
            "failed": counts.failed(),
            "status": counts.status,
            "verdict": counts.verdict,
            "same_bits": summary.same,
            "other_bits": summary.different.iter().map(JobId::as_str).collect::<Vec<_>>(),
        });
        if let (Some(all), serde_json::Value::Object(more)) =
            (json.as_object_mut(), super::answer::json(answer))
        {
            all.extend(more);
        }
        return writeln!(out, "{json}");
    }
    if summary.ran == 0 && counts.of(Status::Pending) == 0 {
        writeln!(out, "{name}: nothing to run, all {} jobs are finished", counts.jobs())?;
    } else {
        let (ran, points) = (count(summary.ran, "job"), count(counts.rows(), "point"));
        writeln!(out, "{name}: {ran} run, {points}")?;
    }
    writeln!(out, "  status   {}", listed(&counts.status))?;
    if !counts.verdict.is_empty() {
        writeln!(out, "  verdict  {}", listed(&counts.verdict))?;
    }
    if summary.same > 0 {
        writeln!(out, "  bits     {} the same as before", count(summary.same, "job"))?;
    }
    writeln!(out, "  results  {}", root.display())?;
    super::answer::print(answer, out)?;
    super::answer::print_next(answer, root, out)
}

/// Counts in words, as in "4 done, 1 infeasible".
pub(super) fn listed(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<String> = counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
    parts.join(", ")
}
