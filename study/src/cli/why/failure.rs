//! Why a job has no result, and what to do about it.

use billow_solver::output::outcome::FailureKind;

use super::Line;
use crate::input::value::brief_number;
use crate::job::Status;
use crate::job::remedy::Failure;
use crate::job::row::{Cells, ColumnId};

/// Lines of a failed or infeasible job, and the next step.
pub(super) fn explanation(
    cells: &Cells,
    status: Status,
    short_id: &str,
    root: &str,
) -> (Vec<Line>, String) {
    let mut lines = vec![("status", format!("{}: {}", status.name(), meaning(status)))];
    if let Some(time) = cells.number(ColumnId::StopTime) {
        lines.push(("time", format!("{} s", brief_number(time))));
    }
    for (topic, column) in [
        ("location", ColumnId::StopLocation),
        ("audit", ColumnId::StopAudit),
        ("reason", ColumnId::Reason),
        ("nearest", ColumnId::Nearest),
    ] {
        if !cells.text(column).is_empty() {
            let scope = if column == ColumnId::Nearest {
                " (each for a change of that key only)"
            } else {
                ""
            };
            lines.push((topic, format!("{}{scope}", cells.text(column))));
        }
    }
    if let Some(energy) = cells.number(ColumnId::PeakKineticEnergy)
        && Failure::of(cells).is_without_motion()
    {
        let text = format!(
            "the film hardly moved (peak kinetic energy {} J): the strain energy of the folded mesh is \
             as large, so the energy balance has no meaning",
            brief_number(energy)
        );
        lines.push(("energy", text));
    }
    let has_history = !cells.text(ColumnId::ContentHash).is_empty();
    (lines, next_step(status, has_history, short_id, root))
}

/// What a status means.
fn meaning(status: Status) -> &'static str {
    match status {
        Status::Infeasible => "no fold pattern exists for this design; nothing was run",
        Status::Invalid => "the model refused the scene before the first step",
        Status::Panicked => "an error in the program billow stopped the job",
        Status::Failed(FailureKind::Unstable) => {
            "the state became non-finite, or its energy grew without a source"
        }
        Status::Failed(FailureKind::Overstretched) => {
            "the film stretched beyond its material model (St. Venant-Kirchhoff, linear in Green strain)"
        }
        Status::Failed(FailureKind::EnergyDrift) => {
            "the energy ledger did not balance, so the run has no valid result"
        }
        Status::Failed(FailureKind::InvertedVolume) => {
            "the enclosed volume became zero or negative"
        }
        Status::Failed(FailureKind::StepLimit) => {
            "the run used all steps that it may take (solver.step_limit, job_limits.steps), or no step could advance it: see location"
        }
        Status::Failed(FailureKind::Interpenetrated) => {
            "film passed through film, or intersects film"
        }
        Status::Failed(FailureKind::Inconsistent) => {
            "the state contradicted itself: an error in the program, or in the memory of the machine"
        }
        Status::Timeout => "the attempt reached its limit of wall time (job_limits.wall_time)",
        Status::OutOfMemory => "the job needs more memory than it may use",
        Status::Crashed => {
            "the process died in two attempts at this job; it runs again only on request"
        }
        Status::Pending
        | Status::Done
        | Status::Cancelled
        | Status::Paused
        | Status::NoEquilibrium => "the run stopped before its end time",
    }
}

/// What to do about a failure.
fn next_step(status: Status, has_history: bool, short_id: &str, root: &str) -> String {
    let show = format!("billow show {short_id} {root} --history");
    match status {
        Status::Infeasible => {
            "use a nearest value, or exclude the point with a grid filter".to_owned()
        }
        Status::Invalid => "change the key that the reason names".to_owned(),
        Status::Panicked => format!("report the reason with {root}/study.json and the job id"),
        Status::Failed(FailureKind::StepLimit) => {
            if has_history {
                format!("{show}: see how the time advanced")
            } else {
                let rerun = format!("billow rerun {short_id} {root} --job-limit steps=…");
                format!("{rerun}: the job resumes from its checkpoint")
            }
        }
        Status::Failed(FailureKind::Inconsistent) => format!(
            "billow rerun {short_id} {root}: if it ends alike, report it with {root}/study.json and the job id"
        ),
        Status::Timeout => format!(
            "billow rerun {short_id} {root} --job-limit wall_time=…: the job resumes from its checkpoint, if \
             it has one"
        ),
        Status::OutOfMemory => format!(
            "a coarser mesh (design.subdivisions), or billow rerun {short_id} {root} where there is more memory; \
             with --job-limit memory=… if the reason names job_limits.memory"
        ),
        Status::Crashed => format!(
            "look for the cause in the messages of the system (memory, a signal of a batch system), then \
             billow rerun {short_id} {root}"
        ),
        _ => show,
    }
}
