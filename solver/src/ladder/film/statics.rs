//! Static states of a capsule, by relaxation under mass damping from the erected shape.
//!
//! ```text
//! m a = f − c m v,   c = 2 ω          until kinetic energy < 1e-9 p V
//! ω² = Σ Δx·Δr / Σ m Δx²              r = −f; the frequency the motion has now
//! ```
//!
//! The bottom ring starts on its erected circle and is moved to the stowed N-gon it is held on, so
//! that deployed and erected shape see the same supports. Pressures are taken falling, each from
//! the state of the one before. Gravity is left out, so that a design has one reference on the
//! ground and in orbit. The film's compression fraction is 0. The frequency is Rayleigh's quotient
//! of the last stretch of motion (P. Underwood, "Dynamic relaxation", 1983).

use nalgebra::Vector3;

use super::capsule::{film_scene, start};
use super::mean_height;
use crate::course::Phase;
use crate::deployment::{Failure, FailureKind};
use crate::film_scene::{Filling, FilmSupport, Motion, Profile};
use crate::fold::FoldPattern;
use crate::integrate::explicit::{Explicit, Interior};
use crate::ladder::SceneError;
use crate::measures::{REFERENCE_PRESSURES, Reference};
use crate::mesh::{Mesh, Shape};
use crate::scene::{Film, Scene};
use crate::state::Field;
use crate::supports::Mover;

/// How a relaxation goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Share of the stable step.
    pub cfl: f64,
    /// Settled: kinetic energy below this share of p V, twice in a row.
    pub kinetic_share: f64,
    /// Steps between two looks.
    pub stretch: u32,
    /// Steps a pressure may take.
    pub step_limit: u64,
}

impl Default for Relaxation {
    fn default() -> Self {
        Self { cfl: 0.9, kinetic_share: 1e-9, stretch: 50, step_limit: 400_000 }
    }
}

impl Relaxation {
    /// Relaxes film at this overpressure (Pa) until it is settled, adapting the mass damping.
    ///
    /// # Errors
    /// [`Failure`] of the motion, or `step_limit` when it does not settle.
    pub fn relax_at(&self, film: &mut Explicit, overpressure: f64) -> Result<(), Failure> {
        film.setting.interior = Interior::Overpressure(overpressure);
        film.state.pressure = overpressure;
        let limit = film.state.steps + self.step_limit;
        film.setting.step_limit = limit;
        let mut calm = 0;
        while calm < 2 {
            let (places, forces) = (film.state.places.clone(), all_forces(film));
            let target = film.state.time + film.stable_step() * f64::from(self.stretch);
            film.advance(target, &Phase::default())?;
            film.setting.mass_damping = 2.0 * frequency(film, &places, &forces);
            let energy = film.overpressure() * film.state.volume;
            let settled = film.kinetic_energy().abs() < self.kinetic_share * energy;
            calm = if settled { calm + 1 } else { 0 };
        }
        Ok(())
    }
}

fn all_forces(film: &Explicit) -> Vec<Vector3<f64>> {
    let free = |node: usize| film.setting.supports.projector(node) * film.force(node);
    (0..film.model.nodes()).map(free).collect()
}

/// ω of the motion since `places`, rad/s.
fn frequency(film: &Explicit, places: &Field, forces: &[Vector3<f64>]) -> f64 {
    let (mut stiffness, mut mass) = (0.0, 0.0);
    for (node, (before, now)) in forces.iter().zip(all_forces(film)).enumerate() {
        let moved = film.state.places.get(node) - places.get(node);
        stiffness += moved.dot(&(before - now));
        mass += film.model.mass[node] * moved.norm_squared();
    }
    // A quotient below nought belongs to a motion that still gains speed: let it.
    if mass > 0.0 { (stiffness / mass).max(0.0).sqrt() } else { 0.0 }
}

/// One static state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticState {
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// V, m³.
    pub volume: f64,
    /// Mean height of the top ring, m.
    pub z_rim: f64,
    /// Strain energy, J.
    pub strain_energy: f64,
    /// Steps it took.
    pub steps: u64,
}

