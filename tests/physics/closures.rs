//! Vessels whose ends are closed by faces that are no film: the closure carries no load away.

use std::f64::consts::FRAC_PI_2;

use billow_solver::geometry::shapes::{disc, icosphere, moved, pseudo_random, ring_nodes, tube};
use billow_solver::mechanics::forces::pressure::{add_closure, volume};
use billow_solver::mechanics::forces::tangent;
use billow_solver::models::film::capsule;
use billow_solver::scene::paper::{free_film, nitrogen_supply};
use billow_solver::statics::solve;
use billow_solver::system::TermStiffness;

use crate::film_rig::{film_forces, support};
use crate::prelude::*;

const RADIUS: f64 = 0.25;
const LENGTH: f64 = 0.4;
const AROUND: u32 = 16;
const ALONG: u32 = 4;
const PRESSURE: f64 = 100.0;
/// p A of an end, N.
const END_LOAD: f64 = PRESSURE * core::f64::consts::PI * RADIUS * RADIUS;

/// Closes a loop by faces with a ring of inner vertices and one more near its middle, this far off the mean
/// of the loop along z (m).
fn cap(shell: &mut Shell, rim: &[u32], lift: f64) {
    let at = |node: &u32| shell.positions[*node as usize];
    let mean = rim.iter().map(at).sum::<Vector3<f64>>() / rim.len() as f64;
    let up = Vector3::z() * lift;
    let inner: Vec<Vector3<f64>> =
        rim.iter().map(|node| mean + (at(node) - mean) * 0.6 + up).collect();
    let first = shell.positions.len() as u32;
    shell.positions.extend(inner);
    let centre = shell.positions.len() as u32;
    shell.positions.push(mean + Vector3::new(0.02, -0.03, 0.0) + up * 1.5);
    for k in 0..rim.len() {
        let next = (k + 1) % rim.len();
        let (a, b) = (rim[k], rim[next]);
        let (c, d) = (first + k as u32, first + next as u32);
        shell.closure.extend([[a, b, d], [a, d, c], [c, d, centre]]);
    }
}

/// A tube off the origin whose upper rim is warped by this height (m).
fn open_tube(warp: f64) -> Shell {
    moved(tube(AROUND, ALONG, RADIUS, LENGTH), |x| {
        let angle = libm::atan2(x.y, x.x);
        let share = (x.z / LENGTH).powi(2);
        x + Vector3::new(0.3, -0.2, 0.5 + warp * share * libm::cos(2.0 * angle))
    })
}

/// The tube with both ends closed by given faces.
pub fn vessel(warp: f64, lift: f64) -> Shell {
    let mut shell = open_tube(warp);
    for rim in shell.boundary() {
        let upper = rim.contains(&(ALONG * AROUND));
        cap(&mut shell, &rim, if upper { lift } else { -0.5 * lift });
    }
    let closure = shell.closure;
    let shell = Shell { closure, ..Shell::relaxed(shell.positions, shell.triangles) };
    shell.check().unwrap();
    assert!(shell.is_closed());
    shell
}

/// The ring in the middle is held.
fn middle() -> FilmSupport {
    support("middle", ring_nodes(ALONG / 2, AROUND), Hold::Components([true; 3]))
}

/// Vessels: plane ends, a dome, warped rims, both.
const VESSELS: [(f64, f64); 4] = [(0.0, 0.0), (0.0, 0.05), (0.04, 0.0), (0.04, -0.03)];

