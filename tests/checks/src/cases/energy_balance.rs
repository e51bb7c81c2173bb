//! Energy balance of a sphere with every term of the equations.
//!
//! ```text
//! residual = |Δ(kinetic + stored) + lost + numerical + damping − external works| / (peak kinetic + Σ|external works|)
//! ```

use billow_solver::output::ledger::{GasBalance, gas_residuals, residuals};
use billow_solver::scene::inflow::Inflow;

use super::prelude::*;

/// A damped sphere that is thrown upward in air, filled, leaks, exchanges heat and has mass damping:
/// every term at once.
pub(super) fn sphere_ledger(rig: &Rig) -> Outcome {
    let ambient = 1000.0;
    let shell = icosphere(2, 0.5);
    let species = nitrogen_supply().species;
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let supply = GasSupply {
        initial_mass: 2.0 * ambient * volume / (species.gas_constant * 350.0),
        ambient_pressure: ambient,
        heat_transfer: HeatTransfer::Coefficient(50.0),
        leak_area: 2e-2,
        ..nitrogen_supply()
    };
    let velocities =
        shell.positions.iter().map(|x| Vector3::new(0.0, 0.0, 3.0) + x * 4.0).collect();
    let mut scene = FilmScene {
        velocities,
        filling: Filling::Gas { supply, initial_temperature: 350.0 },
        gravity: Vector3::new(0.0, 0.0, -9.806_65),
        ..free_film(shell, Film { numerical_damping: 0.1, compression: 0.01, ..Film::PAPER })
    };
    scene.solver.mass_damping = 5.0;
    scene.solver.cfl = 0.2;
    let mut film = rig.start(&scene)?;
    let inflow = Inflow { mass_flow_rate: 1.0, temperature_flow: 400.0 };
    let phase = Phase { inflow, ..Phase::default() };
    let (mut ledgers, mut balances) = (vec![film.view().ledger()], vec![film.view().gas_balance()]);
    for sample in 1..=40 {
        let time = f64::from(sample) * 1e-3;
        advance(&mut film, time, &phase)?;
        ledgers.push(film.view().ledger());
        balances.push(GasBalance {
            mass_in: inflow.mass_flow_rate * time,
            ..film.view().gas_balance()
        });
    }
    let largest = |series: Vec<f64>| series.into_iter().fold(0.0, worse);
    let film = largest(residuals(&ledgers));
    let gas = largest(gas_residuals(&balances));
    Ok(vec![
        Row::at_most("film energy residual", film, number("ledger/sphere_band")),
        Row::at_most("gas energy residual", gas, number("ledger/gas_band")),
    ])
}
