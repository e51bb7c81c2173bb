//! `billow-checks pareto`: work-precision diagrams of scenes with an exact answer.
//!
//! ```text
//! seconds = wall time on one thread over the simulated time
//! ```
//! The scenes run the code of the cases of the same names at several meshes and steps. Relaxation and set-up before
//! the motion do not count.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use billow_solver::integrators::{FilmSimulation, entry};
use billow_solver::output::events::EventKind;
use billow_solver::scene::{IntegratorKind, Stepping};
use billow_study::analysis::work_precision::{
    Configuration, Cost, Diagram, Ending, Outcome, Quantity, Run, SceneRuns,
};
use billow_study::chart::work_precision as pictures;
use billow_study::cli::chart::work_precision::print_front;
use billow_study::cli::picture::{self, Picture};
use billow_study::input::value::Value;
use billow_study::platform::error::{self, Error};
use billow_study::platform::files::{Disk, Files, disk_error};

use crate::cases::reference::{number, rows};
use crate::cases::{Result, Rig, drum, gas, sphere_motion};
use crate::output::{Options, chosen};

/// A scene: its name, and the function that runs it at every mesh and step, with every integrator that can.
type Scene = (&'static str, fn(&Rig) -> Result<SceneRuns>);

/// Every scene.
const SCENES: [Scene; 3] = [
    ("injected_piston", injected_piston),
    ("breathing_sphere", breathing_sphere),
    ("stretched_disc", stretched_disc),
];

/// Arguments of `billow-checks pareto`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of the pictures.
    #[arg(long, value_name = "DIR", default_value = "results/exact")]
    out: PathBuf,
    /// Only these scenes, comma-separated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    scenes: Vec<String>,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks pareto`: runs the scenes on one thread, prints the front, in CSV and JSON every configuration,
/// and draws the pictures over element-steps and over seconds.
pub fn run(args: &Args, out: &mut dyn Write) -> error::Result<()> {
    let rig = Rig::selected()?;
    let mut diagrams = Vec::new();
    for (name, body) in chosen("--scenes", &args.scenes, &SCENES, |(name, _)| name)? {
        args.options.note(&format!("runs the scene {name}"));
        let runs =
            body(&rig).map_err(|problem| Error::JobsFailed(format!("scene {name}: {problem}")))?;
        diagrams.push(Diagram::of(runs));
    }
    let folder = args.out.join("charts");
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    for (cost, ending) in [(Cost::Work, ""), (Cost::Seconds, "_seconds")] {
        let scenes =
            diagrams.iter().map(|diagram| (&*diagram.name, pictures::scene(diagram, cost)));
        for (name, svg) in scenes.chain([("exact", pictures::overview(&diagrams, cost))]) {
            for format in Picture::ALL {
                let name = format!("pareto_{name}{ending}.{}", format.extension());
                picture::write(&folder.join(name), &svg)?;
            }
        }
    }
    print_front(&diagrams, Cost::Work, args.options.format(), out)
}

/// CFL numbers of the injected piston: each halves the step.
const PISTON_CFL: [f64; 7] = [0.64, 0.32, 0.16, 0.08, 0.04, 0.02, 0.01];
/// Number of them at which the explicit integrator, the implicit one and the hybrid run. The last never leaves its
/// explicit steps here, so one run shows it.
const PISTON_RUNS: [(IntegratorKind, usize); 3] =
    [(IntegratorKind::Explicit, 7), (IntegratorKind::Implicit, 6), (IntegratorKind::Hybrid, 1)];
/// Tolerances of the model piston.
const TOLERANCES: [f64; 6] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
/// Fixed steps of the model piston, s.
const FIXED_STEPS: [f64; 5] = [8e-4, 4e-4, 2e-4, 1e-4, 5e-5];
/// Levels of the icosphere: each has four times the elements of the one before.
const SPHERE_LEVELS: [u32; 5] = [1, 2, 3, 4, 5];
/// Rings of the disc.
const RINGS: [u32; 5] = [4, 8, 16, 32, 48];
/// CFL numbers of sphere and disc.
const CFL: [f64; 3] = [0.225, 0.45, 0.9];
/// Samples a period of the implicit integrator: they bound its steps. Its error control allows longer ones, because the
/// amplitude is far below the error it allows.
const IMPLICIT_SAMPLES: [u32; 2] = [100, 400];
/// Finest level, and number of rings, at which every CFL number is run.
const FINEST_OF_ALL: [u32; 2] = [4, 16];
/// The same for the other integrators. Chosen: they take a minute in all.
const FINEST_OF_OTHERS: [u32; 2] = [3, 16];

/// A quantity of a scene with its exact value.
fn quantity(name: String, unit: &str, meaning: String, exact: f64) -> Quantity {
    Quantity { name, unit: unit.to_owned(), meaning, exact: Some(exact), is_course: false }
}

/// A scene without runs.
fn scene([name, meaning]: [&str; 2], quantities: Vec<Quantity>) -> SceneRuns {
    let [name, meaning] = [name, meaning].map(str::to_owned);
    let runs = Vec::new();
    SceneRuns { name, meaning, quantities, per_simulated_second: true, runs, without_result: 0 }
}

/// Cost so far: elements, steps, whether some are implicit, simulated time, wall time.
#[derive(Default)]
struct Meter {
    elements: f64,
    steps: f64,
    implicit: bool,
    simulated: f64,
    wall: f64,
}

impl Meter {
    /// Adds film that ran for this wall time, s.
    fn add(&mut self, film: &mut FilmSimulation, wall: f64) {
        self.implicit |= film.settings().integrator == IntegratorKind::Implicit
            || film.take_events().iter().any(|event| event.kind == EventKind::Implicit);
        let film = film.view();
        self.elements = film.system.model.elements() as f64;
        self.steps += film.steps() as f64;
        self.simulated += film.state.time;
        self.wall += wall;
    }

    /// A run of this cost with these results.
    fn run(self, configuration: Configuration, values: &[f64]) -> Run {
        Run {
            configuration,
            ending: Ending::Trusted,
            elements: self.elements,
            steps: self.steps,
            implicit: self.implicit,
            seconds: Some(self.wall / self.simulated),
            results: values.iter().map(|value| Some(Outcome::Number(*value))).collect(),
            mesh_errors: Vec::new(),
        }
    }
}

/// Result and wall time, s.
fn timed<T>(body: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    let start = Instant::now();
    let value = body()?;
    Ok((value, start.elapsed().as_secs_f64()))
}

/// A plate driven by a constant inflow into vacuum, by film and by the model piston. Its start is exact to 12 digits,
/// so errors end near 1e-12.
fn injected_piston(rig: &Rig) -> Result<SceneRuns> {
    let [end, start] = ["end", "start"].map(|key| number(&format!("injected_piston/{key}")));
    let exact = gas::injected_exact(end);
    let quantities = vec![quantity("x".to_owned(), "m", "position at 50 ms".to_owned(), exact)];
    let meaning = "a plate driven by a constant inflow into vacuum; the model piston has no elements: its work is steps";
    let mut scene = scene(["injected_piston", meaning], quantities);
    let configuration = |values: [Value; 5]| -> Configuration {
        let names = ["model", "integrator", "cfl", "stepping.adaptive", "stepping.fixed"];
        names.map(|name| format!("solver.{name}")).into_iter().zip(values).collect()
    };
    let none = Value::Null;
    let pairs = PISTON_RUNS
        .iter()
        .flat_map(|(kind, count)| PISTON_CFL.iter().take(*count).map(move |cfl| (*kind, *cfl)));
    for (kind, cfl) in pairs {
        let ((mut film, height), wall) = timed(|| gas::injected(rig, kind, cfl))?;
        let mut meter = Meter::default();
        meter.add(&mut film, wall);
        let integrator = entry(kind).name.into();
        let method = ["film".into(), integrator, cfl.into(), none.clone(), none.clone()];
        scene.runs.push(meter.run(configuration(method), &[height]));
    }
    let adaptive =
        TOLERANCES.map(|tolerance| (Stepping::Adaptive(tolerance), [Some(tolerance), None]));
    let fixed = FIXED_STEPS.map(|step| (Stepping::Fixed(step), [None, Some(step)]));
    // A run takes less than a millisecond; the first of a process also pays for what is done once.
    let _ = gas::injected_model(Stepping::Adaptive(TOLERANCES[0]))?;
    for (stepping, [adaptive, fixed]) in adaptive.into_iter().chain(fixed) {
        let ((steps, height), wall) = timed(|| gas::injected_model(stepping))?;
        let meter = Meter { steps: steps as f64, simulated: end - start, wall, ..Meter::default() };
        let method = ["piston".into(), none.clone(), none.clone(), adaptive.into(), fixed.into()];
        scene.runs.push(meter.run(configuration(method), &[height]));
    }
    Ok(scene)
}

/// A run of vibrating film: parameter of its mesh, integrator, CFL number, samples a period where they bound the steps.
type Vibration = (u32, IntegratorKind, f64, Option<u32>);

/// The configuration of vibrating film; `mesh`: the name of the parameter of its mesh.
fn configuration(mesh: &str, (n, integrator, cfl, samples): Vibration) -> Configuration {
    let cfl = if samples.is_some() { Value::Null } else { cfl.into() };
    let integrator = entry(integrator).name.into();
    [
        (mesh, n.into()),
        ("solver.integrator", integrator),
        ("solver.cfl", cfl),
        ("samples", samples.into()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// The runs of vibrating film: explicit with every CFL number up to a mesh and the middle one on every mesh; up to
/// another one the other integrators. The hybrid never leaves its explicit steps here, so one run shows it.
fn vibrations(meshes: &[u32], scene: usize) -> Vec<Vibration> {
    let (finest_of_all, finest_of_others) = (FINEST_OF_ALL[scene], FINEST_OF_OTHERS[scene]);
    let mut found = Vec::new();
    for n in meshes.iter().copied() {
        let cfl = if n <= finest_of_all { &CFL[..] } else { &CFL[1..2] };
        found.extend(cfl.iter().map(|cfl| (n, IntegratorKind::Explicit, *cfl, None)));
    }
    for n in meshes.iter().copied().filter(|n| *n <= finest_of_others) {
        let implicit = |samples| (n, IntegratorKind::Implicit, CFL[1], Some(samples));
        found.extend(IMPLICIT_SAMPLES.map(implicit));
    }
    found.push((finest_of_others, IntegratorKind::Hybrid, CFL[1], None));
    found
}

/// A sphere on adiabatic gas about its equilibrium.
fn breathing_sphere(rig: &Rig) -> Result<SceneRuns> {
    let rows = rows("breathing_sphere");
    let of_row = |row: &Vec<f64>| {
        let meaning = format!("frequency at {} Pa", row[0]);
        quantity(format!("frequency_{}_Pa", row[0]), "Hz", meaning, row[1])
    };
    let meaning = "radial mode of a sphere of film on adiabatic gas; cost of the runs at both pressures; implicit steps end \
                   at samples, whose number a period is given";
    let mut scene = scene(["breathing_sphere", meaning], rows.iter().map(of_row).collect());
    for run in vibrations(&SPHERE_LEVELS, 0) {
        let (level, integrator, cfl, samples) = run;
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for row in &rows {
            let method = (integrator, Some(cfl));
            let (mut film, volume) = sphere_motion::breathing_start(rig, level, row[0], method)?;
            let interval = samples.map(|samples| 1.0 / (f64::from(samples) * row[1]));
            let (value, wall) =
                timed(|| sphere_motion::breathing_frequency(&mut film, volume, interval))?;
            meter.add(&mut film, wall);
            values.push(value);
        }
        scene.runs.push(meter.run(configuration("level", run), &values));
    }
    Ok(scene)
}

/// A drum: a disc under tension from its rim.
fn stretched_disc(rig: &Rig) -> Result<SceneRuns> {
    let modes = drum::drum_modes();
    let of_mode = |mode: &drum::DrumMode| {
        let meaning = format!("frequency with {} nodal diameters", mode.diameters);
        let name = format!("frequency_{}_{}", mode.diameters, mode.circles);
        quantity(name, "Hz", meaning, mode.frequency)
    };
    let meaning = "frequencies of a disc under tension from its rim; cost of the runs of both modes; implicit steps end at \
                   samples, whose number a period is given";
    let mut scene = scene(["stretched_disc", meaning], modes.iter().map(of_mode).collect());
    for run in vibrations(&RINGS, 1) {
        let (rings, integrator, cfl, samples) = run;
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for mode in &modes {
            let method = (integrator, cfl, samples.map_or(drum::SAMPLES, f64::from));
            let ((value, mut film), wall) = timed(|| drum::drum(rig, mode, rings, method))?;
            meter.add(&mut film, wall);
            values.push(value);
        }
        scene.runs.push(meter.run(configuration("rings", run), &values));
    }
    Ok(scene)
}
