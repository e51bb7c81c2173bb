//! `billow run`: runs the jobs of a study that are not finished.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::memory::Memory;
use super::options::{
    OutputOptions, ProgressOptions, ResultsOption, SetOption, ThreadsOption, UnitsOption,
};
use super::{Format, changes, memory, output_error, report, results};
use crate::analysis::answer::Answer;
use crate::job::executor::Solver;
use crate::job::limits::JobLimits;
use crate::job::references::References;
use crate::job::row::COLUMNS;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, disk_error};
use crate::platform::quote;
use crate::platform::stop::Stop;
use crate::print::notes;
use crate::print::{count, points_of_runs};
use crate::report::DEFAULT_SIZE;
use crate::run::progress;
use crate::run::runner::{self, CHECKPOINT_INTERVAL, Run, RunResult, Summary};
use crate::run::selection::{Part, Selection};
use crate::store::journal::Journal;
use crate::store::results::Results;
use crate::store::stored::{Stored, other_physics};
use crate::store::table::Table;
use crate::study::Study;
use crate::study::plan;

mod again;
mod failures;

use failures::result;

/// Arguments of `billow run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or a results folder.
    pub study: PathBuf,
    #[command(flatten)]
    results: ResultsOption,
    #[command(flatten)]
    set: SetOption,
    /// Run these jobs again, also finished ones, and check that they give the same bits: the first digits of their ids, or
    /// a status as in --again timeout; comma-separated. With --set they run with other settings, beside the study.
    #[arg(long, value_name = "JOBS", value_delimiter = ',')]
    again: Vec<String>,
    /// Run a part of the jobs, as in --points 2/8: the second of eight parts. `billow merge` joins the folders of the parts.
    #[arg(long, value_name = "K/N")]
    points: Option<String>,
    #[command(flatten)]
    options: RunOptions,
}

/// Options of the commands that run jobs.
#[derive(Debug, Default, clap::Args)]
pub(super) struct RunOptions {
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    pub(super) output: OutputOptions,
    #[command(flatten)]
    pub(super) progress: ProgressOptions,
    /// Write no report.html at the end.
    #[arg(long)]
    no_report: bool,
}

/// Runs `billow run`. Finished jobs are kept; the others run. After a stop at any moment the same
/// command resumes. A study whose grid has changed keeps the jobs that are still in its plan.
///
/// # Errors
/// An invalid study, a disk error, jobs that failed, a signal.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let (study, root) = results::study_of(&args.study, &args.set, &args.results)?;
    if !args.again.is_empty() {
        return again::run(args, &root, out);
    }
    if !args.options.progress.quiet {
        notes::print_warnings(&study);
        let results = Results::new(&Disk, &root);
        changes::note_before_run(&results, &study)?;
        changes::note_elsewhere(&results, &study);
        let points = plan::next_jobs(&study, &[]).map(|plan| plan.points).unwrap_or_default();
        let versions = other_physics(&points, &results.journal()?.records);
        if let Some(note) = changes::other_physics(&versions) {
            eprintln!("note: {note}");
        }
    }
    let limits = study.job_limits();
    run_study(study, limits, &root, None, selection(args.points.as_deref())?, &args.options, out)
}

/// The jobs that the run takes.
fn selection(points: Option<&str>) -> Result<Selection> {
    let Some(text) = points else { return Ok(Selection::All) };
    let part = Part::parse(text).ok_or_else(|| {
        let allowed = "K/N: part K of N, from 1/N to N/N, as in --points 2/8";
        let next = "run every part in a folder of its own (--results), then billow merge FOLDER… --results FOLDER";
        Error::invalid_option("--points", text, "is no part", allowed, next)
    })?;
    Ok(Selection::Part(part))
}

