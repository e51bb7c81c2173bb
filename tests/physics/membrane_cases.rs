//! Film forces against their energies, rigid motions, patch, and the step they allow.

use billow_solver::forces::damping;
use billow_solver::forces::membrane::{strain, strain_energy};
use billow_solver::forces::pressure;
use billow_solver::material::Regime;
use billow_solver::model::{FilmError, FilmModel};
use billow_solver::scene::Film;
use billow_solver::state::Field;
use nalgebra::{Rotation3, Vector3};

use crate::film_rig::{ELASTIC, Piece, film_forces, gradients, icosphere, mapped, pattern, sheet};
use crate::rig::PAPER_FILM;

fn still(piece: &Piece) -> Field {
    Field::zeros(piece.nodes.len())
}

/// Largest difference between a force and minus the central difference of its energy, over all
/// nodes and components.
fn defect(force: &Field, places: &Field, step: f64, energy: impl Fn(&Field) -> f64) -> f64 {
    let mut worst = 0.0_f64;
    for node in 0..places.len() {
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut shifted = places.clone();
                let mut place = shifted.get(node);
                place[axis] += by;
                shifted.set(node, place);
                energy(&shifted)
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            worst = worst.max((force.get(node)[axis] + slope).abs());
        }
    }
    worst
}

/// A stretch of the sheet by (1 + a, 1 + b) with a slope out of the plane, turned in space.
fn stretched(piece: &Piece, a: f64, b: f64) -> Field {
    let turn = Rotation3::from_euler_angles(0.4, -0.9, 1.3);
    let bumps = pattern(piece.nodes.len(), 3);
    let mut index = 0;
    mapped(piece, |x| {
        let bump = bumps[index] * 1e-5;
        index += 1;
        turn * (Vector3::new(x.x * (1.0 + a), x.y * (1.0 + b), 0.0) + bump)
    })
}

#[test]
fn film_force_is_the_slope_of_strain_energy_in_every_regime() {
    let piece = sheet(4, 3, 0.2, 0.15);
    let cell = 0.05;
    let regimes = [
        (5e-3, 4e-3, Regime::Taut),
        (6e-3, -5e-3, Regime::Wrinkled),
        (-6e-3, -5e-3, Regime::Slack),
        (-0.2, -0.3, Regime::Slack),
    ];
    for compression in [0.0, 0.01, 1.0] {
        let film = Film { compression, ..ELASTIC };
        let model = piece.model(&film);
        for (a, b, regime) in regimes {
            let places = stretched(&piece, a, b);
            for element in 0..model.elements() {
                assert_eq!(model.material.regime(strain(&model, &places, element)), regime);
            }
            let force = film_forces(&model, &places, &still(&piece)).0.film;
            let energy = |places: &Field| strain_energy(&model, places);
            let scale = film.youngs_modulus * film.thickness * cell;
            let worst = defect(&force, &places, 1e-7, energy) / scale;
            println!("{regime:?} c {compression}: {worst:e} of E t h");
            assert!(worst < 1e-6, "{regime:?} c {compression}: {worst}");
        }
    }
}

#[test]
fn work_along_a_path_through_all_regimes_is_the_change_of_energy() {
    let piece = sheet(4, 3, 0.2, 0.15);
    let model = piece.model(&Film { compression: 1e-3, ..ELASTIC });
    // From slack over wrinkled to taut and back to slack on another way.
    let turn = |s: f64| {
        let (a, b) = (8e-3 * libm::sin(s), 8e-3 * libm::sin(1.7 * s + 0.4));
        stretched(&piece, a, b)
    };
    let steps = 20_000;
    let at = |k: i32| turn(f64::from(k) / f64::from(steps) * 4.0);
    let mut places = at(0);
    let start = strain_energy(&model, &places);
    let mut force = film_forces(&model, &places, &still(&piece)).0.film;
    let (mut work, mut largest) = (0.0, 0.0_f64);
    for k in 1..=steps {
        let next = at(k);
        let next_force = film_forces(&model, &next, &still(&piece)).0.film;
        for node in 0..places.len() {
            let mean = (force.get(node) + next_force.get(node)) * 0.5;
            work -= mean.dot(&(next.get(node) - places.get(node)));
        }
        (places, force) = (next, next_force);
        largest = largest.max(strain_energy(&model, &places));
    }
    let change = strain_energy(&model, &places) - start;
    println!("path work {work}, change {change}, largest {largest}");
    assert!(largest > 0.1 && (work - change).abs() < 1e-6 * largest);
}

