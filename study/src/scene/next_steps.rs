//! What to try after a scene had no result.

use billow_solver::output::outcome::Stop;
use billow_solver::scene::{ModelKind, Solver, Stepping};
use serde_json::Value as Json;

use super::file::SceneFile;
use super::solve::{Ended, Solved};
use crate::job::Status;
use crate::job::row::{Cells, ColumnId};
use crate::job::suggestions::{Suggestion, suggestions};

/// What to try after a run without a result: for static equilibrium here, else what a study suggests for such a job.
pub(super) fn of(scene: &SceneFile, summary: &Json, solved: &Solved) -> Vec<String> {
    let status = solved.status;
    if status == Status::NoEquilibrium {
        return vec![
            "hold film that can move freely (supports); start nearer to the equilibrium (mesh.positions), or with a \
             smaller gas.pressure"
                .to_owned(),
            "or find it by motion: solver.static false with solver.end_time and solver.mass_damping".to_owned(),
        ];
    }
    let film = &scene.film.solver;
    let solver = Solver {
        model: ModelKind::Film,
        end_time: film.end_time,
        integrator: film.integrator,
        stepping: Stepping::Stable(film.cfl),
        step_limit: film.step_limit,
    };
    let mut cells = Cells::new(status);
    let number = |value: &Json| value.as_f64();
    cells.set(ColumnId::Steps, summary["steps"].as_i64());
    cells.set(ColumnId::PeakKineticEnergy, number(&summary["measures"]["peak_kinetic_energy"]));
    if let Ended::Motion(motion) = &solved.end
        && let Stop::Failed(failure) = &motion.1.stop
    {
        cells.set(ColumnId::StopAudit, Some(failure.audit.name()));
    }
    let found = suggestions(&cells, &solver).into_iter();
    let text = |suggestion: Suggestion| match suggestion.set {
        Some(set) => format!("--set {set}: {}", suggestion.text),
        None => suggestion.text.to_owned(),
    };
    found.filter(|_| matches!(status, Status::Failed(_))).map(text).collect()
}
