//! Invariants of film: rigid motion, momentum, energy with every term; and a panel in simple shear.
//!
//! ```text
//! rotation:  x = R X + t  →  zero strain, force and power
//! momentum:  Σ m v and Σ m x × v of free film, relative to Σ |m v|
//! energy:    residual = |Δ(kinetic + stored) + lost + numerical + damping − external works|
//!                       / (peak kinetic + Σ|external works|)
//! shear:     F = 1 + γ e1⊗e2  →  P12 = −Σ f·e1 X·e2/V,  zero force on inner nodes
//! ```

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::forces::membrane::{
    CreepStep, NodeForces, assemble_membrane, numerical_forces,
};
use billow_solver::output::ledger::{GasBalance, gas_residuals, residuals};
use nalgebra::Rotation3;

use super::prelude::*;
use super::rig::{explicit, inflow};

/// Rigid motion causes no strain.
pub fn rigid_rotation(rig: &Rig) -> Outcome {
    let axis = Vector3::new(1.0, -2.0, 0.5);
    let turn = Rotation3::new(axis);
    let mut shell = icosphere(2, 0.5);
    let spin = |x: &Vector3<f64>| (turn * x).cross(&axis) * 100.0 + Vector3::new(5.0, 0.0, 1.0);
    let velocities: Vec<Vector3<f64>> = shell.positions.iter().map(spin).collect();
    for x in &mut shell.positions {
        *x = turn * *x + Vector3::new(3.0, -1.0, 2.0);
    }
    let film = Film { compression: 1.0, numerical_damping: 0.1, ..Film::PAPER };
    let scale = film.youngs_modulus * film.thickness * 0.1;
    let film = rig.start(&FilmScene { velocities, ..free_film(shell, film) })?;
    let force = film.view().forces().films().iter().map(|force| force.norm()).fold(0.0, worse);
    // A large rotation in a single step.
    let mut histories = explicit(&film).histories;
    let (model, last) = (&film.view().system.model, &film.view().state.creep);
    let mut next = last.clone();
    let mut creep = CreepStep { last, next: &mut next };
    let mut out = NodeForces::new(model);
    let spun = film.view().state.positions.iter().map(|x| turn * x).collect::<Vec<_>>();
    let (spun, instruction_set) = (Field::of(&spun), film.view().system.instruction_set);
    let stepped = assemble_membrane(
        instruction_set,
        model,
        &spun,
        1e-5,
        &mut creep,
        &mut histories,
        &mut out,
    );
    let after = numerical_forces(model, &spun, &histories);
    let after = after.iter().map(|force| force.norm()).fold(0.0, worse);
    let energy = scale * 0.1;
    Ok(Row::each_at_most(
        number("rigid_rotation/band"),
        [
            ("force over E t h", force / scale),
            ("numerical force after a rotation in one step, over E t h", after / scale),
            (
                "numerical dissipation of this rotation over E t h^2",
                stepped.numerical_dissipation.abs() / energy,
            ),
            ("strain energy over E t h^2", film.view().ledger().strain / energy),
        ],
    ))
}

/// Σ m v, Σ m x × v and Σ |m v|.
fn momentum(film: &FilmView<'_>) -> (Vector3<f64>, Vector3<f64>, f64) {
    let (mut sum, mut moment, mut size) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for (node, mass) in film.system.model.mass.iter().enumerate() {
        let velocity = film.state.velocities.get(node);
        sum += velocity * *mass;
        moment += film.state.positions.get(node).cross(&velocity) * *mass;
        size += velocity.norm() * mass;
    }
    (sum, moment, size)
}

/// A free sphere of film and gas conserves linear and angular momentum over 1e5 steps.
pub fn momenta(rig: &Rig) -> Outcome {
    let shell = icosphere(1, 0.5);
    let (spin, throw) = (Vector3::new(2.0, -3.0, 5.0), Vector3::new(0.3, 0.1, -0.2));
    let kicks = pseudo_random(shell.positions.len(), 5);
    let velocity = |(x, kick): (&Vector3<f64>, Vector3<f64>)| spin.cross(x) + kick * 0.5 + throw;
    let velocities = shell.positions.iter().zip(kicks).map(velocity).collect();
    let filling = nitrogen_filling(5e-3, 293.0);
    let film = Film { numerical_damping: 0.1, ..Film::PAPER };
    let mut film = rig.start(&FilmScene { velocities, filling, ..free_film(shell, film) })?;
    let before = momentum(&film.view());
    let target = 1e5 * film.view().next_step();
    advance(&mut film, target, &Phase::default())?;
    let after = momentum(&film.view());
    let relative = |change: Vector3<f64>| change.norm() / before.2;
    let changes = Row::each_at_most(
        number("momentum/band"),
        [
            ("change of linear momentum over sum of |m v|", relative(after.0 - before.0)),
            ("change of angular momentum over sum of |m v|, m", relative(after.1 - before.1)),
        ],
    );
    let steps = Row::at_least("steps", film.view().steps() as f64, 1e5);
    Ok([vec![steps], changes].concat())
}

/// Wrinkled film in simple shear without transverse stretch: the stress of the tension field.
pub fn shear_panel(rig: &Rig) -> Outcome {
    let gamma = number("shear_panel/gamma");
    let reference = sheet(6, 4, 0.3, 0.2);
    let mut shell = reference.clone();
    for x in &mut shell.positions {
        x.x += gamma * x.y;
    }
    let film = rig.start(&free_film(shell, Film::PAPER_ELASTIC))?;
    let volume: f64 = film.view().system.model.volume.iter().sum();
    let forces = film.view().forces().films();
    let forces = forces.iter().zip(&reference.positions);
    let stress = -forces.map(|(force, x)| force.x * x.y).sum::<f64>() / volume;
    let (expected, band) = (number("shear_panel/P12"), number("shear_panel/band"));
    // A uniform strain has no force inside.
    let inside = |x: &Vector3<f64>| (0.04..0.26).contains(&x.x) && (0.04..0.16).contains(&x.y);
    let nodes = (0..reference.positions.len()).filter(|node| inside(&reference.positions[*node]));
    let force = nodes.map(|node| film.view().forces().film(node).norm()).fold(0.0, worse);
    let scale = Film::PAPER_ELASTIC.youngs_modulus * Film::PAPER_ELASTIC.thickness * 0.05;
    let quantity = "force on inner nodes over E t h";
    Ok(vec![
        Row::new("P12, Pa", stress, expected, band),
        Row::at_most(quantity, force / scale, number("rigid_rotation/band")),
    ])
}

/// A damped sphere that is thrown upward in air, filled, leaks, exchanges heat and has mass damping:
/// every term at once.
pub fn sphere_ledger(rig: &Rig) -> Outcome {
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
    let phase = inflow(1.0, 400.0);
    let (mut ledgers, mut balances) = (vec![film.view().ledger()], vec![film.view().gas_balance()]);
    for sample in 1..=40 {
        let time = f64::from(sample) * 1e-3;
        advance(&mut film, time, &phase)?;
        ledgers.push(film.view().ledger());
        let mass_in = phase.inflow.mass_flow_rate * time;
        balances.push(GasBalance { mass_in, ..film.view().gas_balance() });
    }
    let largest = |series: Vec<f64>| series.into_iter().fold(0.0, worse);
    let film = largest(residuals(&ledgers));
    let gas = largest(gas_residuals(&balances));
    Ok(vec![
        Row::at_most("film energy residual", film, number("ledger/sphere_band")),
        Row::at_most("gas energy residual", gas, number("ledger/gas_band")),
    ])
}
