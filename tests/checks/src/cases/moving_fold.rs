//! A strip folded once: arm A is held at its end, arm B flies along it and unrolls.
//!
//! ```text
//! v = v0 √(L/l),  l = L − x/2           the fold moves at v/2; nothing is lost
//! energy kept = E/E0                    coherent share = ½ μ l v²/E0
//! ```
//!
//! Symbols: L length of an arm, l length of arm B that still moves, x and v displacement and speed of
//! the free end along the strip, μ mass per length, E kinetic energy, E0 that of the start. The law is
//! that of an inextensible string: both quantities are 1. E0 is less than ½ μ L v0², because the film
//! next to the fold starts more slowly; the law needs only E0.
//!
//! x is the mean over the nodes of the free end. v is its mean while l/L falls by twice
//! [`HALF_WINDOW`], because the end rattles. The coherent share takes both arms as straight and arm B as
//! rigid.

use billow_solver::geometry::shapes::crossed_grid;
use billow_solver::output::ledger::{Ledger, residuals};

use super::oscillation::when;
use super::prelude::*;

/// Length of an arm over the width of the strip.
const ASPECT: u32 = 5;
/// Largest coefficient of a mode of the perturbation, m. Chosen: all modes together stay below the
/// contact distance and strain the film by less than 1e-5.
const AMPLITUDE: f64 = 2e-5;
/// Number of modes of the perturbation along the strip.
const MODES: usize = 4;
/// Time between two samples, s. Chosen: the end moves by less than 4 mm in it.
const SAMPLE_INTERVAL: f64 = 1e-4;
/// Half the change of l/L over which the speed of the end is a mean. Chosen: one element or more passes
/// the fold meanwhile, and by the law the share from this mean is less than 0.3 % below that from the
/// speed in the middle.
const HALF_WINDOW: f64 = 0.05;
/// Most samples. Chosen: 60 ms, three times as long as the law needs for the whole arm.
const MAX_SAMPLES: u32 = 600;
/// Seeds of the perturbed starts.
const SEEDS: [u64; 5] = [1, 2, 3, 4, 5];

/// A length (m) or speed (m/s) of the scene.
fn size(name: &str) -> f64 {
    number(&format!("moving_fold/{name}"))
}

/// Width of the strip, m.
fn width() -> f64 {
    size("arm") / f64::from(ASPECT)
}

/// Nodes across a strip with this number of square cells along an arm, in a column: 0 is the fixed end, the last the
/// free one.
fn nodes(cells: u32, column: u32) -> Vec<u32> {
    (0..=cells / ASPECT).map(|row| row * (2 * cells + 1) + column).collect()
}

/// The strip at time 0, with the perturbation of a seed. Over the length of the ramp behind the fold, the film rises
/// from arm A to arm B without strain, and its speed rises from 0 to v0.
fn folded(cells: u32, seed: u64) -> FilmScene {
    let [arm, gap, ramp, speed] = ["arm", "gap", "ramp", "speed"].map(size);
    let width = width();
    let flat = crossed_grid(2 * cells, cells / ASPECT, 2.0 * arm, width);
    let rise = |s: f64| ((s - arm) / ramp).clamp(0.0, 1.0);
    let velocities = flat.positions.iter().map(|x| Vector3::x() * (speed * rise(x.x))).collect();
    let modes = pseudo_random(MODES, seed);
    // Out of the plane, symmetric and antisymmetric across the strip, zero at both ends.
    let perturbation = |s: f64, y: f64| -> f64 {
        let mode = |(k, mode): (u32, &Vector3<f64>)| {
            let along = libm::sin(f64::from(k) * PI * s / (2.0 * arm));
            AMPLITUDE * along * (mode.x + mode.y * (2.0 * y / width - 1.0))
        };
        (1..).zip(&modes).map(mode).sum()
    };
    let shortening = ramp - (ramp * ramp - gap * gap).sqrt();
    let shell = moved(flat, |x| {
        let (s, y) = (x.x, x.y);
        let along = if s <= arm { s } else { 2.0 * arm - s + shortening * rise(s) };
        Vector3::new(along, y, gap * rise(s) + perturbation(s, y))
    });
    let distance = Some(size("contact_distance"));
    FilmScene {
        velocities,
        supports: vec![held(nodes(cells, 0), "xyz")],
        contact: Some(FilmContact { distance, ..FilmContact::default() }),
        ..free_film(shell, Film::PAPER)
    }
}

