//! The system of film: energies and their derivatives agree, dissipation takes energy, looking changes nothing.

use std::sync::Arc;

use billow_solver::geometry::shapes::{icosphere, pseudo_random};
use billow_solver::models::film::capsule;
use billow_solver::scene::paper::{free_film, nitrogen_supply};
use billow_solver::system::{Evaluation, TermStiffness};

use crate::closures;
use crate::film_rig::{INFLOW, capsule_film, free, pressed_sheets, still};
use crate::prelude::*;
use crate::spring::Spring;

/// The paper's capsule at n 3 with gas, contact, friction and adhesion, 15 ms after its release.
fn capsule_in_contact() -> FilmSimulation {
    let contact = FilmContact { friction: 0.2, adhesion: 50.0, ..FilmContact::default() };
    let mut film = capsule_film(InstructionSet::detect(), Some(contact), |scene| {
        scene.gravity = -9.8;
        scene.film.numerical_damping = 0.05;
    });
    film.advance(0.015, &INFLOW).unwrap();
    assert!(film.view().state.contact.contacts.iter().any(|contact| contact.energy > 0.0));
    film
}

/// A sphere of film with loss under gas and gravity, out of shape, after 2 ms.
fn sphere(heat_transfer: HeatTransfer) -> FilmSimulation {
    let supply = GasSupply {
        initial_mass: 2e-2,
        ambient_pressure: 300.0,
        heat_transfer,
        ..nitrogen_supply()
    };
    let film = Film { loss_factor: 0.1, loss_frequency: 300.0, compression: 0.1, ..Film::PAPER };
    let shell = icosphere(2, 0.5);
    let velocities = pseudo_random(shell.positions.len(), 3);
    let mut film = capsule::start(
        &FilmScene {
            filling: Filling::Gas { supply, initial_temperature: 320.0 },
            gravity: Vector3::new(1.0, -2.0, -9.8),
            velocities,
            ..free_film(shell, film)
        },
        &[],
    )
    .unwrap();
    film.advance(2e-3, &free()).unwrap();
    film
}

/// A sphere whose nodes at the far ends of its numbers a stretched spring joins.
fn sphere_with_a_spring() -> FilmSimulation {
    let shell = icosphere(1, 0.5);
    let nodes = [0, shell.positions.len() as u32 - 1];
    let load = (PressureLoad::Overpressure(100.0), GasState::default());
    still(&shell, &Film { compression: 1.0, ..Film::PAPER_ELASTIC }, load, |system, _| {
        let spring = Spring { nodes, stiffness: 4e3, rest_length: 0.1 };
        system.energy_terms.push(Arc::new(spring));
    })
}

/// A tube with a warped rim and closed ends, after 3 ms under gas.
fn inflated_vessel() -> FilmSimulation {
    let mut film = closures::with_gas(closures::vessel(0.04, -0.03), Vec::new(), 0.0);
    film.advance(3e-3, &free()).unwrap();
    film
}

fn films() -> Vec<(&'static str, FilmSimulation)> {
    vec![
        ("capsule", capsule_in_contact()),
        ("sphere", sphere(HeatTransfer::Coefficient(3.0))),
        ("isothermal sphere", sphere(HeatTransfer::Isothermal)),
        ("pressed sheets", pressed_sheets(MonitorSettings::FRAMES, 0.0)),
        ("sphere with a spring", sphere_with_a_spring()),
        ("vessel", inflated_vessel()),
    ]
}

/// Positions plus `factor` times a pseudo-random displacement of all nodes.
fn displaced(system: &FilmSystem, state: &FilmState, factor: f64) -> (Field, Vec<Vector3<f64>>) {
    let directions = pseudo_random(state.positions.len(), 11);
    let moved = state.positions.iter().zip(&directions).map(|(x, u)| x + u * factor);
    let mut positions = Field::of(&moved.collect::<Vec<_>>());
    // Vertices of the closure follow the film.
    system.model.closure_nodes.place(&mut positions);
    (positions, directions)
}

fn forces(
    system: &FilmSystem,
    workspace: &Workspace,
    evaluation: &Evaluation,
) -> Vec<Vector3<f64>> {
    let overpressure = system.overpressure_at(evaluation.gas_pressure);
    let planes = |node: usize| -> Vector3<f64> {
        let bodies = system.supports.bodies.iter();
        let of = bodies.filter(|body| body.nodes.first() == Some(&u32::try_from(node).unwrap()));
        of.map(|body| body.plane.normal * body.plane.force).sum()
    };
    (0..system.model.nodes())
        .map(|node| system.node_force(&workspace.forces, overpressure, node) + planes(node))
        .collect()
}

#[test]
fn forces_are_minus_the_slope_of_the_energy() {
    for (name, film) in films() {
        let now = film.view();
        let (system, state) = (now.system, now.state);
        let mut workspace = Workspace::new(system, state);
        let mut at = |factor: f64| {
            let (positions, _) = displaced(system, state, factor);
            system.evaluate(state, &positions, state.time, &mut workspace).energy()
        };
        let small = 1e-8;
        let slope = (at(small) - at(-small)) / (2.0 * small);
        let (positions, directions) = displaced(system, state, 0.0);
        let evaluation = system.evaluate(state, &positions, state.time, &mut workspace);
        let forces = forces(system, &workspace, &evaluation);
        let power: f64 = forces.iter().zip(&directions).map(|(f, u)| f.dot(u)).sum();
        let size: f64 = forces.iter().zip(&directions).map(|(f, u)| f.dot(u).abs()).sum();
        assert!((slope + power).abs() < 2e-6 * size, "{name}: {slope} {power} of {size}");
        assert!(evaluation.contact != 0.0 || system.contact.is_none(), "{name}");
        // At the state itself the conservative forces are those of the run but for its numerical stress.
        assert!((evaluation.volume / state.volume - 1.0).abs() < 1e-12, "{name}");
        assert!((evaluation.gas_pressure - state.pressure).abs() <= 1e-12 * state.pressure.abs());
    }
}

