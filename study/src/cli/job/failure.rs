//! Why a job has no result, and what to do about it.

use crate::platform::quote;
use billow_solver::output::outcome::FailureKind;

use super::Inspected;
use crate::input::value::brief_number;
use crate::job::Status;
use crate::job::row::ColumnId;
use crate::job::suggestions::is_without_motion;
use crate::print::TopicLine;

/// Lines of a failed or infeasible job, and the next step.
pub(super) fn explanation(job: &Inspected) -> (Vec<TopicLine>, String) {
    let cells = &job.cells;
    let (meaning, next) = meaning_and_next(job);
    let mut lines = vec![("status", format!("{}: {meaning}", cells.status()))];
    if let Some(time) = cells.number(ColumnId::StopTime) {
        lines.push(("time", format!("{} s", brief_number(time))));
    }
    let each = " (each for a change of that key only)";
    for (topic, column, scope) in [
        ("location", ColumnId::StopLocation, ""),
        ("audit", ColumnId::StopAudit, ""),
        ("reason", ColumnId::Reason, ""),
        ("nearest", ColumnId::Nearest, each),
    ] {
        if !cells.text(column).is_empty() {
            lines.push((topic, format!("{}{scope}", cells.text(column))));
        }
    }
    if let Some(energy) = cells.number(ColumnId::PeakKineticEnergy).map(brief_number)
        && is_without_motion(cells)
    {
        let text = format!(
            "the film hardly moved (peak kinetic energy {energy} J): the strain energy of the folded mesh is as \
             large, so the energy balance has no meaning"
        );
        lines.push(("energy", text));
    }
    (lines, next)
}

/// What a status means, and what to do about it.
fn meaning_and_next(job: &Inspected) -> (&'static str, String) {
    let (id, root) = (job.id.short(), quote::path(job.stored.results.root()));
    let history = format!("billow job {id} {root} --history");
    let again = format!("billow run {root} --again {id}");
    let has_history = !job.cells.text(ColumnId::ContentHash).is_empty();
    match job.cells.status() {
        Status::Infeasible => (
            "no fold pattern exists for this design; nothing was run",
            "use a nearest value, or exclude the point with a grid filter".to_owned(),
        ),
        Status::Invalid => (
            "the model refused the scene before the first step",
            "change the key that the reason names".to_owned(),
        ),
        Status::Panicked => (
            "an error in the program billow stopped the job",
            format!("report the reason with {root}/study.json and the job id"),
        ),
        Status::Failed(FailureKind::Unstable) => {
            ("the state became non-finite, or its energy grew without a source", history)
        }
        Status::Failed(FailureKind::Overstretched) => (
            "the film stretched beyond its material model (St. Venant-Kirchhoff, linear in Green strain)",
            history,
        ),
        Status::Failed(FailureKind::EnergyDrift) => {
            ("the energy ledger did not balance, so the run has no valid result", history)
        }
        Status::Failed(FailureKind::InvertedVolume) => {
            ("the enclosed volume became zero or negative", history)
        }
        Status::Failed(FailureKind::StepLimit) => (
            "the run used all steps that it may take (solver.step_limit, job_limits.steps), or no step could \
             advance it: see location",
            if has_history {
                format!("{history}: see how the time advanced")
            } else {
                format!("{again} --set job_limits.steps=…: the job resumes from its checkpoint")
            },
        ),
        Status::Failed(FailureKind::Interpenetrated) => {
            ("film passed through film, or intersects film", history)
        }
        Status::Failed(FailureKind::Inconsistent) => (
            "the state contradicted itself: an error in the program, or in the memory of the machine",
            format!("{again}: if it ends alike, report it with {root}/study.json and the job id"),
        ),
        Status::Timeout => (
            "the attempt reached its limit of wall time (job_limits.wall_time)",
            format!(
                "{again} --set job_limits.wall_time=…: the job resumes from its checkpoint, if it has one"
            ),
        ),
        Status::OutOfMemory => (
            "the job needs more memory than it may use",
            format!(
                "a coarser mesh (design.subdivisions), or {again} where there is more memory; with --set \
                 job_limits.memory=… if the reason names job_limits.memory"
            ),
        ),
        Status::Crashed => (
            "the process died in two attempts at this job; it runs again only on request",
            format!(
                "look for the cause in the messages of the system (memory, a signal of a batch system), then \
                 {again}"
            ),
        ),
        Status::Pending
        | Status::Done
        | Status::Cancelled
        | Status::Paused
        | Status::NoEquilibrium => ("the run stopped before its end time", history),
    }
}
