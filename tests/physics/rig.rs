//! Pistons without a capsule.

use billow_solver::models;
use billow_solver::models::piston::VolumeLaw;
use billow_solver::scene::paper;

use crate::prelude::*;

pub fn adaptive(tolerance: f64) -> Control {
    Control { stepping: Stepping::Adaptive(tolerance), step_limit: 10_000_000 }
}

pub fn fixed(step: f64) -> Control {
    Control { stepping: Stepping::Fixed(step), step_limit: 10_000_000 }
}

/// A piston on V = A z + V0 without an end.
pub fn tube(area: f64, offset: f64, mass: f64, gas: Gas) -> Piston {
    let volume = VolumeLaw::Uniform { area, offset };
    let (first_moment, weight, film_weight) = (mass, 0.0, 0.0);
    Piston { volume, mass, weight, first_moment, film_weight, end: EndFilm::none(), gas }
}

/// The paper's capsule without gas at n 5, for half a second.
pub fn paper_scene() -> Scene {
    paper::empty_capsule(5, 0.5)
}

pub fn run(scene: &Scene) -> Deployment {
    models::solve(InstructionSet::detect(), scene, &mut Unobserved).expect("a valid scene")
}
