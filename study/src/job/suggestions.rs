//! What to try about a run that failed: a change of one key, or what only its user can decide.
//!
//! ```text
//! with a change   leaves the physics alone: a smaller CFL number, another integrator, error-controlled steps
//! without         changes the result or its cost: loss, mesh, material, model, gas, limits
//! ```
//! The table is a pure function of the row and of the settings of its scene. It has what the map of failure
//! shows to work.

use billow_solver::integrators;
use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::output::outcome::{AuditKind, FailureKind};
use billow_solver::scene::{IntegratorKind, ModelKind, Solver, Stepping};

use crate::input::value::{Value, short_number};
use crate::job::Status;
use crate::job::row::{Cells, ColumnId};

/// Peak kinetic energy below which nothing deployed, J. Chosen: a thousandth of the slowest run of the paper.
const MIN_DEPLOYMENT_ENERGY: f64 = 5e-3;
/// Factor by which a smaller CFL number is smaller. Chosen: one such step cures most drift, at twice the steps.
const CFL_FACTOR: f64 = 0.5;

const STRETCH: &str = "less stretch: check film.youngs_modulus, film.thickness and the gas (gas.mass_flow_rate, \
                       gas.residual_gas_mass, solver.end_time); pressure times radius over E t is the strain";
const FINER_MESH: &str =
    "a finer mesh (design.subdivisions); it moves film in more detail, and costs more";

/// Something to try.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suggestion {
    /// The change that `--set` takes, as in `solver.cfl=0.225`; `None` for what only the user can decide.
    pub set: Option<String>,
    /// Why it helps, or what to decide.
    pub text: &'static str,
}

/// What to try about a row of a run with these settings, the best first.
pub fn suggestions(cells: &Cells, solver: &Solver) -> Vec<Suggestion> {
    let failure = Failure { cells, solver };
    let decisions = failure.decisions().into_iter().map(|text| Suggestion { set: None, text });
    failure.change().into_iter().chain(decisions).collect()
}

/// Whether a run ended as `energy_drift` of film that hardly moved: the strain energy of the folded mesh is then as
/// large as all energy that moved.
pub fn is_without_motion(cells: &Cells) -> bool {
    let energy = cells.number(ColumnId::PeakKineticEnergy);
    cells.status() == Status::Failed(FailureKind::EnergyDrift)
        && energy.is_some_and(|energy| energy < MIN_DEPLOYMENT_ENERGY)
}

/// A row of a run that did not do what was asked.
struct Failure<'a> {
    cells: &'a Cells,
    solver: &'a Solver,
}

