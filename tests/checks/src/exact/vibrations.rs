//! Film that vibrates about its equilibrium: a sphere on gas, and a drum.

use billow_solver::integrators::entry;
use billow_solver::scene::IntegratorKind;
use billow_study::analysis::work_precision::{Ending, SceneRuns};
use billow_study::input::value::Value;

use super::meter::{Configuration, Meter, add, quantity, scene, timed};
use crate::cases::reference::rows;
use crate::cases::{Result, Rig, drum, sphere_motion};

/// Levels of the icosphere: each has four times the elements of the one before.
const SPHERE_LEVELS: [u32; 5] = [1, 2, 3, 4, 5];
/// CFL numbers of sphere and disc.
const CFL: [f64; 3] = [0.225, 0.45, 0.9];
/// Samples a period of the implicit integrator: they bound its steps. Its error control allows longer ones, because the
/// amplitude is far below the error it allows.
const IMPLICIT_SAMPLES: [u32; 2] = [100, 400];
/// Finest level, and number of rings, at which every CFL number is run.
const FINEST_OF_ALL: [u32; 2] = [4, 16];
/// The same for the other integrators. Chosen: they take a minute in all.
const FINEST_OF_OTHERS: [u32; 2] = [3, 16];
/// Rings of the disc.
const RINGS: [u32; 5] = [4, 8, 16, 32, 48];

/// A run of vibrating film.
struct Vibration {
    mesh: u32,
    integrator: IntegratorKind,
    cfl: f64,
    /// Samples a period, where they bound the steps.
    samples: Option<u32>,
}

impl Vibration {
    /// `mesh`: the parameter of its mesh.
    fn configuration(&self, mesh: &'static str) -> Configuration<4> {
        let integrator = entry(self.integrator).name;
        let cfl = if self.samples.is_some() { Value::Null } else { self.cfl.into() };
        [
            (mesh, self.mesh.into()),
            ("solver.integrator", integrator.into()),
            ("solver.cfl", cfl),
            ("samples", self.samples.into()),
        ]
    }
}

/// The runs of vibrating film: explicit with every CFL number up to a mesh and the middle one on every mesh; up to
/// another one the other integrators. The hybrid never leaves its explicit steps here, so one run shows it.
fn vibrations(all: &[u32], scene: usize) -> Vec<Vibration> {
    let (finest_of_all, finest_of_others) = (FINEST_OF_ALL[scene], FINEST_OF_OTHERS[scene]);
    let run = |mesh, integrator, cfl| Vibration { mesh, integrator, cfl, samples: None };
    let mut found = Vec::new();
    for mesh in all {
        let every = *mesh <= finest_of_all;
        let explicit = CFL.iter().filter(|cfl| every || (**cfl - CFL[1]).abs() < 1e-9);
        found.extend(explicit.map(|cfl| run(*mesh, IntegratorKind::Explicit, *cfl)));
    }
    for mesh in all.iter().filter(|mesh| **mesh <= finest_of_others) {
        let implicit = |samples| Vibration {
            samples: Some(samples),
            ..run(*mesh, IntegratorKind::Implicit, CFL[1])
        };
        found.extend(IMPLICIT_SAMPLES.map(implicit));
    }
    found.push(run(finest_of_others, IntegratorKind::Hybrid, CFL[1]));
    found
}

/// A sphere on adiabatic gas about its equilibrium.
pub(super) fn breathing_sphere(rig: &Rig) -> Result<SceneRuns> {
    let rows = rows("breathing_sphere");
    let name = |row: &Vec<f64>| {
        let name = format!("frequency_{}_Pa", row[0]);
        quantity(&name, "Hz", &format!("frequency at {} Pa", row[0]), Some(row[1]))
    };
    let meaning = "radial mode of a sphere of film on adiabatic gas; cost of the runs at both pressures; implicit steps end \
                   at samples, whose number a period is given";
    let mut scene = scene(["breathing_sphere", meaning], rows.iter().map(name).collect(), true);
    for run in vibrations(&SPHERE_LEVELS, 0) {
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for row in &rows {
            let method = (run.integrator, Some(run.cfl));
            let (mut film, volume) = sphere_motion::breathing_start(rig, run.mesh, row[0], method)?;
            let interval = run.samples.map(|samples| 1.0 / (f64::from(samples) * row[1]));
            let (value, wall) =
                timed(|| sphere_motion::breathing_frequency(&mut film, volume, interval))?;
            meter.add(&mut film, wall);
            values.push(value);
        }
        add(&mut scene, run.configuration("level"), &meter, Ending::Trusted, &values);
    }
    Ok(scene)
}

/// A drum: a disc under tension from its rim.
pub(super) fn stretched_disc(rig: &Rig) -> Result<SceneRuns> {
    let modes = drum::drum_modes();
    let name = |mode: &drum::DrumMode| {
        let name = format!("frequency_{}_{}", mode.diameters, mode.circles);
        let meaning = format!("frequency with {} nodal diameters", mode.diameters);
        quantity(&name, "Hz", &meaning, Some(mode.frequency))
    };
    let meaning = "frequencies of a disc under tension from its rim; cost of the runs of both modes; implicit steps end at \
                   samples, whose number a period is given";
    let mut scene = scene(["stretched_disc", meaning], modes.iter().map(name).collect(), true);
    for run in vibrations(&RINGS, 1) {
        let (mut meter, mut values) = (Meter::default(), Vec::new());
        for mode in &modes {
            let method = (run.integrator, run.cfl, run.samples.map_or(drum::SAMPLES, f64::from));
            let ((value, mut film), wall) = timed(|| drum::drum(rig, mode, run.mesh, method))?;
            meter.add(&mut film, wall);
            values.push(value);
        }
        add(&mut scene, run.configuration("rings"), &meter, Ending::Trusted, &values);
    }
    Ok(scene)
}
