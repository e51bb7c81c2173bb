//! `billow submit`: gives the unfinished jobs of a study to a cluster.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::options::{OutputOptions, ResultsOption, SetOption};
use super::{Format, output_error, results};
use crate::cluster::script::{Needs, Scripts};
use crate::cluster::slurm;
use crate::cluster::submission::{self, Queued};
use crate::input::units::{self, Dimension};
use crate::job::Job;
use crate::job::cost::Costs;
use crate::job::memory::estimate;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, disk_error};
use crate::print::{count, duration};
use crate::run::merge;
use crate::store::results::Results;
use crate::store::stored;
use crate::study::Study;

/// Memory of a task beside its jobs, bytes. Chosen: the program with the plan of a large study.
const PROGRAM_MEMORY: u64 = 500_000_000;

/// Time of a task by the estimate, s. Chosen: long against the start of a task, short against the wait for the last one.
const TASK_SECONDS: f64 = 600.0;
/// Estimated time over the wall time of a task, at most. Chosen: estimates and machines differ by a factor of two.
const MAX_ESTIMATE_RATIO: f64 = 0.4;

/// Arguments of `billow submit`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or a results folder.
    study: PathBuf,
    /// Wall time of a task, as in --time "2 h". A task stops before its end; what it has not finished is in the next submission.
    #[arg(long, value_name = "TIME", default_value = "1 h")]
    time: String,
    /// Cores of a task, and number of jobs that run side by side in it.
    #[arg(long, value_name = "N", default_value_t = 1)]
    cpus: usize,
    /// Memory of a task, as in --mem "4 GB" [default: the estimate of its largest jobs].
    #[arg(long, value_name = "MEMORY")]
    mem: Option<String>,
    /// Number of tasks [default: tasks of about ten minutes].
    #[arg(long, value_name = "N")]
    tasks: Option<usize>,
    /// Give this option to sbatch too, as in --sbatch=--partition=short; can be repeated.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// Print the scripts; write and submit nothing.
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    results: ResultsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
}

/// What is submitted.
struct Tasks {
    number: usize,
    needs: Needs,
    jobs: usize,
    /// Estimated time on one core, s.
    seconds: f64,
}

/// Runs `billow submit`. Jobs that have ended are left out, so the same command submits what is missing.
///
/// # Errors
/// An invalid study; a folder in which runs work, or whose last submission is still in the queue; what Slurm refuses.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let (study, root) = results::study_of(&args.study, &args.set, &args.results)?;
    let root = std::path::absolute(&root).map_err(|error| disk_error(&root, &error))?;
    let results = Results::new(&Disk, &root);
    if !args.dry_run {
        refuse_queued(&results)?;
    }
    let missing = missing(&study, &results)?;
    let tasks = tasks(args, &missing)?;
    let program =
        std::env::current_exe().map_err(|error| disk_error(Path::new("billow"), &error))?;
    let (number, needs) = (tasks.number, &tasks.needs);
    let scripts = Scripts { program, root: root.clone(), study: &study.name, tasks: number, needs };
    let (array, merge) = (scripts.array(), scripts.merge());
    if args.dry_run || missing.is_empty() {
        let texts = (!missing.is_empty()).then_some([array.as_str(), merge.as_str()]);
        return print_scripts(&tasks, &study.name, texts, args.output.format(), out);
    }
    merge::prepare(&results, (&study.name, study.file()))?;
    let array = submission::write(&results, "array.sh", &array)?;
    let merge = submission::write(&results, "merge.sh", &merge)?;
    let queued = slurm::submit(&array, &merge)?;
    submission::write_queued(&results, &queued)?;
    print(&tasks, &study.name, &results, &queued, args.output.format(), out)
}

/// Refuses a submission while the last one is in the queue.
fn refuse_queued(results: &Results<'_>) -> Result<()> {
    let Some(queued) = submission::last_queued(results)? else { return Ok(()) };
    let tasks: usize = match slurm::queue(&queued) {
        Ok(states) => states.values().sum(),
        Err(problem) => {
            eprintln!("note: squeue does not say whether the last submission has ended: {problem}");
            0
        }
    };
    if tasks == 0 {
        return Ok(());
    }
    Err(Error::Disk {
        path: results.submission_path(),
        problem: format!(
            "{} of the last submission are still in the queue\n  next: billow status {}; or scancel {} {}, then submit again",
            count(tasks, "task"),
            results.root().display(),
            queued.array,
            queued.merge
        ),
    })
}

/// The jobs that have not ended, in plan order.
fn missing(study: &Study, results: &Results<'_>) -> Result<Vec<Job>> {
    let journal = results.journal()?;
    let mut jobs = Vec::new();
    for point in stored::planned(study, &journal).iter() {
        let id = &point.job.id;
        let record = journal.records.get(id);
        let is_missing = match record {
            Some(record) => results.damage(record)?.is_some(),
            None => true,
        };
        if point.infeasible.is_none() && is_missing {
            jobs.push(point.job.clone());
        }
    }
    Ok(jobs)
}

