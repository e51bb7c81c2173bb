//! Strips at rest: the start of a run, and the static shapes with which it is compared.
//!
//! ```text
//! v ← d (v + Δt f/m)         until the height is constant
//! start     heights held, no gas: folds relax until the smooth shape is free of stress
//! static    from the erected shape under a fixed overpressure, without gravity
//! ```
//!
//! Mean radii and turns of a folded line do not fit a smooth shape exactly; the rings then turn and shrink a
//! little. The film has no loss here.

use nalgebra::Vector3;

use super::kernel::{ElementState, ForceStep, Kick, Nodes, advance, set_forces, volume};
use super::strip::{Place, Strip, erected, stowed};
use crate::geometry::fold::FoldPattern;
use crate::output::measures::StaticShape;
use crate::platform::simd::{InstructionSet, Lanes};
use crate::scene::Film;

/// Factor of the velocities in a step, d. Chosen: waves along an element die within it, and the shape still
/// moves.
const KEPT_VELOCITY: f64 = 0.98;
/// Step over the stable step. Chosen.
const STEP_FRACTION: f64 = 0.5;
/// Steps of the start. Chosen: with half as many its volume changes by less than 1e-4.
const START_STEPS: u32 = 3000;
/// Steps between two looks at the height. Chosen.
const LOOK_STEPS: u32 = 500;
/// Looks at most. Chosen: ten times what the paper's capsule needs.
const MAX_LOOKS: u32 = 200;
/// Largest relative change of the height between two looks at rest. Chosen: far below the 0.1 % of the
/// film's static states.
const MAX_CHANGE: f64 = 1e-6;

/// Positions of strips around the axis, m.
fn around(places: &[Place]) -> Nodes {
    places
        .iter()
        .map(|place| {
            let mut node = [Lanes::default(); 3];
            for strip in 0..super::STRIPS {
                let angle = core::f64::consts::TAU * strip as f64 / super::STRIPS as f64;
                let x: Vector3<f64> = place.position(angle);
                for (lanes, value) in node.iter_mut().zip(x.iter()) {
                    lanes.0[strip] = *value;
                }
            }
            node
        })
        .collect()
}

/// A damped motion of strips.
struct Rest<'a> {
    strip: &'a Strip,
    instruction_set: InstructionSet,
    overpressure: f64,
    level: bool,
    positions: Nodes,
    velocities: Nodes,
    forces: Nodes,
    states: Vec<ElementState>,
}

impl<'a> Rest<'a> {
    fn new(strip: &'a Strip, instruction_set: InstructionSet, places: &[Place]) -> Self {
        let still = vec![[Lanes::default(); 3]; places.len()];
        Self {
            strip,
            instruction_set,
            overpressure: 0.0,
            level: false,
            positions: around(places),
            velocities: still.clone(),
            forces: still,
            states: vec![ElementState::default(); strip.elements.len()],
        }
    }

    fn steps(&mut self, count: u32) {
        let step = STEP_FRACTION * self.strip.stable_step;
        let kick = Kick {
            velocity_step: step,
            drift: step,
            gravity: 0.0,
            keep: KEPT_VELOCITY,
            level: self.level,
        };
        let load = ForceStep { length: 0.0, overpressure: self.overpressure, creep_share: 0.0 };
        for _ in 0..count {
            let (strip, set) = (self.strip, self.instruction_set);
            set_forces(set, strip, &self.positions, load, &mut self.states, &mut self.forces);
            advance(set, strip, &self.forces, kick, &mut self.positions, &mut self.velocities);
        }
    }

    fn height(&self) -> f64 {
        self.positions[self.strip.top_ring][2].0[0]
    }
}

/// Positions of the stowed strips at rest, m.
pub(super) fn start(instruction_set: InstructionSet, pattern: &FoldPattern, film: &Film) -> Nodes {
    let strip = Strip::new(pattern, &film.elastic(), 0.0);
    let mut rest = Rest::new(&strip, instruction_set, &stowed(pattern));
    rest.level = true;
    rest.steps(START_STEPS);
    rest.positions
}

/// The static shape at an overpressure (Pa); `None` if the strips do not come to rest.
pub(super) fn static_shape(
    instruction_set: InstructionSet,
    pattern: &FoldPattern,
    film: &Film,
    overpressure: f64,
) -> Option<StaticShape> {
    let strip = Strip::new(pattern, &film.elastic(), 0.0);
    let mut rest = Rest::new(&strip, instruction_set, &erected(pattern));
    rest.overpressure = overpressure;
    let mut last = rest.height();
    for _ in 0..MAX_LOOKS {
        rest.steps(LOOK_STEPS);
        let height = rest.height();
        if (height - last).abs() <= MAX_CHANGE * height {
            let volume = volume(instruction_set, &strip, &rest.positions);
            return Some(StaticShape { overpressure, volume, height });
        }
        last = height;
    }
    None
}
