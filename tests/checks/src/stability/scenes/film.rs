//! Scenes of free film with a step of any length: a sheet, a bag, two sheets that collide.
//!
//! ```text
//! sheet: small motion in its plane, linear:  Δt = 2/ω_max (√(1+ζ²) − ζ)
//!        ω_max²: largest eigenvalue of M⁻¹K, by power iteration; K from differences of the forces
//! ```

use billow_solver::geometry::field::Field;
use billow_solver::integrators::SimulationSettings;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::forces::membrane::{
    ElementHistory, NodeForces, assemble_conservative,
};
use billow_solver::models::film::Rings;
use billow_solver::scene::paper::TEMPERATURE;

use super::{
    CONTACT_STIFFNESS, DAMPING, MODULUS, Parameter, Prepared, STEP, StabilityScene, THICKNESS,
    Values, compression, parameter,
};
use crate::cases::prelude::*;
use crate::stability::Method;

/// Samples of a run.
const SAMPLES: f64 = 40.0;
/// Steps that a run may take over those of its length at the step asked for. Chosen: no method that works
/// needs more.
const MAX_STEPS: f64 = 50.0;
/// Most steps of any run. Chosen: minutes of a small scene.
const MOST_STEPS: u64 = 10_000_000;
/// Width of the sheet, m, and its height where elements are well shaped.
const SIZE: [f64; 2] = [0.2, 0.15];
/// Speed of its motion, m/s. Chosen: strains of 1e-6, far above rounding and far below what is not linear.
const SPEED: f64 = 1e-3;
/// Amplitude of the differences that give its stiffness, m. Chosen: strains of 1e-6, as [`SPEED`].
const AMPLITUDE: f64 = 1e-7;
/// Steps of its run. Chosen: a step 0.1 % too long multiplies the motion by 1e100.
const STEPS: f64 = 3000.0;
/// Radius of the erected bag, m.
const RADIUS: f64 = 0.2;
/// Simulated time of the bag, s. Chosen: the flat bag becomes round in it.
const BAG_END: f64 = 0.02;
/// Time at which a burst begins, s.
const BURST_START: f64 = 1e-3;
/// Contact distance of the two sheets, m.
const DISTANCE: f64 = 2e-3;
/// Simulated time of the two sheets, s.
const FILMS_END: f64 = 4e-3;

/// The modulus of one of two parts of film over that of the other one. Not above 1: the stiff part bounds the step.
const fn soft(meaning: &'static str) -> Parameter {
    parameter("soft", 1.0, "ratio", meaning)
}

/// The sheet.
pub(super) const SHEET: StabilityScene = StabilityScene {
    name: "sheet",
    meaning: "a free uneven sheet of 24 elements in small motion, 3000 steps",
    parameters: &[
        STEP,
        DAMPING,
        compression(1.0),
        THICKNESS,
        MODULUS,
        parameter("sliver", 1.0, "ratio", "height of the elements over that of well-shaped ones"),
        parameter(
            "slack",
            0.0,
            "ratio",
            "share by which the sheet starts shortened in both directions",
        ),
        soft("modulus of the left half of the sheet over that of the right half"),
    ],
    runs: Method::is_film,
    prepare: free_sheet,
};

/// The bag.
pub(super) const BAG: StabilityScene = StabilityScene {
    name: "bag",
    meaning: "a bag (icosphere of 0.2 m) that gas fills for 20 ms, without contact",
    parameters: &[
        STEP,
        DAMPING,
        compression(0.0),
        THICKNESS,
        MODULUS,
        parameter("level", 1.0, "number", "refinements of the icosahedron"),
        parameter("flatness", 0.3, "ratio", "height at the start over that of the sphere"),
        parameter("mass_flow_rate", 5e-3, "kg/s", "inflow from 0 to the end"),
        parameter("residual_pressure", 1.0, "Pa", "pressure of the gas at the start"),
        parameter("burst_steps", 0.0, "stable steps", "length of a burst; 0: none"),
        parameter("burst_mass", 1e-4, "kg", "mass of the burst"),
    ],
    runs: Method::is_film,
    prepare: filled_bag,
};

