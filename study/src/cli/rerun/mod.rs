//! `billow rerun`: runs finished jobs again and checks that they give the same bits, or runs failed jobs again with
//! a remedy.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use super::Format;
use super::options::ResultsOption;
use super::print::{count, print_rows};
use super::run::{RunOptions, Scope, run_study};
use super::target::{StudyArgs, filtered, folder};
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::ColumnId;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::run::runner::Rerun;
use crate::store::stored::Stored;

mod remedy;

/// Arguments of `billow rerun`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Jobs, by the first digits of their ids; then the study file or the folder of its results
    /// [default: the only folder under results].
    #[arg(value_name = "JOB… [RESULTS]")]
    pub jobs: Vec<String>,
    /// Run the jobs of the rows for which this condition holds, as in `status == 'unstable'`,
    /// instead of ids.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Run the jobs with this status, as in --status timeout, instead of ids; can be repeated.
    #[arg(long, value_name = "STATUS")]
    pub status: Vec<String>,
    /// Run failed jobs with a remedy that leaves the physics alone (a smaller step, another integrator), one after
    /// another until one has a result; without jobs every failed one.
    #[arg(long)]
    pub remedy: bool,
    /// List the jobs; run nothing.
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    results: ResultsOption,
    #[command(flatten)]
    options: RunOptions,
}

/// Runs `billow rerun`. It invalidates the jobs in the journal and runs them and no others. Their old
/// histories stay until the new ones replace them.
///
/// # Errors
/// As [`super::run::run`]; unknown job ids; [`Error::JobsFailed`] when bits differ.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let (ids, study) = split(&args.jobs, args.results.results.is_some());
    let given = StudyArgs { study: study.map(PathBuf::from), results: args.results.clone() };
    let root = folder(&given, &[])?;
    let stored = super::stored::read(&root)?;
    let jobs = match (&args.condition, args.status.as_slice(), ids) {
        (Some(condition), [], []) => matching(&stored, condition)?,
        (None, [_, ..], []) => with_status(&stored, &args.status)?,
        (None, [], [_, ..]) => named(&stored, ids)?,
        (None, [], []) if args.remedy => remedy::failed(&stored),
        (None, [], []) => return Err(refused("", "no job is named")),
        (Some(_), [], _) => return Err(refused("", "jobs are named both by id and by --where")),
        (_, [_, ..], _) => {
            let problem = "jobs are named by --status and by ids or --where";
            return Err(refused("", problem));
        }
    };
    if args.remedy {
        return remedy::run(&stored, &root, &jobs, args, out);
    }
    if args.dry_run || jobs.is_empty() {
        return list(&stored, &jobs, &args.options, out);
    }
    if !args.options.progress.quiet {
        eprintln!("{} to run again", count(jobs.len(), "job"));
    }
    let again = Rerun { jobs: &jobs, remedy: false };
    run_study(&stored.study, &root, Some(again), Scope::default(), &args.options, out)
}

/// Job ids, and the results: a last argument that cannot be an id. A folder whose name could be an id is
/// written as ./ab.
fn split(arguments: &[String], has_results: bool) -> (&[String], Option<&str>) {
    match arguments.split_last() {
        Some((last, ids)) if !has_results && !is_prefix(last) => (ids, Some(last)),
        _ => (arguments, None),
    }
}

