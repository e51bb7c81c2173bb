//! The scenes with an exact answer (or none but their finest mesh) at several meshes and steps, for work-precision
//! diagrams.
//!
//! ```text
//! seconds = wall time on one thread over the simulated time;  of a static search, its wall time
//! ```
//! They run the code of the cases of the same names. Relaxation and set-up before the motion do not count.

use std::time::Instant;

use billow_solver::integrators::FilmView;
use billow_solver::models::run::Model;
use billow_solver::scene::Stepping;
use serde_json::{Value, json};

use super::reference::{number, rows};
use super::{Rig, drum, gas_piston, piston_model, sphere_motion, static_airbag};
use crate::store::exact_scenes::{ExactQuantity, ExactRun, ExactScene};

/// A scene: its name and the function that runs it.
pub struct Scene {
    /// Name.
    pub name: &'static str,
    /// Runs it at every mesh and step.
    pub body: fn(&Rig) -> Result<ExactScene, String>,
}

/// Every scene.
pub const SCENES: [Scene; 4] = [
    Scene { name: "injected_piston", body: injected_piston },
    Scene { name: "breathing_sphere", body: breathing_sphere },
    Scene { name: "square_airbag", body: square_airbag },
    Scene { name: "stretched_disc", body: stretched_disc },
];

/// CFL numbers of the injected piston: each halves the step.
const PISTON_CFL: [f64; 7] = [0.64, 0.32, 0.16, 0.08, 0.04, 0.02, 0.01];
/// Tolerances of the model piston.
const TOLERANCES: [f64; 6] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
/// Fixed steps of the model piston, s.
const FIXED_STEPS: [f64; 5] = [8e-4, 4e-4, 2e-4, 1e-4, 5e-5];
/// Levels of the icosphere: each has four times the elements of the one before.
const SPHERE_LEVELS: [u32; 5] = [1, 2, 3, 4, 5];
/// CFL numbers of sphere and disc.
const CFL: [f64; 3] = [0.225, 0.45, 0.9];
/// Finest level, and number of rings, at which every CFL number is run.
const FINEST_OF_ALL: [u32; 2] = [4, 16];
/// Rings of the disc.
const RINGS: [u32; 5] = [4, 8, 16, 32, 48];
/// Cells along the side of a quarter of the airbag. With 96 the search finds another minimum, of higher energy.
const CELLS: [u32; 5] = [4, 8, 16, 32, 64];

fn quantity(name: &str, unit: &str, meaning: &str, exact: Option<f64>) -> ExactQuantity {
    let [name, unit, meaning] = [name, unit, meaning].map(str::to_owned);
    ExactQuantity { name, unit, meaning, exact }
}

fn scene(
    name: &str,
    meaning: &str,
    parameters: &[&str],
    quantities: Vec<ExactQuantity>,
) -> ExactScene {
    ExactScene {
        name: name.to_owned(),
        meaning: meaning.to_owned(),
        quantities,
        per_simulated_second: true,
        parameters: parameters.iter().map(|name| (*name).to_owned()).collect(),
        runs: Vec::new(),
    }
}

/// Cost so far: elements, steps, simulated time, wall time.
#[derive(Default)]
struct Meter {
    elements: f64,
    steps: f64,
    simulated: f64,
    wall: f64,
}

impl Meter {
    /// Adds film that ran for this wall time, s.
    fn add(&mut self, film: &FilmView<'_>, wall: f64) {
        self.elements = film.system.model.elements() as f64;
        self.steps += film.steps() as f64;
        self.simulated += film.state.time;
        self.wall += wall;
    }

    fn run(&self, configuration: Vec<Value>, values: Vec<f64>) -> ExactRun {
        ExactRun {
            configuration,
            elements: self.elements,
            steps: self.steps,
            seconds: self.wall / self.simulated,
            values,
        }
    }
}

/// Result and wall time, s.
fn timed<T>(body: impl FnOnce() -> Result<T, String>) -> Result<(T, f64), String> {
    let start = Instant::now();
    let value = body()?;
    Ok((value, start.elapsed().as_secs_f64()))
}

