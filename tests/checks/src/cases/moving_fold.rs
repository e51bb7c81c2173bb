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

/// A strip of square cells.
#[derive(Debug, Clone, Copy)]
struct Strip {
    /// Cells along one arm, a multiple of the aspect ratio of an arm.
    cells: u32,
}

impl Strip {
    /// Nodes along the strip.
    fn columns(self) -> u32 {
        2 * self.cells + 1
    }

    /// Cells across the strip.
    fn rows(self) -> u32 {
        self.cells / ASPECT
    }

    /// Width of the strip, m.
    fn width() -> f64 {
        size("arm") / f64::from(ASPECT)
    }

    /// Nodes across the strip in a column: 0 is the fixed end, the last the free one.
    fn nodes(self, column: u32) -> Vec<u32> {
        (0..=self.rows()).map(|row| row * self.columns() + column).collect()
    }

    /// The strip at time 0, with the perturbation of a seed. Over the length of the ramp behind the fold,
    /// the film rises from arm A to arm B without strain, and its speed rises from 0 to v0.
    fn scene(self, seed: u64) -> FilmScene {
        let [arm, gap, ramp, speed] = ["arm", "gap", "ramp", "speed"].map(size);
        let width = Self::width();
        let flat = crossed_grid(self.columns() - 1, self.rows(), 2.0 * arm, width);
        let rise = |s: f64| ((s - arm) / ramp).clamp(0.0, 1.0);
        let velocities = flat.positions.iter().map(|x| Vector3::x() * (speed * rise(x.x)));
        let velocities = velocities.collect();
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
            let folded = if s <= arm { s } else { 2.0 * arm - s + shortening * rise(s) };
            Vector3::new(folded, y, gap * rise(s) + perturbation(s, y))
        });
        let contact =
            FilmContact { distance: Some(size("contact_distance")), ..FilmContact::default() };
        FilmScene {
            velocities,
            supports: vec![held(self.nodes(0), "xyz")],
            contact: Some(contact),
            ..free_film(shell, Film::PAPER)
        }
    }
}

/// One sample of a strip that unrolls.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time: f64,
    /// l/L.
    length: f64,
    ledger: Ledger,
}

/// A strip that unrolls.
#[derive(Debug, Clone)]
struct Unrolling {
    samples: Vec<Sample>,
    /// ½ μ L³/E0, s².
    scale: f64,
}

impl Unrolling {
    /// Runs a strip until l/L is half a window below `last`, or to the last sample.
    fn run(rig: &Rig, strip: Strip, seed: u64, last: f64) -> Result<Self, String> {
        let arm = size("arm");
        let scene = strip.scene(seed);
        let mut film = rig.start(&scene)?;
        let end = strip.nodes(strip.columns() - 1);
        let position = |film: &FilmView<'_>| {
            let sum: f64 = end.iter().map(|node| film.state.positions.x[*node as usize]).sum();
            sum / end.len() as f64
        };
        let start = position(&film.view());
        let sample = |film: &FilmView<'_>| Sample {
            time: film.state.time,
            length: 1.0 - 0.5 * (position(film) - start) / arm,
            ledger: film.ledger(),
        };
        let mut samples = vec![sample(&film.view())];
        for number in 1..=MAX_SAMPLES {
            advance(&mut film, SAMPLE_INTERVAL * f64::from(number), &Phase::default())?;
            let now = sample(&film.view());
            samples.push(now);
            if now.length < last - HALF_WINDOW {
                break;
            }
        }
        let mass = scene.film.area_density() * Strip::width() * arm;
        Ok(Self { scale: 0.5 * mass * arm * arm / samples[0].ledger.kinetic, samples })
    }

    /// A value when l/L first falls to `length`, linear between samples; NaN if it does not.
    fn when(&self, length: f64, value: impl Fn(&Sample) -> f64) -> f64 {
        let pair = self.samples.windows(2).find(|pair| pair[1].length <= length);
        pair.map_or(f64::NAN, |pair| {
            let fraction = (length - pair[0].length) / (pair[1].length - pair[0].length);
            let [from, to] = [value(&pair[0]), value(&pair[1])];
            from + fraction * (to - from)
        })
    }

    /// E/E0 when l/L falls to `length`.
    fn energy_kept(&self, length: f64) -> f64 {
        self.when(length, |sample| sample.ledger.kinetic) / self.samples[0].ledger.kinetic
    }

    /// The coherent share when l/L falls to `length`.
    fn coherent_share(&self, length: f64) -> f64 {
        let [from, to] = [HALF_WINDOW, -HALF_WINDOW]
            .map(|offset| self.when(length + offset, |sample| sample.time));
        // v/L = 2 Δ(l/L)/Δt.
        let speed = 4.0 * HALF_WINDOW / (to - from);
        self.scale * length * speed * speed
    }

    /// Largest residual of the energy ledger.
    fn residual(&self) -> f64 {
        let ledgers: Vec<Ledger> = self.samples.iter().map(|sample| sample.ledger).collect();
        residuals(&ledgers).into_iter().fold(0.0, worse)
    }
}