/// Number and needs of the tasks for these jobs.
fn tasks(args: &Args, missing: &[Job]) -> Result<Tasks> {
    let wall_time = quantity("--time", &args.time, Dimension::Time)?;
    let positive = |option: &str, number: usize| match number {
        0 => Err(Error::invalid_option(option, "0", "is too few", "1 or more", "")),
        number => Ok(number),
    };
    let cores = positive("--cpus", args.cpus)?;
    let mut costs = Costs::default();
    let mut memory: BTreeMap<u64, usize> = BTreeMap::new();
    let mut seconds = 0.0;
    for job in missing {
        *memory.entry(estimate(&job.scene).total).or_default() += 1;
        seconds += costs.seconds(&job.scene);
    }
    let most = slurm::max_tasks();
    let number = match args.tasks {
        None => wanted_tasks(seconds, cores, wall_time)
            .min(missing.len().div_ceil(cores))
            .min(most)
            .max(1),
        Some(number) if positive("--tasks", number)? <= most => number.min(missing.len().max(1)),
        Some(number) => {
            let allowed = format!("1 to {most}: MaxArraySize of the cluster less one");
            let value = number.to_string();
            return Err(Error::invalid_option("--tasks", &value, "is too many", allowed, ""));
        }
    };
    let memory = match &args.mem {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and saturates"
        )]
        Some(text) => quantity("--mem", text, Dimension::Memory)? as u64,
        None => PROGRAM_MEMORY + largest(&memory, cores),
    };
    let needs = Needs { wall_time, cores, memory, options: args.sbatch.clone() };
    let number = if missing.is_empty() { 0 } else { number };
    Ok(Tasks { number, needs, jobs: missing.len(), seconds })
}

/// Number of tasks for jobs that take this time (s in all, on one core), on this number of cores each with this wall
/// time (s).
fn wanted_tasks(seconds: f64, cores: usize, wall_time: f64) -> usize {
    let each = TASK_SECONDS.min(MAX_ESTIMATE_RATIO * wall_time) * cores as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at least 1, and saturates"
    )]
    let wanted = libm::ceil(seconds / each).max(1.0) as usize;
    wanted
}

/// Memory of this number of jobs side by side at most, bytes: of the jobs with these sizes.
fn largest(sizes: &BTreeMap<u64, usize>, cores: usize) -> u64 {
    let all = sizes.iter().rev().flat_map(|(size, number)| std::iter::repeat_n(*size, *number));
    all.take(cores).sum()
}

/// A quantity of the command line, in SI, above zero.
fn quantity(option: &str, text: &str, dimension: Dimension) -> Result<f64> {
    let read = units::parse(text, dimension).ok();
    read.filter(|value| *value > 0.0 && value.is_finite()).ok_or_else(|| {
        let example = if dimension == Dimension::Time { "2 h" } else { "4 GB" };
        let name = dimension.name();
        let allowed = format!("{name} above zero with its unit, as in {option} \"{example}\"");
        Error::invalid_option(option, text, "is no such quantity", allowed, "")
    })
}

impl Tasks {
    fn summary(&self, study: &str) -> String {
        if self.jobs == 0 {
            return format!("{study}: nothing to submit, all jobs are finished");
        }
        format!(
            "{study}: {} in {}, about {} on one core",
            count(self.jobs, "job"),
            count(self.number, "task"),
            duration(libm::ceil(self.seconds))
        )
    }

    fn json(&self, study: &str, more: &[(&str, serde_json::Value)]) -> serde_json::Value {
        let mut json = serde_json::json!({
            "study": study,
            "jobs": self.jobs,
            "tasks": self.number,
            "estimated_seconds": self.seconds,
        });
        for (name, value) in more {
            json[*name] = value.clone();
        }
        json
    }
}

/// Prints what a submission would write; `None` where nothing is to be submitted.
fn print_scripts(
    tasks: &Tasks,
    study: &str,
    scripts: Option<[&str; 2]>,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    if format == Format::Json {
        let [array, merge] = scripts.map_or([None; 2], |scripts| scripts.map(Some));
        let json =
            tasks.json(study, &[("array_script", array.into()), ("merge_script", merge.into())]);
        return writeln!(out, "{json}").map_err(output_error);
    }
    if let Some([array, merge]) = scripts {
        write!(
            out,
            "# array.sh\n{array}\n# merge.sh\n{merge}\n# billow submit gives them to Slurm, after it has \
             written study.json:\n#   sbatch --parsable array.sh\n#   sbatch --parsable --dependency=afterany:NUMBER merge.sh\n"
        )
        .map_err(output_error)?;
    }
    eprintln!("{}", tasks.summary(study));
    Ok(())
}

fn print(
    tasks: &Tasks,
    study: &str,
    results: &Results<'_>,
    queued: &Queued,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let folder = results.submission_path();
    let folder = folder.display().to_string();
    let Queued { array, merge } = queued;
    let text = match format {
        Format::Json => {
            let more = [
                ("folder", folder.into()),
                ("array", array.as_str().into()),
                ("merge", merge.as_str().into()),
            ];
            tasks.json(study, &more).to_string()
        }
        _ => format!(
            "{}\n  slurm    array {array}, then {merge} writes the table\n  folder   {folder}\n  next     billow status",
            tasks.summary(study)
        ),
    };
    writeln!(out, "{text}").map_err(output_error)
}
