//! Builds the piston of a scene.

use super::end_film::END_DAMPING_RATIO;
use super::{EndFilm, MovingMass, Piston, PistonRun, PistonState, Stroke, VolumeLaw};
use crate::geometry::fold::FoldPattern;
use crate::integrators::dormand_prince::Control;
use crate::mechanics::gas::Gas;
use crate::scene::error::SceneError;
use crate::scene::{Scene, SupportLocation};

/// Checks the supports: the bottom is held along z and the top is free along z.
pub(super) fn check_supports(scene: &Scene) -> Result<(), SceneError> {
    let mut bottom_held = false;
    for (index, support) in scene.supports.iter().enumerate() {
        let along_z = support.fix.contains('z');
        match support.on {
            SupportLocation::BottomRing | SupportLocation::BottomCap => bottom_held |= along_z,
            SupportLocation::TopRing | SupportLocation::TopCap if along_z => {
                return Err(SceneError::invalid(
                    format!("supports[{index}].fix"),
                    "model `piston` moves the top along z, so a support cannot hold it along z; \
                     allowed there: letters of \"xy\"",
                ));
            }
            SupportLocation::TopRing | SupportLocation::TopCap => {}
        }
    }
    if bottom_held {
        return Ok(());
    }
    Err(SceneError::invalid(
        "supports",
        "model `piston` needs a fixed bottom; allowed: at least one support on bottom_ring or \
         bottom_cap that fixes z",
    ))
}

/// The piston of a valid scene, stowed, with its gas at time 0.
pub(super) fn build(scene: &Scene, pattern: &FoldPattern) -> Result<PistonRun, SceneError> {
    let film = &scene.film;
    let mass = MovingMass::new(pattern, film.area_density());
    let stowed_height = pattern.design.stowed_height;
    let stowed = (stowed_height, pattern.stowed_volume(stowed_height));
    let erected = (pattern.height, pattern.erected_volume());
    let stroke = Stroke::new(stowed, erected)
        .map_err(|problem| SceneError::invalid("design.stowed_height", problem))?;
    let end = EndFilm::of_cone(
        (pattern.bottom_radius, pattern.top_radius),
        pattern.height,
        (film.youngs_modulus, film.thickness),
        END_DAMPING_RATIO,
        mass.effective,
    );
    let gas = Gas::new(&scene.gas, film.temperature, mass.area);
    let start = PistonState {
        height: stowed_height,
        speed: 0.0,
        gas: gas.at_temperature(scene.gas.initial_mass, film.temperature),
    };
    let piston = Piston {
        volume: VolumeLaw::Stroke(stroke),
        mass: mass.effective,
        weight: scene.gravity * mass.first_moment,
        first_moment: mass.first_moment,
        film_weight: scene.gravity * mass.total,
        end,
        gas,
    };
    let control = Control { stepping: scene.solver.stepping, step_limit: scene.solver.step_limit };
    Ok(PistonRun::new(piston, 0.0, start, control))
}