/// Runs the unfinished jobs of a study, or those to run `again`, and prints the result.
///
/// # Errors
/// As [`run`], and jobs that gave different bits than before.
pub(super) fn run_study(
    study: Study,
    limits: JobLimits,
    root: &Path,
    again: Option<&BTreeSet<JobId>>,
    selection: Selection,
    options: &RunOptions,
    out: &mut dyn Write,
) -> Result<()> {
    let units = options.units.apply(study.display_units(), &|name| {
        let is_parameter = study.parameter_names().iter().any(|parameter| parameter == name);
        let column = COLUMNS.iter().find(|column| column.name == name);
        let unit = is_parameter.then(|| study.unit(name));
        unit.or(column.map(|column| column.unit)).map(str::to_owned)
    })?;
    let instruction_set = super::instruction_set::selected()?;
    // Only a search with a prior computes while it plans.
    let pool = (study.points_of_prior() > 0).then(|| options.threads.pool()).transpose()?;
    let (threads, note) = memory::threads(options.threads.count()?);
    let memory = Memory::new(threads);
    memory.check()?;
    if !options.progress.quiet {
        // Before the run: a reader may want to change the study.
        notes::print(&study);
        note.into_iter().chain(memory.note(&study)).for_each(|note| eprintln!("{note}"));
    }
    let stop = Stop::on_signals().map_err(|error| disk_error(Path::new("signals"), &error))?;
    let results = Results::new(&Disk, root);
    let RunResult { summary, points, records } = runner::run(
        &Run {
            name: &study.name,
            study: study.file(),
            planner: &|finished| {
                let plan = || plan::next_jobs(&study, finished);
                let next = pool.as_ref().map_or_else(plan, |pool| pool.install(plan));
                if !study.minimised().is_empty() {
                    results.keep_proposed();
                }
                next
            },
            judging: study.judging(),
            table: &|points, records| Table::of_study(&study, points, records),
            label: &|parameters| study.label(parameters, &units),
            executor: &Solver { instruction_set, references: References::default() },
            results: results.clone(),
            threads,
            limits,
            checkpoint_interval: CHECKPOINT_INTERVAL,
            stop,
            rerun: again,
            selection,
            known: results.known()?,
        },
        progress::reporter(options.progress.loudness(), threads).as_mut(),
    )?;
    // A signal after the last job has stopped nothing.
    let open = summary.counts.of(Status::Pending) > 0;
    if let Some(signal) = summary.signal.filter(|_| open) {
        // The program ends soon after a signal, whatever the size of the study.
        return Err(Error::Signal(signal));
    }
    let journal = Journal { records, ..Journal::default() };
    let stored = Stored { results, study, units, journal, points };
    let table = stored.table();
    let answer = Answer::of(&stored, &table);
    let (study, points) = (&stored.study, stored.planned_runs());
    let pilots = stored.pilot_runs();
    let ended = Ended { study, root, summary: &summary, points, pilots };
    // A part of a study has no answer.
    let is_whole = stored.results.whole().is_none();
    let report = (!options.no_report && is_whole && summary.counts.jobs() > 0)
        .then(|| stored.results.report_path());
    ended.print(&answer, options.output.format(), out).map_err(output_error)?;
    if let Some(path) = &report {
        // The reader has the answer while the page is made, and also where it cannot be written.
        out.flush().map_err(output_error)?;
        match report::write((&stored, &table, &answer), DEFAULT_SIZE, false, path) {
            Ok(notes) => {
                for note in notes.iter().filter(|_| !options.progress.quiet) {
                    eprintln!("note: report: {note}");
                }
                if options.output.format() == Format::Table {
                    writeln!(out, "  report   {}", path.display()).map_err(output_error)?;
                }
            }
            Err(error) => {
                eprintln!("note: no report: {error}\n  next: billow report {}", quote::path(root));
            }
        }
    }
    result(study, &summary, &limits, root)
}

/// A run that ended.
struct Ended<'a> {
    study: &'a Study,
    root: &'a Path,
    summary: &'a Summary,
    /// Number of points planned so far.
    points: usize,
    /// Number of runs of pilots among them.
    pilots: usize,
}

impl Ended<'_> {
    fn print(&self, answer: &Answer, format: Format, out: &mut dyn Write) -> io::Result<()> {
        let Self { study, root, summary, .. } = self;
        let (name, counts) = (&study.name, &summary.counts);
        let points = points_of_runs(study, self.points, self.pilots);
        if format == Format::Json {
            let mut json = serde_json::json!({
                "study": name,
                "results": root.display().to_string(),
                "points": self.points,
                "ran": summary.ran,
                "failed": counts.failed(),
                "status": counts.status,
                "verdict": counts.verdict,
                "same_bits": summary.same,
                "other_bits": summary.different.iter().map(JobId::as_str).collect::<Vec<_>>(),
            });
            if let (Some(keys), serde_json::Value::Object(more)) =
                (json.as_object_mut(), crate::print::answer::json(answer))
            {
                keys.extend(more);
            }
            return writeln!(out, "{json}");
        }
        if counts.jobs() == 0 {
            writeln!(out, "{name}: nothing to run, no fold pattern fits any of {points}")?;
            let root = quote::path(root);
            writeln!(out, "  next     billow table {root} --columns job,reason,nearest")?;
        } else if summary.ran == 0 && counts.of(Status::Pending) == 0 {
            writeln!(out, "{name}: nothing to run, all {} jobs are finished", counts.jobs())?;
        } else {
            writeln!(out, "{name}: {} run, {points}", count(summary.ran, "job"))?;
        }
        writeln!(out, "  status   {}", listed(&counts.status))?;
        if !counts.verdict.is_empty() {
            writeln!(out, "  verdict  {}", listed(&counts.verdict))?;
        }
        if summary.not_selected > 0 {
            let jobs = count(summary.not_selected, "unfinished job");
            writeln!(
                out,
                "  parts    {jobs} in other parts (--points); billow merge joins their folders"
            )?;
        }
        if summary.same > 0 {
            writeln!(out, "  bits     {} the same as before", count(summary.same, "job"))?;
        }
        writeln!(out, "  results  {}", root.display())?;
        crate::print::answer::print(answer, out)?;
        crate::print::answer::print_next(answer, root, out)
    }
}

/// Counts as text: "4 done, 1 infeasible".
pub(super) fn listed(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<String> = counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
    parts.join(", ")
}
