//! `billow run --again`: runs finished jobs again and checks that they give the same bits; with `--set`, tries them
//! with other settings beside the study.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{Args, run_study};
use crate::input::keys::{self, KEYS};
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::{Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::Disk;
use crate::print::{count, print_rows};
use crate::run::selection::Selection;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::{JOB_LIMITS, Study, plan};

/// What is shown of a job and of its run with other settings, before the measures of the limits.
const COMPARED: [ColumnId; 8] = [
    ColumnId::Status,
    ColumnId::Verdict,
    ColumnId::StopTime,
    ColumnId::LedgerResidual,
    ColumnId::T50ZRim,
    ColumnId::PeakVz,
    ColumnId::FinalVolume,
    ColumnId::Steps,
];

/// Runs the jobs that `--again` names, each by the first digits of its id or all of a status.
///
/// # Errors
/// As [`super::run`]; unknown jobs; [`Error::JobsFailed`] when bits differ.
pub(super) fn run(args: &Args, root: &Path, out: &mut dyn Write) -> Result<()> {
    let stored = crate::cli::results::read(root)?;
    let jobs = chosen(&stored, &args.again)?;
    // Limits of jobs change no job.
    let is_limit = |set: &String| {
        let key = set.split_once('=').and_then(|(name, _)| keys::find(name.trim()));
        key.is_some_and(|key| KEYS[key].path.starts_with(JOB_LIMITS))
    };
    if !args.set.set.iter().all(is_limit) {
        return run_changed(args, &stored, &jobs, out);
    }
    let limits = Study::load(&stored.results.study_path(), &args.set.set)?.job_limits();
    if !args.options.progress.quiet {
        eprintln!("{} to run again", count(jobs.len(), "job"));
    }
    run_study(stored.study, limits, root, Some(&jobs), Selection::All, &args.options, out)
}

/// The jobs with these ids or statuses.
fn chosen(stored: &Stored<'_>, names: &[String]) -> Result<BTreeSet<JobId>> {
    let mut jobs = BTreeSet::new();
    for name in names.iter().map(|name| name.trim()) {
        if let Some(status) = Status::from_name(name).filter(|status| status.has_job()) {
            let points = stored.points.iter().filter(|point| point.infeasible.is_none());
            let found = points.filter(|point| stored.cells(point).status() == status);
            jobs.extend(found.map(|point| point.job.id.clone()));
            continue;
        }
        let id = stored.job(name)?;
        match stored.point(&id) {
            None => return Err(refused(name, "this job is no longer in the study (study.json)")),
            Some(point) if point.infeasible.is_some() => {
                return Err(refused(name, "this point is infeasible: it has no job to run"));
            }
            Some(_) => jobs.insert(id),
        };
    }
    if jobs.is_empty() {
        return Err(refused(&names.join(","), "no job of the study has this status"));
    }
    Ok(jobs)
}

fn refused(value: &str, problem: &str) -> Error {
    let allowed = "the first digits of job ids, or a status as in --again timeout; comma-separated";
    Error::invalid_option(
        "--again",
        value,
        problem,
        allowed,
        "billow status; billow table --runs --columns job,status",
    )
}

/// Runs jobs with other settings. They are stored in a folder of their own beside the results, whose table stays.
fn run_changed(
    args: &Args,
    stored: &Stored<'_>,
    jobs: &BTreeSet<JobId>,
    out: &mut dyn Write,
) -> Result<()> {
    let chosen = stored.study.names_chosen();
    let mut changed = Vec::new();
    for id in jobs {
        let Some(point) = stored.point(id) else { continue };
        // Searched values, or the mesh of a pilot, are in no plan from the start, and samples are numbered in their order.
        let values = chosen.iter().filter_map(|name| Some((name, parameter(point, name)?)));
        let mut sets: Vec<String> = values.map(|(name, value)| format!("{name}={value}")).collect();
        if stored.study.is_pilot(point) {
            sets.push(format!("solver.meshes=[{}]", point.job.scene.design.subdivisions()));
        }
        sets.extend(args.set.set.iter().cloned());
        let study = Study::load(&stored.results.study_path(), &sets)?;
        let planned = plan::next_jobs(&study, &[]).map(|generation| generation.points);
        let planned = planned.unwrap_or_default();
        let found = planned.iter().find(|other| is_same_point(other, point));
        let found = found.filter(|other| other.infeasible.is_none()).ok_or_else(|| {
            let problem = format!("leaves the study without the point of job {}", id.short());
            let next = "change a key that the grid does not vary";
            Error::invalid_option("--set", &args.set.set.join(" "), problem, "", next)
        })?;
        let root = beside(stored.results.root());
        let only = BTreeSet::from([found.job.id.clone()]);
        let limits = study.job_limits();
        run_study(
            study,
            limits,
            &root,
            Some(&only),
            Selection::All,
            &args.options,
            &mut std::io::sink(),
        )
        .or_else(|error| if matches!(error, Error::JobsFailed(_)) { Ok(()) } else { Err(error) })?;
        let again = Stored::read(Results::new(&Disk, &root))?;
        changed.push((id, found.job.id.clone(), again.cells_of_job(&found.job.id)));
    }
    print(stored, &changed, args, out)?;
    if !args.options.progress.quiet {
        let root = beside(stored.results.root());
        eprintln!(
            "the table of the study is as it was; billow job JOB {} shows a changed run",
            root.display()
        );
    }
    Ok(())
}

/// The folder of changed runs: `results/STUDY-again`.
fn beside(root: &Path) -> PathBuf {
    let mut name = root.file_name().unwrap_or_default().to_owned();
    name.push("-again");
    root.with_file_name(name)
}

fn parameter<'a>(point: &'a Point, name: &str) -> Option<&'a Value> {
    point.job.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| value)
}

/// Whether a point of a changed study has the values of this one, in the parameters that both vary.
fn is_same_point(other: &Point, point: &Point) -> bool {
    other
        .job
        .parameters
        .iter()
        .all(|(name, value)| parameter(point, name).is_none_or(|known| known == value))
}

/// Prints each job and its changed run.
fn print(
    stored: &Stored<'_>,
    changed: &[(&JobId, JobId, Cells)],
    args: &Args,
    out: &mut dyn Write,
) -> Result<()> {
    let mut compared = COMPARED.to_vec();
    for limit in stored.study.result_limits() {
        if !compared.contains(&limit.measure) {
            compared.push(limit.measure);
        }
    }
    let mut columns = vec!["job".to_owned(), "set".to_owned()];
    columns.extend(compared.iter().map(|column| column.name().to_owned()));
    let row = |id: &JobId, set: Value, cells: &Cells| {
        let mut row = vec![Value::Text(id.short().to_owned()), set];
        row.extend(compared.iter().map(|column| match column {
            ColumnId::Status => Value::Text(cells.status().name().to_owned()),
            column => cells.get(*column).clone(),
        }));
        row
    };
    let mut rows = Vec::new();
    for (id, other, cells) in changed {
        rows.push(row(id, Value::Null, &stored.cells_of_job(id)));
        rows.push(row(other, Value::Text(args.set.set.join(" ")), cells));
    }
    print_rows(&columns, &rows, args.options.output.format(), out)
}