/// Whether a text can be the first digits of a job id.
fn is_prefix(text: &str) -> bool {
    (1..=32).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn refused(value: &str, problem: &str) -> Error {
    Error::invalid_option(
        "billow rerun",
        value,
        problem,
        "billow rerun JOB… [RESULTS], or billow rerun [RESULTS] with --where CONDITION, --status STATUS or --remedy",
        "billow rerun … --dry-run lists the jobs",
    )
}

fn named(stored: &Stored<'_>, ids: &[String]) -> Result<BTreeSet<JobId>> {
    let mut jobs = BTreeSet::new();
    for prefix in ids {
        let id = stored.job(prefix)?;
        match stored.point(&id) {
            None => {
                let problem = "this job is no longer in the study (study.json)";
                return Err(refused(prefix, problem));
            }
            Some(point) if point.infeasible.is_some() => {
                let problem = "this point is infeasible: it has no job to run";
                return Err(refused(prefix, problem));
            }
            Some(point) if point.job.id != id => {
                let problem = format!(
                    "the result of its point is not that of this job; it is that of {}",
                    point.job.id.short()
                );
                return Err(refused(prefix, &problem));
            }
            Some(_) => jobs.insert(id),
        };
    }
    Ok(jobs)
}

/// Jobs with one of these statuses.
fn with_status(stored: &Stored<'_>, names: &[String]) -> Result<BTreeSet<JobId>> {
    let mut statuses = Vec::new();
    for name in names {
        let known = Status::all().filter(|status| status.has_job());
        let found = Status::from_name(name.trim()).filter(|status| status.has_job());
        statuses.push(found.ok_or_else(|| {
            let allowed: Vec<&str> = known.map(Status::name).collect();
            let problem = "is not a status of jobs";
            let next = "billow status lists the statuses of a study";
            Error::invalid_option("--status", name, problem, allowed.join(", "), next)
        })?);
    }
    let points = stored.points.iter().filter(|point| point.infeasible.is_none());
    let chosen = points.filter(|point| statuses.contains(&stored.cells(point).status()));
    Ok(chosen.map(|point| point.job.id.clone()).collect())
}

/// Jobs of the rows for which a condition holds; infeasible points have no job.
fn matching(stored: &Stored<'_>, condition: &str) -> Result<BTreeSet<JobId>> {
    let table = stored.table();
    let rows = filtered(&table, Some(condition))?;
    let ids = table.column("job").map(|column| &column.cells);
    let chosen: BTreeSet<String> =
        rows.into_iter().filter_map(|row| Some(ids?[row].to_string())).collect();
    let points = stored.points.iter().filter(|point| chosen.contains(point.job.id.as_str()));
    let feasible = points.filter(|point| point.infeasible.is_none());
    Ok(feasible.map(|point| point.job.id.clone()).collect())
}

/// Prints jobs as rows, in plan order.
fn list(
    stored: &Stored<'_>,
    jobs: &BTreeSet<JobId>,
    options: &RunOptions,
    out: &mut dyn Write,
) -> Result<()> {
    let points: Vec<&Point> =
        stored.points.iter().filter(|point| jobs.contains(&point.job.id)).collect();
    let verdict = |point: &Point| vec![stored.cells(point).get(ColumnId::Verdict).clone()];
    let last = Last { columns: &["verdict"], cells: &verdict };
    print_points(stored, &points, &last, options.output.format(), out)?;
    if !options.progress.quiet {
        let finished = number_finished(stored, jobs);
        eprintln!("{} would run, {finished} of them finished", count(points.len(), "job"));
    }
    Ok(())
}

/// The last columns of a list of points.
struct Last<'a> {
    columns: &'a [&'a str],
    /// Their cells.
    cells: &'a dyn Fn(&Point) -> Vec<Value>,
}

/// Prints points as rows: job, parameters, status, and the last columns.
fn print_points(
    stored: &Stored<'_>,
    points: &[&Point],
    last: &Last<'_>,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let parameters = stored.study.run_parameter_names();
    let row = |point: &&Point| {
        let id = &point.job.id;
        let shown = if format == Format::Table { id.short() } else { id.as_str() };
        let mut row = vec![Value::Text(shown.to_owned())];
        row.extend(parameters.iter().map(|name| {
            let parameter = point.job.parameters.iter().find(|(known, _)| known == name);
            parameter.map_or(Value::Null, |(_, value)| value.clone())
        }));
        row.push(Value::Text(stored.cells(point).status().name().to_owned()));
        row.extend((last.cells)(point));
        row
    };
    let rows: Vec<Vec<Value>> = points.iter().map(row).collect();
    let last = std::iter::once("status").chain(last.columns.iter().copied()).map(str::to_owned);
    let columns: Vec<String> =
        std::iter::once("job".to_owned()).chain(parameters.iter().cloned()).chain(last).collect();
    print_rows(&columns, &rows, format, out)
}

fn number_finished(stored: &Stored<'_>, jobs: &BTreeSet<JobId>) -> usize {
    let chosen = stored.points.iter().filter(|point| jobs.contains(&point.job.id));
    chosen.filter(|point| stored.cells(point).status() != Status::Pending).count()
}