#[test]
fn the_closure_starts_in_the_shape_of_its_file() {
    for (warp, lift) in VESSELS {
        let shell = vessel(warp, lift);
        let start = Field::of(&shell.positions);
        let model = FilmModel::supported(&Film::PAPER_ELASTIC, &shell, |_| false).unwrap();
        let mut placed = start.clone();
        model.closure_nodes.place(&mut placed);
        let moved =
            start.iter().zip(placed.iter()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(moved < 1e-14, "{moved}");
        let closed = volume(&model, &placed);
        assert!((closed / shell.volume(|node| shell.positions[node as usize]) - 1.0).abs() < 1e-14);
    }
}

#[test]
fn statics_of_a_closed_vessel_leave_no_reaction() {
    for (warp, lift) in VESSELS {
        let scene = FilmScene {
            filling: Filling::Pressure(PRESSURE),
            supports: vec![middle()],
            ..free_film(vessel(warp, lift), Film::PAPER_ELASTIC)
        };
        let state = solve(&scene, None, &mut || true).unwrap();
        let reaction = &state.reactions[0];
        let [force, moment] = [reaction.force.norm(), reaction.moment.norm()];
        assert!(force < 1e-9 * END_LOAD, "{warp} {lift}: {force} N");
        assert!(moment < 1e-9 * END_LOAD * LENGTH, "{warp} {lift}: {moment} N m");
    }
}

/// Central differences of the forces of a pressure that is large beside the film's tension, along random moves.
#[test]
fn the_stiffness_of_a_closure_is_the_slope_of_its_forces() {
    for (warp, lift) in VESSELS {
        let shell = vessel(warp, lift);
        let model = FilmModel::supported(&Film::PAPER_ELASTIC, &shell, |_| false).unwrap();
        let pressure = 1e7;
        let system = FilmSystem::free(model, PressureLoad::Overpressure(pressure));
        let model = &system.model;
        let with = |moves: &[Vector3<f64>], by: f64| {
            let taut = shell.positions.iter().zip(moves).map(|(x, u)| x * 1.01 + u * by);
            let mut positions = Field::of(&taut.collect::<Vec<_>>());
            model.closure_nodes.place(&mut positions);
            positions
        };
        let moves = pseudo_random(shell.positions.len(), 7);
        let moves: Vec<Vector3<f64>> = moves
            .iter()
            .zip(&model.mass)
            .map(|(u, mass)| if *mass > 0.0 { *u } else { u * 0.0 })
            .collect();
        let forces = |by: f64| {
            let positions = with(&moves, by);
            let mut nodes = film_forces(model, &positions);
            let _ = add_closure(model, &positions, &mut nodes);
            let of_node = |node| system.node_force(&nodes, pressure, node);
            Field::of(&(0..model.nodes()).map(of_node).collect::<Vec<_>>())
        };
        let step = 1e-7;
        let [before, after] = [-step, step].map(forces);
        let positions = with(&moves, 0.0);
        let mut products = Field::zeros(model.nodes());
        let (faces, stiffness): (Vec<_>, Vec<_>) =
            system.face_stiffness(&[], &positions, pressure).unzip();
        tangent::add_products(&faces, &stiffness, &Field::of(&moves), &mut products);
        let mut terms = TermStiffness::new(&system);
        terms.prepare(&system, &positions, pressure, &[]);
        terms.add_product(&system, &Field::of(&moves), &mut products);
        let of_film = (0..model.nodes()).filter(|node| model.mass[*node] > 0.0);
        for node in of_film {
            let slope = (before.get(node) - after.get(node)) / (2.0 * step);
            let error = (products.get(node) - slope).norm();
            assert!(error < 1e-6 * pressure, "{warp} {lift}, node {node}: {error} N/m");
        }
    }
}

/// Nothing holds these vessels: rigid motions have no stiffness, and at some pressures rounding is all that remains.
#[test]
fn a_free_vessel_has_an_equilibrium_at_any_pressure() {
    let shells = [vessel(0.0, 0.0), vessel(0.04, 0.05), icosphere(2, 0.5)];
    for shell in shells {
        for pressure in [1.0, 30.0, 1e3, 5e3, 3e4] {
            let film = free_film(shell.clone(), Film::PAPER_ELASTIC);
            let scene = FilmScene { filling: Filling::Pressure(pressure), ..film };
            let state = solve(&scene, None, &mut || true);
            let state = state.unwrap_or_else(|error| panic!("{pressure} Pa: {error}"));
            assert!(state.iterations < 200, "{pressure} Pa: {} steps", state.iterations);
        }
    }
}

/// Film with gas at the test's pressure, at rest in its scene's shape.
pub fn with_gas(shell: Shell, supports: Vec<FilmSupport>, mass_damping: f64) -> FilmSimulation {
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let supply = nitrogen_supply();
    let initial_mass = PRESSURE * volume / (supply.species.gas_constant * 293.0);
    let supply = GasSupply { initial_mass, ..supply };
    let mut scene = FilmScene {
        filling: Filling::Gas { supply, initial_temperature: 293.0 },
        supports,
        ..free_film(shell, Film::PAPER_ELASTIC)
    };
    scene.solver.mass_damping = mass_damping;
    capsule::start(&scene, &[]).unwrap()
}

/// Largest force and moment of all nodes together over those of an end, in motion.
fn imbalance(film: &mut FilmSimulation) -> f64 {
    let mut largest = 0.0_f64;
    for sample in 1..=5 {
        film.advance(1e-3 * f64::from(sample), &Phase::default()).unwrap();
        let (mut sum, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for node in 0..film.view().system.model.nodes() {
            let force = film.view().force(node);
            sum += force;
            moment += film.view().state.positions.get(node).cross(&force);
        }
        largest = largest.max(sum.norm()).max(moment.norm() / LENGTH);
    }
    largest / END_LOAD
}

#[test]
fn film_in_motion_gives_no_load_to_its_closure() {
    for (warp, lift) in VESSELS {
        for supports in [vec![middle()], Vec::new()] {
            let mut film = with_gas(vessel(warp, lift), supports, 0.0);
            let start = film.view().ledger();
            assert!(imbalance(&mut film) < 1e-11, "{warp} {lift}");
            let ledger = film.view().ledger();
            let defect = ledger.defect(&start).abs() / (ledger.kinetic + ledger.external());
            assert!(defect < 1e-3, "{warp} {lift}: ledger {defect}");
        }
    }
}

#[test]
fn fans_over_free_rims_move_with_them() {
    for warp in [0.0, 0.04] {
        let mut shell = open_tube(warp);
        let apexes = shell.close(|_| Matrix3::identity());
        assert!(apexes.len() == 2 && shell.walls.is_empty());
        let mut film = with_gas(shell, vec![middle()], 0.0);
        assert!(imbalance(&mut film) < 1e-11, "{warp}");
    }
}

/// Half a sphere on a symmetry plane: the fan over its rim is the plane, not part of the film.
#[test]
fn symmetry_planes_take_the_pressure_on_their_fans() {
    for centre in [Vector3::zeros(), Vector3::new(0.1, 0.2, 0.3)] {
        // A disc bulged to half a sphere.
        let mut shell = moved(disc(6, RADIUS), |x| {
            let [sin, cos] = [libm::sin, libm::cos].map(|f| f(FRAC_PI_2 * x.norm() / RADIUS));
            let outward = x.try_normalize(1e-12).unwrap_or_default();
            centre + (outward * sin + Vector3::z() * cos) * RADIUS
        });
        shell = Shell::relaxed(shell.positions, shell.triangles);
        let rim = shell.boundary().concat();
        let mut nodes = rim.clone();
        nodes.sort_unstable();
        let plane = support("plane", nodes, Hold::Plane(Vector3::z()));
        let supports = Supports::new(std::slice::from_ref(&plane), &Field::of(&shell.positions));
        let _ = shell.close(|node| supports.projector(node as usize));
        assert_eq!(shell.walls.len(), 1);
        let mut film = with_gas(shell, vec![plane.clone()], 2000.0);
        film.advance(0.02, &Phase::default()).unwrap();
        let at = |node: u32| film.view().state.positions.get(node as usize) - centre;
        let faces = (0..rim.len()).map(|k| at(rim[(k + 1) % rim.len()]).cross(&at(rim[k])).z);
        let [force, _] = film.view().reaction(&plane.nodes, &plane.hold.projector());
        let expected = film.view().overpressure() * 0.5 * faces.sum::<f64>().abs();
        assert!((force.z / expected - 1.0).abs() < 1e-3, "{force:?} {expected}");
    }
}

#[test]
fn a_vertex_without_a_rim_is_refused() {
    // A closure whose inner ring is free: it ends nowhere.
    let mut shell = vessel(0.0, 0.0);
    let centre = shell.positions.len() as u32 - 1;
    shell.closure.retain(|face| !face.contains(&centre));
    let error =
        FilmModel::supported(&Film::PAPER_ELASTIC, &shell, |_| false).unwrap_err().to_string();
    assert!(error.contains("closing faces"), "{error}");
}
