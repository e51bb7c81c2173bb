//! Small films for the tests of the explicit solver.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::mesh::Shape;
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::{FilmSimulation, FilmView, SimulationSettings};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::forces::membrane::{ElementHistory, NodeForces, assemble_membrane};
use billow_solver::mechanics::gas::{Gas, GasState};
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::paper::nitrogen_supply;
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{Film, Scene};
use billow_solver::system::{FilmSystem, PressureLoad};
use nalgebra::Vector3;

/// The paper's inflow, 5 g/s at 293 K, into a released capsule.
pub const INFLOW: Phase = Phase {
    packed: false,
    inflow: Inflow { mass_flow_rate: 5e-3, temperature_flow: 5e-3 * 293.0 },
};

/// The film of a capsule's scene in its stowed shape.
pub fn stowed(instruction_set: InstructionSet, scene: &Scene, cfl: f64) -> FilmScene {
    let shape = Shape::Stowed(scene.design.stowed_height);
    capsule::film_scene(instruction_set, scene, shape, cfl).expect("a foldable design").0
}

/// The model of a shell.
pub fn model(shell: &Shell, film: &Film) -> FilmModel {
    FilmModel::of_shell(film, shell).expect("a valid film")
}

/// Film forces on nodes at these positions, without motion.
pub fn film_forces(model: &FilmModel, positions: &Field) -> NodeForces {
    let mut nodes = NodeForces::new(model);
    let history = &mut ElementHistory::at_rest(model, positions);
    let _ = assemble_membrane(InstructionSet::detect(), model, positions, 0.0, history, &mut nodes);
    nodes
}

/// The nodes of a shell under a map.
pub fn mapped(shell: &Shell, mut map: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Field {
    Field::of(&shell.positions.iter().map(|node| map(*node)).collect::<Vec<_>>())
}

/// Film without velocity at the shell's positions.
pub fn at_rest(
    shell: &Shell,
    film: &Film,
    pressure: PressureLoad,
    gas: GasState,
) -> FilmSimulation {
    let (nodes, numerical_damping) = (shell.positions.len(), film.numerical_damping);
    let parameters = Parameters { numerical_damping, ..Parameters::free(pressure, nodes) };
    let positions = Field::of(&shell.positions);
    Explicit::new(model(shell, film), parameters, positions, Field::zeros(nodes), gas)
}

pub fn free() -> Phase {
    Phase::default()
}

pub fn nitrogen_gas() -> Gas {
    Gas::new(&nitrogen_supply(), 293.0, 1.0)
}

/// Orders of convergence of errors on meshes or steps halved each time.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).abs().log2()).collect()
}
