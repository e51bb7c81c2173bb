//! `billow rerun`: runs jobs again that are finished, and says whether they give the same bits.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use super::print::count;
use super::print::print_rows;
use super::run::run_study;

use super::target::{filtered, folder};
use super::{Format, Global};
use crate::input::value::Value;
use crate::job::row::ColumnId;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::Disk;
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Arguments of `billow rerun`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Jobs, by the first digits of their ids; then the study file or the folder of its results
    /// [default: the only one under results].
    #[arg(value_name = "JOB… [RESULTS]")]
    pub jobs: Vec<String>,
    /// Jobs of the rows of which this holds, as in `status == 'unstable'`, in place of ids.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// List them, run nothing.
    #[arg(long)]
    pub dry_run: bool,
}

/// Runs `billow rerun`: the jobs are invalidated in the journal and run, and nothing else is. Their old
/// histories stay until the new ones replace them.
///
/// # Errors
/// As [`super::run::run`]; ids that are no jobs; [`Error::JobsFailed`] where bits differ.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let (ids, results) = split(&args.jobs, global.results.is_some());
    let root = folder(results.map(Path::new), global)?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let jobs = match (&args.condition, ids) {
        (Some(condition), []) => matching(&stored, condition)?,
        (None, [_, ..]) => named(&stored, ids)?,
        (condition, _) => {
            let problem = if condition.is_some() {
                "jobs are named both by id and by --where"
            } else {
                "no job is named"
            };
            return Err(refused("", problem));
        }
    };
    if args.dry_run || jobs.is_empty() {
        return list(&stored, &jobs, global, out);
    }
    if !global.quiet {
        eprintln!("{} to run again", count(jobs.len(), "job"));
    }
    run_study(&stored.study, &root, Some(&jobs), global, out)
}

/// Job ids, and where the results lie: a last argument that is no id. A folder whose name could be
/// one is named as ./ab.
fn split(arguments: &[String], has_results: bool) -> (&[String], Option<&str>) {
    match arguments.split_last() {
        Some((last, ids)) if !has_results && !is_prefix(last) => (ids, Some(last)),
        _ => (arguments, None),
    }
}

fn is_prefix(text: &str) -> bool {
    (1..=32).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn refused(value: &str, problem: &str) -> Error {
    InputError {
        file: "billow rerun".to_owned(),
        key: String::new(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed: "billow rerun JOB… [RESULTS], or billow rerun [RESULTS] --where CONDITION"
            .to_owned(),
        hint: "billow rerun … --dry-run lists what would run".to_owned(),
    }
    .into()
}

fn named(stored: &Stored<'_>, ids: &[String]) -> Result<BTreeSet<JobId>> {
    let mut jobs = BTreeSet::new();
    for prefix in ids {
        let id = stored.job(prefix)?;
        match stored.point(&id) {
            None => {
                let problem = "this job is not in the study as it is now (study.json)";
                return Err(refused(prefix, problem));
            }
            Some(point) if point.infeasible.is_some() => {
                let problem = "no fold pattern meets this point: it has no job to run";
                return Err(refused(prefix, problem));
            }
            Some(_) => jobs.insert(id),
        };
    }
    Ok(jobs)
}

/// Jobs of the rows a condition holds for; infeasible points have none.
fn matching(stored: &Stored<'_>, condition: &str) -> Result<BTreeSet<JobId>> {
    let rows = filtered(&stored.table(), Some(condition))?;
    let points = rows.into_iter().map(|row| &stored.points[row]);
    let feasible = points.filter(|point| point.infeasible.is_none());
    Ok(feasible.map(|point| point.job.id.clone()).collect())
}

/// Prints jobs as rows, in plan order.
fn list(
    stored: &Stored<'_>,
    jobs: &BTreeSet<JobId>,
    global: &Global,
    out: &mut dyn Write,
) -> Result<()> {
    let format = global.format();
    let parameters = stored.study.parameter_names();
    let points = stored.points.iter().filter(|point| jobs.contains(&point.job.id));
    let rows: Vec<Vec<Value>> = points
        .map(|point| {
            let id = &point.job.id;
            let shown = if format == Format::Table { id.short() } else { id.as_str() };
            let mut row = vec![Value::Text(shown.to_owned())];
            row.extend(parameters.iter().map(|name| {
                let own = point.job.parameters.iter().find(|(own, _)| own == name);
                own.map_or(Value::Null, |(_, value)| value.clone())
            }));
            let cells = stored.cells(point);
            row.push(Value::Text(cells.status().name().to_owned()));
            row.push(cells.get(ColumnId::Verdict).clone());
            row
        })
        .collect();
    let ends = ["status", "verdict"].map(str::to_owned);
    let columns: Vec<String> =
        ["job".to_owned()].into_iter().chain(parameters).chain(ends).collect();
    print_rows(&columns, &rows, format, out)?;
    if !global.quiet {
        let finished = points_finished(stored, jobs);
        eprintln!("{} would run, {finished} of them finished", count(rows.len(), "job"));
    }
    Ok(())
}

fn points_finished(stored: &Stored<'_>, jobs: &BTreeSet<JobId>) -> usize {
    let own = stored.points.iter().filter(|point| jobs.contains(&point.job.id));
    own.filter(|point| stored.cells(point).status() != Status::Pending).count()
}
