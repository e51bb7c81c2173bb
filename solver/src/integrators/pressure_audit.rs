//! The audit of pressure: the gas does the work p dV on the film, and no other.
//!
//! ```text
//! V = Σ_e x0·(x1 × x2)/6 of the positions         |ΔV| ≤ 1e-9 Σ_e |x0·(x1 × x2)|/6
//! p = (γ − 1) U/V                                 |Δp| ≤ 1e-9 p
//! Σ A·δ = Σ_e (δ0·(x1 × x2) + δ1·(x2 × x0) + δ2·(x0 × x1))/6        |Δ| ≤ 1e-4 Σ |A·δ|
//! ```
//!
//! Symbols: A what the pressure acts on at a node, ∂V/∂x in the integrator's forces, m²; δ a virtual displacement, m:
//! each node away from the middle of the film, by a share of its own. Everything is computed again from the
//! positions, one face after the other. With these three the work of the pressure on the film is the one that the gas
//! loses. Film under a fixed overpressure may be open: it is not audited.

use nalgebra::Vector3;

use super::virtual_displacement::weight;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::NodeForces;
use crate::output::outcome::{AuditKind, Failure};
use crate::system::{FilmState, FilmSystem, PressureLoad};

/// Bounds of the differences in volume and pressure. Chosen: far above rounding.
const MAX_DIFFERENCE: f64 = 1e-9;
/// Bound of the difference in virtual work. Chosen: far below 1 %, and above the error of the vertices that follow a
/// rim.
const MAX_VIRTUAL_DIFFERENCE: f64 = 1e-4;
/// Virtual displacement over δ for those vertices: their place is not linear in that of the rim. Chosen.
const STEP: f64 = 1e-4;

/// Replaces `moves` by δ of all nodes, m.
fn set_virtual_displacements(system: &FilmSystem, positions: &Field, moves: &mut Field) {
    let middle = positions.iter().sum::<Vector3<f64>>() / positions.len() as f64;
    for node in 0..positions.len() {
        moves.set(node, (positions.get(node) - middle) * weight(node));
    }
    if !system.model.closure_nodes.is_empty() {
        let placed = |step: f64| {
            let mut placed = positions.clone();
            for node in 0..placed.len() {
                placed.set(node, placed.get(node) + moves.get(node) * step);
            }
            system.place_closing_nodes(&mut placed);
            placed
        };
        let (ahead, behind) = (placed(STEP), placed(-STEP));
        for node in 0..positions.len() {
            if system.model.inverse_mass[node] == 0.0 {
                moves.set(node, (ahead.get(node) - behind.get(node)) / (2.0 * STEP));
            }
        }
    }
}

/// Checks gas and pressure of a state with these forces. `moves`: scratch memory, a vector for each node.
pub(super) fn check(
    system: &FilmSystem,
    state: &FilmState,
    forces: &NodeForces,
    moves: &mut Field,
) -> Result<(), Failure> {
    let PressureLoad::Gas(gas) = system.pressure_load else { return Ok(()) };
    let failure = |problem: &str| Err(Failure::new(AuditKind::Pressure, state.time, problem));
    let (model, positions) = (&system.model, &state.positions);
    set_virtual_displacements(system, positions, moves);
    let (mut volume, mut size, mut growth) = (0.0, 0.0, 0.0);
    for face in model.triangles.iter().chain(&model.closure) {
        let [a, b, c] = positions.at(*face);
        let [u, v, w] = moves.at(*face);
        let (normal, part) = (b.cross(&c), a.dot(&b.cross(&c)) / 6.0);
        volume += part;
        size += part.abs();
        growth += (u.dot(&normal) + v.dot(&c.cross(&a)) + w.dot(&a.cross(&b))) / 6.0;
    }
    // All comparisons are written so that NaN fails.
    let agrees = |a: f64, b: f64, bound: f64| (a - b).abs() <= bound;
    if !agrees(volume, state.volume, MAX_DIFFERENCE * size) {
        return failure("the volume is not that of the positions");
    }
    let pressure = gas.pressure(state.gas, state.volume);
    if !agrees(pressure, state.pressure, MAX_DIFFERENCE * pressure.abs()) {
        return failure("the pressure is not that of the gas");
    }
    let (mut work, mut magnitude) = (0.0, 0.0);
    for node in 0..positions.len() {
        let part = forces.area(node).dot(&moves.get(node));
        work += part;
        magnitude += part.abs();
    }
    if !agrees(work, growth, MAX_VIRTUAL_DIFFERENCE * magnitude) {
        return failure("the force of the pressure is not that of its work");
    }
    Ok(())
}
