//! The film of a capsule, explicit in time, **without contact**: film passes through film.
//!
//! Tension-field triangles ([`crate::forces`]) on the mesh of the pattern, one gas volume, central
//! differences ([`crate::integrate::explicit`]). For unfolded shapes and for validation. A folded
//! capsule let go in it is a check of energy, not a deployment: its passages and intersections are
//! not counted and come out as `None`, no scene can name it as its model, and
//! [`crate::scene::Solver::model`] and `stepping` are not read here.
//!
//! While packed every node is held where it is stowed; the gas presses on the lid. The lid's force
//! is the one that does the work of a uniform stretch of the stack, Σ `f_z` z/h: what a lone piston
//! would feel.

use super::SceneError;
use crate::course::{Course, Phase};
use crate::deployment::{self, Deployment, Failure, Model, Observer};
use crate::history::Sample;
use crate::integrate::explicit::{Explicit, Interior};
use crate::measures::Reference;
use crate::mesh::Shape;
use crate::scene::Scene;
use crate::state::Field;

pub mod capsule;
mod imperfection;
mod statics;

pub use statics::{Relaxation, StaticState, erected, static_reference, static_states};

/// Runs a scene as film without contact, at this share of the stable step, judged against
/// `reference` ([`static_reference`], or a stored one of the same design, film and supports).
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn solve(
    scene: &Scene,
    cfl: f64,
    reference: Reference,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let mut run = FilmRun::from_scene(scene, cfl, reference)?;
    Ok(deployment::run(&mut run, &Course::new(scene), observer))
}

/// A capsule of film in the middle of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmRun {
    /// The film.
    pub film: Explicit,
    top_ring: Vec<u32>,
    top_centre: u32,
    stowed_height: f64,
    reference: Reference,
}

impl FilmRun {
    /// The scene's film, stowed, at time 0.
    ///
    /// # Errors
    /// As [`solve`].
    pub fn from_scene(scene: &Scene, cfl: f64, reference: Reference) -> Result<Self, SceneError> {
        let stowed = Shape::Stowed(scene.design.stowed_height);
        let (film, mesh) = capsule::film_scene(scene, stowed, cfl)?;
        Ok(Self {
            film: capsule::start(&film)?,
            top_ring: mesh.top_ring,
            top_centre: mesh.top_centre,
            stowed_height: scene.design.stowed_height,
            reference,
        })
    }

    fn lid_force(&self) -> f64 {
        let lift: f64 = (0..self.film.model.nodes())
            .map(|node| self.film.force(node).z * self.film.state.places.z[node])
            .sum();
        (lift / self.stowed_height).max(0.0)
    }
}

/// Mean height of these nodes, m.
fn mean_height(places: &Field, nodes: &[u32]) -> f64 {
    nodes.iter().map(|node| places.z[*node as usize]).sum::<f64>() / nodes.len() as f64
}

impl Model for FilmRun {
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.film.advance(target, phase)
    }

    fn sample(&self, phase: &Phase) -> Sample {
        let film = &self.film;
        let Interior::Gas(gas) = film.setting.interior else { unreachable!("made with gas") };
        let centre = self.top_centre as usize;
        Sample {
            time: film.state.time,
            z_centre: film.state.places.z[centre],
            z_rim: mean_height(&film.state.places, &self.top_ring),
            z_max: film.state.places.z.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            vz: film.velocities().z[centre],
            volume: film.state.volume,
            pressure: film.state.pressure,
            temperature: gas.temperature(film.state.gas),
            lid_force: if phase.packed { self.lid_force() } else { 0.0 },
            ledger: film.ledger(),
            gas: film.books(),
            passages: 0,
            intersections: 0,
        }
    }

    fn reference(&self) -> Reference {
        self.reference.clone()
    }

    fn film_stress(&self) -> f64 {
        self.film.state.film_stress
    }

    fn steps(&self) -> u64 {
        self.film.state.steps
    }

    fn elements(&self) -> usize {
        self.film.model.elements()
    }

    fn counts_passages(&self) -> bool {
        false
    }
}
