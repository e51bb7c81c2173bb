//! Static equilibria of film under a fixed overpressure, its weight and its supports.
//!
//! ```text
//! f_film(x) + p ∂V/∂x + m g + support forces = 0
//! Π = strain energy − p V − Σ m g·x − Σ F s        minimal at the equilibrium of closed film
//! ```
//!
//! Symbols: p overpressure, V enclosed volume; F the constant force on a rigid plane, s its travel.
//! [`solve`] takes a scene; [`settle`] takes a system and any start; [`equilibrium`] is Newton's
//! method alone; [`Relaxation`] is damped motion, slower but more robust. Each ends with a state whose
//! residual is small compared with the load, or with a typed failure.

use nalgebra::{Matrix3, Vector3};

use crate::bending::Bending;
use crate::geometry::field::Field;
use crate::geometry::shell::ShellError;
use crate::mechanics::film_model::{FilmError, FilmModel};
use crate::mechanics::forces::membrane::strain_energy;
use crate::mechanics::supports::Supports;
use crate::scene::film_scene::{Filling, FilmScene};
use crate::scene::film_support::FilmSupport;
use crate::system::{FilmSystem, PressureLoad};

mod approach;
mod equations;
mod newton;
mod relaxation;

pub use approach::settle;
pub use newton::{
    Continues, Equilibrium, StaticFailure, StaticFailureKind, Tolerances, equilibrium,
};
pub use relaxation::{Relaxation, Unsettled};

/// Why a scene has no static equilibrium.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StaticError {
    /// Its faces are not a film.
    #[error(transparent)]
    Shell(#[from] ShellError),
    /// Its elements are not a film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// It is filled with gas instead of a fixed pressure.
    #[error("a static equilibrium needs a fixed pressure, but the scene has gas")]
    Gas,
    /// The search found none.
    #[error(transparent)]
    NoState(#[from] StaticFailure),
}

/// A static equilibrium of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticSolution {
    /// The film.
    pub model: FilmModel,
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Forces of film, pressure and weight on the nodes, N. At held nodes the supports balance them.
    pub forces: Field,
    /// Force of the film on each support, in the order of the scene.
    pub reactions: Vec<Reaction>,
    /// Strain energy, J.
    pub strain_energy: f64,
    /// Potential energy Π, J.
    pub potential_energy: f64,
    /// Enclosed volume, m³; boundary loops are closed by fans.
    pub volume: f64,
    /// Total number of Newton steps.
    pub iterations: u32,
    /// Residual force over the load, a fraction.
    pub residual: f64,
}

/// Force of the film on one support.
#[derive(Debug, Clone, PartialEq)]
pub struct Reaction {
    /// Name of the support.
    pub name: String,
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment about the origin, N m.
    pub moment: Vector3<f64>,
}

/// The static equilibrium of a scene under its fixed pressure, with moving supports at the end of their
/// motion. Velocities, gas, release and times have no effect. The search may start from a `known`
/// equilibrium of the same scene at another overpressure (Pa): it needs fewer steps if the pressure is
/// lower.
pub fn solve(
    scene: &FilmScene,
    known: Option<(&StaticSolution, f64)>,
    continues: Continues<'_>,
) -> Result<StaticSolution, StaticError> {
    let Filling::Pressure(overpressure) = scene.filling else { return Err(StaticError::Gas) };
    scene.shell.check()?;
    let start = Field::of(&scene.shell.positions);
    let supports = Supports::new(&scene.supports, &start);
    let material = scene.film.elastic();
    let model = FilmModel::supported(&material, &scene.shell, |node| supports.hold_fully(node))?;
    let set = scene.solver.instruction_set;
    let held = |node| supports.hold_fully(node);
    let energy_terms = Bending::terms(&material, &model, &scene.shell, set, held);
    let film = FilmSystem {
        supports,
        energy_terms,
        gravity: scene.gravity,
        instruction_set: set,
        ..FilmSystem::free(model, PressureLoad::Overpressure(overpressure))
    };
    let (positions, from) =
        known.map_or((&start, None), |(state, pressure)| (&state.positions, Some(pressure)));
    let equilibrium = settle(&film, positions, from, &Tolerances::default(), continues)?;
    let terms = film.term_energy(&equilibrium.positions, &film.unyielded());
    let FilmSystem { model, supports, .. } = film;
    let strain = strain_energy(&model, &equilibrium.positions) + terms;
    let volume = scene.shell.volume(|node| equilibrium.positions.get(node as usize));
    let gravity_work: f64 = model
        .mass
        .iter()
        .zip(equilibrium.positions.iter())
        .map(|(mass, position)| mass * scene.gravity.dot(&position))
        .sum();
    let plane_work: f64 = supports
        .bodies
        .iter()
        .filter_map(|body| {
            let node = *body.nodes.first()? as usize;
            let displacement = equilibrium.positions.get(node) - start.get(node);
            Some(body.plane.force * body.plane.normal.dot(&displacement))
        })
        .sum();
    Ok(StaticSolution {
        reactions: scene.supports.iter().map(|support| reaction(support, &equilibrium)).collect(),
        strain_energy: strain,
        potential_energy: strain - overpressure * volume - gravity_work - plane_work,
        volume,
        iterations: equilibrium.iterations,
        residual: equilibrium.residual,
        positions: equilibrium.positions,
        forces: equilibrium.forces,
        model,
    })
}

fn reaction(support: &FilmSupport, equilibrium: &Equilibrium) -> Reaction {
    let [force, moment] = support_force(equilibrium, &support.nodes, &support.hold.projector());
    Reaction { name: support.name.clone(), force, moment }
}

/// Force of the film on a support that holds `nodes` along `held`, N, and its moment about the origin, N m.
pub fn support_force(
    equilibrium: &Equilibrium,
    nodes: &[u32],
    held: &Matrix3<f64>,
) -> [Vector3<f64>; 2] {
    let mut sum = [Vector3::zeros(); 2];
    for node in nodes {
        let node = *node as usize;
        let force = held * equilibrium.forces.get(node);
        sum[0] += force;
        sum[1] += equilibrium.positions.get(node).cross(&force);
    }
    sum
}
