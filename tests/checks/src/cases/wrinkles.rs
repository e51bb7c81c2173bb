//! Wrinkles of a stretched sheet that is narrowed.
//!
//! ```text
//! λ = 2 √π (D/T)^¼ √L        E. Cerda, L. Mahadevan, Phys. Rev. Lett. 90 (2003) 074302
//! ```
//!
//! T is the tension along x in N/m, L the length between two ends that stay flat. A wave along y with one half wave
//! along x costs D k² + T (π/L)²/k² of compression: the smallest, 2 π √(T D)/L, is at this wavelength.

use billow_solver::geometry::shapes::{grid, nodes_where};

use super::bending::stiff;
use super::prelude::*;

/// Strain along x. Chosen: small, and far above the narrowing.
const STRAIN: f64 = 0.01;
/// Compression over that at which the sheet wrinkles. Chosen: near one, where one wavelength is preferred.
const COMPRESSION: f64 = 1.3;
/// Cells along x and y, the same at every tension: 16 edges along y over the shortest wave.
const CELLS: [u32; 2] = [80, 160];
/// Seeds of the uneven start; it decides where waves begin. Chosen.
const SEEDS: [u64; 3] = [1, 2, 3];

/// Mean wavelength (m) on the line x = ½ of a square of side 1 m under a tension of this value times D/m².
fn wavelength(rig: &Rig, tension: f64, seed: u64) -> Result<f64> {
    // Tension is E t times the strain, with D = 1 N m.
    let film = stiff((12.0 * STRAIN / tension).sqrt());
    let membrane = film.youngs_modulus * film.thickness;
    let narrowing = COMPRESSION * TAU * tension.sqrt() / membrane;
    let shell = grid(CELLS[0], CELLS[1], 1.0, 1.0);
    let ends = nodes_where(&shell, |x| x.x < 1e-9 || x.x > 1.0 - 1e-9);
    let sides =
        nodes_where(&shell, |x| (x.y < 1e-9 || x.y > 1.0 - 1e-9) && x.x > 1e-9 && x.x < 1.0 - 1e-9);
    let middle = nodes_where(&shell, |x| (x.x - 0.5).abs() < 1e-9);
    let random = pseudo_random(shell.positions.len(), seed);
    let mut start =
        moved(shell, |x| Vector3::new(x.x * (1.0 + STRAIN), x.y * (1.0 - narrowing), 0.0));
    for (position, random) in start.positions.iter_mut().zip(random) {
        let free = |x: f64, size: f64| x > 1e-9 && x < size - 1e-9;
        if free(position.x, 1.0 + STRAIN) && free(position.y, 1.0 - narrowing) {
            position.z = 0.3 * film.thickness * random.z;
        }
    }
    let supports = vec![held(ends, "xyz"), held(sides, "yz")];
    let state = equilibrium(rig, &FilmScene { supports, ..free_film(start, film) }, None)?;
    let line: Vec<_> = middle.iter().map(|node| state.positions.get(*node as usize)).collect();
    let crossings: Vec<f64> = line
        .windows(2)
        .filter(|pair| pair[0].z * pair[1].z < 0.0)
        .map(|pair| {
            let at = pair[0].z / (pair[0].z - pair[1].z);
            pair[0].y + at * (pair[1].y - pair[0].y)
        })
        .collect();
    let (first, last) = (crossings.first().ok_or("flat")?, crossings.last().ok_or("flat")?);
    Ok(2.0 * (last - first) / (crossings.len() - 1) as f64)
}

/// Wavelengths at tensions a factor of 16 apart, and the exponent of D/T.
pub fn stretched_sheet(rig: &Rig) -> Outcome {
    let [band, exponent, exponent_band] =
        entry("bending/wrinkles", ["band", "exponent", "exponent_band"]);
    let mut all = Vec::new();
    let mut found = Vec::new();
    for tension in numbers("bending/wrinkles/tensions") {
        let predicted = 2.0 * (PI / tension.sqrt()).sqrt();
        let mut sum = 0.0;
        for seed in SEEDS {
            sum += wavelength(rig, tension, seed)?;
        }
        let mean = sum / SEEDS.len() as f64;
        all.push(Row::new(&format!("wavelength/L, T L²/D {tension:e}"), mean, predicted, band));
        found.push((tension, mean));
    }
    let [(first, long), .., (last, short)] = found[..] else { return Err("two tensions".into()) };
    let slope = libm::log(long / short) / libm::log(last / first);
    all.push(Row::new("exponent of D/T", slope, exponent, exponent_band / exponent));
    Ok(all)
}