#[test]
fn the_stiffness_is_minus_the_slope_of_the_forces() {
    for (name, film) in films() {
        let now = film.view();
        let (system, state) = (now.system, now.state);
        let mut workspace = Workspace::new(system, state);
        let small = 1e-9;
        let mut at = |factor: f64| {
            let (positions, _) = displaced(system, state, factor);
            let evaluation = system.evaluate(state, &positions, state.time, &mut workspace);
            forces(system, &workspace, &evaluation)
        };
        let (after, before) = (at(small), at(-small));
        let (positions, directions) = displaced(system, state, 0.0);
        let evaluation = system.evaluate(state, &positions, state.time, &mut workspace);
        let mut product = vec![Vector3::zeros(); directions.len()];
        let at_now = (&positions, state.time);
        let mut add = |[a, b]: [u32; 2], block: &Matrix3<f64>| {
            product[a as usize] += block * directions[b as usize];
        };
        let overpressure = system.overpressure_at(evaluation.gas_pressure);
        for (nodes, stiffness) in system.face_stiffness(&state.creep, &positions, overpressure) {
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                add([nodes[i], nodes[j]], &stiffness.fixed_view::<3, 3>(3 * i, 3 * j).into());
            }
        }
        system.pair_stiffness(at_now, &workspace, &mut add);
        let mut terms = TermStiffness::new(system);
        terms.prepare(system, &positions, overpressure, &state.yielded);
        let mut of_terms = Field::zeros(directions.len());
        terms.add_product(system, &Field::of(&directions), &mut of_terms);
        for (sum, of_terms) in product.iter_mut().zip(of_terms.iter()) {
            *sum += of_terms;
        }
        if let Some(gas) = system.gas_stiffness(&evaluation, &workspace) {
            let rate: f64 = gas.gradient.iter().zip(&directions).map(|(g, u)| g.dot(u)).sum();
            for (sum, gradient) in product.iter_mut().zip(gas.gradient.iter()) {
                *sum += gradient * (gas.factor * rate);
            }
        }
        let norm = |all: &[Vector3<f64>]| all.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        let slope: Vec<Vector3<f64>> =
            after.iter().zip(&before).map(|(a, b)| (b - a) / (2.0 * small)).collect();
        let off: Vec<Vector3<f64>> = slope.iter().zip(&product).map(|(a, b)| a - b).collect();
        let (off, size) = (norm(&off), norm(&product));
        assert!(off < 1e-4 * size, "{name}: {off} of {size}");
    }
}

#[test]
fn looking_at_film_changes_nothing() {
    let film = capsule_in_contact();
    let (system, state) = (film.view().system, film.view().state);
    let before = state.clone();
    let mut workspace = Workspace::new(system, state);
    let first =
        system.evaluate(state, &displaced(system, state, 1e-5).0, state.time, &mut workspace);
    let _ = system.evaluate(state, &displaced(system, state, -2e-5).0, state.time, &mut workspace);
    let again =
        system.evaluate(state, &displaced(system, state, 1e-5).0, state.time, &mut workspace);
    assert_eq!(first, again);
    assert_eq!(*state, before);
}

/// The safe share of a motion through film and floor leaves every pair a tenth of its distance, and is 1 where
/// nothing meets.
#[test]
fn a_safe_step_lets_nothing_through() {
    let film = pressed_sheets(MonitorSettings::FRAMES, 0.0);
    let (system, state) = (film.view().system, film.view().state);
    let model = system.contact.as_ref().unwrap();
    let gaps = |positions: &Field| {
        let mut least = f64::INFINITY;
        model.pairs_within(positions, 2.0 * model.distance, |_, gap| least = least.min(gap));
        least.min(model.plates[0].smallest_gap(positions, state.time))
    };
    let half = state.positions.len() / 2;
    let at = (&state.positions, state.time);
    let apart = |factor: f64| {
        let up = |node: usize| Vector3::z() * if node < half { 0.5 * factor } else { factor };
        Field::of(&(0..state.positions.len()).map(up).collect::<Vec<_>>())
    };
    let moved = |displacements: &Field, share: f64| {
        let all = state.positions.iter().zip(displacements.iter());
        Field::of(&all.map(|(x, u)| x + u * share).collect::<Vec<_>>())
    };
    let before = gaps(&state.positions);
    for factor in [-0.1, -1.0, -10.0] {
        let displacements = apart(factor);
        let share = system.safe_step(at, &displacements, &mut Workspace::new(system, state));
        let after = gaps(&moved(&displacements, share));
        assert!(share > 0.0 && share < 1.0, "{factor}: {share}");
        assert!(after >= 0.0999 * before, "{factor}: {before} to {after}");
    }
    let share = system.safe_step(at, &apart(0.05), &mut Workspace::new(system, state));
    assert_eq!(share.to_bits(), 1.0_f64.to_bits());
}
