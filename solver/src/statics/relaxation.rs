//! Static equilibria by damped motion (dynamic relaxation): slow and robust.
//!
//! ```text
//! m a = f − c m v,   c = 2 ω          until kinetic energy < fraction · p V
//! ω² = Σ Δx·Δr / Σ m Δx²              r = −f
//! ```
//!
//! ω is the frequency of the present motion: Rayleigh's quotient of its last [`Relaxation::check_interval`]
//! steps (P. Underwood, "Dynamic relaxation", 1983).

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::integrators::{FilmSimulation, FilmView, SimulationSettings};
use crate::output::outcome::Failure;
use crate::scene::timeline::Phase;
use crate::system::{FilmSystem, PressureLoad};

/// Settings of a relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// CFL number.
    pub cfl: f64,
    /// Upper bound of the kinetic energy over p V at two successive checks.
    pub max_kinetic_fraction: f64,
    /// Number of steps between two checks.
    pub check_interval: u32,
    /// Upper bound of the number of steps at one pressure.
    pub step_limit: u64,
}

impl Default for Relaxation {
    fn default() -> Self {
        Self { cfl: 0.9, max_kinetic_fraction: 1e-9, check_interval: 50, step_limit: 400_000 }
    }
}

/// A relaxation that did not come to rest.
#[derive(Debug)]
pub struct Unsettled {
    /// Why.
    pub failure: Failure,
    /// The film as far as it came.
    pub film: FilmSimulation,
}

impl Relaxation {
    /// Relaxes film at this overpressure (Pa) until it is at rest. Adapts the mass damping: each time it
    /// continues with another system.
    ///
    /// # Errors
    /// [`Unsettled`]: a failure of the motion; `step_limit` if the film does not come to rest.
    pub fn relax_at(
        &self,
        film: FilmSimulation,
        overpressure: f64,
    ) -> Result<FilmSimulation, Box<Unsettled>> {
        let step_limit = film.view().steps() + self.step_limit;
        let mut film = film.with(|system, settings| {
            let pressure_load = PressureLoad::Overpressure(overpressure);
            (FilmSystem { pressure_load, ..system }, SimulationSettings { step_limit, ..settings })
        });
        let mut settled_checks = 0;
        while settled_checks < 2 {
            let before = film.view();
            let (positions, forces) = (before.state.positions.clone(), free_forces(&before));
            let target = before.state.time + before.next_step() * f64::from(self.check_interval);
            if let Err(failure) = film.advance(target, &Phase::default()) {
                return Err(Box::new(Unsettled { failure, film }));
            }
            let mass_damping = 2.0 * frequency(&film.view(), &positions, &forces);
            film = film.with(|system, settings| (FilmSystem { mass_damping, ..system }, settings));
            let now = film.view();
            let energy = now.overpressure() * now.state.volume;
            let settled = now.ledger().kinetic.abs() < self.max_kinetic_fraction * energy;
            settled_checks = if settled { settled_checks + 1 } else { 0 };
        }
        Ok(film)
    }
}

/// Forces on all nodes along free directions, N.
fn free_forces(film: &FilmView<'_>) -> Vec<Vector3<f64>> {
    let free_force = |node: usize| film.system.supports.projector(node) * film.force(node);
    (0..film.system.model.nodes()).map(free_force).collect()
}

/// Frequency ω of the motion since these positions (m) with these forces (N), rad/s.
fn frequency(film: &FilmView<'_>, positions: &Field, forces: &[Vector3<f64>]) -> f64 {
    let (mut stiffness, mut mass) = (0.0, 0.0);
    for (node, (before, now)) in forces.iter().zip(free_forces(film)).enumerate() {
        let moved = film.state.positions.get(node) - positions.get(node);
        stiffness += moved.dot(&(before - now));
        mass += film.system.model.mass[node] * moved.norm_squared();
    }
    // A negative quotient belongs to a motion that still accelerates: no damping then.
    if mass > 0.0 { (stiffness / mass).max(0.0).sqrt() } else { 0.0 }
}
