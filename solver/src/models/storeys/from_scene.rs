//! Builds the storeys of a scene.
//!
//! ```text
//! Δz = a s z/h        s in [−1, 1) for each strip, from the seed
//! ```
//!
//! a is the scene's amplitude of the imperfection, or [`AMPLITUDE_FRACTION`] of the stowed height h. Strips
//! that start alike would move alike. Seed 0 draws numbers too: film of seed 0 has no imperfection,
//! but its panels part from each other all the same.

use super::kernel::Nodes;
use super::motion::Constants;
use super::rest;
use super::strip::Strip;
use super::{STRIPS, StoreysRun, UNRESOLVED_LOSS};
use crate::geometry::fold::{Caps, FoldPattern};
use crate::mechanics::gas::Gas;
use crate::platform::random::{hash, unit};
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::{Scene, Stepping, SupportLocation};

/// Default amplitude over the stowed height. Chosen: that of the film on the paper's capsule, 0.158 of 40 mm.
const AMPLITUDE_FRACTION: f64 = 4e-3;

/// Checks a scene, its stepping and its supports for this model.
pub(in crate::models) fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.validate()?;
    if !matches!(scene.solver.stepping, Stepping::Stable(_)) {
        let problem = "model `storeys` takes a fraction of its stable step; allowed: a CFL number";
        return Err(SceneError::invalid("solver.stepping", problem));
    }
    if scene.design.folded()?.caps != Caps::Polygon {
        let problem = "model `storeys` starts folded; allowed: polygon caps";
        return Err(SceneError::invalid("design.caps", problem));
    }
    let mut held = false;
    for (index, support) in scene.supports.iter().enumerate() {
        let all = "xyz".chars().all(|axis| support.fix.contains(axis));
        if support.on != SupportLocation::BottomRing || !all {
            let problem = "model `storeys` holds its whole bottom ring and nothing else; allowed: \
                           bottom_ring with \"xyz\"";
            return Err(SceneError::invalid(format!("supports[{index}]"), problem));
        }
        held = true;
    }
    if held {
        return Ok(());
    }
    let problem = "model `storeys` needs a fixed bottom; allowed: a support on bottom_ring that \
                   fixes \"xyz\"";
    Err(SceneError::invalid("supports", problem))
}

/// The storeys of a checked scene, stowed, with their gas at time 0.
pub(super) fn build(
    instruction_set: InstructionSet,
    scene: &Scene,
    pattern: &FoldPattern,
) -> StoreysRun {
    let film = scene.film;
    let mut positions = rest::start(instruction_set, pattern, &film);
    let amplitude =
        scene.imperfection_amplitude.unwrap_or(AMPLITUDE_FRACTION * pattern.design.stowed_height);
    perturb(&mut positions, amplitude / pattern.design.stowed_height, scene.seed);
    let gas = Gas::new(&scene.gas, film.temperature, pattern.film_area());
    let state = gas.at_temperature(scene.gas.initial_mass, film.temperature);
    let cfl = match scene.solver.stepping {
        Stepping::Stable(cfl) => cfl,
        Stepping::Adaptive(_) | Stepping::Fixed(_) => 1.0,
    };
    let constants = Constants {
        strip: Strip::new(pattern, &film, UNRESOLVED_LOSS),
        gas,
        pattern: pattern.clone(),
        film,
        gravity: scene.gravity,
        cfl,
        step_limit: scene.solver.step_limit,
        instruction_set,
    };
    StoreysRun::new(constants, positions, state)
}

/// Stretches each strip along z by its own share of `fraction`.
fn perturb(positions: &mut Nodes, fraction: f64, seed: u64) {
    let draw = |strip: u64| unit(hash(seed, strip + 1));
    let factors: [f64; STRIPS] =
        core::array::from_fn(|strip| 1.0 + fraction * (2.0 * draw(strip as u64) - 1.0));
    for [_, _, z] in positions {
        for (value, factor) in z.0.iter_mut().zip(factors) {
            *value *= factor;
        }
    }
}