/// Two sheets that collide, every step monitored.
pub(super) const FILMS: StabilityScene = StabilityScene {
    name: "films",
    meaning: "two free sheets of 24 elements that collide, 4 ms, every step monitored",
    parameters: &[
        STEP,
        DAMPING,
        compression(0.0),
        THICKNESS,
        MODULUS,
        CONTACT_STIFFNESS,
        parameter("speed", 5.0, "m/s", "speed of approach"),
        parameter(
            "gap",
            2.0,
            "contact distances",
            "gap at the start; the contact distance is 2 mm; 0: facets coincide",
        ),
        soft("modulus of the upper sheet over that of the lower one"),
    ],
    runs: Method::is_film,
    prepare: colliding_sheets,
};

fn free_sheet(rig: &Rig, method: Method, values: &Values) -> Result<Prepared> {
    let film = values.film();
    let flat = sheet(4, 3, SIZE[0], SIZE[1] * values.get("sliver"));
    let soft = values.get("soft");
    let left = |triangle: &[u32; 3]| {
        let x = triangle.map(|node| flat.positions[node as usize].x);
        x.iter().sum::<f64>() < 1.5 * SIZE[0]
    };
    let factors: Vec<f64> =
        flat.triangles.iter().map(|triangle| if left(triangle) { soft } else { 1.0 }).collect();
    let model = FilmModel::of_shell(&film, &flat)?.with_stiffness(&factors);
    let (compression, slack) = (film.compression, values.get("slack"));
    let linear = compression.to_bits() == 1.0_f64.to_bits() && slack.to_bits() == 0;
    let omega = linear.then(|| fastest_mode(rig, &flat, &model));
    let shell = moved(flat, |x| x * (1.0 - slack));
    let kick = |kick: &Vector3<f64>| Vector3::new(kick.x, kick.y, 0.0) * SPEED;
    let velocities = pseudo_random(shell.positions.len(), 4).iter().map(kick).collect();
    let mut scene = FilmScene { velocities, ..free_film(shell, film) };
    scene.solver.end_time = STEPS * values.get("step") * stable_step(rig, &scene)?;
    prepared(rig, scene, method, values, &factors, None, omega)
}

/// ω of the fastest mode in the plane of flat film at rest, rad/s.
fn fastest_mode(rig: &Rig, shell: &Shell, model: &FilmModel) -> f64 {
    let force = |mode: &[Vector3<f64>], amplitude: f64| {
        let moved = shell.positions.iter().zip(mode).map(|(x, mode)| x + mode * amplitude);
        let positions = Field::of(&moved.collect::<Vec<_>>());
        let (histories, mut nodes) = (&mut ElementHistory::zero(model), NodeForces::new(model));
        assemble_conservative(rig.instruction_set, model, &positions, &[], histories, &mut nodes);
        nodes.films()
    };
    let norm = |mode: &[Vector3<f64>]| mode.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    let (mut mode, mut value) = (pseudo_random(shell.positions.len(), 1), 0.0);
    for _ in 0..4000 {
        let scale = norm(&mode);
        mode = mode.iter().map(|x| Vector3::new(x.x, x.y, 0.0) / scale).collect();
        let (low, high) = (force(&mode, -AMPLITUDE), force(&mode, AMPLITUDE));
        let next = low.iter().zip(high.iter()).zip(&model.mass);
        mode = next.map(|((low, high), mass)| (low - high) / (2.0 * AMPLITUDE * mass)).collect();
        value = norm(&mode);
    }
    value.sqrt()
}

/// The shell of a bag, flattened. The reference of its film is the sphere.
pub(super) fn flattened_bag(values: &Values) -> Shell {
    let flatness = values.get("flatness");
    let flattened = |x: Vector3<f64>| Vector3::new(x.x, x.y, x.z * flatness);
    moved(icosphere(values.count("level"), RADIUS), flattened)
}

