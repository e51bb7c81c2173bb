//! A capsule as film: mesh, imperfection, supports, contact, plates.

use nalgebra::Vector3;

use super::imperfection;
pub use super::reference_gap::{contact_distance, imperfection_amplitude};
use crate::bending::Bending;
use crate::collision::contact::{Adhesion, ContactModel};
use crate::geometry::field::Field;
use crate::geometry::fold::{FoldDesign, FoldPattern};
use crate::geometry::mesh::{Mesh, Part, Shape};
use crate::geometry::shell::Shell;
use crate::integrators::{self, FilmSimulation, Refusal, SimulationSettings};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::gas::{Gas, GasState};
use crate::mechanics::supports::{PrescribedNodes, Supports};
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{Filling, FilmContact, FilmOutputs, FilmScene, FilmSolver};
use crate::scene::film_support::{FilmSupport, Hold};
use crate::scene::plate::Plate;
use crate::scene::{IntegratorKind, Scene, Support, SupportLocation};
use crate::system::{FilmSystem, PressureLoad};

/// Subdivisions of the mesh on which the largest displacement of the imperfection is its amplitude.
/// Chosen: an edge is short against the shortest wave.
const AMPLITUDE_SUBDIVISIONS: u32 = 8;

/// Adds the imperfection of a scene's seed to its stowed capsule: the same displacement field on every
/// mesh. Returns [`imperfection_amplitude`].
pub fn imperfect(
    mesh: &mut Mesh,
    design: &FoldDesign,
    seed: u64,
    amplitude: Option<f64>,
) -> Result<Option<f64>, SceneError> {
    let amplitude = imperfection_amplitude(design, seed, amplitude)?;
    if let Some(amplitude) = amplitude {
        let stowed = Shape::Stowed(design.stowed_height);
        let pattern = FoldPattern::new(design)?;
        let reference = Mesh::new(&pattern, AMPLITUDE_SUBDIVISIONS, stowed)?.positions;
        imperfection::imperfect(&mut mesh.positions, &reference, seed, amplitude);
    }
    Ok(amplitude)
}

/// Contact of the capsule of a design, with its [`contact_distance`].
pub fn resolved_contact(
    contact: FilmContact,
    design: &FoldDesign,
) -> Result<FilmContact, SceneError> {
    let distance = contact_distance(contact.distance, design)?;
    Ok(FilmContact { distance: Some(distance), ..contact })
}

/// Name of the plate above packed film.
pub const LID: &str = "lid";
/// Name of the plate below packed film.
pub const BASE: &str = "base";

/// The capsule of a scene in one of its shapes, without contact, at this CFL number; and its mesh.
pub fn film_scene(
    instruction_set: InstructionSet,
    scene: &Scene,
    shape: Shape,
    cfl: f64,
) -> Result<(FilmScene, Mesh), SceneError> {
    scene.validate()?;
    let design = scene.design.folded()?;
    let pattern = FoldPattern::new(design)?;
    let mut mesh = Mesh::new(&pattern, design.subdivisions, shape)?;
    if matches!(shape, Shape::Stowed(_)) {
        imperfect(&mut mesh, design, scene.seed, scene.imperfection_amplitude)?;
    }
    let supports = scene.supports.iter().map(|support| on_capsule(support, &mesh)).collect();
    let film = assembled(instruction_set, scene, Shell::of_mesh(&mesh), supports, cfl);
    Ok((film, mesh))
}

/// The film of a scene with this shape and these supports, without contact.
pub(super) fn assembled(
    instruction_set: InstructionSet,
    scene: &Scene,
    shell: Shell,
    supports: Vec<FilmSupport>,
    cfl: f64,
) -> FilmScene {
    FilmScene {
        shell,
        velocities: Vec::new(),
        film: scene.film,
        filling: Filling::Gas {
            supply: scene.gas.clone(),
            initial_temperature: scene.film.temperature,
        },
        supports,
        contact: None,
        gravity: Vector3::new(0.0, 0.0, scene.gravity),
        release_time: scene.release_time,
        solver: FilmSolver {
            integrator: scene.solver.integrator,
            cfl,
            end_time: scene.solver.end_time,
            statics: false,
            mass_damping: 0.0,
            step_limit: scene.solver.step_limit,
            instruction_set,
        },
        outputs: FilmOutputs {
            sample_interval: scene.outputs.sample_interval,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: scene.outputs.frames,
        },
    }
}

fn on_capsule(support: &Support, mesh: &Mesh) -> FilmSupport {
    let (name, nodes) = match support.on {
        SupportLocation::BottomRing => ("bottom_ring", sorted(mesh.bottom_ring.clone())),
        SupportLocation::TopRing => ("top_ring", sorted(mesh.top_ring.clone())),
        SupportLocation::BottomCap => ("bottom_cap", part_nodes(mesh, Part::BottomCap)),
        SupportLocation::TopCap => ("top_cap", part_nodes(mesh, Part::TopCap)),
    };
    let held = ['x', 'y', 'z'].map(|axis| support.fix.contains(axis));
    FilmSupport { name: name.to_owned(), nodes, hold: Hold::Components(held), motion: None }
}

