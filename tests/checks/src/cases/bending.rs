//! Bending of film: strips against the elastica, a column beyond its Euler load, and clamped plates.
//!
//! A strip is clamped by elements that are held at all their nodes. Poisson's ratio of the strips is 0: then a narrow
//! strip has the stiffness D of a plate.

use core::ops::Range;

use billow_solver::geometry::shapes::{crossed_grid, grid, nodes_where, pseudo_random};

use billow_solver::output::ledger::Ledger;

use super::oscillation::frequency;
use super::prelude::*;

/// Length over width of the strips, and thickness over length. Chosen: slender, and hardly stretched.
pub const SLENDERNESS: f64 = 4.0;
pub const THINNESS: f64 = 1.0 / 500.0;
/// Thickness of the plates over their side. Chosen: stretching and bending forces of similar size have few rounding errors.
pub const PLATE_THINNESS: f64 = 1.0 / 50.0;
/// Displacement of the inner nodes of an irregular mesh over its cells. Chosen as in the comparison of bending models
/// (`docs/experiments.md`).
pub const IRREGULAR: f64 = 0.28;

/// A strip along x from 0 to its length.
pub struct Strip {
    pub shell: Shell,
    /// Nodes of its start and of one more column of elements before it.
    pub clamped: Vec<u32>,
    /// Nodes of its end, and of the column beyond it if there is one.
    pub end: Vec<u32>,
}

/// A strip with one more column of elements before it, and with `beyond` a column after its end.
pub fn strip(
    length: f64,
    width: f64,
    [columns, rows]: [u32; 2],
    irregular: bool,
    beyond: bool,
) -> Strip {
    let cell = length / f64::from(columns);
    let more = 1 + u32::from(beyond);
    let shell = grid(columns + more, rows, length + f64::from(more) * cell, width);
    let shell = moved(shell, |x| x - Vector3::new(cell, 0.0, 0.0));
    let clamped = nodes_where(&shell, |x| x.x < 1e-9 * length);
    let end = nodes_where(&shell, |x| x.x > length * (1.0 - 1e-9));
    let inner = |x: f64, size: f64| x > 1e-9 * size && x < size * (1.0 - 1e-9);
    let amplitude = if irregular { IRREGULAR } else { 0.0 };
    let sizes = [amplitude * cell, amplitude * width / f64::from(rows)];
    let shell = uneven(shell, sizes, 11, |x| inner(x.x, length) && inner(x.y, width));
    Strip { shell, clamped, end }
}

/// Flat film whose inner nodes are moved by up to these lengths (m) along x and y.
pub fn uneven(
    shell: Shell,
    sizes: [f64; 2],
    seed: u64,
    inner: impl Fn(&Vector3<f64>) -> bool,
) -> Shell {
    let random = pseudo_random(shell.positions.len(), seed);
    let mut positions = shell.positions;
    for (position, random) in positions.iter_mut().zip(random) {
        if inner(position) {
            *position += Vector3::new(sizes[0] * random.x, sizes[1] * random.y, 0.0);
        }
    }
    flat(positions, shell.triangles)
}

