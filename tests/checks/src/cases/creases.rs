//! Creases: a panel opened by a force, two panels opened by pressure, and a panel swung until its crease yields.
//!
//! ```text
//! D ψ″ = F sin ψ,   ψ′(0) = (ψ(0) − θ̄)/L*,   ψ′(L) = 0      panel that a force along x opens; ψ its slope
//! ∫ D ψ′²/2 ds + D (2 ψ(0) − θ̄)²/(4 L*) − p A     smallest       half of two panels that pressure opens; A its area
//! I ω²/2 = M w θ_p + M² w L*/(2 D)                           panel of width w that is swung at ω; M yield moment
//! ```

use core::ops::Range;

use billow_solver::geometry::shapes::{grid, nodes_where};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::output::ledger::Ledger;
use billow_solver::scene::Creases;
use billow_solver::statics::StaticSolution;

use super::bending::{
    IRREGULAR, PLATE_THINNESS, SLENDERNESS, STRIPS, Strip, THINNESS, band_of, pushed, stiff, strip,
    uneven,
};
use super::prelude::*;

/// Edges between nodes of a line, the lower node first.
fn edges_of(shell: &Shell, line: &[u32]) -> Vec<[u32; 2]> {
    let on_line = |node: &u32| line.binary_search(node).is_ok();
    let edges = shell.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut folds: Vec<_> =
        edges.filter(|edge| edge.iter().all(on_line)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    folds.sort_unstable();
    folds.dedup();
    folds
}

/// Film with creases of this length scale (m), whose rest angles are those at the start.
fn creased(length_scale: f64, thickness: f64) -> Film {
    let creases = Some(Creases { length_scale, rest_angle: None });
    Film { creases, ..stiff(thickness) }
}

/// A panel that is joined to a wall by a crease, and opened by a force at its end.
pub fn opened_crease(rig: &Rig, meshes: Range<usize>) -> Outcome {
    let [rest_angle, band] = entry("bending/opened_crease", ["rest_angle", "band"]);
    let width = 1.0 / SLENDERNESS;
    let mut all = Vec::new();
    for row in rows("bending/opened_crease") {
        for (mesh, cells, irregular) in &STRIPS[meshes.clone()] {
            let band = band_of(band, *irregular);
            let quantities = [("x/L", row[2]), ("z/L", row[3])].map(|(name, value)| {
                (format!("{name}, F {}, L* {}, {mesh}", row[0], row[1]), value, band)
            });
            all.extend(refined([1, 2, 4], quantities, None, |factor| {
                let Strip { shell, clamped, end } =
                    strip(1.0, width, cells.map(|n| n * factor), *irregular, false);
                let crease = nodes_where(&shell, |x| x.x.abs() < 1e-9);
                let folds = edges_of(&shell, &crease);
                let (sin, cos) = libm::sincos(rest_angle);
                let folded = moved(shell, |x| {
                    let along = x.x.max(0.0);
                    Vector3::new(x.x.min(0.0) + along * cos, x.y, along * sin)
                });
                let force = pushed(&end, Vector3::x(), row[0] * width);
                let supports = vec![held(clamped, "xyz"), force];
                let shell = Shell { folds, ..folded };
                let scene = FilmScene { supports, ..free_film(shell, creased(row[1], THINNESS)) };
                let state = equilibrium(rig, &scene, None)?;
                Ok([mean(&state, &end, |x| x.x), mean(&state, &end, |x| x.z)])
            })?);
        }
    }
    Ok(all)
}

/// Two panels of length 1 m with a crease between them, folded by an angle about it; the far edges slide on a floor,
/// walls hold all nodes along y. Floor and walls close the volume.
struct Roof {
    shell: Shell,
    supports: Vec<FilmSupport>,
    crease: Vec<u32>,
    floor: Vec<u32>,
}

fn roof(fold_angle: f64, [columns, rows]: [u32; 2], irregular: bool) -> Roof {
    let width = 1.0 / SLENDERNESS;
    let flat_grid = moved(grid(2 * columns, rows, 2.0, width), |x| x - Vector3::x());
    let line = |at: f64| nodes_where(&flat_grid, |x| (x.x.abs() - at).abs() < 1e-9);
    let (crease, floor) = (line(0.0), line(1.0));
    let folds = edges_of(&flat_grid, &crease);
    let inside = |x: f64, size: f64| x > 1e-9 && x < size - 1e-9;
    let amplitude = if irregular { IRREGULAR } else { 0.0 };
    let sizes = [amplitude / f64::from(columns), amplitude * width / f64::from(rows)];
    let shell = uneven(flat_grid, sizes, 3, |x| inside(x.x.abs(), 1.0) && inside(x.y, width));
    let (sin, cos) = libm::sincos(0.5 * fold_angle);
    let shell = moved(shell, |x| Vector3::new(x.x * cos, x.y, (1.0 - x.x.abs()) * sin));
    // Node i of row j, and the last node of a row.
    let last = 2 * columns;
    let node = |i: u32, j: u32| j * (last + 1) + i;
    let mut closure = Vec::new();
    for j in 0..rows {
        closure.push([node(0, j), node(0, j + 1), node(last, j)]);
        closure.push([node(last, j), node(0, j + 1), node(last, j + 1)]);
    }
    for i in 1..last {
        closure.push([node(0, 0), node(i + 1, 0), node(i, 0)]);
        closure.push([node(0, rows), node(i, rows), node(i + 1, rows)]);
    }
    let everywhere = 0..u32::try_from(shell.positions.len()).expect("under 2^32");
    let between: Vec<u32> =
        everywhere.filter(|node| !crease.contains(node) && !floor.contains(node)).collect();
    let supports = vec![held(crease.clone(), "xy"), held(floor.clone(), "yz"), held(between, "y")];
    Roof { shell: Shell { folds, closure, ..shell }, supports, crease, floor }
}

/// Two panels that pressure opens against their crease.
pub fn creased_panels(rig: &Rig, meshes: Range<usize>) -> Outcome {
    let [rest_angle, length_scale, band] =
        entry("bending/creased_panels", ["rest_angle_degrees", "length_scale", "band"]);
    let table: [Vec<f64>; 3] =
        rows("bending/creased_panels").try_into().map_err(|_| "three pressures expected")?;
    let mut all = Vec::new();
    for (mesh, [columns, rows], irregular) in &STRIPS[meshes] {
        let band = band_of(band, *irregular);
        let quantities: [_; 3] = core::array::from_fn(|row| {
            let name = format!("2 asin(h/l), degrees, p l³/D {:.3}, {mesh}", table[row][0]);
            (name, table[row][1], band)
        });
        all.extend(refined([1, 2, 4], quantities, None, |factor| {
            let cells = [columns, rows].map(|n| n / 2 * factor);
            let Roof { shell, supports, crease, floor } =
                roof(rest_angle.to_radians(), cells, *irregular);
            let film = creased(length_scale, PLATE_THINNESS);
            let at = |pressure: f64, known: Option<(&StaticSolution, f64)>| {
                let filling = Filling::Pressure(pressure);
                let (shell, supports) = (shell.clone(), supports.clone());
                equilibrium(rig, &FilmScene { filling, supports, ..free_film(shell, film) }, known)
            };
            // Each pressure from the equilibrium at the one before.
            let mut known: Option<(StaticSolution, f64)> = None;
            let mut angles = [0.0; 3];
            for (angle, row) in angles.iter_mut().zip(&table) {
                let pressure = row[0] * film.bending_stiffness();
                let before = known.as_ref().map(|(state, pressure)| (state, *pressure));
                let state = at(pressure, before)?;
                let height = mean(&state, &crease, |x| x.z) - mean(&state, &floor, |x| x.z);
                *angle = 2.0 * libm::asin(height).to_degrees();
                known = Some((state, pressure));
            }
            Ok(angles)
        })?);
    }
    Ok(all)
}

/// Energies of a film with their change into losses, J.
fn energy_of(film: &FilmSimulation) -> f64 {
    let Ledger { kinetic, strain, material_loss, numerical_dissipation, .. } = film.view().ledger();
    kinetic + strain + material_loss + numerical_dissipation
}

/// A panel that is joined to a wall by a crease, and swung until the crease has taken its energy: elastically up to the
/// yield moment, and with that moment beyond. Then it swings back and forth without yielding again. Another one starts
/// at rest with twice its yield moment.
pub fn yielding_crease(rig: &Rig) -> Outcome {
    let [length_scale, yield_moment, plastic_angle] =
        entry("bending/yielding_crease", ["length_scale", "yield_moment", "plastic_angle"]);
    let [band, residual_band] = entry("bending/yielding_crease", ["band", "residual_band"]);
    let film = Film { yield_moment: Some(yield_moment), ..creased(length_scale, PLATE_THINNESS) };
    let width = 1.0 / SLENDERNESS;
    let elastic_angle = yield_moment * length_scale / film.bending_stiffness();
    let elastic = 0.5 * yield_moment * width * elastic_angle;
    let dissipated = yield_moment * width * plastic_angle;
    let mut all = Vec::new();
    for (mesh, irregular) in [("structured", false), ("irregular", true)] {
        let Strip { shell, clamped, end } = strip(1.0, width, [8, 2], irregular, false);
        let folds = edges_of(&shell, &nodes_where(&shell, |x| x.x.abs() < 1e-9));
        let shell = Shell { folds, ..shell };
        let model = FilmModel::of_shell(&film, &shell)?;
        let arms: Vec<f64> = shell.positions.iter().map(|x| x.x.max(0.0)).collect();
        let inertia: f64 = model.mass.iter().zip(&arms).map(|(mass, arm)| mass * arm * arm).sum();
        let omega = (2.0 * (dissipated + elastic) / inertia).sqrt();
        let velocities = arms.iter().map(|arm| Vector3::z() * (omega * arm)).collect();
        let supports = vec![held(clamped, "xyz")];
        let scene = FilmScene { supports, ..free_film(shell, film) };
        let mut swung = rig.start(&FilmScene { velocities, ..scene.clone() })?;
        let (mut largest, mut residual) = (0.0, 0.0);
        for sample in 1..=200 {
            advance(
                &mut swung,
                f64::from(sample) * 0.04 * plastic_angle / omega,
                &Phase::default(),
            )?;
            let [x, z] = [0, 2].map(|axis| {
                let nodes = end.iter().map(|node| swung.view().state.positions.get(*node as usize));
                nodes.map(|position| position[axis]).sum::<f64>()
            });
            largest = f64::max(largest, libm::atan2(z, x));
            residual = worse(residual, (energy_of(&swung) / (dissipated + elastic) - 1.0).abs());
        }
        let mut wound = scene;
        wound.film.creases = Some(Creases { length_scale, rest_angle: Some(2.0 * elastic_angle) });
        let mut wound = rig.start(&wound)?;
        advance(&mut wound, 1.0, &Phase::default())?;
        let wound_residual = (energy_of(&wound) / (4.0 * elastic) - 1.0).abs();
        let name = |quantity: &str| format!("{quantity}, {mesh}");
        let loss = |film: &FilmSimulation| film.view().ledger().material_loss;
        let angle = plastic_angle + elastic_angle;
        all.push(Row::new(&name("largest angle, rad"), largest, angle, band));
        all.push(Row::new(&name("dissipated energy, J"), loss(&swung), dissipated, band));
        all.push(Row::new(&name("dissipated at the start, J"), loss(&wound), 3.0 * elastic, band));
        all.push(Row::at_most(&name("energy residual"), residual, residual_band));
        // Its film shakes at the release, and starts to yield again at each shake.
        all.push(Row::at_most(
            &name("from rest, energy residual"),
            wound_residual,
            2.0 * residual_band,
        ));
    }
    Ok(all)
}