/// Nodes of a part of the film, ascending.
pub fn part_nodes(mesh: &Mesh, part: Part) -> Vec<u32> {
    let elements = mesh.triangles.iter().zip(&mesh.parts).filter(|(_, of)| **of == part);
    sorted(elements.flat_map(|(triangle, _)| *triangle).collect())
}

fn sorted(mut nodes: Vec<u32>) -> Vec<u32> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The film of a scene at time 0, with further nodes that move as prescribed.
pub fn start(scene: &FilmScene, seating: &[PrescribedNodes]) -> Result<FilmSimulation, SceneError> {
    let (mut system, settings, gas) = constants(scene)?;
    system.supports.movers.extend(seating.iter().cloned());
    let positions = Field::of(&scene.shell.positions);
    let mut velocities = Field::zeros(positions.len());
    for (node, velocity) in scene.velocities.iter().enumerate() {
        velocities.set(node, *velocity);
    }
    Ok(FilmSimulation::new(system, settings, positions, velocities, gas))
}

/// The film of a scene as a system, how it is integrated, and its gas at time 0.
pub fn constants(
    scene: &FilmScene,
) -> Result<(FilmSystem, SimulationSettings, GasState), SceneError> {
    let solver = &scene.solver;
    check_cfl(solver.cfl)?;
    scene.shell.check().map_err(|error| SceneError::invalid("mesh", error))?;
    let positions = Field::of(&scene.shell.positions);
    let supports = Supports::new(&scene.supports, &positions);
    let model = FilmModel::supported(&scene.film, &scene.shell, |node| supports.hold_fully(node))
        .map_err(|error| SceneError::invalid("mesh", error))?;
    let (pressure_load, gas) = match &scene.filling {
        Filling::Pressure(pressure) => (PressureLoad::Overpressure(*pressure), GasState::default()),
        Filling::Gas { supply, initial_temperature } => {
            let gas = Gas::new(supply, scene.film.temperature, scene.shell.reference_area());
            (PressureLoad::Gas(gas), gas.at_temperature(supply.initial_mass, *initial_temperature))
        }
    };
    let (film, shell, set) = (&scene.film, &scene.shell, solver.instruction_set);
    let held = |node| supports.hold_fully(node);
    let energy_terms = Bending::terms(film, &model, shell, set, held);
    let system = FilmSystem {
        supports,
        energy_terms,
        gravity: scene.gravity,
        numerical_damping: scene.film.numerical_damping,
        mass_damping: solver.mass_damping,
        instruction_set: solver.instruction_set,
        contact: scene.contact.as_ref().map(|_| contact_model(scene, &model, &positions)),
        ..FilmSystem::free(model, pressure_load)
    };
    check_integrator(solver.integrator, &system)?;
    let settings = SimulationSettings {
        integrator: solver.integrator,
        cfl: solver.cfl,
        step_limit: solver.step_limit,
        monitor: scene.contact.as_ref().map(|contact| contact.monitor),
    };
    Ok((system, settings, gas))
}

/// The contact model of a scene. Until its release the film lies packed between base and lid.
fn contact_model(scene: &FilmScene, model: &FilmModel, positions: &Field) -> ContactModel {
    let contact = scene.contact.clone().unwrap_or_default();
    let (distance, set) = (contact.distance, scene.solver.instruction_set);
    let mut contact_model =
        ContactModel::of_film(model, positions, distance, &contact.ignored, set);
    contact_model.soften(scene.solver.cfl);
    contact_model.friction = contact.friction;
    if contact.adhesion > 0.0 {
        let range = contact.adhesion_range.unwrap_or(contact_model.distance);
        contact_model.adhesion = Adhesion { pressure: contact.adhesion, range };
    }
    contact_model.plates = contact.plates;
    if scene.release_time > 0.0 {
        let (low, high) = positions
            .z
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(*z), high.max(*z)));
        let plate = |name: &str, z: f64, normal: Vector3<f64>| Plate {
            name: name.to_owned(),
            point: Vector3::new(0.0, 0.0, z),
            normal,
            motion: None,
            removal_time: scene.release_time,
        };
        contact_model.plates.push(plate(BASE, low - contact_model.distance, Vector3::z()));
        contact_model.plates.push(plate(LID, high + contact_model.distance, -Vector3::z()));
    }
    contact_model
}

/// Checks that an integrator can move a system.
fn check_integrator(kind: IntegratorKind, system: &FilmSystem) -> Result<(), SceneError> {
    let entry = integrators::entry(kind);
    let Some(Refusal { unknown, allowed }) = entry.refusal(system) else { return Ok(()) };
    let name = entry.name;
    let problem = format!("{name} has no {unknown}; allowed: {allowed}, or explicit");
    Err(SceneError::invalid("solver.integrator", problem))
}

fn check_cfl(cfl: f64) -> Result<(), SceneError> {
    if cfl > 0.0 && cfl <= 1.0 {
        return Ok(());
    }
    let problem = format!("{cfl} is not allowed; allowed: above 0, at most 1");
    Err(SceneError::invalid("cfl", problem))
}