#[test]
fn patch() {
    let piece = sheet(5, 4, 0.2, 0.15);
    let model = piece.model(&ELASTIC);
    let edge = |node: Vector3<f64>| {
        node.x == 0.0 || node.y == 0.0 || node.x == 0.2 || (node.y - 0.15).abs() < 1e-12
    };
    let places = mapped(&piece, |x| Vector3::new(1.004 * x.x + 0.002 * x.y, 1.003 * x.y, 0.0));
    let force = film_forces(&model, &places, &still(&piece)).0.film;
    let scale = ELASTIC.youngs_modulus * ELASTIC.thickness * 0.04;
    let interior: Vec<f64> = (0..piece.nodes.len())
        .filter(|node| !edge(piece.nodes[*node]))
        .map(|node| force.get(node).norm() / scale)
        .collect();
    assert_eq!(interior.len(), 12);
    assert!(interior.iter().all(|force| *force < 1e-12), "{interior:?}");
    let strains: Vec<f64> = (0..model.elements()).map(|e| strain(&model, &places, e).xx).collect();
    assert!(strains.iter().all(|xx| (xx - 0.5 * (1.004 * 1.004 - 1.0)).abs() < 1e-12));
}

#[test]
fn rigid_rotation_strains_nothing() {
    let piece = icosphere(2, 0.5);
    let model = piece.model(&Film { compression: 1.0, ..PAPER_FILM });
    let axis = Vector3::new(1.0, -2.0, 0.5);
    let turn = Rotation3::new(axis);
    let places = mapped(&piece, |x| turn * x + Vector3::new(3.0, -1.0, 2.0));
    let spin = mapped(&piece, |x| (turn * x).cross(&axis) * 100.0 + Vector3::new(5.0, 0.0, 1.0));
    let (forces, power) = film_forces(&model, &places, &spin);
    let scale = PAPER_FILM.youngs_modulus * PAPER_FILM.thickness * 0.1;
    let worst = forces.film.iter().map(|force| force.norm()).fold(0.0, f64::max) / scale;
    let energy = strain_energy(&model, &places);
    println!("rigid: force {worst:e} of E t h, energy {energy:e} J, power {power:e} W");
    assert!(worst < 1e-12 && energy < 1e-20 * scale, "{worst} {energy}");
    assert!(power.abs() < 1e-15 * scale, "{power}");
}

#[test]
fn viscosity_dissipates_without_force_or_moment() {
    let piece = icosphere(2, 0.5);
    let model = piece.model(&PAPER_FILM);
    for seed in 0..5 {
        let places = Field::of(
            &piece
                .nodes
                .iter()
                .zip(pattern(piece.nodes.len(), seed))
                .map(|(x, off)| x + off * 0.01)
                .collect::<Vec<_>>(),
        );
        let velocities = Field::of(&pattern(piece.nodes.len(), seed + 100));
        let (forces, power) = film_forces(&model, &places, &velocities);
        let drag = &forces.viscous;
        let taken: f64 = drag.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum();
        assert!(power > 0.0 && (taken / power - 1.0).abs() < 1e-12, "{taken} {power}");
        let sum: f64 = drag.iter().map(|force| force.norm()).sum();
        let net: Vector3<f64> = drag.iter().sum();
        let moment: Vector3<f64> = places.iter().zip(drag.iter()).map(|(x, f)| x.cross(&f)).sum();
        assert!(net.norm() < 1e-13 * sum && moment.norm() < 1e-13 * sum, "{net} {moment}");
    }
}