/// Film that is flat and free of stress at these positions (m) in the plane z = 0.
fn flat(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Shell {
    let reference = triangles.iter().map(|t| t.map(|node| positions[node as usize].xy())).collect();
    Shell { positions, triangles, reference, ..Shell::default() }
}

/// Film with this thickness (m) and a bending stiffness of 1 N m, with Poisson's ratio 0.
pub fn stiff(thickness: f64) -> Film {
    let youngs_modulus = 12.0 / (thickness * thickness * thickness);
    let (poisson_ratio, density) = (0.0, 1.0 / thickness);
    let elastic = Film { compression: 1.0, bending: true, ..Film::PAPER_ELASTIC };
    Film { youngs_modulus, poisson_ratio, density, thickness, ..elastic }
}

/// Meshes of the strips: cells along and across on the coarsest of three, and whether they are irregular.
pub const STRIPS: [(&str, [u32; 2], bool); 3] =
    [("structured", [16, 4], false), ("irregular", [16, 4], true), ("slender", [16, 12], true)];

/// The band of a mesh.
pub fn band_of(band: f64, irregular: bool) -> f64 {
    if irregular { 3.0 * band } else { band }
}

/// A strip under its weight, of 1 kg/m² and 1 N m; the load ρ t g L³/D is the acceleration.
pub fn heavy_strip(rig: &Rig, meshes: &[usize], loads: Range<usize>) -> Outcome {
    let band = number("bending/heavy_strip/band");
    let mut all = Vec::new();
    for row in &rows("bending/heavy_strip")[loads] {
        for (mesh, cells, irregular) in meshes.iter().map(|mesh| STRIPS[*mesh]) {
            let band = band_of(band, irregular);
            let quantities =
                [("x/L", row[1], band), ("drop/L", row[2], band)].map(|(name, value, band)| {
                    (format!("{name}, load {}, {mesh}", row[0]), value, band)
                });
            all.extend(refined([1, 2, 4], quantities, None, |factor| {
                let strip =
                    strip(1.0, 1.0 / SLENDERNESS, cells.map(|n| n * factor), irregular, false);
                let scene = FilmScene {
                    gravity: Vector3::new(0.0, 0.0, -row[0]),
                    supports: vec![held(strip.clamped, "xyz")],
                    ..free_film(strip.shell, stiff(THINNESS))
                };
                let state = equilibrium(rig, &scene, None)?;
                Ok([mean(&state, &strip.end, |x| x.x), -mean(&state, &strip.end, |x| x.z)])
            })?);
        }
    }
    Ok(all)
}

/// A rigid plane without mass that pushes these nodes.
pub fn pushed(nodes: &[u32], normal: Vector3<f64>, force: f64) -> FilmSupport {
    on_plane(nodes.to_vec(), PlaneBody { normal, mass: 0.0, velocity: 0.0, force })
}

/// A strip whose ends are clamped to each other: a full circle, with energy 2 π² D w/L.
pub fn circle(rig: &Rig, meshes: Range<usize>) -> Outcome {
    let band = number("bending/circle/band");
    let width = 1.0 / SLENDERNESS;
    let mut all = Vec::new();
    for (mesh, cells, irregular) in &STRIPS[meshes] {
        let band = band_of(band, *irregular);
        let quantities = [("height/L", 1.0 / PI), ("energy L/(D w)", 2.0 * PI * PI)]
            .map(|(name, value)| (format!("{name}, {mesh}"), value, band));
        all.extend(refined([1, 2, 4], quantities, None, |factor| {
            let strip = strip(1.0, width, cells.map(|n| n * factor), *irregular, true);
            // A circle that is pushed aside, and both ends along x.
            let rolled = moved(strip.shell, |x| {
                let turn = x.x.clamp(0.0, 1.0);
                let (sin, cos) = libm::sincos(TAU * turn);
                let aside = 0.05 * libm::sin(PI * turn) * libm::sin(PI * turn);
                Vector3::new((sin / TAU) + x.x - turn + aside, x.y, (1.0 - cos) / TAU + aside)
            });
            let supports = vec![held([strip.clamped, strip.end].concat(), "xyz")];
            let scene = FilmScene { supports, ..free_film(rolled, stiff(THINNESS)) };
            let state = equilibrium(rig, &scene, None)?;
            let highest = state.positions.z.iter().copied().fold(0.0, f64::max);
            Ok([highest, state.strain_energy / width])
        })?);
    }
    Ok(all)
}

/// A cantilever under a force across it at its end, which keeps its direction.
pub fn end_shear(rig: &Rig) -> Outcome {
    let [length, width, thickness, youngs_modulus, largest] = entry(
        "bending/end_shear",
        ["length", "width", "thickness", "youngs_modulus", "largest_force"],
    );
    let band = number("bending/end_shear/band");
    let film = Film { youngs_modulus, ..stiff(thickness) };
    each("bending/end_shear", |row| {
        let quantities = [("-U", row[1]), ("W", row[2])]
            .map(|(name, value)| (format!("{name}, {} of the force", row[0]), value, band));
        refined([16, 32, 64], quantities, None, |columns| {
            let strip = strip(length, width, [columns, columns / 8], false, false);
            let force = pushed(&strip.end, Vector3::z(), row[0] * largest);
            let supports = vec![held(strip.clamped, "xyz"), force];
            let state =
                equilibrium(rig, &FilmScene { supports, ..free_film(strip.shell, film) }, None)?;
            Ok([length - mean(&state, &strip.end, |x| x.x), mean(&state, &strip.end, |x| x.z)])
        })
    })
}

/// A column, clamped at one end, under a force along it at the other, beyond its Euler load π² D/(4 L²) a width.
pub fn column(rig: &Rig) -> Outcome {
    let band = number("bending/column/band");
    let width = 1.0 / SLENDERNESS;
    each("bending/column", |row| {
        let quantities = [("x/L", row[1]), ("y/L", row[2])]
            .map(|(name, value)| (format!("{name} at {} Euler loads", row[0]), value, band));
        refined([16, 32, 64], quantities, None, |columns| {
            let strip = strip(1.0, width, [columns, columns / 4], false, false);
            let start =
                moved(strip.shell.clone(), |x| x + Vector3::z() * (0.3 * x.x.max(0.0) * x.x));
            let force = pushed(&strip.end, -Vector3::x(), row[0] * PI * PI / 4.0 * width);
            let supports = vec![held(strip.clamped, "xyz"), force];
            let scene = FilmScene { supports, ..free_film(start, stiff(THINNESS)) };
            let state = equilibrium(rig, &scene, None)?;
            Ok([mean(&state, &strip.end, |x| x.x), mean(&state, &strip.end, |x| x.z).abs()])
        })
    })
}

/// A unit square with one more ring of cells around it, which is held.
fn plate(cells: u32, irregular: bool, alternating: bool) -> (Shell, Vec<u32>) {
    let cell = 1.0 / f64::from(cells);
    let size = 1.0 + 2.0 * cell;
    let make = if alternating { crossed_grid } else { grid };
    let shell =
        moved(make(cells + 2, cells + 2, size, size), |x| x - Vector3::new(cell, cell, 0.0));
    let inner = |x: f64| x > 1e-9 && x < 1.0 - 1e-9;
    let clamped = nodes_where(&shell, |x| !inner(x.x) || !inner(x.y));
    let size = if irregular { IRREGULAR * cell } else { 0.0 };
    (uneven(shell, [size; 2], 5, |x| inner(x.x) && inner(x.y)), clamped)
}

/// The largest deflection of a clamped square plate under its weight, far below its thickness; `fine`: on structured
/// meshes twice as fine, in their narrower band.
pub fn clamped_plate(rig: &Rig, fine: bool) -> Outcome {
    let [exact, band, irregular_band] =
        entry("bending/clamped_plate", ["deflection", "band", "irregular_band"]);
    let all_meshes =
        [("one way", false, false), ("alternating", false, true), ("irregular", true, false)];
    let (meshes, coarsest, band) =
        if fine { (&all_meshes[..2], 16, band) } else { (&all_meshes[..], 8, irregular_band) };
    let film = Film { poisson_ratio: 0.3, ..stiff(PLATE_THINNESS) };
    let stiffness = film.bending_stiffness();
    let mut all = Vec::new();
    for (mesh, irregular, alternating) in meshes {
        let quantities = [(format!("deflection, {mesh}"), exact, band)];
        all.extend(refined([1, 2, 4], quantities, None, |factor| {
            let (shell, clamped) = plate(factor * coarsest, *irregular, *alternating);
            // A deflection of a hundredth of the thickness.
            let load = 0.01 * PLATE_THINNESS * stiffness / exact;
            let scene = FilmScene {
                gravity: Vector3::new(0.0, 0.0, -load / film.area_density()),
                supports: vec![held(clamped, "xyz")],
                ..free_film(shell, film)
            };
            let state = equilibrium(rig, &scene, None)?;
            let lowest = state.positions.z.iter().copied().fold(0.0, f64::min);
            Ok([-lowest * stiffness / load])
        })?);
    }
    Ok(all)
}

/// Amplitude of the vibrating plate over its thickness. Chosen: stretching raises the frequency by less than 1e-4.
const AMPLITUDE: f64 = 0.02;

/// The lowest frequency of a clamped square plate, and its energy ledger.
pub fn plate_frequency(rig: &Rig) -> Outcome {
    let [factor, band, residual_band] =
        entry("bending/clamped_plate", ["frequency", "irregular_band", "residual_band"]);
    let film = Film { poisson_ratio: 0.3, numerical_damping: 0.0, ..stiff(PLATE_THINNESS) };
    let exact = factor * (film.bending_stiffness() / film.area_density()).sqrt() / TAU;
    let mut worst = 0.0;
    let mut all = refined([6, 12, 24], [("frequency, Hz", exact, band)], None, |cells| {
        let (mut shell, clamped) = plate(cells, true, false);
        let bell = |x: f64| {
            let sine = libm::sin(PI * x.clamp(0.0, 1.0));
            sine * sine
        };
        let shape: Vec<f64> = shell.positions.iter().map(|x| bell(x.x) * bell(x.y)).collect();
        for (position, shape) in shell.positions.iter_mut().zip(&shape) {
            position.z = AMPLITUDE * PLATE_THINNESS * shape;
        }
        let scene = FilmScene { supports: vec![held(clamped, "xyz")], ..free_film(shell, film) };
        let mut film = rig.start(&scene)?;
        let mut ledgers = vec![film.view().ledger()];
        for _ in 0..10 {
            let time = film.view().state.time;
            advance(&mut film, time + 0.05 / exact, &Phase::default())?;
            ledgers.push(film.view().ledger());
        }
        let largest = ledgers.iter().map(|ledger| ledger.strain).fold(0.0, f64::max);
        let energy = |ledger: &Ledger| ledger.kinetic + ledger.strain;
        let off = ledgers.iter().map(|now| (energy(now) - energy(&ledgers[0])).abs() / largest);
        worst = off.fold(worst, worse);
        let found = frequency(&mut film, 0.02 / exact, 3, |now| {
            let heights = now.state.positions.z.iter().zip(&shape);
            heights.zip(&now.system.model.mass).map(|((z, shape), mass)| mass * z * shape).sum()
        })?;
        Ok([found])
    })?;
    all.push(Row::at_most("energy residual", worst, residual_band));
    Ok(all)
}
