//! Static states of a capsule, from the erected shape.
//!
//! The bottom ring starts on its erected circle and is moved to the stowed N-gon it is held on, so
//! that deployed and erected shape see the same supports. Pressures are taken falling, each from
//! the state of the one before. Gravity is left out, so that a design has one reference on the
//! ground and in orbit. The film's compression fraction is 0. Each state is one of
//! [`crate::statics::settle`].

use core::ops::ControlFlow;

use nalgebra::Vector3;

use super::capsule::film_scene;
use super::mean_z;
use crate::geometry::field::Field;
use crate::geometry::fold::FoldPattern;
use crate::geometry::mesh::{Mesh, Shape};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::strain_energy;
use crate::mechanics::forces::pressure::volume;
use crate::mechanics::supports::{PrescribedNodes, Supports};
use crate::output::measures::{REFERENCE_PRESSURES, Reference};
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::Filling;
use crate::scene::motion::{Motion, Profile};
use crate::scene::{
    Contact, Film, GasSupply, HeatTransfer, Outputs, Scene, Solver, Stepping, Thresholds,
};
use crate::statics::{Loaded, Settling, StaticFailure, settle};

/// One static state.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticState {
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// V, m³.
    pub volume: f64,
    /// Mean height of the top ring, m.
    pub z_rim: f64,
    /// Strain energy, J.
    pub strain_energy: f64,
    /// Newton steps it took.
    pub iterations: u32,
    /// Residual force over the load.
    pub residual: f64,
    /// Places of the nodes, m.
    pub places: Field,
}

/// A capsule erected: its film, what holds it, and its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Erected {
    /// The film, of compression fraction 0.
    pub model: FilmModel,
    /// What holds it; movers bring what is held to where it is held stowed.
    pub supports: Supports,
    /// Where the nodes are, m.
    pub places: Field,
    /// The mesh.
    pub mesh: Mesh,
    /// Overpressure the places are a state of rest under, Pa.
    pub rests_under: Option<f64>,
}

/// A scene's capsule erected, with what is held on the way to where it is held stowed.
///
/// # Errors
/// [`SceneError`] when the capsule cannot be made.
pub fn erected(scene: &Scene) -> Result<Erected, SceneError> {
    scene.validate()?;
    let still =
        Scene { film: Film { compression: 0.0, ..scene.film }, gravity: 0.0, ..scene.clone() };
    let (mut capsule, mesh) = film_scene(&still, Shape::Erected, 1.0)?;
    capsule.filling = Filling::Pressure(0.0);
    let invalid = |problem: String| SceneError::Invalid { key: "design".to_owned(), problem };
    let model = FilmModel::of_shell(&capsule.film, &capsule.shell)
        .map_err(|error| invalid(error.to_string()))?;
    let places = Field::of(&capsule.shell.positions);
    let mut supports = Supports::new(&capsule.supports, &places);
    if !capsule.supports.is_empty() {
        let pattern = FoldPattern::new(&scene.design)?;
        let stowed = Shape::Stowed(scene.design.stowed_height);
        let stowed = Mesh::new(&pattern, scene.design.subdivisions, stowed)?;
        let place = |node: &u32| places.get(*node as usize);
        let way = |node: &u32| stowed.positions[*node as usize] - place(node);
        supports.movers = capsule
            .supports
            .iter()
            .map(|support| PrescribedNodes {
                nodes: support.nodes.clone(),
                start: support.nodes.iter().map(place).collect(),
                held: support.hold.projector(),
                motion: WHOLE,
                displacements: support.nodes.iter().map(way).collect(),
            })
            .collect();
    }
    Ok(Erected { model, supports, places, mesh, rests_under: None })
}

/// A motion whose own translation is nought: the way of each node stands beside it.
const WHOLE: Motion = Motion {
    from: 0.0,
    to: 1.0,
    profile: Profile::Linear,
    translation: Vector3::new(0.0, 0.0, 0.0),
    rotation: None,
};

