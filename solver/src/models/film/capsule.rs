//! A capsule as film: mesh, supports and places of its rings.

use nalgebra::Vector3;

use super::imperfection;
use crate::collision::contact::{self, Adhesion, ContactModel};
use crate::geometry::field::Field;
use crate::geometry::fold::FoldPattern;
use crate::geometry::mesh::{Mesh, Part, Shape};
use crate::geometry::shell::Shell;
use crate::integrators::explicit::{Explicit, Parameters, PressureLoad};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::gas::{Gas, GasState};
use crate::mechanics::supports::Supports;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{Filling, FilmOutputs, FilmScene, FilmSolver};
use crate::scene::film_support::{FilmSupport, Hold};
use crate::scene::plate::Plate;
use crate::scene::{Film, Scene, Support, SupportLocation};

/// Amplitude of the imperfection of a stowed capsule, as a share of its smallest gap.
const IMPERFECTION: f64 = 0.1;

/// Puts the imperfection of a seed on a stowed capsule; 0 is none.
///
/// # Errors
/// [`SceneError::Invalid`] when the capsule makes no film.
pub fn imperfect(mesh: &mut Mesh, film: &Film, seed: u64) -> Result<(), SceneError> {
    if seed == 0 {
        return Ok(());
    }
    let places = Field::of(&mesh.positions);
    let model = FilmModel::of_shell(film, &Shell::of_mesh(mesh)).map_err(|error| {
        SceneError::Invalid { key: "design".to_owned(), problem: error.to_string() }
    })?;
    let gap = ContactModel::of_film(&model, &places, None, InstructionSet::detect()).distance
        / contact::DISTANCE_PER_GAP;
    imperfection::imperfect(&mut mesh.positions, seed, IMPERFECTION * gap);
    Ok(())
}

/// Name of the plate that holds film packed from above.
pub const LID: &str = "lid";
/// Name of the plate that holds film packed from below.
pub const BASE: &str = "base";

/// A scene's capsule in one of its shapes, without contact, at this share of the stable step; and its mesh.
///
/// # Errors
/// [`SceneError`] when the scene is not sound or the capsule cannot be made.
pub fn film_scene(scene: &Scene, shape: Shape, cfl: f64) -> Result<(FilmScene, Mesh), SceneError> {
    scene.validate()?;
    let pattern = FoldPattern::new(&scene.design)?;
    let mut mesh = Mesh::new(&pattern, scene.design.subdivisions, shape)?;
    if matches!(shape, Shape::Stowed(_)) {
        imperfect(&mut mesh, &scene.film, scene.seed)?;
    }
    let film = FilmScene {
        shell: Shell::of_mesh(&mesh),
        velocities: Vec::new(),
        film: scene.film,
        filling: Filling::Gas {
            supply: scene.gas.clone(),
            initial_temperature: scene.film.temperature,
        },
        supports: scene.supports.iter().map(|support| on_capsule(support, &mesh)).collect(),
        contact: None,
        gravity: Vector3::new(0.0, 0.0, scene.gravity),
        release_time: scene.release_time,
        solver: FilmSolver {
            cfl,
            end_time: scene.solver.end_time,
            statics: false,
            mass_damping: 0.0,
            step_limit: scene.solver.step_limit,
            instruction_set: InstructionSet::detect(),
        },
        outputs: FilmOutputs {
            sample_interval: scene.outputs.sample_interval,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: scene.outputs.frames,
        },
    };
    Ok((film, mesh))
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

/// Nodes of a piece of film, in ascending order.
pub fn part_nodes(mesh: &Mesh, part: Part) -> Vec<u32> {
    let own = mesh.triangles.iter().zip(&mesh.parts).filter(|(_, own)| **own == part);
    sorted(own.flat_map(|(triangle, _)| *triangle).collect())
}

fn sorted(mut nodes: Vec<u32>) -> Vec<u32> {
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// A scene's film at time 0.
///
/// # Errors
/// [`SceneError::Invalid`] when the film is none, or a number is out of range.
pub fn start(scene: &FilmScene) -> Result<Explicit, SceneError> {
    let (model, setting, gas) = constants(scene)?;
    let places = Field::of(&scene.shell.positions);
    let mut velocities = Field::zeros(places.len());
    for (node, velocity) in scene.velocities.iter().enumerate() {
        velocities.set(node, *velocity);
    }
    Ok(Explicit::new(model, setting, places, velocities, gas))
}

/// What is constant in a scene's run, and the gas it starts with.
///
/// # Errors
/// As [`start`].
pub fn constants(scene: &FilmScene) -> Result<(FilmModel, Parameters, GasState), SceneError> {
    let solver = &scene.solver;
    check_cfl(solver.cfl)?;
    let invalid = |key: &str, problem: String| SceneError::Invalid { key: key.to_owned(), problem };
    scene.shell.check().map_err(|error| invalid("mesh", error.to_string()))?;
    let model = FilmModel::of_shell(&scene.film, &scene.shell)
        .map_err(|error| invalid("mesh", error.to_string()))?;
    let places = Field::of(&scene.shell.positions);
    let (interior, gas) = match &scene.filling {
        Filling::Pressure(pressure) => (PressureLoad::Overpressure(*pressure), GasState::default()),
        Filling::Gas { supply, initial_temperature } => {
            let gas = Gas::new(supply, scene.film.temperature, scene.shell.reference_area());
            (PressureLoad::Gas(gas), gas.at_temperature(supply.initial_mass, *initial_temperature))
        }
    };
    let setting = Parameters {
        interior,
        supports: Supports::new(&scene.supports, &places),
        gravity: scene.gravity,
        viscosity: scene.film.viscosity,
        mass_damping: solver.mass_damping,
        cfl: solver.cfl,
        step_limit: solver.step_limit,
        path: solver.instruction_set,
        contact: scene.contact.as_ref().map(|_| law(scene, &model, &places)),
        watch: scene.contact.as_ref().map(|contact| contact.monitor),
        mutation: None,
    };
    Ok((model, setting, gas))
}

/// The law of a scene's contact; until its release the film lies packed between base and lid.
fn law(scene: &FilmScene, model: &FilmModel, places: &Field) -> ContactModel {
    let contact = scene.contact.clone().unwrap_or_default();
    let mut law =
        ContactModel::of_film(model, places, contact.distance, scene.solver.instruction_set);
    law.soften(scene.solver.cfl);
    law.friction = contact.friction;
    if contact.adhesion > 0.0 {
        let range = contact.adhesion_range.unwrap_or(law.distance);
        law.adhesion = Adhesion { pressure: contact.adhesion, range };
    }
    law.plates = contact.plates;
    if scene.release_time > 0.0 {
        let (low, high) = places
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
        law.plates.push(plate(BASE, low - law.distance, Vector3::z()));
        law.plates.push(plate(LID, high + law.distance, -Vector3::z()));
    }
    law
}

fn check_cfl(cfl: f64) -> Result<(), SceneError> {
    if cfl > 0.0 && cfl <= 1.0 {
        return Ok(());
    }
    let problem = format!("{cfl} is not allowed; above 0, at most 1");
    Err(SceneError::Invalid { key: "cfl".to_owned(), problem })
}
