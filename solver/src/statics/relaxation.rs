//! Static states by damped motion: slow and sure.
//!
//! ```text
//! m a = f − c m v,   c = 2 ω          until kinetic energy < share · p V
//! ω² = Σ Δx·Δr / Σ m Δx²              r = −f; the frequency the motion has now
//! ```
//!
//! The frequency is Rayleigh's quotient of the last stretch of motion (P. Underwood, "Dynamic
//! relaxation", 1983).

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::integrators::explicit::{Explicit, PressureLoad};
use crate::output::outcome::Failure;
use crate::scene::timeline::Phase;

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
        film.setting.interior = PressureLoad::Overpressure(overpressure);
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
