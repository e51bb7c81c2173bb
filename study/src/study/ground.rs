//! Gas inside a stowed capsule under ambient pressure.

use billow_solver::geometry::fold::FoldPattern;
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::geometry::shell::Shell;
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{Design, GasSupply, Scene};

use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Volume of the stowed capsule of a design, m³: the same on every mesh, because facets are flat; of film from a mesh its
/// volume at the start. `None` for a design without a pattern.
pub(super) fn stowed_volume(design: &Design) -> Option<f64> {
    let design = match design {
        Design::Capsule(design) => design,
        Design::Mesh(design) => {
            let shell = &design.film.shell;
            return Some(shell.volume(|node| shell.positions[node as usize]));
        }
    };
    let pattern = FoldPattern::new(design).ok()?;
    let shell = Shell::of_mesh(&Mesh::new(&pattern, 1, Shape::Stowed(design.stowed_height)).ok()?);
    Some(shell.volume(|node| shell.positions[node as usize]))
}

/// Pressure (Pa) of a mass of gas inside a stowed capsule, at film temperature.
fn pressure(scene: &Scene, mass: f64, stowed_volume: f64) -> f64 {
    mass * scene.gas.species.gas_constant * scene.film.temperature / stowed_volume
}

/// Pressure (Pa) inside a stowed capsule just before its release, at film temperature.
pub(super) fn pressure_at_release(scene: &Scene, stowed_volume: f64) -> f64 {
    let gas = &scene.gas;
    let mass = gas.initial_mass + Schedule::new(&gas.windows).mass_until(scene.release_time);
    pressure(scene, mass, stowed_volume)
}

/// Mass (kg) of gas that fills the stowed capsule at ambient pressure and film temperature.
pub(super) fn mass_at_ambient_pressure(
    design: &Design,
    settings: &Settings,
    residual_mass: f64,
    source: &Source,
) -> Result<f64, InputError> {
    if residual_mass > 0.0 {
        return Err(source.error(
            "gas.residual_gas_mass",
            shown(residual_mass),
            "is given beside residual_gas ambient, which follows from gas.ambient_pressure",
            "one of the two; residual_gas stored for a given mass",
        ));
    }
    let gas_constant = settings.species(source)?.gas_constant;
    // A design without a pattern is infeasible, whatever gas it has.
    let volume = stowed_volume(design).unwrap_or(0.0);
    let temperature = settings.needed("film.temperature", source)?;
    let pressure = settings.needed("gas.ambient_pressure", source)?;
    Ok(pressure * volume / (gas_constant * temperature))
}

/// Refuses ambient pressure on a capsule without any gas inside: it would implode.
pub(super) fn check_gas_inside(gas: &GasSupply, source: &Source) -> Result<(), InputError> {
    if gas.ambient_pressure <= 0.0 || gas.initial_mass > 0.0 {
        return Ok(());
    }
    Err(source.error(
        "gas.ambient_pressure",
        shown(gas.ambient_pressure),
        "presses on a stowed capsule without gas inside, which implodes",
        "gas inside from the start, or 0 (orbit)",
    ).with_hint("store air: \"residual_gas\": \"ambient\" fills the folds at ambient pressure; \"stored\" takes a \
     residual_gas_mass"))
}

/// Pressure of the stored gas over the ambient pressure below which a note says so. Chosen: a little less gas
/// than ambient pressure holds back is common, half is a mistake or a question of its own.
const MIN_PRESSURE_RATIO: f64 = 0.9;

/// The pressure (Pa) inside a stowed capsule at the start, where ambient pressure exceeds it by more than a
/// tenth.
pub(crate) fn pressure_below_ambient(scene: &Scene) -> Option<f64> {
    let ambient = scene.gas.ambient_pressure;
    if ambient <= 0.0 {
        return None;
    }
    let pressure = pressure(scene, scene.gas.initial_mass, stowed_volume(&scene.design)?);
    (pressure < MIN_PRESSURE_RATIO * ambient).then_some(pressure)
}