/// A plate driven by a constant inflow into vacuum, by film and by the model piston. Its start is exact to 12 digits,
/// so errors end near 1e-12.
fn injected_piston(rig: &Rig) -> Result<ExactScene, String> {
    let [end, start] = ["end", "start"].map(|key| number(&format!("injected_piston/{key}")));
    let exact = gas_piston::injected_exact(end);
    let simulated = end - start;
    let quantities = vec![quantity("x", "m", "position at 50 ms", Some(exact))];
    let mut found = scene(
        "injected_piston",
        "a plate driven by a constant inflow into vacuum; the model piston has no elements: its work is steps",
        &["solver.model", "solver.cfl", "solver.stepping.adaptive", "solver.stepping.fixed"],
        quantities,
    );
    for cfl in PISTON_CFL {
        let (film, wall) = timed(|| gas_piston::injected(rig, cfl))?;
        let mut meter = Meter::default();
        meter.add(&film.view(), wall);
        let configuration = vec!["film".into(), cfl.into(), Value::Null, Value::Null];
        found.runs.push(meter.run(configuration, vec![gas_piston::height(&film.view())]));
    }
    let adaptive = TOLERANCES.map(|value| (Stepping::Adaptive(value), json!(value), Value::Null));
    let fixed = FIXED_STEPS.map(|value| (Stepping::Fixed(value), Value::Null, json!(value)));
    // A run takes less than a millisecond; the first of a process also pays for what is done once.
    let _ = piston_model::injected(Stepping::Adaptive(TOLERANCES[0]))?;
    for (stepping, tolerance, step) in adaptive.into_iter().chain(fixed) {
        let (run, wall) = timed(|| piston_model::injected(stepping))?;
        let meter = Meter { elements: 0.0, steps: run.steps() as f64, simulated, wall };
        let configuration = vec!["piston".into(), Value::Null, tolerance, step];
        found.runs.push(meter.run(configuration, vec![run.state().height]));
    }
    Ok(found)
}

/// The meshes and CFL numbers that are run: every CFL number up to a mesh, the middle one on every mesh.
fn meshes<const N: usize>(all: [u32; N], finest_of_all: u32) -> Vec<(u32, f64)> {
    let pairs = all.into_iter().flat_map(|mesh| CFL.map(|cfl| (mesh, cfl)));
    pairs.filter(|(mesh, cfl)| *mesh <= finest_of_all || (*cfl - CFL[1]).abs() < 1e-9).collect()
}

/// A sphere on adiabatic gas about its equilibrium.
fn breathing_sphere(rig: &Rig) -> Result<ExactScene, String> {
    let rows = rows("breathing_sphere");
    let name = |row: &Vec<f64>| {
        let name = format!("frequency_{}_Pa", row[0]);
        quantity(&name, "Hz", &format!("frequency at {} Pa", row[0]), Some(row[1]))
    };
    let mut found = scene(
        "breathing_sphere",
        "radial mode of a sphere of film on adiabatic gas; cost of the runs at both pressures",
        &["level", "solver.cfl"],
        rows.iter().map(name).collect(),
    );
    for (level, cfl) in meshes(SPHERE_LEVELS, FINEST_OF_ALL[0]) {
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for row in &rows {
            let (mut film, volume) = sphere_motion::breathing_start(rig, level, row[0], Some(cfl))?;
            let (value, wall) = timed(|| sphere_motion::breathing_frequency(&mut film, volume))?;
            meter.add(&film.view(), wall);
            values.push(value);
        }
        found.runs.push(meter.run(vec![level.into(), cfl.into()], values));
    }
    Ok(found)
}

/// Two squares sewn together and inflated. No closed form is known: the finest mesh is the reference.
fn square_airbag(rig: &Rig) -> Result<ExactScene, String> {
    let quantities = vec![
        quantity("potential_energy", "J", "potential energy of a quarter of a sheet", None),
        quantity("height", "m", "height of the middle", None),
        quantity("volume", "m3", "enclosed volume", None),
    ];
    let mut found = scene(
        "square_airbag",
        "two squares sewn together and inflated, at rest; work is elements times Newton steps, seconds are those of the search",
        &["cells"],
        quantities,
    );
    found.per_simulated_second = false;
    for cells in CELLS {
        let ((state, _), wall) = timed(|| static_airbag::inflated(rig, cells))?;
        found.runs.push(ExactRun {
            configuration: vec![cells.into()],
            elements: state.model.elements() as f64,
            steps: f64::from(state.iterations),
            seconds: wall,
            values: vec![state.potential_energy, state.positions.z[0], 8.0 * state.volume],
        });
    }
    Ok(found)
}

/// A drum: a disc under tension from its rim.
fn stretched_disc(rig: &Rig) -> Result<ExactScene, String> {
    let modes = drum::drum_modes();
    let name = |mode: &drum::DrumMode| {
        let name = format!("frequency_{}_{}", mode.diameters, mode.circles);
        let meaning = format!("frequency with {} nodal diameters", mode.diameters);
        quantity(&name, "Hz", &meaning, Some(mode.frequency))
    };
    let mut found = scene(
        "stretched_disc",
        "frequencies of a disc under tension from its rim; cost of the runs of both modes",
        &["rings", "solver.cfl"],
        modes.iter().map(name).collect(),
    );
    for (rings, cfl) in meshes(RINGS, FINEST_OF_ALL[1]) {
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for mode in &modes {
            let ((value, film), wall) = timed(|| drum::drum(rig, mode, rings, cfl))?;
            meter.add(&film.view(), wall);
            values.push(value);
        }
        found.runs.push(meter.run(vec![rings.into(), cfl.into()], values));
    }
    Ok(found)
}