#[test]
fn pressure_is_the_slope_of_volume() {
    let piece = icosphere(1, 0.5);
    let model = piece.model(&ELASTIC);
    let places = Field::of(
        &piece
            .nodes
            .iter()
            .zip(pattern(piece.nodes.len(), 9))
            .map(|(x, off)| x + off * 0.05 + Vector3::new(1.0, 2.0, -3.0))
            .collect::<Vec<_>>(),
    );
    let mut area = film_forces(&model, &places, &still(&piece)).0.area;
    let volume = |places: &Field| -pressure::volume(&model, places);
    let scale = 0.25 * 0.25;
    let worst = defect(&area, &places, 1e-6, volume) / scale;
    println!("volume gradient {worst:e}");
    assert!(worst < 1e-8, "{worst}");
    // No net force and no net moment on a closed film.
    let net: Vector3<f64> = area.iter().sum();
    let moment: Vector3<f64> = places.iter().zip(area.iter()).map(|(x, f)| x.cross(&f)).sum();
    assert!(net.norm() < 1e-14 && moment.norm() < 1e-14, "{net} {moment}");
    // The test can fail.
    area.set(0, area.get(0) * 1.01);
    assert!(defect(&area, &places, 1e-6, volume) / scale > 1e-4);
}

/// `ω_max` of the assembled film at rest, by power iteration on M⁻¹K from finite element forces of
/// the reference gradients (written out here, not through the solver).
fn assembled_frequency(piece: &Piece, model: &FilmModel) -> f64 {
    let film = &model.material;
    let (k, nu) = (film.plane_modulus(), film.poisson_ratio);
    let mut mode = pattern(piece.nodes.len(), 1);
    let mut value = 0.0;
    for _ in 0..4000 {
        let mut force = vec![Vector3::<f64>::zeros(); mode.len()];
        for (element, triangle) in piece.triangles.iter().enumerate() {
            let g = gradients(piece.reference[element]);
            let u = triangle.map(|node| mode[node as usize]);
            let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
            for corner in 0..3 {
                xx += g[(0, corner)] * u[corner].x;
                yy += g[(1, corner)] * u[corner].y;
                xy += g[(1, corner)] * u[corner].x + g[(0, corner)] * u[corner].y;
            }
            let (sx, sy) = (k * (xx + nu * yy), k * (yy + nu * xx));
            let t = 0.5 * k * (1.0 - nu) * xy;
            for corner in 0..3 {
                let (gx, gy) = (g[(0, corner)], g[(1, corner)]);
                let own = Vector3::new(gx * sx + gy * t, gy * sy + gx * t, 0.0);
                force[triangle[corner] as usize] += own * model.volume[element];
            }
        }
        let next: Vec<Vector3<f64>> =
            force.iter().zip(&model.mass).map(|(force, mass)| force / *mass).collect();
        let norm = next.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        value = norm / mode.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        mode = next.iter().map(|v| v / norm).collect();
    }
    value.sqrt()
}

#[test]
fn element_bound_is_never_below_the_assembled_frequency() {
    for (columns, rows, width, height) in [(4, 3, 0.2, 0.15), (6, 2, 0.1, 0.15), (3, 5, 0.4, 0.05)]
    {
        let piece = sheet(columns, rows, width, height);
        let model = piece.model(&ELASTIC);
        let assembled = assembled_frequency(&piece, &model);
        let share = assembled / model.largest_frequency();
        println!("{columns}x{rows}: assembled {assembled} rad/s, {share} of the element bound");
        assert!(share <= 1.0 && share > 0.7, "{share}");
    }
}

#[test]
fn what_is_no_film_is_refused() {
    let piece = sheet(2, 2, 0.1, 0.1);
    let model = |piece: &Piece, nodes| {
        FilmModel::new(&ELASTIC, nodes, &piece.triangles, &piece.reference).unwrap_err()
    };
    assert_eq!(model(&piece, 10), FilmError::Loose { node: 9 });
    assert!(matches!(model(&piece, 8), FilmError::Unknown { nodes: 8, .. }));
    let mut turned = piece.clone();
    turned.reference[3].swap(0, 1);
    assert!(matches!(model(&turned, 9), FilmError::Degenerate { element: 3, .. }));
}

#[test]
fn damping_factors() {
    assert_eq!(damping::kick_factors(0.0, 1e-3), (1.0, 1e-3));
    let (keep, gain) = damping::kick_factors(2.0, 0.5);
    assert!((keep - 1.0 / 3.0).abs() < 1e-15 && (gain - 1.0 / 3.0).abs() < 1e-15);
    assert!((damping::stable_share(0.1) - 0.904_987_562_112_089).abs() < 1e-14);
}
