//! The gas against independent quadratures, and inflow windows against their closed form. Filling,
//! blow-down and cooling are reference cases of `billow-checks validate`.

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::paper::{nitrogen_supply, window};

use crate::prelude::*;
use crate::rig::{adaptive, paper_scene, run, tube};

/// A rigid tank of `volume` m³: a packed piston.
fn tank(gas: Gas, volume: f64, mass: f64, temperature: f64, control: Control) -> PistonRun {
    let start = PistonState { height: 1.0, speed: 0.0, gas: gas.at_temperature(mass, temperature) };
    PistonRun::new(tube(0.0, volume, 1.0, gas), 0.0, start, control)
}

fn packed(inflow: Inflow) -> Phase {
    Phase { packed: true, inflow, ..Phase::default() }
}

fn near(value: f64, expected: f64, band: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < band, "{what}: {value}, expected {expected}");
}

/// Time for a rigid adiabatic tank to fall from p0 to p1 through a subsonic orifice, by Simpson's
/// rule on dt = −dm/ṁ along the isentrope. The variable s = √(1 − `p_ambient`/p) removes the square
/// root at the end of the outflow.
fn subsonic_time(p0: f64, p1: f64, ambient: f64, volume: f64, mass: f64, area: f64) -> f64 {
    let species = Species::NITROGEN;
    let gamma = species.cp / (species.cp - species.gas_constant);
    let rate = |s: f64| {
        let ratio = 1.0 - s * s;
        let p = ambient / ratio;
        let m = mass * (p / p0).powf(1.0 / gamma);
        let temperature = p * volume / (m * species.gas_constant);
        let flux = 2.0 * gamma / ((gamma - 1.0) * species.gas_constant * temperature)
            * (ratio.powf(2.0 / gamma) - ratio.powf((gamma + 1.0) / gamma));
        let out = area * p * flux.sqrt();
        // dm/ds, from m ∝ p^(1/γ) and p = p_ambient/(1 − s²).
        m / gamma * 2.0 * s / ratio / out
    };
    let (a, b) = ((1.0 - ambient / p1).sqrt(), (1.0 - ambient / p0).sqrt());
    let n = 2000;
    let h = (b - a) / f64::from(n);
    let weight = |i| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=n).map(|i| weight(i) * rate(a + f64::from(i) * h)).sum::<f64>() * h / 3.0
}

#[test]
fn subsonic_leak_against_a_quadrature() {
    let (ambient, volume, area) = (1e5, 0.5, 2e-4);
    let leaky = GasSupply { leak_area: area, ambient_pressure: ambient, ..nitrogen_supply() };
    let gas = Gas::new(&leaky, 293.0, 1.0);
    let (p0, start) = (1.5e5, 300.0);
    let mass = p0 * volume / (Species::NITROGEN.gas_constant * start);
    for p1 in [1.3e5, 1.1e5, 1.01e5] {
        let mut run = tank(gas, volume, mass, start, adaptive(1e-10));
        let time = subsonic_time(p0, p1, ambient, volume, mass, 0.6 * area);
        run.advance(time, &packed(Inflow::default())).unwrap();
        near(run.sample(&packed(Inflow::default())).pressure, p1, 1e-7, "p");
    }
    // At ambient pressure the outflow ends, and nothing flows back in.
    let mut run = tank(gas, volume, mass, start, adaptive(1e-8));
    run.advance(60.0, &packed(Inflow::default())).unwrap();
    near(run.sample(&packed(Inflow::default())).pressure, ambient, 1e-5, "p at rest");
}

#[test]
fn isothermal_gas_in_a_moving_piston() {
    let exchange = HeatTransfer::Isothermal;
    let gas = Gas::new(&GasSupply { heat_transfer: exchange, ..nitrogen_supply() }, 293.0, 1.0);
    let start = PistonState { height: 0.1, speed: 0.0, gas: gas.at_temperature(0.001, 293.0) };
    let (area, mass) = (0.5, 0.1);
    let piston = tube(area, 0.0, mass, gas);
    let mut run = PistonRun::new(piston, 0.0, start, adaptive(DEFAULT_TOLERANCE));
    let phase = Phase::default();
    for time in [0.002, 0.01, 0.03] {
        run.advance(time, &phase).unwrap();
        let now = run.sample(&phase);
        assert_eq!(now.temperature, 293.0);
        // p V = m R T: the work is m R T ln(V/V0), and all of it was heat.
        let work = 0.001 * Species::NITROGEN.gas_constant * 293.0 * (now.z_rim / 0.1).ln();
        near(now.ledger.gas_work, work, 1e-7, "work");
        near(now.gas.heat, work, 1e-7, "heat");
        near(now.ledger.kinetic, work, 1e-7, "kinetic energy");
        near(
            now.pressure * now.volume,
            0.001 * Species::NITROGEN.gas_constant * 293.0,
            1e-13,
            "p V",
        );
    }
}

#[test]
fn windows_admit_their_mass_to_rounding_at_any_step() {
    use billow_solver::scene::Stepping;
    let mut scene = paper_scene();
    // Windows start and end between samples, overlap, and one ends after the run.
    scene.gas.windows = vec![
        window(0.0, 0.0101, 0.005),
        window(0.003_333, 0.2, 0.001),
        window(0.123_456_7, 0.3, 0.002),
        window(0.45, 0.9, 0.003),
    ];
    let expected = Schedule::new(&scene.gas.windows).mass_until(scene.solver.end_time);
    for stepping in [
        Stepping::Adaptive(1e-5),
        Stepping::Adaptive(1e-9),
        Stepping::Fixed(1e-5),
        Stepping::Fixed(3.7e-5),
    ] {
        scene.solver.stepping = stepping;
        let deployment = run(&scene);
        let mass = *deployment.history.column("gas_mass").last().unwrap();
        near(mass, expected, 1e-14, "mass");
    }
}
