//! A closed bag of film that gas fills, without contact.

use billow_solver::geometry::shapes::{icosphere, moved};
use billow_solver::scene::GasSupply;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::{TEMPERATURE, free_film, nitrogen_supply, window};
use nalgebra::Vector3;

use super::film::{Parts, prepared, stable_step};
use super::{
    DAMPING, MODULUS, Prepared, Runs, STEP, StabilityScene, THICKNESS, Values, compression, real,
    whole,
};
use crate::cases::Rig;
use crate::stability::Method;

/// Radius of the erected bag, m.
const RADIUS: f64 = 0.2;
/// Simulated time, s. Chosen: the flat bag becomes round in it.
const END: f64 = 0.02;
/// Time at which a burst begins, s.
const BURST_START: f64 = 1e-3;

/// The bag.
pub const SCENE: StabilityScene = StabilityScene {
    name: "bag",
    meaning: "a bag (icosphere of 0.2 m) that gas fills for 20 ms, without contact",
    parameters: &[
        STEP,
        DAMPING,
        compression(0.0),
        THICKNESS,
        MODULUS,
        whole("level", 1.0, [0.0, 3.0], "refinements of the icosahedron"),
        real("flatness", 0.3, [0.0, 1.0], "ratio", "height at the start over that of the sphere"),
        real("mass_flow_rate", 5e-3, [0.0, 1e3], "kg/s", "inflow from 0 to the end"),
        real("residual_pressure", 1.0, [0.0, 1e9], "Pa", "pressure of the gas at the start"),
        real("burst_steps", 0.0, [0.0, 1e3], "stable steps", "length of a burst; 0: none"),
        real("burst_mass", 1e-4, [0.0, 1.0], "kg", "mass of the burst"),
    ],
    runs: Runs::Film,
    build,
};

fn build(rig: &Rig, method: Method, values: &Values) -> Result<Prepared, String> {
    let Method::Film(kind) = method else { return Err("film only".to_owned()) };
    let level = values.count("level");
    let flatness = values.get("flatness");
    // The reference of the film is the sphere.
    let shell = moved(icosphere(level, RADIUS), |x| Vector3::new(x.x, x.y, x.z * flatness));
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let nitrogen = nitrogen_supply();
    let mass = values.get("residual_pressure") * volume.max(0.0)
        / (nitrogen.species.gas_constant * TEMPERATURE);
    let rate = values.get("mass_flow_rate");
    let windows = if rate > 0.0 { vec![window(0.0, END, rate)] } else { Vec::new() };
    let supply = GasSupply { initial_mass: mass, windows, ..nitrogen };
    let filling = Filling::Gas { supply, initial_temperature: TEMPERATURE };
    let mut scene = FilmScene { filling, ..free_film(shell, values.film()) };
    scene.solver.end_time = END;
    let steps = values.get("burst_steps");
    if steps > 0.0 {
        let length = steps * stable_step(rig, &scene)?;
        let burst = window(BURST_START, BURST_START + length, values.get("burst_mass") / length);
        if let Filling::Gas { supply, .. } = &mut scene.filling {
            supply.windows.push(burst);
        }
    }
    let (run, timeline) = prepared(rig, scene, kind, values, Parts::default())?;
    Ok(Prepared::Film(Box::new(run), timeline, None))
}
