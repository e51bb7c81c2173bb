//! The moving mass against closed forms.

use billow_solver::course::Phase;
use billow_solver::deployment::Model;
use billow_solver::gas::{Gas, GasState, Inflow};
use billow_solver::integrate::{Control, DEFAULT_TOLERANCE};
use billow_solver::ladder::piston::{EndFilm, Piston, PistonRun, PistonState, VolumeLaw};
use billow_solver::scene::{GasSupply, Species};

use crate::rig::{adaptive, fixed, number, rows, supply, tube};

fn injection() -> Phase {
    let rate = number("injected_piston/rate");
    let temperature = number("injected_piston/inflow_temperature");
    Phase { packed: false, inflow: Inflow { mass: rate, mass_temperature: rate * temperature } }
}

/// Position at 50 ms of the piston in vacuum, from the closed form at 1 ms on.
fn injected(control: Control) -> PistonRun {
    let gas = Gas::new(&supply(), 293.0, 1.0);
    let c = number("injected_piston/C");
    let (start, end) = (number("injected_piston/start"), number("injected_piston/end"));
    let gamma = gas.gamma();
    let temperature =
        number("injected_piston/inflow_temperature") * 2.0 * gamma / (3.0 * gamma - 1.0);
    let state = PistonState {
        height: c * start.powf(1.5),
        speed: 1.5 * c * start.sqrt(),
        gas: gas.at_temperature(number("injected_piston/rate") * start, temperature),
    };
    // The closed form does not depend on the area: any will do.
    let piston = tube(0.7, 0.0, number("injected_piston/mass"), gas);
    let mut run = PistonRun::new(piston, start, state, control);
    run.advance(end, &injection()).unwrap();
    run
}

#[test]
fn injected_piston_follows_the_closed_form() {
    let (band, expected) =
        (number("injected_piston/band"), number("injected_piston/position_at_50_ms"));
    for control in [adaptive(DEFAULT_TOLERANCE), fixed(2e-5)] {
        let state = injected(control).state();
        assert!((state.height / expected - 1.0).abs() < band, "{}", state.height);
        let enthalpy = number("injected_piston/rate")
            * number("injected_piston/end")
            * number("nitrogen/cp")
            * number("injected_piston/inflow_temperature");
        let kinetic = 0.5 * number("injected_piston/mass") * state.speed * state.speed;
        let share = number("injected_piston/kinetic_share_of_enthalpy");
        assert!((kinetic / enthalpy / share - 1.0).abs() < 1e-5, "{}", kinetic / enthalpy);
    }
}

#[test]
fn fixed_steps_converge_with_order_five() {
    let exact = injected(adaptive(1e-13)).state().height;
    let errors: Vec<f64> = [8e-4, 4e-4, 2e-4]
        .map(|step| (injected(fixed(step)).state().height - exact).abs())
        .to_vec();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        println!("injected piston: errors {:e} {:e}, order {order:.2}", pair[0], pair[1]);
        assert!(order > 4.5, "order {order}, errors {errors:?}");
    }
}

/// Heun's rule with Richardson's extrapolation in steps (Gragg-free Romberg on the whole interval):
/// independent of the solver's integrator and of its formulas' arrangement.
fn extrapolated_position(offset: f64, area: f64, end: f64) -> f64 {
    let cp = number("nitrogen/cp");
    let gas_constant = number("nitrogen/gas_constant");
    let excess = cp / (cp - gas_constant) - 1.0;
    let power = number("injected_piston/rate") * cp * number("injected_piston/inflow_temperature");
    let mass = number("injected_piston/mass");
    // U follows from the energy let in: U = Ḣ t − M ẋ²/2.
    let acceleration = |t: f64, x: f64, v: f64| {
        excess * (power * t - 0.5 * mass * v * v) / (area * x + offset) * area / mass
    };
    let classical = |n: u32| {
        let h = end / f64::from(n);
        let (mut x, mut v) = (0.0, 0.0);
        for i in 0..n {
            let t = f64::from(i) * h;
            let (k1x, k1v) = (v, acceleration(t, x, v));
            let (k2x, k2v) = (
                v + 0.5 * h * k1v,
                acceleration(t + 0.5 * h, x + 0.5 * h * k1x, v + 0.5 * h * k1v),
            );
            let (k3x, k3v) = (
                v + 0.5 * h * k2v,
                acceleration(t + 0.5 * h, x + 0.5 * h * k2x, v + 0.5 * h * k2v),
            );
            let (k4x, k4v) = (v + h * k3v, acceleration(t + h, x + h * k3x, v + h * k3v));
            x += h / 6.0 * (k1x + 2.0 * k2x + 2.0 * k3x + k4x);
            v += h / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v);
        }
        x
    };
    let (coarse, fine) = (classical(20_000), classical(40_000));
    assert!((fine / coarse - 1.0).abs() < 1e-9, "{coarse} {fine}");
    fine + (fine - coarse) / 15.0
}

