//! What the cases share: film, gas, scenes of film, and the deliberate fault a test may ask for.

use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::explicit::{DEFAULT_CFL, Explicit};
use billow_solver::models::film::capsule;
use billow_solver::platform::fault_injection::Fault;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::{Filling, FilmOutputs, FilmScene, FilmSolver};
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{Film, GasSupply, HeatTransfer, Species};
use nalgebra::Vector3;

use super::reference::number;

/// How cases are run: as they are, or with a deliberate fault that a judge must notice.
#[derive(Debug, Clone, Copy)]
pub struct Rig {
    /// The fault; tests only.
    pub mutation: Option<Fault>,
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
}

impl Default for Rig {
    fn default() -> Self {
        Self { mutation: None, instruction_set: InstructionSet::detect() }
    }
}

impl Rig {
    /// A scene's film at time 0.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn start(&self, scene: &FilmScene) -> Result<Explicit, String> {
        let film = capsule::start(&self.on_instruction_set(scene));
        let film = film.map_err(|error| error.to_string())?;
        Ok(self.faulty(film))
    }

    /// The scene with the rig's instruction set.
    pub fn on_instruction_set(&self, scene: &FilmScene) -> FilmScene {
        let mut scene = scene.clone();
        scene.solver.instruction_set = self.instruction_set;
        scene
    }

    /// Film at time 0, with the fault in it.
    pub fn faulty(&self, film: Explicit) -> Explicit {
        let Some(mutation) = self.mutation else { return film };
        let Explicit { mut model, mut parameters, state, .. } = film;
        model.inject_fault(mutation);
        parameters.fault = Some(mutation);
        Explicit::new(model, parameters, state.positions, state.velocities, state.gas)
    }
}

/// The paper's film, without viscosity.
pub fn film() -> Film {
    Film {
        youngs_modulus: number("film/youngs_modulus"),
        poisson_ratio: number("film/poisson_ratio"),
        density: number("film/density"),
        thickness: number("film/thickness"),
        compression: 0.0,
        viscosity: 0.0,
        temperature: number("film/temperature"),
    }
}

/// Nitrogen in vacuum: adiabatic, no leak, no windows.
pub fn nitrogen() -> GasSupply {
    GasSupply {
        species: Species {
            gas_constant: number("nitrogen/gas_constant"),
            cp: number("nitrogen/cp"),
        },
        initial_mass: 0.0,
        windows: Vec::new(),
        ambient_pressure: 0.0,
        heat_transfer: HeatTransfer::Coefficient(0.0),
        leak_area: 0.0,
        discharge_coefficient: 0.6,
    }
}

/// Film of this shape in orbit, at rest, free, without pressure.
pub fn scene(shell: Shell, film: Film) -> FilmScene {
    FilmScene {
        shell,
        velocities: Vec::new(),
        film,
        filling: Filling::Pressure(0.0),
        supports: Vec::new(),
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            cfl: DEFAULT_CFL,
            end_time: 0.0,
            statics: false,
            mass_damping: 0.0,
            step_limit: u64::MAX,
            instruction_set: InstructionSet::detect(),
        },
        outputs: FilmOutputs {
            sample_interval: 1e-3,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: 0,
        },
        contact: None,
    }
}

/// A support that stands and holds components of these nodes: letters of "xyz".
pub fn held(nodes: Vec<u32>, fix: &str) -> FilmSupport {
    let hold = Hold::Components(['x', 'y', 'z'].map(|axis| fix.contains(axis)));
    FilmSupport { name: "held".to_owned(), nodes, hold, motion: None }
}

/// Gas let in at this rate (kg/s) and temperature (K), nothing packed.
pub fn inflow(rate: f64, temperature: f64) -> Phase {
    Phase {
        packed: false,
        inflow: Inflow { mass_flow_rate: rate, temperature_flow: rate * temperature },
    }
}

/// Advances film to a time, s.
///
/// # Errors
/// Kind, time and place of what stopped it.
pub fn advance(film: &mut Explicit, target: f64, phase: &Phase) -> Result<(), String> {
    film.advance(target, phase)
        .map_err(|failure| format!("{:?} at {} s: {}", failure.kind, failure.time, failure.place))
}

/// The gas's temperature, K.
pub fn temperature(film: &Explicit) -> f64 {
    use billow_solver::integrators::explicit::PressureLoad;
    match film.parameters.pressure_load {
        PressureLoad::Gas(gas) => gas.temperature(film.state.gas),
        PressureLoad::Overpressure(_) => f64::NAN,
    }
}
