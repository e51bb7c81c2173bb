//! Why a job has no result, and what to do about it.

use billow_solver::output::outcome::FailureKind;

use super::{Line, STOP_LOCATION, STOP_TIME, number};
use crate::input::value::brief_number;
use crate::job::row::{self, Cells};

/// Peak kinetic energy below which nothing deployed, J. Chosen: a thousandth of the slowest run of the
/// paper.
const MIN_DEPLOYMENT_ENERGY: f64 = 5e-3;

/// The kind of failure with this status; `None` for other statuses.
fn kind(status: &str) -> Option<FailureKind> {
    FailureKind::ALL.into_iter().find(|kind| kind.name() == status)
}

/// Lines of a failed or infeasible job, and the next step.
pub(super) fn explanation(
    cells: &Cells,
    status: &str,
    short_id: &str,
    root: &str,
) -> (Vec<Line>, String) {
    let mut lines = vec![("status", format!("{status}: {}", meaning(status)))];
    if let Some(time) = number(cells, STOP_TIME) {
        lines.push(("time", format!("{} s", brief_number(time))));
    }
    for (topic, name) in [("location", STOP_LOCATION), ("reason", "reason"), ("nearest", "nearest")]
    {
        if !cells.text(name).is_empty() {
            let scope =
                if name == "nearest" { " (each for a change of that key only)" } else { "" };
            lines.push((topic, format!("{}{scope}", cells.text(name))));
        }
    }
    let energy = number(cells, "peak_kinetic_energy").unwrap_or(f64::INFINITY);
    if kind(status) == Some(FailureKind::EnergyDrift) && energy < MIN_DEPLOYMENT_ENERGY {
        let text = format!(
            "the film hardly moved (peak kinetic energy {} J): the strain energy of the folded mesh is \
             as large, so the energy balance has no meaning",
            brief_number(energy)
        );
        lines.push(("energy", text));
        let next = "check that gas flows in before solver.end_time: gas.mass_flow_rate and the inflow \
                    windows of the strategy; their times count from the start of the run";
        return (lines, next.to_owned());
    }
    (lines, next_step(status, short_id, root))
}

/// What a status means.
fn meaning(status: &str) -> &'static str {
    match status {
        row::INFEASIBLE => "no fold pattern exists for this design; nothing was run",
        row::INVALID => "the model refused the scene before the first step",
        row::PANICKED => "an error in the program billow stopped the job",
        _ => match kind(status) {
            Some(FailureKind::Unstable) => {
                "the state became non-finite, or its energy grew without a source"
            }
            Some(FailureKind::EnergyDrift) => {
                "the energy ledger did not balance, so the run has no valid result"
            }
            Some(FailureKind::InvertedVolume) => "the enclosed volume became zero or negative",
            Some(FailureKind::StepLimit) => {
                "the run used all steps of solver.step_limit before its end time"
            }
            Some(FailureKind::Interpenetrated) => "film passed through film, or intersects film",
            None => "the run stopped before its end time",
        },
    }
}

/// What to do about a failure.
fn next_step(status: &str, short_id: &str, root: &str) -> String {
    let show = format!("billow show {short_id} {root} --history");
    match status {
        row::INFEASIBLE => {
            "use a nearest value, or exclude the point with a grid filter".to_owned()
        }
        row::INVALID => "change the key that the reason names".to_owned(),
        row::PANICKED => format!("report the reason with {root}/study.json and the job id"),
        _ => match kind(status) {
            Some(FailureKind::StepLimit) => {
                format!("{show}: see how the time advanced; then raise solver.step_limit")
            }
            Some(FailureKind::Unstable | FailureKind::EnergyDrift) => {
                format!("{show}; then a smaller step (billow schema: solver)")
            }
            _ => show,
        },
    }
}
