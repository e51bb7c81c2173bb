//! `billow rerun --remedy`: runs failed jobs again with remedies.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use super::{Args, Last, print_points};
use crate::cli::print::count;
use crate::cli::remedies::{NONE, proposed};
use crate::cli::run::{Scope, run_study};
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::{Point, Remedied};
use crate::job::remedy::MAX_REMEDIES;
use crate::platform::error::{Error, Result};
use crate::run::runner::Rerun;
use crate::store::stored::Stored;

/// Every job that failed.
pub(super) fn failed(stored: &Stored<'_>) -> BTreeSet<JobId> {
    let points = stored.points.iter().filter(|point| has_failed(stored, point));
    points.map(|point| point.job.id.clone()).collect()
}

fn has_failed(stored: &Stored<'_>, point: &Point) -> bool {
    stored.cells(point).status().is_failure()
}

/// Runs the failed ones of these jobs with remedies, or lists what would run.
pub(super) fn run(
    stored: &Stored<'_>,
    root: &Path,
    jobs: &BTreeSet<JobId>,
    args: &Args,
    out: &mut dyn Write,
) -> Result<()> {
    let options = &args.options;
    let chosen = stored.points.iter().filter(|point| jobs.contains(&point.job.id));
    let failed: Vec<&Point> = chosen.filter(|point| has_failed(stored, point)).collect();
    let with_remedy = failed.iter().filter(|point| stored.remedy(point).is_some());
    let with_remedy: BTreeSet<JobId> = with_remedy.map(|point| point.job.id.clone()).collect();
    if args.dry_run {
        let cells = |point: &Point| match stored.remedy(point) {
            Some(attempt) => {
                vec![Value::Text(attempt.text), Value::Text(attempt.reason.to_owned())]
            }
            None => vec![Value::Null, Value::Text(without_remedy(stored, point))],
        };
        let last = Last { columns: &["remedy", "reason"], cells: &cells };
        print_points(stored, &failed, &last, options.output.format(), out)?;
    }
    if failed.is_empty() {
        if !options.progress.quiet {
            let of = if jobs.is_empty() { stored.points.len() } else { jobs.len() };
            eprintln!("nothing to do: no job has failed, of {}", count(of, "job"));
        }
        return Ok(());
    }
    if !options.progress.quiet {
        let will = if args.dry_run { "would" } else { "will" };
        if !with_remedy.is_empty() {
            let jobs = count(with_remedy.len(), "failed job");
            eprintln!("{jobs} {will} run with a remedy, at most {MAX_REMEDIES} one after another");
        }
        let others = failed.len() - with_remedy.len();
        if others > 0 && (args.dry_run || !with_remedy.is_empty()) {
            eprintln!("no remedy can be applied to {}", count(others, "failed job"));
        }
    }
    if args.dry_run {
        return Ok(());
    }
    if with_remedy.is_empty() {
        let root = root.display();
        return Err(Error::JobsFailed(format!(
            "no remedy can be applied to {}\n  next: billow rerun {root} --remedy --dry-run says why; billow job JOB {root}",
            count(failed.len(), "failed job")
        )));
    }
    let again = Rerun { jobs: &with_remedy, remedy: true };
    run_study(&stored.study, root, Some(again), Scope::default(), options, out)
}

/// Why no remedy can be applied to a failed point, and what is proposed instead.
fn without_remedy(stored: &Stored<'_>, point: &Point) -> String {
    let tried = point.remedied.as_ref().and_then(Remedied::failed);
    let tried = tried.map(|failed| format!("tried: {failed}"));
    let proposed = proposed(&stored.cells(point), point);
    let proposed = (!proposed.is_empty()).then(|| format!("proposed: {}", proposed.join("; or ")));
    let none = proposed.is_none().then(|| NONE.to_owned());
    let texts: Vec<String> = tried.into_iter().chain(proposed).chain(none).collect();
    texts.join("; ")
}