/// Smallest, middle and largest of an odd number of values; NaN if one is NaN.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.collect();
    if sorted.iter().any(|value| value.is_nan()) {
        return [f64::NAN; 3];
    }
    sorted.sort_by(f64::total_cmp);
    [sorted[0], sorted[sorted.len() / 2], sorted[sorted.len() - 1]]
}

/// Medians over the perturbed starts on one mesh, with floors of the energy kept and of the coherent
/// share at each of the lengths.
fn judged(rig: &Rig, cells: u32, kept_floors: &[f64], coherent_floors: Option<&[f64]>) -> Outcome {
    let lengths = numbers("moving_fold/lengths");
    let last = lengths.iter().copied().fold(1.0, f64::min);
    let runs: Result<Vec<Unrolling>, String> =
        SEEDS.iter().map(|seed| Unrolling::run(rig, Strip { cells }, *seed, last)).collect();
    let runs = runs?;
    let mut rows = Vec::new();
    for (place, length) in lengths.into_iter().enumerate() {
        let of = |value: fn(&Unrolling, f64) -> f64| spread(runs.iter().map(|r| value(r, length)));
        let [least, kept, most] = of(Unrolling::energy_kept);
        let quantity = |name: &str| format!("L/{cells}, l/L {length}: {name}");
        let energy = Row::at_least(&quantity("energy kept"), kept, kept_floors[place])
            .with_note(&format!("{least:.3} to {most:.3}"));
        let [least, coherent, most] = of(Unrolling::coherent_share);
        let mut note = format!("{least:.3} to {most:.3}");
        let lowered = coherent_floors.filter(|floors| floors[place] < floors[0]);
        if let Some([asked, ..]) = lowered {
            let limit = format!("; measured limit, asked {asked}: {cells} nodes an arm snap");
            note.push_str(&limit);
        }
        if let Some(floors) = coherent_floors {
            let share = Row::at_least(&quantity("coherent share"), coherent, floors[place]);
            rows.extend([energy, share.with_note(&note)]);
        } else {
            rows.push(energy.with_note(&format!("coherent share {coherent:.3}, {note}")));
        }
    }
    let residual = runs.iter().map(Unrolling::residual).fold(0.0, worse);
    let band = number("moving_fold/ledger_band");
    rows.push(Row::at_most(&format!("L/{cells}: film energy residual"), residual, band));
    Ok(rows)
}

/// Elements of L/10, without a floor of the coherent share, and of L/20.
pub fn moving_fold(rig: &Rig) -> Outcome {
    let coarse = judged(rig, 10, &numbers("moving_fold/energy_kept_coarse"), None)?;
    let (kept, coherent) =
        (numbers("moving_fold/energy_kept"), numbers("moving_fold/coherent_share"));
    Ok([coarse, judged(rig, 20, &kept, Some(&coherent))?].concat())
}

/// Elements of L/40.
pub fn moving_fold_fine(rig: &Rig) -> Outcome {
    let (kept, coherent) =
        (numbers("moving_fold/energy_kept"), numbers("moving_fold/coherent_share_fine"));
    judged(rig, 40, &kept, Some(&coherent))
}
