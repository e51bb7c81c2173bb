//! Changes of numerical settings that leave the physics alone.

use billow_solver::integrators;
use billow_solver::scene::{IntegratorKind, Solver, Stepping};
use serde::{Deserialize, Serialize};

use crate::input::value::short_number;

/// One change, by the key of a study and its new value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Change {
    /// Another CFL number.
    #[serde(rename = "solver.cfl")]
    Cfl(f64),
    /// Another integrator of film.
    #[serde(rename = "solver.integrator")]
    Integrator(IntegratorKind),
    /// Error-controlled steps, with this relative tolerance.
    #[serde(rename = "solver.stepping.adaptive")]
    Adaptive(f64),
}

impl Change {
    /// The settings with this change.
    #[must_use]
    pub fn applied(self, solver: &Solver) -> Solver {
        let mut solver = *solver;
        match self {
            Self::Cfl(cfl) => solver.stepping = Stepping::Stable(cfl),
            Self::Integrator(kind) => solver.integrator = kind,
            Self::Adaptive(tolerance) => solver.stepping = Stepping::Adaptive(tolerance),
        }
        solver
    }

    /// Key, planned value and new value: "solver.cfl 0.45 -> 0.225".
    fn text(self, planned: &Solver) -> String {
        match self {
            Self::Cfl(cfl) => format!("{} -> {}", step(planned.stepping), short_number(cfl)),
            Self::Integrator(kind) => {
                let name = |kind| integrators::entry(kind).name;
                format!("solver.integrator {} -> {}", name(planned.integrator), name(kind))
            }
            Self::Adaptive(tolerance) => {
                let new = step(Stepping::Adaptive(tolerance));
                format!("{} -> {new}", step(planned.stepping))
            }
        }
    }
}

/// Key and value of a choice of the step.
fn step(stepping: Stepping) -> String {
    match stepping {
        Stepping::Adaptive(tolerance) => {
            format!("solver.stepping.adaptive {}", short_number(tolerance))
        }
        Stepping::Fixed(step) => format!("solver.stepping.fixed {} s", short_number(step)),
        Stepping::Stable(cfl) => format!("solver.cfl {}", short_number(cfl)),
    }
}

/// The changes from planned settings to others, as far as remedies make them.
pub fn changes(planned: &Solver, used: &Solver) -> Vec<Change> {
    let integrator =
        (planned.integrator != used.integrator).then_some(Change::Integrator(used.integrator));
    let stepping = match used.stepping {
        stepping if stepping == planned.stepping => None,
        Stepping::Stable(cfl) => Some(Change::Cfl(cfl)),
        Stepping::Adaptive(tolerance) => Some(Change::Adaptive(tolerance)),
        Stepping::Fixed(_) => None,
    };
    integrator.into_iter().chain(stepping).collect()
}

/// These changes of planned settings, as the table shows them.
pub fn text(changes: &[Change], planned: &Solver) -> String {
    let texts: Vec<String> = changes.iter().map(|change| change.text(planned)).collect();
    texts.join(", ")
}
