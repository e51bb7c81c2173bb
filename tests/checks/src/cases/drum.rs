//! Discs that vibrate out of their plane: under tension from the rim, and under their own spin.
//!
//! ```text
//! stretched:  f = j/(2π a) √(S t/(ρ t)),  j a zero of J_m               w = J_m(j r/a) cos mθ
//! spinning:   (p/Ω)² = (n(n+2)(3+ν) − m²(1+3ν))/8,  n = m + 2s          in the co-rotating frame
//!             (2,0): w = r² cos 2θ      (0,1): w = 1 − 2 (r/a)²
//! ```
//!
//! The signal is the projection Σ m w φ on the mode φ: an admixture of other modes by the mesh has an
//! effect of second order only.

use billow_solver::geometry::shapes::disc;

use super::oscillation::frequency;
use super::prelude::*;
use super::row::converged;
use super::shapes::disc_rim;

/// CFL number. Chosen: a period takes thousands of steps, so the error of the step is about 1e-8.
pub const CFL: f64 = 0.9;
/// Samples a period. Chosen: the error of a crossing between two samples is far below that of a mesh.
pub const SAMPLES: f64 = 400.0;

/// A disc that starts in a shape with this amplitude (m).
fn displaced(
    rig: &Rig,
    mut scene: FilmScene,
    shape: &[f64],
    amplitude: f64,
    (integrator, cfl): (IntegratorKind, f64),
) -> Result<FilmSimulation> {
    for (position, shape) in scene.shell.positions.iter_mut().zip(shape) {
        position.z = amplitude * shape;
    }
    (scene.solver.integrator, scene.solver.cfl) = (integrator, cfl);
    rig.start(&scene)
}

/// Frequency of a displaced disc, sampled at an interval (s), over a number of zero crossings.
fn ringing_frequency(
    film: &mut FilmSimulation,
    shape: &[f64],
    (interval, crossings): (f64, usize),
) -> Result<f64> {
    frequency(film, interval, crossings, |film| {
        let heights = film.state.positions.z.iter().zip(shape);
        heights.zip(&film.system.model.mass).map(|((z, shape), mass)| mass * z * shape).sum()
    })
}

/// A mode of the drum.
pub struct DrumMode {
    /// Number of nodal diameters.
    pub diameters: f64,
    /// Number of nodal circles, the rim counted.
    pub circles: f64,
    /// Zero of the Bessel function.
    zero: f64,
    /// Exact frequency, Hz.
    pub frequency: f64,
}

/// The modes of the drum.
pub fn drum_modes() -> Vec<DrumMode> {
    let mode = |row: Vec<f64>| DrumMode {
        diameters: row[0],
        circles: row[1],
        zero: row[2],
        frequency: row[3],
    };
    rows("stretched_disc").into_iter().map(mode).collect()
}

/// The drum, a disc under equal biaxial tension with its rim held, in a mode on a mesh of rings, with an integrator at
/// a CFL number and samples a period: its frequency, Hz, and the film after it.
pub fn drum(
    rig: &Rig,
    mode: &DrumMode,
    rings: u32,
    (integrator, cfl, samples): (IntegratorKind, f64, f64),
) -> Result<(f64, FilmSimulation)> {
    let [radius, tension, share] = entry("stretched_disc", ["radius", "tension", "amplitude"]);
    let film = Film::PAPER_ELASTIC;
    // S = E/(1−ν) e for an equal biaxial strain e.
    let stress = tension / film.thickness;
    let strain = stress * (1.0 - film.poisson_ratio) / film.youngs_modulus;
    let stretch = (1.0 + 2.0 * strain).sqrt();
    let mut shell = disc(rings, radius);
    let shape: Vec<f64> = shell
        .positions
        .iter()
        .map(|x| {
            let argument = mode.zero * x.norm() / radius;
            if mode.diameters == 0.0 {
                libm::j0(argument)
            } else {
                libm::j1(argument) * libm::cos(libm::atan2(x.y, x.x))
            }
        })
        .collect();
    for position in &mut shell.positions {
        *position *= stretch;
    }
    let supports = vec![held(disc_rim(rings), "xyz")];
    let scene = FilmScene { supports, ..free_film(shell, film) };
    let mut film = displaced(rig, scene, &shape, share * radius, (integrator, cfl))?;
    let interval = 1.0 / (samples * mode.frequency);
    let found = ringing_frequency(&mut film, &shape, (interval, 3))?;
    Ok((found, film))
}

/// The drum, against its exact frequencies.
pub fn stretched_disc(rig: &Rig) -> Outcome {
    let bands = entry("stretched_disc", ["raw_band", "band", "order"]);
    let mut judged = Vec::new();
    for mode in drum_modes() {
        let explicit = (IntegratorKind::Explicit, CFL, SAMPLES);
        let name = format!("frequency ({},{}), Hz", mode.diameters, mode.circles);
        judged.extend(converged([8, 16, 32], [(name, mode.frequency)], bands, |rings| {
            Ok([drum(rig, &mode, rings, explicit)?.0])
        })?);
    }
    Ok(judged)
}

/// Radial displacement, m, of a free disc that spins at this rate (1/s), at the radius r (m).
fn centrifugal_displacement(film: &Film, radius: f64, rate: f64, r: f64) -> f64 {
    let nu = film.poisson_ratio;
    let scale = film.density * rate * rate * (1.0 - nu * nu) / (8.0 * film.youngs_modulus);
    scale * r * ((3.0 + nu) / (1.0 + nu) * radius * radius - r * r)
}

/// A free disc that spins.
pub fn spinning_disc(rig: &Rig) -> Outcome {
    let [radius, rate, share, band] =
        entry("spinning_disc", ["radius", "rate", "amplitude", "band"]);
    let film = Film::PAPER_ELASTIC;
    each("spinning_disc", |row| {
        let (diameters, expected) = (row[0], row[2]);
        let quantity = format!("p/Omega of mode ({diameters},{})", row[1]);
        refined([4, 8, 16], [(quantity, expected, band)], None, |rings| {
            let mut shell = disc(rings, radius);
            let shape: Vec<f64> = shell
                .positions
                .iter()
                .map(|x| {
                    if diameters == 0.0 {
                        1.0 - 2.0 * x.norm_squared() / (radius * radius)
                    } else {
                        (x.x * x.x - x.y * x.y) / (radius * radius)
                    }
                })
                .collect();
            for position in &mut shell.positions {
                let r = position.norm();
                if r > 0.0 {
                    *position *= 1.0 + centrifugal_displacement(&film, radius, rate, r) / r;
                }
            }
            let spin = Vector3::new(0.0, 0.0, rate);
            let velocities = shell.positions.iter().map(|x| spin.cross(x)).collect();
            let scene = FilmScene { velocities, ..free_film(shell, film) };
            let period = TAU / (expected * rate);
            let explicit = (IntegratorKind::Explicit, CFL);
            let mut film = displaced(rig, scene, &shape, share * radius, explicit)?;
            let found = ringing_frequency(&mut film, &shape, (period / 400.0, 3))?;
            Ok([found * TAU / rate])
        })
    })
}
