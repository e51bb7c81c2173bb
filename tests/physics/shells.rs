//! Closed films at rest against closed forms, and the order of film and gas in the step. Breathing
//! spheres are reference cases of `billow-checks validate`.

use std::sync::LazyLock;

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shapes::{icosphere, tube};
use billow_solver::integrators::{FilmSimulation, SimulationSettings};
use billow_solver::mechanics::gas::GasState;
use billow_solver::scene::{Film, Species};
use billow_solver::statics::Relaxation;
use billow_solver::system::PressureLoad;
use nalgebra::Vector3;
use serde_json::Value;

use crate::film_rig::{at_rest, edited, free, moving, nitrogen_gas, orders};

static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../reference/film.json")).expect("JSON in tests/reference")
});

fn number(path: &str) -> f64 {
    REFERENCE.pointer(&format!("/{path}")).and_then(Value::as_f64).expect("a number")
}

fn rows(case: &str) -> Vec<[f64; 2]> {
    let rows = REFERENCE[case]["rows"].as_array().expect("rows");
    rows.iter().map(|row| [0, 1].map(|k| row[k].as_f64().expect("a number"))).collect()
}

/// λ − 1 of a relaxed sphere, from the mean radius over that of the unloaded mesh; and its film.
fn sphere_stretch(level: u32, overpressure: f64) -> (f64, FilmSimulation) {
    let piece = icosphere(level, number("sphere/radius"));
    let load = (PressureLoad::Overpressure(overpressure), GasState::default());
    let still = Field::zeros(piece.positions.len());
    let film = moving(&piece, &Film::PAPER, load, still, |_, settings| settings.cfl = 0.9);
    let relaxation = Relaxation { max_kinetic_fraction: 1e-14, ..Relaxation::default() };
    let film = relaxation.relax_at(film, overpressure).unwrap();
    let loaded: f64 = film.view().state.positions.iter().map(|x| x.norm()).sum();
    let unloaded: f64 = piece.positions.iter().map(Vector3::norm).sum();
    (loaded / unloaded - 1.0, film)
}

#[test]
fn the_stretch_of_a_sphere_converges_to_its_closed_form() {
    for [overpressure, expected] in rows("sphere") {
        let errors: Vec<f64> =
            [1, 2, 3].map(|level| sphere_stretch(level, overpressure).0 / expected - 1.0).to_vec();
        let orders = orders(&errors);
        println!("sphere {overpressure} Pa: errors {errors:?}, orders {orders:?}");
        assert!(errors[2].abs() < number("sphere/band"), "{errors:?}");
        assert!(orders.iter().all(|order| *order >= number("sphere/order")), "{orders:?}");
    }
}

/// A tube between two planes with the axial stretch of the closed form: its hoop stretch and its
/// axial force.
#[test]
fn hoop_stretch_and_axial_force_of_a_cylinder_converge() {
    let radius = number("cylinder/radius");
    let (axial, hoop) = (number("cylinder/axial"), number("cylinder/hoop"));
    let overpressure = number("cylinder/overpressure");
    let errors: Vec<[f64; 2]> = [24_u32, 48, 96]
        .map(|around| {
            let along = around / 8;
            let piece = tube(around, along, radius, 0.4);
            let ends: Vec<u32> = (0..around).chain(along * around..(along + 1) * around).collect();
            let load = (PressureLoad::Overpressure(overpressure), GasState::default());
            let still = Field::zeros(piece.positions.len());
            let film = moving(&piece, &Film::PAPER, load, still, |system, settings| {
                settings.cfl = 0.9;
                system.supports.hold(&ends, "z");
            });
            let film = edited(film, |stored| {
                let z = &mut stored.state.positions.z;
                (0..z.len()).for_each(|node| z[node] *= 1.0 + axial);
            });
            let relaxation = Relaxation { max_kinetic_fraction: 1e-14, ..Relaxation::default() };
            let film = relaxation.relax_at(film, overpressure).unwrap();
            let mean: f64 = film.view().state.positions.iter().map(|x| x.xy().norm()).sum::<f64>()
                / film.view().state.positions.len() as f64;
            let pull: f64 = (0..around as usize).map(|node| film.view().force(node).z).sum();
            // The axial force of a closed end is p π r².
            let r = radius * (1.0 + hoop);
            let expected = overpressure * std::f64::consts::PI * r * r;
            [(mean / radius - 1.0) / hoop - 1.0, pull / expected - 1.0]
        })
        .to_vec();
    let hoops: Vec<f64> = errors.iter().map(|error| error[0]).collect();
    let pulls: Vec<f64> = errors.iter().map(|error| error[1]).collect();
    println!("cylinder: hoop {hoops:?} orders {:?}; axial {pulls:?}", orders(&hoops));
    assert!(hoops[2].abs() < number("cylinder/band") && pulls[2].abs() < number("cylinder/band"));
    assert!(orders(&hoops).iter().all(|order| *order >= 1.8), "{hoops:?}");
}

/// A sphere released unstretched. Its gas has this pressure (Pa) at equilibrium.
fn released(level: u32, pressure: f64) -> FilmSimulation {
    let gas = nitrogen_gas();
    let rest = sphere_stretch(level, pressure).1.view().state.volume;
    let piece = icosphere(level, number("breathing_sphere/radius"));
    let empty = at_rest(&piece, &Film::PAPER_ELASTIC, PressureLoad::Gas(gas), GasState::default());
    let pressure = pressure * (rest / empty.view().state.volume).powf(gas.gamma());
    let mass = pressure * empty.view().state.volume / (Species::NITROGEN.gas_constant * 293.0);
    at_rest(&piece, &Film::PAPER_ELASTIC, PressureLoad::Gas(gas), gas.at_temperature(mass, 293.0))
}

#[test]
fn film_with_gas_is_of_second_order_in_the_step() {
    let volume = |cfl: f64| {
        let film = released(1, 1000.0);
        let mut film =
            film.with(|system, settings| (system, SimulationSettings { cfl, ..settings }));
        film.advance(0.9e-3, &free()).unwrap();
        film.view().state.volume
    };
    let exact = volume(0.005);
    let errors: Vec<f64> = [0.4, 0.2, 0.1].map(|cfl| volume(cfl) - exact).to_vec();
    println!("step order: {errors:?}, {:?}", orders(&errors));
    assert!(orders(&errors).iter().all(|order| *order > 1.9 && *order < 2.1), "{errors:?}");
}