/// Static states of a scene's capsule at these overpressures (Pa), in the order given; falling
/// pressures settle soonest.
///
/// # Errors
/// [`SceneError`] when the capsule cannot be made, or has no such state within the steps allowed.
pub fn static_states(
    scene: &Scene,
    overpressures: &[f64],
    relaxation: &Relaxation,
) -> Result<Vec<StaticState>, SceneError> {
    let (mut film, mesh) = erected(scene, relaxation)?;
    let mut states = Vec::new();
    for overpressure in overpressures {
        let steps = film.state.steps;
        relaxation.relax_at(&mut film, *overpressure).map_err(|failure| no_state(&failure))?;
        states.push(StaticState {
            overpressure: *overpressure,
            volume: film.state.volume,
            z_rim: mean_height(&film.state.places, &mesh.top_ring),
            strain_energy: film.strain_energy(),
            steps: film.state.steps - steps,
        });
    }
    Ok(states)
}

/// `V_ref` and `H_ref` of a scene's capsule, at [`REFERENCE_PRESSURES`].
///
/// # Errors
/// As [`static_states`].
pub fn static_reference(scene: &Scene, relaxation: &Relaxation) -> Result<Reference, SceneError> {
    let mut falling = REFERENCE_PRESSURES;
    falling.reverse();
    let mut states = static_states(scene, &falling, relaxation)?;
    states.reverse();
    Ok(Reference::new(states.iter().map(|s| [s.overpressure, s.volume, s.z_rim]).collect()))
}

fn no_state(failure: &Failure) -> SceneError {
    let Failure { kind, time, place } = failure;
    let problem = format!("no static state: {kind:?} at {time} s, {place}");
    SceneError::Invalid { key: "design".to_owned(), problem }
}

/// A scene's capsule erected, still and without pressure, with what is held moved to where it is
/// held stowed; and its mesh. Its compression fraction is 0.
///
/// # Errors
/// [`SceneError`] when the capsule cannot be made, or does not bear the move.
pub fn erected(scene: &Scene, relaxation: &Relaxation) -> Result<(Explicit, Mesh), SceneError> {
    scene.validate()?;
    let still =
        Scene { film: Film { compression: 0.0, ..scene.film }, gravity: 0.0, ..scene.clone() };
    let (mut capsule, mesh) = film_scene(&still, Shape::Erected, relaxation.cfl)?;
    capsule.filling = Filling::Pressure(MOVE_PRESSURE);
    let mut film = start(&capsule)?;
    film.setting.step_limit = relaxation.step_limit;
    if !scene.supports.is_empty() {
        let pattern = FoldPattern::new(&scene.design)?;
        let stowed = Shape::Stowed(scene.design.stowed_height);
        let stowed = Mesh::new(&pattern, scene.design.subdivisions, stowed)?;
        move_held(&mut film, &capsule.supports, &stowed).map_err(|failure| no_state(&failure))?;
    }
    Ok((film, mesh))
}

/// How long what is held takes to its stowed place, s.
const MOVE_TIME: f64 = 0.01;
/// Overpressure that keeps the film open meanwhile, Pa.
const MOVE_PRESSURE: f64 = 1000.0;

/// Moves what is held to where it is held stowed.
fn move_held(film: &mut Explicit, held: &[FilmSupport], stowed: &Mesh) -> Result<(), Failure> {
    let place = |node: &u32| film.state.places.get(*node as usize);
    let motion = Motion {
        from: 0.0,
        to: MOVE_TIME,
        profile: Profile::Smooth,
        translation: Vector3::zeros(),
        turn: None,
    };
    let mover = |support: &FilmSupport| Mover {
        nodes: support.nodes.clone(),
        start: support.nodes.iter().map(place).collect(),
        held: support.hold.projector(),
        motion,
        beside: support
            .nodes
            .iter()
            .map(|node| stowed.positions[*node as usize] - place(node))
            .collect(),
    };
    film.setting.supports.movers = held.iter().map(mover).collect();
    film.advance(MOVE_TIME, &Phase::default())?;
    if film.state.volume > 0.0 {
        return Ok(());
    }
    let place = "gas volume, moving the ring".to_owned();
    Err(Failure { kind: FailureKind::InvertedVolume, time: film.state.time, place })
}
