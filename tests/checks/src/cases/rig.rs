//! What the cases share: supports and inflow, advancing film, and the deliberate fault that a test
//! may inject.

use billow_solver::integrators::explicit::StoredExplicit;
use billow_solver::integrators::{FilmSimulation, FilmView, StoredIntegrator};
use billow_solver::models::film::capsule;
use billow_solver::platform::fault_injection::Fault;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;
use billow_solver::system::PressureLoad;

/// How cases are run: as they are, or with a deliberate fault that a case must detect.
#[derive(Debug, Clone, Copy)]
pub struct Rig {
    /// The fault; tests only.
    pub fault: Option<Fault>,
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
}

impl Default for Rig {
    fn default() -> Self {
        Self { fault: None, instruction_set: InstructionSet::detect() }
    }
}

impl Rig {
    /// The film of a scene at time 0.
    ///
    /// # Errors
    /// What is invalid in the scene.
    pub fn start(&self, scene: &FilmScene) -> Result<FilmSimulation, String> {
        let film = capsule::start(&self.on_instruction_set(scene), &[]);
        let film = film.map_err(|error| error.to_string())?;
        Ok(self.faulty(film))
    }

    /// The scene with the rig's instruction set.
    pub fn on_instruction_set(&self, scene: &FilmScene) -> FilmScene {
        let mut scene = scene.clone();
        scene.solver.instruction_set = self.instruction_set;
        scene
    }

    /// The same film at time 0, with the fault injected.
    pub fn faulty(&self, film: FilmSimulation) -> FilmSimulation {
        let Some(fault) = self.fault else { return film };
        let (mut system, state, settings) = film.into_parts();
        system.model.inject_fault(fault);
        system.fault = Some(fault);
        FilmSimulation::new(system, settings, state.positions, state.velocities, state.gas)
    }
}

/// A support at rest that holds components of these nodes: letters of "xyz".
pub fn held(nodes: Vec<u32>, fix: &str) -> FilmSupport {
    let hold = Hold::Components(['x', 'y', 'z'].map(|axis| fix.contains(axis)));
    FilmSupport { name: "held".to_owned(), nodes, hold, motion: None }
}

/// Film in motion while gas enters at this rate (kg/s) and temperature (K).
pub fn inflow(rate: f64, temperature: f64) -> Phase {
    Phase {
        inflow: Inflow { mass_flow_rate: rate, temperature_flow: rate * temperature },
        ..Phase::default()
    }
}

/// Advances film to a time, s.
///
/// # Errors
/// Kind, time and location of the failure.
pub fn advance(film: &mut FilmSimulation, target: f64, phase: &Phase) -> Result<(), String> {
    film.advance(target, phase)
        .map_err(|failure| format!("{:?} at {} s: {}", failure.kind, failure.time, failure.place))
}

/// What central differences keep beside the state.
///
/// # Panics
/// If the film has another integrator.
pub fn explicit(film: &FilmSimulation) -> StoredExplicit {
    match film.stored().map(|stored| stored.integrator) {
        Some(StoredIntegrator::Explicit(explicit)) => *explicit,
        _ => unreachable!("reference cases use central differences, which can be stored"),
    }
}

/// Temperature of the gas, K; NaN under a fixed pressure.
pub fn temperature(film: &FilmView<'_>) -> f64 {
    match film.system.pressure_load {
        PressureLoad::Gas(gas) => gas.temperature(film.state.gas),
        PressureLoad::Overpressure(_) => f64::NAN,
    }
}