/// Time (s), l/L and energy ledger of a strip that unrolls.
type Sample = (f64, f64, Ledger);

/// Energy kept and coherent share of one start at each of these l/L, and the largest residual of its energy ledger.
fn unrolled(rig: &Rig, cells: u32, seed: u64, lengths: &[f64]) -> Result<(Vec<[f64; 2]>, f64)> {
    let arm = size("arm");
    let scene = folded(cells, seed);
    let mut film = rig.start(&scene)?;
    let end = nodes(cells, 2 * cells);
    let position = |film: &FilmView<'_>| {
        let sum: f64 = end.iter().map(|node| film.state.positions.x[*node as usize]).sum();
        sum / end.len() as f64
    };
    let start = position(&film.view());
    let sample = |film: &FilmView<'_>| {
        (film.state.time, 1.0 - 0.5 * (position(film) - start) / arm, film.ledger())
    };
    let last = lengths.iter().copied().fold(1.0, f64::min) - HALF_WINDOW;
    let mut samples = vec![sample(&film.view())];
    for number in 1..=MAX_SAMPLES {
        advance(&mut film, SAMPLE_INTERVAL * f64::from(number), &Phase::default())?;
        let now = sample(&film.view());
        samples.push(now);
        if now.1 < last {
            break;
        }
    }
    let kinetic = samples[0].2.kinetic;
    let mass = scene.film.area_density() * width() * arm;
    let found = lengths.iter().map(|length| {
        let series = |of: fn(&Sample) -> f64| -> Vec<(f64, f64)> {
            samples.iter().map(|sample| (sample.1, of(sample))).collect()
        };
        let kept = when(&series(|sample| sample.2.kinetic), *length) / kinetic;
        let time = series(|sample| sample.0);
        let [from, to] = [HALF_WINDOW, -HALF_WINDOW].map(|offset| when(&time, length + offset));
        // v/L = 2 Δ(l/L)/Δt.
        let speed = 4.0 * HALF_WINDOW / (to - from);
        [kept, 0.5 * mass * arm * arm / kinetic * length * speed * speed]
    });
    let found = found.collect();
    let ledgers: Vec<Ledger> = samples.iter().map(|sample| sample.2).collect();
    Ok((found, residuals(&ledgers).into_iter().fold(0.0, worse)))
}

/// Medians over the perturbed starts on a mesh with this number of elements along an arm, with the floors of the
/// coherent share by their name.
pub fn moving_fold(rig: &Rig, cells: u32, share_floors: &str) -> Outcome {
    let lengths = numbers("moving_fold/lengths");
    let floors = ["energy_kept", share_floors].map(|name| numbers(&format!("moving_fold/{name}")));
    let starts = SEEDS.iter().map(|seed| unrolled(rig, cells, *seed, &lengths));
    let starts = starts.collect::<Result<Vec<_>>>()?;
    let mut rows = Vec::new();
    for (place, length) in lengths.iter().enumerate() {
        for (index, name) in ["energy kept", "coherent share"].into_iter().enumerate() {
            let mut sorted: Vec<f64> = starts.iter().map(|start| start.0[place][index]).collect();
            sorted.sort_by(f64::total_cmp);
            // No median stands for a start that failed.
            let failed = sorted.iter().any(|value| value.is_nan());
            let median = if failed { f64::NAN } else { sorted[sorted.len() / 2] };
            let quantity = format!("L/{cells}, l/L {length}: {name}");
            rows.push(Row::at_least(&quantity, median, floors[index][place]));
        }
    }
    let residual = starts.iter().map(|start| start.1).fold(0.0, worse);
    let band = number("moving_fold/ledger_band");
    rows.push(Row::at_most(&format!("L/{cells}: film energy residual"), residual, band));
    Ok(rows)
}
