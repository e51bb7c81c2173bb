//! The map of failure: where each method of integration fails, by real runs of small scenes.
//!
//! ```text
//! cell    one scene, one method, one value of each parameter → status, time of failure, audit, ledger residual
//! border  the value between two cells of different outcome, by bisection
//! linear scenes:  largest stable step = 2/ω_max
//! ```
//!
//! A method is an integrator of film (each of [`IntegratorKind::ALL`]), a model without film, or the search for a static
//! equilibrium. A map file names scenes, axes and what is expected of each cell. The runs go to the
//! solver directly: a step beyond the stable one is outside the range of `solver.cfl`, and the map must show what it
//! does.

use billow_solver::integrators;
use billow_solver::scene::IntegratorKind;

mod cell;
pub mod command;
mod file;
mod map;
mod picture;
mod scenes;

/// How a scene is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    /// Film with this integrator.
    Film(IntegratorKind),
    /// The model piston.
    Piston,
    /// The model storeys.
    Storeys,
    /// The search for a static equilibrium.
    Statics,
}

impl Method {
    /// Every method: all integrators, then the models without film, then statics.
    fn all() -> impl Iterator<Item = Self> {
        let film = IntegratorKind::ALL.map(Self::Film);
        film.into_iter().chain([Self::Piston, Self::Storeys, Self::Statics])
    }

    fn is_film(self) -> bool {
        matches!(self, Self::Film(_))
    }

    /// Name, as in a map file.
    fn name(self) -> &'static str {
        match self {
            Self::Film(kind) => integrators::entry(kind).name,
            Self::Piston => "piston",
            Self::Storeys => "storeys",
            Self::Statics => "statics",
        }
    }
}

/// The names of methods in a row.
fn names(methods: &[Method]) -> String {
    methods.iter().map(|method| method.name()).collect::<Vec<_>>().join(", ")
}
