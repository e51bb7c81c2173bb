//! The piston model on the gas cases: the same closed forms, without film.

use billow_solver::integrators::dormand_prince::{Control, DEFAULT_TOLERANCE};
use billow_solver::mechanics::gas::{Gas, GasState};
use billow_solver::models::piston::{EndFilm, Piston, PistonRun, PistonState, VolumeLaw};
use billow_solver::models::run::Model;
use billow_solver::scene::paper::nitrogen_supply;
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{GasSupply, HeatTransfer, Species, Stepping};

use super::gas_vessel::emptying_time;
use super::reference::{entry, number, rows};
use super::rig::inflow;
use super::row::order;
use super::{Outcome, Rig, Row};

fn control(stepping: Stepping) -> Control {
    Control { stepping, step_limit: 10_000_000 }
}

fn adaptive(tolerance: f64) -> Control {
    control(Stepping::Adaptive(tolerance))
}

/// A piston on V = A z + V0 without an end.
fn tube(area: f64, offset: f64, mass: f64, gas: Gas) -> Piston {
    let volume = VolumeLaw::Uniform { area, offset };
    Piston { volume, mass, weight: 0.0, end: EndFilm::none(), gas }
}

fn advance(run: &mut PistonRun, target: f64, phase: &Phase) -> Result<(), String> {
    run.advance(target, phase)
        .map_err(|failure| format!("{:?} at {} s: {}", failure.kind, failure.time, failure.place))
}

fn injection() -> Phase {
    inflow(number("injected_piston/rate"), number("injected_piston/inflow_temperature"))
}

/// A rigid tank of this volume (m³): a packed piston.
fn tank(gas: Gas, volume: f64, mass: f64, temperature: f64) -> PistonRun {
    let gas_state = gas.at_temperature(mass, temperature);
    let state = PistonState { height: 1.0, speed: 0.0, gas: gas_state };
    PistonRun::new(tube(0.0, volume, 1.0, gas), 0.0, state, adaptive(DEFAULT_TOLERANCE))
}

/// Blow-down of a rigid tank through a choked orifice.
pub fn blow_down(_: &Rig) -> Outcome {
    let (volume, mass, start) = (0.5, 0.6, 300.0);
    let supply = GasSupply { leak_area: 1e-3, ..nitrogen_supply() };
    let gas = Gas::new(&supply, 293.0, 1.0);
    let (gamma, tau) = (gas.gamma(), emptying_time(&supply, volume, start));
    let closed = Phase { packed: true, ..Phase::default() };
    let mut run = tank(gas, volume, mass, start);
    let first = run.sample(&closed).pressure;
    let band = number("blow_down/band");
    let mut judged = Vec::new();
    for share in [0.1, 0.5, 1.0, 3.0] {
        advance(&mut run, share * tau, &closed)?;
        let now = run.sample(&closed);
        let root = 1.0 + 0.5 * (gamma - 1.0) * share;
        let cooled = 1.0 / (root * root);
        let pressure = libm::pow(cooled, gamma / (gamma - 1.0));
        let [of_temperature, of_pressure] = ["T/T0", "p/p0"].map(|q| format!("{q} at {share} tau"));
        judged.push(Row::new(&of_temperature, now.temperature / start, cooled, band));
        judged.push(Row::new(&of_pressure, now.pressure / first, pressure, band));
    }
    Ok(judged)
}

/// The gas in a rigid tank approaches the temperature of its film.
pub fn cooling(_: &Rig) -> Outcome {
    let (coefficient, area, mass, start) = (5.0, 2.0, 0.02, 450.0);
    let supply =
        GasSupply { heat_transfer: HeatTransfer::Coefficient(coefficient), ..nitrogen_supply() };
    let gas = Gas::new(&supply, 293.0, area);
    let rate = coefficient * area / (mass * gas.cv);
    let closed = Phase { packed: true, ..Phase::default() };
    let mut run = tank(gas, 0.5, mass, start);
    let band = number("cooling/band");
    let mut judged = Vec::new();
    for elapsed in [0.3, 1.0, 4.0] {
        advance(&mut run, elapsed / rate, &closed)?;
        let share = (run.sample(&closed).temperature - 293.0) / (start - 293.0);
        let quantity = format!("(T - T_film)/(T0 - T_film) at {elapsed} time constants");
        judged.push(Row::new(&quantity, share, libm::exp(-elapsed), band));
    }
    let expected = mass * gas.cv * (start - 293.0) * (libm::exp(-4.0) - 1.0);
    let heat = run.sample(&closed).gas.heat;
    judged.push(Row::new("heat from the film, J", heat, expected, band));
    Ok(judged)
}

/// Filling of a rigid tank.
pub fn tank_filling(_: &Rig) -> Outcome {
    let [initial, start, entering, band] = entry(
        "tank_filling",
        ["initial_mass", "initial_temperature", "inflow_temperature", "band"],
    );
    let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
    let mut run = tank(gas, 0.3, initial, start);
    let phase = Phase { packed: true, ..inflow(5e-3, entering) };
    let mut judged = Vec::new();
    for row in rows("tank_filling") {
        advance(&mut run, (row[0] - initial) / 5e-3, &phase)?;
        let quantity = format!("T at {} kg, K", row[0]);
        judged.push(Row::new(&quantity, run.sample(&phase).temperature, row[1], band));
    }
    Ok(judged)
}

