//! What the air around a film does that no model has: it carries the film, and moves with it.
//!
//! ```text
//! lift of the air over the weight of the film    |ρ_a − ρ_g| V/m        ρ_a air, ρ_g gas inside, both at ambient pressure
//! mass of the air that moves over that of film   ρ_a λ A/(π m)          λ = ∛V, length of the motion
//! ```
//! Source: a plate whose motion has the wavelength λ carries ρ λ/(2 π) of fluid on each side (H. Lamb, "Hydrodynamics",
//! 1932, 228); here it is air on both sides, as long as the gas inside is as dense.

use billow_solver::scene::{Design, Film, GasSupply, Scene};

use super::point::Solved;
use crate::input::value::brief_number;

/// Specific gas constant of dry air, J/(kg K).
const AIR_GAS_CONSTANT: f64 = 287.055;
/// Lift over the weight of the film above which a scene is refused. Chosen: gravity is then wrong by a quarter.
const MAX_LIFT: f64 = 0.25;
/// Lift and moved mass, over the film's, from which a note says so. Chosen: less is below other errors.
const MIN_NOTED: f64 = 0.02;

/// A film and the air around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Lift of the air less the weight of the gas over the weight of the film; 0 without gravity.
    pub lift: f64,
    /// Mass of the air that moves with the film over the mass of the film.
    pub moved_mass: f64,
}

impl Surroundings {
    /// Those of a film of this area (m²) and volume (m³). `gravity`: whether there is any.
    pub fn new(film: &Film, gas: &GasSupply, [area, volume]: [f64; 2], gravity: bool) -> Self {
        let mass = film.density * film.thickness * area;
        let density = |gas_constant| gas.ambient_pressure / (gas_constant * film.temperature);
        let (air, inside) = (density(AIR_GAS_CONSTANT), density(gas.species.gas_constant));
        let lift = if gravity { (air - inside).abs() * volume / mass } else { 0.0 };
        let moved_mass = air * libm::cbrt(volume) * area / (core::f64::consts::PI * mass);
        Self { lift, moved_mass }
    }

    /// Those of an erected capsule, a cone with flat ends, or of other film, with the volume of a sphere of its area, which
    /// is the largest. `None` for a capsule without a pattern.
    pub fn of_scene(scene: &Scene, solved: Option<&Solved>) -> Option<Self> {
        let (area, volume) = match &scene.design {
            Design::Capsule(design) => of_cone(design.bottom_radius, solved?),
            Design::Mesh(design) => of_sphere(design.film.shell.reference_area()),
        };
        Some(Self::new(&scene.film, &scene.gas, [area, volume], scene.gravity != 0.0))
    }

    /// Why these scenes are not computed.
    pub fn refusal(&self) -> Option<String> {
        (self.lift > MAX_LIFT).then(|| {
            format!(
                "and gas.ambient_pressure together need buoyancy, which no model has: air outside and gas inside differ by {} \
                 times the weight of the film",
                brief_number(self.lift)
            )
        })
    }

    /// What is allowed instead.
    pub const ALLOWED: &'static str =
        "gravity 0, or gas.ambient_pressure 0, or a gas about as dense as air (nitrogen, air)";

    /// What is left out and can be seen in results.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.lift > MIN_NOTED {
            notes.push(format!(
                "no buoyancy: the air outside would carry {} of the weight of the film",
                brief_number(self.lift)
            ));
        }
        if self.moved_mass > MIN_NOTED {
            notes.push(format!(
                "no added mass and no drag: air of {} times the mass of the film would move with it, so times of \
                 fast motion are too short and speeds too high",
                brief_number(self.moved_mass)
            ));
        }
        notes
    }
}

/// Area (m²) and volume (m³) of an erected capsule with this bottom radius, m.
fn of_cone(r: f64, solved: &Solved) -> (f64, f64) {
    let (top, h) = (solved.top_radius, solved.height);
    let side = libm::sqrt(h * h + (r - top) * (r - top));
    let area = core::f64::consts::PI * ((r + top) * side + r * r + top * top);
    (area, solved.erected_volume)
}

/// Area (m²) and volume (m³) of a sphere of this area.
pub fn of_sphere(area: f64) -> (f64, f64) {
    (area, area * libm::sqrt(area) / (6.0 * libm::sqrt(core::f64::consts::PI)))
}

#[cfg(test)]
mod tests {
    use billow_solver::scene::paper;

    use super::*;

    #[test]
    fn what_air_does_is_noted_or_refused_by_its_size() {
        let mut scene = paper::empty_capsule(1, 1.0);
        let solved = Solved::of(&scene.design.pattern().unwrap());
        // Ambient pressure, gravity, gas constant of the gas: lift and moved mass, over the film's.
        for (pressure, gravity, gas, lift, moved, refused, notes) in [
            (0.0, 0.0, 296.8, 0.0, 0.0, false, 0),
            (0.0, -9.81, 296.8, 0.0, 0.0, false, 0),
            (101_325.0, 0.0, 296.8, 0.0, 9.1, false, 1),
            (101_325.0, -9.81, 296.8, 0.17, 9.1, false, 2),
            (101_325.0, -9.81, AIR_GAS_CONSTANT, 0.0, 9.1, false, 1),
            (101_325.0, 9.81, 2077.0, 4.5, 9.1, true, 2),
            (101_325.0, 0.0, 2077.0, 0.0, 9.1, false, 1),
            (101_325.0, -9.81, 188.9, 2.7, 9.1, true, 2),
            (1000.0, -9.81, 2077.0, 0.044, 0.09, false, 2),
            (100.0, -9.81, 2077.0, 0.0044, 0.009, false, 0),
        ] {
            scene.gas.ambient_pressure = pressure;
            scene.gravity = gravity;
            scene.gas.species.gas_constant = gas;
            let found = Surroundings::of_scene(&scene, Some(&solved)).unwrap();
            assert!((found.lift - lift).abs() <= 0.05 * lift, "{found:?}");
            assert!((found.moved_mass - moved).abs() <= 0.05 * moved, "{found:?}");
            assert_eq!(found.refusal().is_some(), refused, "{found:?}");
            assert_eq!(found.notes().len(), notes, "{found:?}");
        }
    }
}
