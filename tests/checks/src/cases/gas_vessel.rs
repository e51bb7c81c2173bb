//! Gas in a rigid vessel, with the explicit step: filling, blow-down, cooling.
//!
//! ```text
//! filling from vacuum at T0:   m T = m0 T0 + (m − m0) γ T_in
//! blow-down, choked:           T/T0 = (1 + (γ−1) t/(2τ))^−2,  p/p0 = (T/T0)^(γ/(γ−1))
//!                              τ = V/(C_d A √(γ R T0) (2/(γ+1))^((γ+1)/(2(γ−1))))
//! cooling:                     T − T_film ~ exp(−h A t/(m cv))
//! ```

use billow_solver::integrators::FilmView;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::{free_film, nitrogen_supply};
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{GasSupply, HeatTransfer};

use super::gas_column::{column, rigid_vessel};
use super::reference::{entry, number, rows};
use super::rig::{advance, inflow, temperature};
use super::{Outcome, Rig, Row};

/// A vessel of 0.5 m² and this height (m), every node held, with gas of this mass (kg) and
/// temperature (K).
fn vessel(height: f64, supply: GasSupply, mass: f64, temperature: f64) -> FilmScene {
    let column = column(0.5, height);
    let supports = rigid_vessel();
    let supply = GasSupply { initial_mass: mass, ..supply };
    let filling = Filling::Gas { supply, initial_temperature: temperature };
    FilmScene { filling, supports, ..free_film(column.shell, Film::PAPER_ELASTIC) }
}

/// γ of nitrogen.
fn gamma() -> f64 {
    let (cp, gas_constant) = (number("nitrogen/cp"), number("nitrogen/gas_constant"));
    cp / (cp - gas_constant)
}

/// Relative error of the gas mass.
fn mass_defect(film: &FilmView<'_>, expected: f64) -> f64 {
    (film.state.gas.mass / expected - 1.0).abs()
}

/// Filling of a vessel that contains gas, and of an empty one.
pub fn tank_filling(rig: &Rig) -> Outcome {
    let rate = 5e-3;
    let [initial, start, entering, band] = entry(
        "tank_filling",
        ["initial_mass", "initial_temperature", "inflow_temperature", "band"],
    );
    let phase = inflow(rate, entering);
    let mut tank = rig.start(&vessel(0.6, nitrogen_supply(), initial, start))?;
    let mut judged = Vec::new();
    for row in rows("tank_filling") {
        advance(&mut tank, (row[0] - initial) / rate, &phase)?;
        let quantity = format!("T at {} kg, K", row[0]);
        judged.push(Row::new(&quantity, temperature(&tank.view()), row[1], band));
    }
    judged.push(Row::at_most("mass defect", mass_defect(&tank.view(), 0.01), 1e-12));
    let mut empty = rig.start(&vessel(0.6, nitrogen_supply(), 0.0, start))?;
    for until in [1e-3, 1.0] {
        advance(&mut empty, until, &phase)?;
        let quantity = format!("T {until} s after the start from vacuum, K");
        judged.push(Row::new(&quantity, temperature(&empty.view()), gamma() * entering, band));
    }
    Ok(judged)
}

/// τ of a choked orifice for this volume (m³) at this temperature (K), s.
pub fn emptying_time(supply: &GasSupply, volume: f64, temperature: f64) -> f64 {
    let gamma = gamma();
    let exponent = (gamma + 1.0) / (2.0 * (gamma - 1.0));
    let sound = (gamma * supply.species.gas_constant * temperature).sqrt();
    let choked = libm::pow(2.0 / (gamma + 1.0), exponent);
    volume / (supply.discharge_coefficient * supply.leak_area * sound * choked)
}

/// Blow-down through a choked orifice into vacuum.
pub fn blow_down(rig: &Rig) -> Outcome {
    let (area, height, mass, start) = (1e-3, 1.0, 0.6, 300.0);
    let supply = GasSupply { leak_area: area, ..nitrogen_supply() };
    let (gamma, band) = (gamma(), number("blow_down/band"));
    let tau = emptying_time(&supply, 0.5 * height, start);
    let mut tank = rig.start(&vessel(height, supply, mass, start))?;
    let first = tank.view().state.pressure;
    let mut judged = Vec::new();
    for share in [0.1, 0.5, 1.0, 3.0] {
        advance(&mut tank, share * tau, &Phase::default())?;
        let root = 1.0 + 0.5 * (gamma - 1.0) * share;
        let cooled = 1.0 / (root * root);
        let pressure = libm::pow(cooled, gamma / (gamma - 1.0));
        let [of_temperature, of_pressure] = ["T/T0", "p/p0"].map(|q| format!("{q} at {share} tau"));
        judged.push(Row::new(&of_temperature, temperature(&tank.view()) / start, cooled, band));
        judged.push(Row::new(&of_pressure, tank.view().state.pressure / first, pressure, band));
    }
    Ok(judged)
}

/// The gas in a rigid tank approaches the temperature of its film.
pub fn cooling(rig: &Rig) -> Outcome {
    let (coefficient, mass, start) = (5.0, 0.02, 450.0);
    let supply =
        GasSupply { heat_transfer: HeatTransfer::Coefficient(coefficient), ..nitrogen_supply() };
    let scene = vessel(1.0, supply, mass, start);
    let capacity = mass * (number("nitrogen/cp") - number("nitrogen/gas_constant"));
    let rate = coefficient * scene.shell.reference_area() / capacity;
    let (around, band) = (scene.film.temperature, number("cooling/band"));
    let mut tank = rig.start(&scene)?;
    let mut judged = Vec::new();
    for elapsed in [0.3, 1.0, 4.0] {
        advance(&mut tank, elapsed / rate, &Phase::default())?;
        let share = (temperature(&tank.view()) - around) / (start - around);
        let quantity = format!("(T - T_film)/(T0 - T_film) at {elapsed} time constants");
        judged.push(Row::new(&quantity, share, libm::exp(-elapsed), band));
    }
    let heat = capacity * (start - around) * (libm::exp(-4.0) - 1.0);
    judged.push(Row::new(
        "heat from the film, J",
        tank.view().accounting().gas_balance.heat,
        heat,
        band,
    ));
    Ok(judged)
}
