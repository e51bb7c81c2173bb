//! Static equilibria of a capsule, from its erected shape; of other film from its stress-free shape, where its mesh knows
//! that, else from its start.
//!
//! The bottom ring starts on its erected circle and moves to the stowed polygon on which a run holds it,
//! so both have the same supports; held nodes of other film likewise. Pressures descend; each equilibrium starts from the
//! previous one.
//! Without gravity, so that a design has the same reference on the ground and in orbit. The film's
//! compression fraction is 0. [`crate::statics::settle`] finds each equilibrium.

use nalgebra::Vector3;

use super::capsule::film_scene;
use super::{any_mesh, heights, mean_z};
use crate::geometry::field::Field;
use crate::geometry::mesh::{Mesh, Shape};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::strain_energy;
use crate::mechanics::forces::pressure::volume;
use crate::mechanics::supports::{PrescribedNodes, Supports};
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::FilmScene;
use crate::scene::motion::{Motion, Profile};
use crate::scene::{
    Contact, Design, Film, GasSupply, HeatTransfer, IntegratorKind, Outputs, Scene, Solver,
    Stepping, Thresholds,
};
use crate::statics::{Continues, StaticFailure, Tolerances, settle};
use crate::system::{FilmSystem, PressureLoad};

/// One static equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticState {
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// Enclosed volume V, m³.
    pub volume: f64,
    /// Mean height of the top ring; of film without rings its whole height, m.
    pub height: f64,
    /// Strain energy, J.
    pub strain_energy: f64,
    /// Newton steps taken.
    pub iterations: u32,
    /// Residual force over the load, a fraction.
    pub residual: f64,
    /// Positions of the nodes, m.
    pub positions: Field,
}

/// An erected capsule: film, supports and mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Erected {
    /// The film, of compression fraction 0.
    pub model: FilmModel,
    /// Supports; movers bring held nodes to their stowed positions.
    pub supports: Supports,
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Nodes of the top ring of a capsule; empty of other film.
    pub top_ring: Vec<u32>,
    /// Overpressure at which the positions are a static equilibrium, Pa; `None` before the first one.
    pub equilibrium_at: Option<f64>,
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
}

/// The erected capsule, or other film, of a scene. Its held nodes still have to move to their positions in a run.
pub fn erected(instruction_set: InstructionSet, scene: &Scene) -> Result<Erected, SceneError> {
    scene.validate()?;
    let reference =
        Scene { film: Film { compression: 0.0, ..scene.film }, gravity: 0.0, ..scene.clone() };
    let Beginning { film: capsule, top_ring, held_at } =
        Beginning::of(instruction_set, &reference)?;
    let positions = Field::of(&capsule.shell.positions);
    let mut supports = Supports::new(&capsule.supports, &positions);
    let elastic = capsule.film.elastic();
    let model = FilmModel::supported(&elastic, &capsule.shell, |node| supports.hold_fully(node))
        .map_err(|error| SceneError::invalid("design", error))?;
    if let Some(held_at) = held_at.filter(|_| !capsule.supports.is_empty()) {
        let position = |node: &u32| positions.get(*node as usize);
        let displacement = |node: &u32| held_at[*node as usize] - position(node);
        supports.movers = capsule
            .supports
            .iter()
            .map(|support| PrescribedNodes {
                nodes: support.nodes.clone(),
                start: support.nodes.iter().map(position).collect(),
                held: support.hold.projector(),
                motion: UNIT_MOTION,
                displacements: support.nodes.iter().map(displacement).collect(),
            })
            .collect();
    }
    Ok(Erected { model, supports, positions, top_ring, equilibrium_at: None, instruction_set })
}

/// Where the search of equilibria begins.
struct Beginning {
    film: FilmScene,
    /// Nodes of the top ring of a capsule.
    top_ring: Vec<u32>,
    /// Positions (m) on which a run holds its nodes, where they are others.
    held_at: Option<Vec<Vector3<f64>>>,
}

impl Beginning {
    /// That of a reference scene.
    fn of(instruction_set: InstructionSet, scene: &Scene) -> Result<Self, SceneError> {
        match &scene.design {
            Design::Capsule(design) => {
                let (film, mesh) = film_scene(instruction_set, scene, Shape::Erected, 1.0)?;
                let stowed = Shape::Stowed(design.stowed_height);
                let stowed = Mesh::new(&scene.design.pattern()?, design.subdivisions, stowed)?;
                let held_at = Some(stowed.positions);
                Ok(Self { film, top_ring: mesh.top_ring, held_at })
            }
            Design::Mesh(design) => {
                let film = any_mesh::unstressed(instruction_set, scene, &design.film, 1.0)?;
                let start = &design.film.shell.positions;
                let held_at = design.film.unstressed.is_some().then(|| start.clone());
                Ok(Self { film, top_ring: Vec::new(), held_at })
            }
        }
    }
}

