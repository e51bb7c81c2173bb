//! Compliant film of revolution at stretches of 8 to 45 %: a held disc, a frustum between rings, the
//! capsule with circular caps as a free body. The references are integrated along a meridian.

use billow_solver::geometry::shapes::{disc, revolved, ring_nodes};
use billow_solver::geometry::shell::Shell;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::film_support::FilmSupport;
use billow_solver::scene::paper::free_film;
use billow_solver::statics::StaticSolution;

use super::axisymmetric::{self, Frustum};
use super::reference::{entry, number, rows};
use super::rig::held;
use super::shapes::{capped_frustum, disc_rim};
use super::static_equilibrium::{equilibrium, mean};
use super::{Outcome, Rig, Row};

/// Steps along each part of a meridian. Chosen: twice as many change nothing by more than 1e-6.
const STEPS: u32 = 400;

/// Film and overpressure (Pa) of a row of the table: E, t, p.
fn load(row: &[f64]) -> (Film, axisymmetric::Film, f64) {
    let film = Film { youngs_modulus: row[0], thickness: row[1], ..Film::PAPER_ELASTIC };
    let Film { youngs_modulus, poisson_ratio, thickness, .. } = film;
    (film, axisymmetric::Film { youngs_modulus, poisson_ratio, thickness }, row[2])
}

/// The shape of the table.
fn shape() -> Frustum {
    let [bottom, top, height] = entry("compliant", ["bottom_radius", "top_radius", "height"]);
    Frustum { bottom, top, height }
}

fn solve(
    rig: &Rig,
    shell: Shell,
    film: Film,
    pressure: f64,
    supports: Vec<FilmSupport>,
) -> Result<(StaticSolution, String), String> {
    let filling = Filling::Pressure(pressure);
    equilibrium(rig, &FilmScene { filling, supports, ..free_film(shell, film) })
}

/// Rows of three meshes against the meridian's values.
fn judge<const N: usize>(
    names: [&str; N],
    row: &[f64],
    meshes: [([f64; N], String); 3],
    expected: [f64; N],
) -> Vec<Row> {
    let [(coarse, _), (middle, _), (fine, note)] = meshes;
    let judged = names.iter().enumerate().map(|(index, name)| {
        let values = [coarse[index], middle[index], fine[index]];
        let name = format!("{name}, E {:e} Pa, {:.1} um, {} Pa", row[0], row[1] * 1e6, row[2]);
        Row::refined(&name, values, expected[index], number("compliant/band")).with_note(&note)
    });
    judged.collect()
}

/// Height and volume of a disc held at its rim.
pub fn held_disc(rig: &Rig) -> Outcome {
    let radius = shape().bottom;
    let mut judged = Vec::new();
    for row in rows("compliant/disc") {
        let (film, meridian, pressure) = load(&row);
        let run = |rings: u32| -> Result<([f64; 2], String), String> {
            let supports = vec![held(disc_rim(rings), "xyz")];
            let (state, note) = solve(rig, disc(rings, radius), film, pressure, supports)?;
            Ok(([state.positions.z[0], state.volume], note))
        };
        let [_, height, volume] = axisymmetric::held_disc(&meridian, radius, pressure, STEPS);
        let meshes = [run(8)?, run(16)?, run(32)?];
        judged.extend(judge(["height, m", "volume, m3"], &row, meshes, [height, volume]));
    }
    Ok(judged)
}

/// Largest radius and volume of a frustum whose rims are held.
pub fn held_frustum(rig: &Rig) -> Outcome {
    let shape = shape();
    let mut judged = Vec::new();
    for row in rows("compliant/frustum") {
        let (film, meridian, pressure) = load(&row);
        let run = |along: u32| -> Result<([f64; 2], String), String> {
            let around = 3 * along;
            let shell = revolved(along, around, true, |ring| {
                let part = f64::from(ring) / f64::from(along);
                [shape.bottom + (shape.top - shape.bottom) * part, shape.height * part]
            });
            let rims = [0, along].map(|ring| held(ring_nodes(ring, around), "xyz"));
            let (state, note) = solve(rig, shell, film, pressure, rims.to_vec())?;
            let radius = |ring: u32| mean(&state, &ring_nodes(ring, around), |x| x.xy().norm());
            Ok(([largest(&(0..=along).map(radius).collect::<Vec<_>>()), state.volume], note))
        };
        let expected = axisymmetric::held_frustum(&meridian, &shape, pressure, STEPS)?;
        let meshes = [run(8)?, run(16)?, run(32)?];
        judged.extend(judge(["largest radius, m", "volume, m3"], &row, meshes, expected));
    }
    Ok(judged)
}

/// Top of the parabola through the largest of some values and its neighbours.
fn largest(values: &[f64]) -> f64 {
    let inner = values.windows(3).max_by(|a, b| a[1].total_cmp(&b[1]));
    inner.map_or(f64::NAN, |window| {
        let (slope, bend) =
            (0.5 * (window[2] - window[0]), window[2] - 2.0 * window[1] + window[0]);
        window[1] - 0.5 * slope * slope / bend
    })
}

/// Sizes of the capsule with circular caps, a free body.
pub fn capsule(rig: &Rig) -> Outcome {
    let shape = shape();
    let mut judged = Vec::new();
    for row in rows("compliant/capsule") {
        let (film, meridian, pressure) = load(&row);
        let run = |fine: u32| -> Result<([f64; 3], String), String> {
            let capped = capped_frustum(fine, [shape.bottom, shape.top], shape.height);
            let (state, note) = solve(rig, capped.shell, film, pressure, Vec::new())?;
            let middle = |rim: &[u32]| mean(&state, rim, |x| x.z);
            let [low, high] = &capped.rims;
            let [bottom, top] = capped.poles.map(|pole| state.positions.get(pole as usize).z);
            Ok(([state.volume, middle(high) - middle(low), top - bottom], note))
        };
        let [volume, _, _, rims, poles] =
            axisymmetric::capped_frustum(&meridian, &shape, pressure, STEPS)?;
        let names = ["volume, m3", "rim to rim height, m", "pole to pole height, m"];
        let meshes = [run(4)?, run(8)?, run(16)?];
        judged.extend(judge(names, &row, meshes, [volume, rims, poles]));
    }
    Ok(judged)
}
