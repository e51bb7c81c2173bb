//! Static states of film: where it rests under a fixed overpressure, its weight and its supports.
//!
//! ```text
//! f_film(x) + p ∂V/∂x + m g + what supports bear = 0
//! Π = strain energy − p V − Σ m g·x − Σ F s        its minimum, where pressure has an energy
//! ```
//!
//! Symbols: p overpressure, V enclosed volume; F the constant force on a rigid plane, s its travel.
//! [`solve`] takes a scene, [`settle`] film with its load from any start, [`equilibrium`] is Newton's
//! method alone, [`Relaxation`] the slow way by damped motion. All four end with a state whose
//! residual is small against the load, or with a typed failure.

use core::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::geometry::shell::ShellError;
use crate::mechanics::film_model::{FilmError, FilmModel};
use crate::mechanics::forces::membrane::strain_energy;
use crate::mechanics::supports::Supports;
use crate::scene::film_scene::{Filling, FilmScene};
use crate::scene::film_support::FilmSupport;

mod approach;
pub mod dense;
pub mod factor;
mod newton;
pub mod order;
mod relaxation;
pub mod tangent;
pub mod unknowns;

pub use approach::settle;
pub use newton::{
    Iteration, Loaded, Rest, Settling, StaticFailure, StaticFailureKind, TunnellingMonitor,
    equilibrium,
};
pub use relaxation::Relaxation;

/// Why a scene has no static state to give.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StaticError {
    /// Its faces are no film.
    #[error(transparent)]
    Shell(#[from] ShellError),
    /// Its elements are no film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// It is filled with gas.
    #[error("a static state needs a fixed pressure; there is gas")]
    Gas,
    /// None was found.
    #[error(transparent)]
    NoState(#[from] StaticFailure),
}

/// A static state of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticSolution {
    /// The film.
    pub model: FilmModel,
    /// Places of the nodes, m.
    pub places: Field,
    /// Forces of film, pressure and weight on the nodes, N: what supports bear.
    pub forces: Field,
    /// What the film exerts on each support, in the scene's order.
    pub reactions: Vec<Reaction>,
    /// Strain energy, J.
    pub strain_energy: f64,
    /// Strain energy less p V, weight and what pushes planes, J.
    pub potential_energy: f64,
    /// Enclosed volume, m³, boundary loops closed by their fans at the start.
    pub volume: f64,
    /// Newton steps in all.
    pub iterations: u32,
    /// Residual force over the load.
    pub residual: f64,
}

/// What film exerts on one support.
#[derive(Debug, Clone, PartialEq)]
pub struct Reaction {
    /// Name of the support.
    pub name: String,
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment about the origin, N m.
    pub moment: Vector3<f64>,
}

/// The state of rest of a scene under its fixed pressure, what moves having come to its end.
/// Velocities, gas, release and times are not read.
///
/// # Errors
/// [`StaticError`].
pub fn solve(
    scene: &FilmScene,
    watch: TunnellingMonitor<'_>,
) -> Result<StaticSolution, StaticError> {
    solve_from(scene, None, watch)
}

/// [`solve`], from a state of the same scene under another overpressure (Pa) where there is one:
/// sooner, where the pressure falls.
///
/// # Errors
/// As [`solve`].
pub fn solve_from(
    scene: &FilmScene,
    known: Option<(&StaticSolution, f64)>,
    watch: TunnellingMonitor<'_>,
) -> Result<StaticSolution, StaticError> {
    let Filling::Pressure(overpressure) = scene.filling else { return Err(StaticError::Gas) };
    scene.shell.check()?;
    let model = FilmModel::of_shell(&scene.film, &scene.shell)?;
    let start = Field::of(&scene.shell.positions);
    let supports = Supports::new(&scene.supports, &start);
    let loaded = Loaded {
        model: &model,
        supports: &supports,
        overpressure,
        gravity: scene.gravity,
        path: scene.solver.instruction_set,
    };
    let (places, from) = known.map_or((&start, None), |(state, at)| (&state.places, Some(at)));
    let rest = settle(&loaded, places, from, &Settling::default(), watch)?;
    let strain = strain_energy(&model, &rest.places);
    let volume = scene.shell.volume(|node| rest.places.get(node as usize));
    let weight: f64 = model
        .mass
        .iter()
        .zip(rest.places.iter())
        .map(|(mass, place)| mass * scene.gravity.dot(&place))
        .sum();
    let pushed: f64 = supports
        .bodies
        .iter()
        .filter_map(|body| {
            let node = *body.nodes.first()? as usize;
            let way = rest.places.get(node) - start.get(node);
            Some(body.plane.force * body.plane.normal.dot(&way))
        })
        .sum();
    Ok(StaticSolution {
        reactions: scene.supports.iter().map(|support| reaction(support, &rest)).collect(),
        strain_energy: strain,
        potential_energy: strain - overpressure * volume - weight - pushed,
        volume,
        iterations: rest.iterations,
        residual: rest.residual,
        places: rest.places,
        forces: rest.forces,
        model,
    })
}

/// [`solve`] without a listener.
///
/// # Errors
/// As [`solve`].
pub fn solve_unwatched(scene: &FilmScene) -> Result<StaticSolution, StaticError> {
    solve(scene, &mut |_| ControlFlow::Continue(()))
}

fn reaction(support: &FilmSupport, rest: &Rest) -> Reaction {
    let [force, moment] = borne(rest, &support.nodes, &support.hold.projector());
    Reaction { name: support.name.clone(), force, moment }
}

/// What film exerts on nodes held along these directions, and its moment about the origin: N and
/// N m.
pub fn borne(rest: &Rest, nodes: &[u32], held: &Matrix3<f64>) -> [Vector3<f64>; 2] {
    let mut sum = [Vector3::zeros(); 2];
    for node in nodes {
        let node = *node as usize;
        let force = held * rest.forces.get(node);
        sum[0] += force;
        sum[1] += rest.places.get(node).cross(&force);
    }
    sum
}