/// The injected piston from its closed form at 1 ms to 50 ms, with this stepping.
///
/// # Errors
/// A failure of the run.
pub fn injected(stepping: Stepping) -> Result<PistonRun, String> {
    let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
    let [mass, rate, entering, c, start, end] =
        entry("injected_piston", ["mass", "rate", "inflow_temperature", "C", "start", "end"]);
    let gamma = gas.gamma();
    let state = PistonState {
        height: c * libm::pow(start, 1.5),
        speed: 1.5 * c * start.sqrt(),
        gas: gas.at_temperature(rate * start, entering * 2.0 * gamma / (3.0 * gamma - 1.0)),
    };
    let mut run = PistonRun::new(tube(0.7, 0.0, mass, gas), start, state, control(stepping));
    advance(&mut run, end, &injection())?;
    Ok(run)
}

/// The injected piston, started at 1 ms on its closed form.
pub fn injected_piston(_: &Rig) -> Outcome {
    let run = |stepping| Ok::<f64, String>(injected(stepping)?.state().height);
    let expected = number("injected_piston/position_at_50_ms");
    let band = number("injected_piston/band");
    let exact = run(Stepping::Adaptive(1e-13))?;
    let steps = [4e-4, 2e-4].map(|step| run(Stepping::Fixed(step)));
    let [coarse, fine] = steps;
    let seen = order(coarse? - exact, fine? - exact);
    Ok(vec![
        Row::new(
            "x at 50 ms, adaptive, m",
            run(Stepping::Adaptive(DEFAULT_TOLERANCE))?,
            expected,
            band,
        ),
        Row::new("x at 50 ms, fixed step, m", run(Stepping::Fixed(2e-5))?, expected, band)
            .with_least_order(seen, number("injected_piston/order")),
    ])
}

/// Displacement at 50 ms, m, of a piston that starts at rest on an empty volume (m³).
///
/// # Errors
/// A failure of the run.
pub fn from_dead_volume(area: f64, volume: f64, tolerance: f64) -> Result<f64, String> {
    let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
    // The height of a piston must be positive, so z starts at 0.1 m.
    let shift = 0.1;
    let piston = tube(area, volume - area * shift, number("injected_piston/mass"), gas);
    let state = PistonState { height: shift, speed: 0.0, gas: GasState::default() };
    let mut run = PistonRun::new(piston, 0.0, state, adaptive(tolerance));
    advance(&mut run, number("injected_piston/end"), &injection())?;
    Ok(run.state().height - shift)
}

/// Displacement at 50 ms, m, by the classical Runge-Kutta method on the energy balance
/// U = Ḣ t − M ẋ²/2, with Richardson's extrapolation. It shares no code with the solver.
fn extrapolated(area: f64, volume: f64) -> f64 {
    let [mass, rate, entering, end] =
        entry("injected_piston", ["mass", "rate", "inflow_temperature", "end"]);
    let cp = number("nitrogen/cp");
    let excess = cp / (cp - number("nitrogen/gas_constant")) - 1.0;
    let power = rate * cp * entering;
    let acceleration = |t: f64, x: f64, v: f64| {
        excess * (power * t - 0.5 * mass * v * v) / (area * x + volume) * area / mass
    };
    let classical = |n: u32| {
        let h = end / f64::from(n);
        let (mut x, mut v) = (0.0, 0.0);
        for i in 0..n {
            let t = f64::from(i) * h;
            let (v1, a1) = (v, acceleration(t, x, v));
            let half = t + 0.5 * h;
            let v2 = v + 0.5 * h * a1;
            let a2 = acceleration(half, x + 0.5 * h * v1, v2);
            let v3 = v + 0.5 * h * a2;
            let a3 = acceleration(half, x + 0.5 * h * v2, v3);
            let v4 = v + h * a3;
            let a4 = acceleration(t + h, x + h * v3, v4);
            x += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        x
    };
    let (coarse, fine) = (classical(20_000), classical(40_000));
    fine + (fine - coarse) / 15.0
}

/// The injected piston from rest on an empty dead volume.
pub fn injected_piston_dead_volume(_: &Rig) -> Outcome {
    let (area, volume) = (0.1, number("injected_piston/offset_volume"));
    let value = from_dead_volume(area, volume, DEFAULT_TOLERANCE)?;
    let band = number("injected_piston/offset_band");
    Ok(vec![Row::new("x at 50 ms, m", value, extrapolated(area, volume), band)])
}

/// Periods of a mass on gas.
pub fn gas_spring(_: &Rig) -> Outcome {
    let gamma = number("gas_spring/gamma");
    let species = Species { gas_constant: 296.8, cp: 296.8 * gamma / (gamma - 1.0) };
    let gas = Gas::new(&GasSupply { species, ..nitrogen_supply() }, 293.0, 1.0);
    let (mass, length, area, pressure) = (0.4, 0.3, 0.02, 2000.0);
    let linear = 2.0 * core::f64::consts::PI * (mass * length / (gamma * pressure * area)).sqrt();
    let mut judged = Vec::new();
    for row in rows("gas_spring") {
        let (amplitude, ratio) = (row[0], row[1]);
        let temperature = 293.0 * libm::pow(1.0 + amplitude, 1.0 - gamma);
        let content = pressure * area * length / (species.gas_constant * 293.0);
        let piston = Piston { weight: -pressure * area, ..tube(area, 0.0, mass, gas) };
        let state = PistonState {
            height: length * (1.0 + amplitude),
            speed: 0.0,
            gas: gas.at_temperature(content, temperature),
        };
        let mut run = PistonRun::new(piston, 0.0, state, adaptive(1e-10));
        advance(&mut run, ratio * linear, &Phase::default())?;
        // After one period the piston is at rest: the remaining speed over the acceleration is the
        // error of the period.
        let force = pressure * area * (libm::pow(1.0 + amplitude, -gamma) - 1.0);
        let period = ratio * linear - run.state().speed / (force / mass);
        let quantity = format!("period over linear period at amplitude {amplitude}");
        judged.push(Row::new(&quantity, period / linear, ratio, number("gas_spring/band")));
    }
    Ok(judged)
}