impl Erected {
    /// The capsule's static state at this overpressure (Pa), from where its nodes are; leaves them
    /// there.
    ///
    /// # Errors
    /// [`StaticFailure`].
    pub fn settle(&mut self, overpressure: f64) -> Result<StaticState, StaticFailure> {
        self.settle_while(overpressure, &mut || true)
    }

    /// The same, for as long as `goes_on` says so, which is asked at every iteration.
    ///
    /// # Errors
    /// [`StaticFailure`], of kind `Impulses` where it said no.
    pub fn settle_while(
        &mut self,
        overpressure: f64,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<StaticState, StaticFailure> {
        let loaded = Loaded {
            model: &self.model,
            supports: &self.supports,
            overpressure,
            gravity: Vector3::zeros(),
            path: InstructionSet::detect(),
        };
        let watch = &mut |_: &_| {
            if goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let rest = settle(&loaded, &self.places, self.rests_under, &Settling::default(), watch)?;
        self.places.clone_from(&rest.places);
        // What is held has arrived.
        self.supports.movers.clear();
        self.rests_under = Some(overpressure);
        Ok(StaticState {
            overpressure,
            volume: volume(&self.model, &rest.places),
            z_rim: mean_z(&rest.places, &self.mesh.top_ring),
            strain_energy: strain_energy(&self.model, &rest.places),
            iterations: rest.iterations,
            residual: rest.residual,
            places: rest.places,
        })
    }
}

/// Static states of a scene's capsule at these overpressures (Pa), in the order given; falling
/// pressures settle soonest.
///
/// # Errors
/// [`SceneError`] when the capsule cannot be made, or has no such state.
pub fn static_states(scene: &Scene, overpressures: &[f64]) -> Result<Vec<StaticState>, SceneError> {
    states_while(scene, overpressures, &mut || true)
}

fn states_while(
    scene: &Scene,
    overpressures: &[f64],
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<Vec<StaticState>, SceneError> {
    let mut capsule = erected(scene)?;
    let no_state = |failure: StaticFailure| SceneError::Invalid {
        key: "design".to_owned(),
        problem: failure.to_string(),
    };
    let mut settle = |pressure: &f64| capsule.settle_while(*pressure, goes_on).map_err(no_state);
    overpressures.iter().map(&mut settle).collect()
}

/// A scene of which all that does not matter to its static states is at its default: gas, contact,
/// lid, gravity, imperfection, what is stored, how long it runs, and of the film compression and
/// viscosity.
pub fn reference_scene(scene: &Scene) -> Scene {
    Scene {
        design: scene.design.clone(),
        film: Film { compression: 0.0, viscosity: 0.0, ..scene.film },
        gas: GasSupply {
            initial_mass: 0.0,
            windows: Vec::new(),
            ambient_pressure: 0.0,
            heat_transfer: HeatTransfer::Coefficient(0.0),
            leak_area: 0.0,
            discharge_coefficient: 1.0,
            ..scene.gas.clone()
        },
        supports: scene.supports.clone(),
        contact: Contact { distance: None, friction: 0.0, adhesion: 0.0 },
        gravity: 0.0,
        release_time: 0.0,
        solver: Solver {
            end_time: 1.0,
            stepping: Stepping::Stable(1.0),
            step_limit: 1,
            ..scene.solver
        },
        outputs: Outputs { sample_interval: 1.0, frames: 0, thresholds: Thresholds::default() },
        seed: 0,
    }
}

/// `V_ref` and `H_ref` of a scene's capsule, at [`REFERENCE_PRESSURES`].
///
/// # Errors
/// As [`static_states`].
pub fn static_reference(scene: &Scene) -> Result<Reference, SceneError> {
    static_reference_while(scene, &mut || true)
}

/// The same, for as long as `goes_on` says so, which is asked now and then.
///
/// # Errors
/// As [`static_states`], and where it said no.
pub fn static_reference_while(
    scene: &Scene,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<Reference, SceneError> {
    let mut falling = REFERENCE_PRESSURES;
    falling.reverse();
    let mut states = states_while(scene, &falling, goes_on)?;
    states.reverse();
    Ok(Reference::new(states.iter().map(|s| [s.overpressure, s.volume, s.z_rim]).collect()))
}
