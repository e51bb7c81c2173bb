//! The paper's stowed capsule with contact, for film and for the models without film.

use billow_solver::geometry::mesh::Shape;
use billow_solver::models::film::Rings;
use billow_solver::scene::monitor_settings::MonitorSettings;

use super::film::prepared;
use super::{
    CONTACT_STIFFNESS, MODULUS, Parameter, Prepared, STEP, StabilityScene, THICKNESS, Values,
    compression, parameter,
};
use crate::cases::prelude::*;
use crate::stability::Method;

/// Simulated time, s. Chosen: the stack rises and unfolds in it.
const END: f64 = 0.05;
/// Time at which a burst begins, s.
const BURST_START: f64 = 1e-3;
/// Steps that a model without film may take.
const MODEL_STEPS: u64 = 2_000_000;

/// Numerical damping as a capsule has it.
const DAMPING: Parameter = Parameter { default: paper::NUMERICAL_DAMPING, ..super::DAMPING };

/// The capsule.
pub(super) const SCENE: StabilityScene = StabilityScene {
    name: "capsule",
    meaning: "the paper's stowed capsule with contact, 50 ms, every step monitored",
    parameters: &[
        STEP,
        DAMPING,
        compression(0.0),
        THICKNESS,
        MODULUS,
        CONTACT_STIFFNESS,
        parameter("subdivisions", 2.0, "number", "design.subdivisions"),
        parameter("stowed_height", paper::STOWED_HEIGHT, "m", "design.stowed_height"),
        parameter("mass_flow_rate", paper::MASS_FLOW_RATE, "kg/s", "inflow from 0 to the end"),
        parameter("residual_mass", 0.0, "kg", "mass of the gas at the start"),
        parameter("burst", 0.0, "s", "length of a burst; 0: none"),
        parameter("burst_mass", 1e-4, "kg", "mass of the burst"),
        parameter("fixed_step", 0.0, "s", "fixed step of the model piston; 0: adaptive"),
    ],
    runs: |method| method != Method::Statics,
    prepare,
};

/// The scene as data, without its method.
fn scene(values: &Values) -> Scene {
    let subdivisions = values.count("subdivisions");
    let mut scene = paper::empty_capsule(subdivisions, END);
    if let Ok(design) = scene.design.folded_mut() {
        design.stowed_height = values.get("stowed_height");
    }
    scene.film = values.film();
    scene.gas.initial_mass = values.get("residual_mass");
    let rate = values.get("mass_flow_rate");
    if rate > 0.0 {
        scene.gas.windows.push(window(0.0, END, rate));
    }
    let burst = values.get("burst");
    if burst > 0.0 {
        let rate = values.get("burst_mass") / burst;
        scene.gas.windows.push(window(BURST_START, BURST_START + burst, rate));
    }
    scene.outputs.sample_interval = END / 40.0;
    scene
}

fn prepare(rig: &Rig, method: Method, values: &Values) -> Result<Prepared> {
    let mut scene = scene(values);
    let step = values.get("step");
    if !method.is_film() {
        let fixed = values.get("fixed_step");
        (scene.solver.model, scene.solver.stepping) = match method {
            Method::Storeys => (ModelKind::Storeys, Stepping::Stable(step)),
            _ if fixed > 0.0 => (ModelKind::Piston, Stepping::Fixed(fixed)),
            _ => (ModelKind::Piston, scene.solver.stepping),
        };
        scene.solver.step_limit = MODEL_STEPS;
        return Ok(Prepared::Model(Box::new(scene)));
    }
    scene.solver.model = ModelKind::Film;
    // The step of the values is set later: a scene has a CFL number of its range.
    let (height, cfl) = (scene.design.folded()?.stowed_height, step.min(1.0));
    scene.solver.stepping = Stepping::Stable(cfl);
    let stowed = Shape::Stowed(height);
    let (film, mesh) = capsule::film_scene(rig.instruction_set, &scene, stowed, cfl)?;
    let monitor = MonitorSettings::EVERY_STEP;
    let contact = FilmContact { monitor, ..FilmContact::of(&scene.contact) };
    let contact = capsule::resolved_contact(contact, scene.design.folded()?)?;
    let film = FilmScene { contact: Some(contact), ..film };
    prepared(rig, film, method, values, &[], Some(Rings::of(&mesh, height)), None)
}