fn filled_bag(rig: &Rig, method: Method, values: &Values) -> Result<Prepared> {
    let shell = flattened_bag(values);
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let nitrogen = nitrogen_supply();
    let mass = values.get("residual_pressure") * volume.max(0.0)
        / (nitrogen.species.gas_constant * TEMPERATURE);
    let rate = values.get("mass_flow_rate");
    let windows = if rate > 0.0 { vec![window(0.0, BAG_END, rate)] } else { Vec::new() };
    let supply = GasSupply { initial_mass: mass, windows, ..nitrogen };
    let filling = Filling::Gas { supply, initial_temperature: TEMPERATURE };
    let mut scene = FilmScene { filling, ..free_film(shell, values.film()) };
    scene.solver.end_time = BAG_END;
    let steps = values.get("burst_steps");
    if steps > 0.0 {
        let length = steps * stable_step(rig, &scene)?;
        let burst = window(BURST_START, BURST_START + length, values.get("burst_mass") / length);
        if let Filling::Gas { supply, .. } = &mut scene.filling {
            supply.windows.push(burst);
        }
    }
    prepared(rig, scene, method, values, &[], None, None)
}

fn colliding_sheets(rig: &Rig, method: Method, values: &Values) -> Result<Prepared> {
    let low = sheet(4, 3, 0.2, 0.15);
    let (nodes, elements) = (low.positions.len(), low.triangles.len());
    let rise = Vector3::z() * (values.get("gap") * DISTANCE);
    let high = moved(sheet(4, 3, 0.2, 0.15), |x| x + rise);
    let high = Shell::relaxed(high.positions, high.triangles);
    let shell = joined(&[low, high]);
    let half = 0.5 * values.get("speed");
    let velocity = |node: usize| Vector3::z() * if node < nodes { half } else { -half };
    let mut scene = FilmScene {
        velocities: (0..shell.positions.len()).map(velocity).collect(),
        contact: Some(monitored_contact(DISTANCE)),
        ..free_film(shell, values.film())
    };
    scene.solver.end_time = FILMS_END;
    let factors = [vec![1.0; elements], vec![values.get("soft"); elements]].concat();
    prepared(rig, scene, method, values, &factors, None, None)
}

/// The step that a film of a scene takes at the CFL number 1, s.
fn stable_step(rig: &Rig, scene: &FilmScene) -> Result<f64> {
    let mut free = scene.clone();
    free.contact = None;
    free.solver.integrator = IntegratorKind::default();
    free.solver.cfl = 1.0;
    let film = rig.start(&free)?;
    Ok(film.view().next_step())
}

/// The film of a scene with an integrator and the step and contact stiffness of the values, until the end time of the
/// scene. `factors`: of the modulus of each element, at most 1; empty for one material.
pub(super) fn prepared(
    rig: &Rig,
    mut scene: FilmScene,
    method: Method,
    values: &Values,
    factors: &[f64],
    rings: Option<Rings>,
    omega: Option<f64>,
) -> Result<Prepared> {
    let Method::Film(kind) = method else { return Err("no integrator of film".into()) };
    let step = values.get("step");
    let end = scene.solver.end_time;
    scene.outputs.sample_interval = end / SAMPLES;
    let shortest = stable_step(rig, &scene)? * step.min(1.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
    let step_limit = ((MAX_STEPS * (end / shortest + SAMPLES)) as u64).clamp(1, MOST_STEPS);
    scene.solver.integrator = kind;
    scene.solver.cfl = step.min(1.0);
    let film = capsule::start(&rig.on_instruction_set(&scene), &[])?;
    let (mut system, state, settings) = film.into_parts();
    if factors.iter().any(|factor| *factor < 1.0) {
        system.model = system.model.with_stiffness(factors);
    }
    if let Some(contact) = &mut system.contact {
        contact.stiffness_per_mass *= values.get("contact_stiffness");
    }
    let settings = SimulationSettings { cfl: step, step_limit, ..settings };
    let film = FilmSimulation::new(system, settings, state.positions, state.velocities, state.gas);
    let run = Box::new(FilmRun::with(film, &scene, rings));
    Ok(Prepared::Film(run, Timeline::of_film(&scene), omega))
}