/// Tolerances of a capsule's equilibria. Chosen: volumes and heights err by less than 1e-6.
const TOLERANCES: Tolerances = Tolerances { residual: 1e-5, step: 1e-6, iterations: 400 };

/// A motion without translation: each node has its own displacement.
const UNIT_MOTION: Motion = Motion {
    from: 0.0,
    to: 1.0,
    profile: Profile::Linear,
    translation: Vector3::new(0.0, 0.0, 0.0),
    rotation: None,
};

impl Erected {
    /// The same capsule in a known equilibrium: these positions (m), at this overpressure (Pa).
    #[must_use]
    pub fn at_equilibrium(&self, positions: Field, overpressure: f64) -> Self {
        // Held nodes are at their stowed positions.
        let supports = Supports { movers: Vec::new(), ..self.supports.clone() };
        Self { positions, supports, equilibrium_at: Some(overpressure), ..self.clone() }
    }

    /// The static equilibrium of the capsule at this overpressure (Pa), searched from the positions now.
    /// Moves the nodes there.
    pub fn settle(&mut self, overpressure: f64) -> Result<StaticState, StaticFailure> {
        self.settle_while(overpressure, &mut || true)
    }

    /// [`Self::settle`]; calls `continues` at every iteration and ends when it returns `false`.
    ///
    /// # Errors
    /// [`StaticFailure`], of kind `Stopped` if `continues` returned `false`.
    pub fn settle_while(
        &mut self,
        overpressure: f64,
        continues: Continues<'_>,
    ) -> Result<StaticState, StaticFailure> {
        let load = PressureLoad::Overpressure(overpressure);
        let film = FilmSystem {
            supports: self.supports.clone(),
            instruction_set: self.instruction_set,
            ..FilmSystem::free(self.model.clone(), load)
        };
        let equilibrium =
            settle(&film, &self.positions, self.equilibrium_at, &TOLERANCES, continues)?;
        self.positions.clone_from(&equilibrium.positions);
        // Held nodes are at their stowed positions.
        self.supports.movers.clear();
        self.equilibrium_at = Some(overpressure);
        Ok(StaticState {
            overpressure,
            volume: volume(&self.model, &equilibrium.positions),
            height: if self.top_ring.is_empty() {
                let [low, high] = heights(&self.model, &equilibrium.positions);
                high - low
            } else {
                mean_z(&equilibrium.positions, &self.top_ring)
            },
            strain_energy: strain_energy(&self.model, &equilibrium.positions),
            iterations: equilibrium.iterations,
            residual: equilibrium.residual,
            positions: equilibrium.positions,
        })
    }
}

/// Static equilibria of a scene's capsule at these overpressures (Pa), in the given order. Descending
/// pressures need the fewest steps.
pub fn static_states(
    instruction_set: InstructionSet,
    scene: &Scene,
    overpressures: &[f64],
) -> Result<Vec<StaticState>, SceneError> {
    let mut capsule = erected(instruction_set, scene)?;
    let no_equilibrium = |failure: StaticFailure| SceneError::invalid("design", failure);
    overpressures.iter().map(|p| capsule.settle(*p).map_err(no_equilibrium)).collect()
}

/// A scene in which everything that does not affect static equilibria has its default: gas, contact, lid,
/// gravity, imperfection, outputs, end time, and the film's compression fraction, bending, loss and
/// numerical damping.
pub fn reference_scene(scene: &Scene) -> Scene {
    Scene {
        design: scene.design.clone(),
        film: Film { compression: 0.0, bending: false, creases: None, ..scene.film.elastic() },
        gas: GasSupply {
            initial_mass: 0.0,
            windows: Vec::new(),
            ambient_pressure: 0.0,
            heat_transfer: HeatTransfer::Coefficient(0.0),
            leak_area: 0.0,
            vent: None,
            discharge_coefficient: 1.0,
            ..scene.gas.clone()
        },
        supports: scene.supports.clone(),
        contact: Contact { distance: None, friction: 0.0, adhesion: 0.0 },
        gravity: 0.0,
        release_time: 0.0,
        solver: Solver {
            end_time: 1.0,
            model: scene.solver.model,
            integrator: IntegratorKind::default(),
            stepping: Stepping::Stable(1.0),
            step_limit: 1,
        },
        outputs: Outputs { sample_interval: 1.0, frames: 0, thresholds: Thresholds::default() },
        seed: 0,
        imperfection_amplitude: None,
    }
}