impl Failure<'_> {
    /// The change that leaves the physics alone.
    fn change(&self) -> Option<Suggestion> {
        let Status::Failed(kind) = self.cells.status() else { return None };
        if is_without_motion(self.cells) || self.used_all_steps() {
            return None;
        }
        let integrator = |kind| format!("solver.integrator={}", integrators::entry(kind).name);
        let (set, text) = match (self.solver.model, self.solver.integrator, self.solver.stepping) {
            (ModelKind::Film, IntegratorKind::Implicit, _) => {
                let text = "explicit steps bear film that hits film; the implicit method finds no step there";
                (integrator(IntegratorKind::Hybrid), text)
            }
            (ModelKind::Film, _, Stepping::Stable(cfl)) => {
                // The gas takes its step in closed form: no smaller step makes its balance better.
                let is_drift =
                    kind == FailureKind::EnergyDrift && !self.ended_by(AuditKind::GasBalance);
                if !is_drift && kind != FailureKind::Unstable {
                    return None;
                }
                let text = "a step of half the length resolves film that gas throws outward within one step";
                (format!("solver.cfl={}", short_number(CFL_FACTOR * cfl)), text)
            }
            (ModelKind::Piston, _, Stepping::Fixed(_)) => {
                let text = "steps that follow their error are short where the fixed step is too long for the piston";
                (format!("solver.stepping.adaptive={}", short_number(DEFAULT_TOLERANCE)), text)
            }
            // A smaller step of storeys fails alike: the model itself does not bear such gas.
            _ => return None,
        };
        Some(Suggestion { set: Some(set), text })
    }

    /// What only the user can decide.
    fn decisions(&self) -> Vec<&'static str> {
        let is_film = self.solver.model == ModelKind::Film;
        let is_damped = *self.cells.get(ColumnId::NumericallyDamped) == Value::Bool(true);
        let is_implicit = is_film && self.solver.integrator == IntegratorKind::Implicit;
        match self.cells.status() {
            _ if is_without_motion(self.cells) => vec![
                "more gas before solver.end_time: gas.mass_flow_rate and the inflow windows of the strategy; their \
                 times count from the start of the run",
            ],
            Status::Done if is_damped && is_implicit => vec![
                "solver.integrator explicit: it takes less energy than this integrator",
                FINER_MESH,
            ],
            Status::Done if is_damped => vec![
                "less numerical damping: a smaller film.numerical_damping or solver.cfl",
                FINER_MESH,
            ],
            Status::Failed(FailureKind::Overstretched) => vec![STRETCH],
            Status::Failed(FailureKind::StepLimit) if self.used_all_steps() => {
                // The next step says how a job goes on that a limit of jobs ended.
                self.steps().map(|_| "more steps: solver.step_limit").into_iter().collect()
            }
            Status::Failed(_) if self.solver.model == ModelKind::Storeys => {
                vec!["solver.model film: it bears gas supplies that storeys does not"]
            }
            // It was stretched far beyond its material model, and a smaller step shows it as overstretched.
            Status::Failed(FailureKind::Unstable) if self.ended_by(AuditKind::Stretch) => {
                vec![STRETCH]
            }
            Status::Failed(FailureKind::Unstable | FailureKind::EnergyDrift) if is_film => vec![
                "more loss (film.loss_factor, film.numerical_damping); it damps the motion",
                FINER_MESH,
            ],
            Status::Failed(FailureKind::InvertedVolume) if is_film => {
                vec![
                    "a volume for the gas at the start: design.stowed_height, gas.residual_gas_mass",
                ]
            }
            Status::Failed(FailureKind::Interpenetrated) if is_film => vec![
                "layers farther apart at the start: design.stowed_height, or those of the mesh",
            ],
            _ => Vec::new(),
        }
    }

    /// Whether this audit ended the run.
    fn ended_by(&self, audit: AuditKind) -> bool {
        self.cells.text(ColumnId::StopAudit) == audit.name()
    }

    /// Accepted steps; `None` for a run without a history.
    fn steps(&self) -> Option<u64> {
        match self.cells.get(ColumnId::Steps) {
            Value::Integer(steps) => u64::try_from(*steps).ok(),
            _ => None,
        }
    }

    /// Whether the run used all steps that it may take. If not, a `step_limit` is a step too small to advance time.
    fn used_all_steps(&self) -> bool {
        self.cells.status() == Status::Failed(FailureKind::StepLimit)
            && self.steps().is_none_or(|steps| steps >= self.solver.step_limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The changes and the number of decisions for a film run that ended so.
    fn of(
        kind: FailureKind,
        integrator: IntegratorKind,
        audit: Option<AuditKind>,
    ) -> (Option<String>, usize) {
        let solver = Solver {
            model: ModelKind::Film,
            end_time: 1.0,
            integrator,
            stepping: Stepping::Stable(0.45),
            step_limit: 1000,
        };
        let mut cells = Cells::new(Status::Failed(kind));
        cells.set(ColumnId::StopAudit, audit.map(AuditKind::name));
        cells.set(ColumnId::PeakKineticEnergy, 1.0);
        cells.set(ColumnId::Steps, 10_i64);
        let found = suggestions(&cells, &solver);
        let set = found.iter().find_map(|suggestion| suggestion.set.clone());
        (set, found.iter().filter(|suggestion| suggestion.set.is_none()).count())
    }

    #[test]
    fn a_change_is_suggested_where_it_helps() {
        use FailureKind::{EnergyDrift, Interpenetrated, Overstretched, StepLimit, Unstable};
        use IntegratorKind::{Explicit, Implicit};
        let smaller = || Some("solver.cfl=0.225".to_owned());
        let hybrid = || Some("solver.integrator=hybrid".to_owned());
        assert_eq!(of(EnergyDrift, Explicit, None), (smaller(), 2));
        assert_eq!(of(EnergyDrift, Explicit, Some(AuditKind::GasBalance)), (None, 2));
        assert_eq!(of(Unstable, Explicit, Some(AuditKind::Stretch)), (smaller(), 1));
        assert_eq!(of(StepLimit, Implicit, None), (hybrid(), 0));
        assert_eq!(of(Overstretched, Explicit, None), (None, 1));
        assert_eq!(of(Interpenetrated, Explicit, None), (None, 1));
    }
}
