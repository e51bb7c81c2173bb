//! What the scenes share: their description, and the cost of their runs.

use std::time::Instant;

use billow_solver::integrators::FilmSimulation;
use billow_solver::output::events::EventKind;
use billow_solver::scene::IntegratorKind;
use serde_json::Value;

use crate::exact_scenes::{ExactQuantity, ExactRun, ExactScene};
use billow_study::job::Status;

/// A quantity of a scene.
pub(super) fn quantity(name: &str, unit: &str, meaning: &str, exact: Option<f64>) -> ExactQuantity {
    let [name, unit, meaning] = [name, unit, meaning].map(str::to_owned);
    ExactQuantity { name, unit, meaning, exact }
}

/// A scene without runs.
pub(super) fn scene(
    name: &str,
    meaning: &str,
    parameters: &[&str],
    quantities: Vec<ExactQuantity>,
) -> ExactScene {
    ExactScene {
        name: name.to_owned(),
        meaning: meaning.to_owned(),
        quantities,
        per_simulated_second: true,
        parameters: parameters.iter().map(|name| (*name).to_owned()).collect(),
        runs: Vec::new(),
    }
}

/// Cost so far: elements, steps, whether some are implicit, simulated time, wall time.
#[derive(Default)]
pub(super) struct Meter {
    pub(super) elements: f64,
    pub(super) steps: f64,
    pub(super) implicit: bool,
    pub(super) simulated: f64,
    pub(super) wall: f64,
}

impl Meter {
    /// Adds film that ran for this wall time, s.
    pub(super) fn add(&mut self, film: &mut FilmSimulation, wall: f64) {
        let changes = film.take_events();
        self.implicit |= film.settings().integrator == IntegratorKind::Implicit
            || changes.iter().any(|event| event.kind == EventKind::Implicit);
        let film = film.view();
        self.elements = film.system.model.elements() as f64;
        self.steps += film.steps() as f64;
        self.simulated += film.state.time;
        self.wall += wall;
    }

    /// The run of a configuration with these values.
    pub(super) fn run(&self, configuration: Vec<Value>, values: Vec<f64>) -> ExactRun {
        ExactRun {
            configuration,
            elements: self.elements,
            steps: self.steps,
            implicit: self.implicit,
            seconds: self.wall / self.simulated,
            status: Status::Done.name().to_owned(),
            values,
        }
    }
}

/// Result and wall time, s.
pub(super) fn timed<T>(body: impl FnOnce() -> Result<T, String>) -> Result<(T, f64), String> {
    let start = Instant::now();
    let value = body()?;
    Ok((value, start.elapsed().as_secs_f64()))
}
