//! What the cases share: supports and inflow, advancing film, and the deliberate fault that a test
//! may inject.

use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::FilmSimulation;
use billow_solver::integrators::StoredIntegrator;
use billow_solver::integrators::explicit::StoredExplicit;
use billow_solver::models::film::capsule;
use billow_solver::output::outcome::Failure;
use billow_solver::platform::fault_injection::Fault;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::paper::{free_film, nitrogen_supply};
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{Film, GasSupply};
use billow_solver::statics::{self, StaticSolution};
use billow_study::cli::instruction_set;
use nalgebra::Vector3;

use super::Result;

/// How cases are run: as they are, or with a deliberate fault that a case must detect.
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
    /// The rig with the instruction set of `BILLOW_SIMD`.
    pub fn selected() -> billow_study::platform::error::Result<Self> {
        Ok(Self { fault: None, instruction_set: instruction_set::selected()? })
    }

    /// The film of a scene at time 0.
    pub fn start(&self, scene: &FilmScene) -> Result<FilmSimulation> {
        let film = capsule::start(&self.on_instruction_set(scene), &[]);
        let film = film?;
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

/// A rigid plane on these nodes.
pub fn on_plane(nodes: Vec<u32>, plane: PlaneBody) -> FilmSupport {
    FilmSupport { name: "plane".to_owned(), nodes, hold: Hold::Body(plane), motion: None }
}

/// Nitrogen of this mass (kg) and temperature (K).
pub fn nitrogen_filling(initial_mass: f64, initial_temperature: f64) -> Filling {
    let supply = GasSupply { initial_mass, ..nitrogen_supply() };
    Filling::Gas { supply, initial_temperature }
}

/// Film in motion while gas enters at this rate (kg/s) and temperature (K).
pub fn inflow(rate: f64, temperature: f64) -> Phase {
    Phase {
        inflow: Inflow {
            mass_flow_rate: rate,
            temperature_flow: rate * temperature,
            ..Inflow::default()
        },
        ..Phase::default()
    }
}

/// A failure in words.
pub fn stopped(failure: &Failure) -> String {
    format!("{} at {} s: {}", failure.kind.name(), failure.time, failure.place)
}

/// Advances film to a time, s.
pub fn advance(film: &mut FilmSimulation, target: f64, phase: &Phase) -> Result<()> {
    film.advance(target, phase).map_err(|failure| stopped(&failure).into())
}

/// What central differences keep beside the state.
pub fn explicit(film: &FilmSimulation) -> StoredExplicit {
    match film.stored().map(|stored| stored.integrator) {
        Some(StoredIntegrator::Explicit(explicit)) => *explicit,
        _ => unreachable!("reference cases use central differences, which can be stored"),
    }
}

/// The static equilibrium of a scene; the search may start from the equilibrium at another overpressure (Pa).
pub fn equilibrium(
    rig: &Rig,
    scene: &FilmScene,
    known: Option<(&StaticSolution, f64)>,
) -> Result<StaticSolution> {
    Ok(statics::solve(&rig.on_instruction_set(scene), known, &mut || true)?)
}

/// The static equilibrium of film under an overpressure (Pa).
pub fn inflated(
    rig: &Rig,
    shell: Shell,
    film: Film,
    pressure: f64,
    supports: Vec<FilmSupport>,
) -> Result<StaticSolution> {
    let filling = Filling::Pressure(pressure);
    equilibrium(rig, &FilmScene { filling, supports, ..free_film(shell, film) }, None)
}

/// Mean of a quantity over nodes.
pub fn mean(state: &StaticSolution, nodes: &[u32], of: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let sum: f64 = nodes.iter().map(|node| of(state.positions.get(*node as usize))).sum();
    sum / nodes.len() as f64
}

/// Film, overpressure (Pa) and name of a row of a table of compliant film: E, t, p.
pub fn compliant(row: &[f64]) -> (Film, f64, String) {
    let film = Film { youngs_modulus: row[0], thickness: row[1], ..Film::PAPER_ELASTIC };
    let name = format!("E {:e} Pa, {:.1} um, {} Pa", row[0], row[1] * 1e6, row[2]);
    (film, row[2], name)
}