#[test]
fn injected_piston_from_a_dead_volume() {
    let (area, offset) = (0.7, number("injected_piston/offset_volume"));
    let gas = Gas::new(&supply(), 293.0, 1.0);
    let piston = tube(area, offset, number("injected_piston/mass"), gas);
    // At z = 0 the height is not yet above zero, so z counts from 0.1 m on.
    let shift = 0.1;
    let volume = VolumeLaw::Uniform { area, offset: offset - area * shift };
    let piston = Piston { volume, ..piston };
    let start = PistonState { height: shift, speed: 0.0, gas: GasState::default() };
    let end = number("injected_piston/end");
    let expected = extrapolated_position(offset, area, end);
    for control in [adaptive(DEFAULT_TOLERANCE), fixed(1e-5)] {
        let mut run = PistonRun::new(piston, 0.0, start, control);
        run.advance(end, &injection()).unwrap();
        let travelled = run.state().height - shift;
        let band = number("injected_piston/offset_band");
        assert!((travelled / expected - 1.0).abs() < band, "{travelled} {expected}");
    }
}

#[test]
fn gas_spring_periods() {
    let gamma = number("gas_spring/gamma");
    // cp/cv = 1.4 exactly.
    let species = Species { gas_constant: 296.8, cp: 296.8 * gamma / (gamma - 1.0) };
    let gas = Gas::new(&GasSupply { species, ..supply() }, 293.0, 1.0);
    let (mass, length, area, pressure) = (0.4, 0.3, 0.02, 2000.0);
    let linear = 2.0 * std::f64::consts::PI * (mass * length / (gamma * pressure * area)).sqrt();
    let energy_at_rest = pressure * area * length / (gamma - 1.0);
    for row in rows("gas_spring") {
        let (amplitude, ratio) = (row[0], row[1]);
        let gas_state = GasState {
            mass: pressure * area * length / (species.gas_constant * 293.0),
            internal_energy: energy_at_rest * (1.0 + amplitude).powf(1.0 - gamma),
        };
        let start = length * (1.0 + amplitude);
        let piston = Piston { weight: -pressure * area, ..tube(area, 0.0, mass, gas) };
        let state = PistonState { height: start, speed: 0.0, gas: gas_state };
        let mut run = PistonRun::new(piston, 0.0, state, adaptive(1e-10));
        run.advance(ratio * linear, &Phase::default()).unwrap();
        // Back at rest after one period: what speed is left tells by how much it was missed.
        let now = run.state();
        let force = pressure * area * ((1.0 + amplitude).powf(-gamma) - 1.0);
        let missed = now.speed / (force / mass);
        let period = ratio * linear - missed;
        let band = number("gas_spring/band");
        assert!((period / linear / ratio - 1.0).abs() < band, "{amplitude}: {}", period / linear);
        assert!((now.height / start - 1.0).abs() < 1e-7);
    }
}

/// Bounces of a driven mass on its end film.
fn on_its_end(control: Control) -> PistonRun {
    let gas = Gas::new(&supply(), 293.0, 1.0);
    let end = EndFilm::of_cone((0.5, 0.365), 1.0, (3.45e9, 25.4e-6), 0.1, 0.07);
    let piston = Piston { end, ..tube(0.6, 0.0, 0.07, gas) };
    let start = PistonState { height: 0.8, speed: 20.0, gas: gas.at_temperature(5e-5, 293.0) };
    let mut run = PistonRun::new(piston, 0.0, start, control);
    run.advance(0.05, &Phase::default()).unwrap();
    run
}

#[test]
fn the_kink_at_full_height_costs_no_accuracy() {
    let reference = on_its_end(adaptive(1e-13)).state();
    let error = |control| (on_its_end(control).state().height - reference.height).abs();
    let tolerances = [1e-6, 1e-8, 1e-10].map(|tolerance| error(adaptive(tolerance)));
    println!("end film: errors at tolerance 1e-6, 1e-8, 1e-10: {tolerances:?}");
    assert!(tolerances[1] < 1e-7 && tolerances[2] < 1e-9, "{tolerances:?}");
    let (coarse, fine) = (error(fixed(1e-4)), error(fixed(5e-5)));
    println!(
        "end film: fixed-step errors {coarse:e} {fine:e}, order {:.2}",
        (coarse / fine).log2()
    );
    assert!((coarse / fine).log2() > 4.0, "{coarse:e} {fine:e}");
}

#[test]
fn strain_work_is_the_strain_energy() {
    let gas = Gas::new(&supply(), 293.0, 1.0);
    let end = EndFilm::of_cone((0.5, 0.365), 1.0, (3.45e9, 25.4e-6), 0.1, 0.07);
    let piston = Piston { end, ..tube(0.6, 0.0, 0.07, gas) };
    let start = PistonState { height: 0.9, speed: 20.0, gas: gas.at_temperature(5e-5, 293.0) };
    let mut run = PistonRun::new(piston, 0.0, start, adaptive(1e-9));
    let mut largest = 0.0_f64;
    for k in 1..200 {
        run.advance(f64::from(k) * 1e-4, &Phase::default()).unwrap();
        let energy = run.sample(&Phase::default()).ledger.strain;
        largest = largest.max(energy);
        assert!((run.strain_work() - energy).abs() < 1e-7 * 14.0, "{energy}");
    }
    assert!(largest > 5.0, "the film was stretched: {largest}");
}
