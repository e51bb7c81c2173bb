//! What the scenes share: their description, and the cost of their runs.

use std::time::Instant;

use billow_solver::integrators::FilmSimulation;
use billow_solver::output::events::EventKind;
use billow_solver::scene::IntegratorKind;
use billow_study::analysis::work_precision::{Ending, Outcome, Quantity, Run, SceneRuns};
use billow_study::input::value::Value;

use crate::cases::Result;

/// A quantity of a scene.
pub(super) fn quantity(name: &str, unit: &str, meaning: &str, exact: Option<f64>) -> Quantity {
    let [name, unit, meaning] = [name, unit, meaning].map(str::to_owned);
    Quantity { name, unit, meaning, exact, is_course: false }
}

/// A scene without runs. Its seconds are those of a simulated second, or of a whole run at rest.
pub(super) fn scene(
    [name, meaning]: [&str; 2],
    quantities: Vec<Quantity>,
    per_simulated_second: bool,
) -> SceneRuns {
    let [name, meaning] = [name, meaning].map(str::to_owned);
    let runs = Vec::new();
    SceneRuns { name, meaning, quantities, per_simulated_second, runs, without_result: 0 }
}

/// A configuration: numerical parameters and their values.
pub(super) type Configuration<const N: usize> = [(&'static str, Value); N];

/// Adds a run with its cost and its result for each quantity; none for a run that failed.
pub(super) fn add<const N: usize>(
    scene: &mut SceneRuns,
    configuration: Configuration<N>,
    meter: &Meter,
    ending: Ending,
    values: &[f64],
) {
    let per = if scene.per_simulated_second { meter.simulated } else { 1.0 };
    let result = |index| values.get(index).map(|value| Outcome::Number(*value));
    scene.runs.push(Run {
        configuration: configuration.map(|(name, value)| (name.to_owned(), value)).into(),
        ending,
        elements: meter.elements,
        steps: meter.steps,
        implicit: meter.implicit,
        seconds: Some(meter.wall / per),
        results: (0..scene.quantities.len()).map(result).collect(),
        mesh_errors: Vec::new(),
    });
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
    /// The cost of film that ran for this wall time, s.
    pub(super) fn of(film: &mut FilmSimulation, wall: f64) -> Self {
        let mut meter = Self::default();
        meter.add(film, wall);
        meter
    }

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
}

/// Result and wall time, s.
pub(super) fn timed<T>(body: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    let start = Instant::now();
    let value = body()?;
    Ok((value, start.elapsed().as_secs_f64()))
}
