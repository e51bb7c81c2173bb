//! The state at a time within a step.
//!
//! ```text
//! x(t + s h) = (1 + 2s)(1 − s)² x + s (1 − s)² h v + s² (3 − 2s) x' + s² (s − 1) h v'        without contact
//!            = x + s (x' − x)                                                               in contact
//! ```
//!
//! Film in contact moves straight, as it was tested for passages. Gas, creep strain and accounting are
//! linear in s; volume and pressure follow.

use nalgebra::Vector3;

use super::motion::PendingStep;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::mechanics::gas::GasState;
use crate::system::{FilmState, FilmSystem};

impl PendingStep {
    /// State and accounting at a time (s) within the step; volume, pressure and contacts are those of its start.
    pub(super) fn at(&self, system: &FilmSystem, time: f64) -> (FilmState, EnergyAccounting) {
        let ((from, before), (to, after)) = (&self.from, &self.to);
        let length = to.time - from.time;
        let s = (time - from.time) / length;
        let touches = !(from.contact.contacts.is_empty() && to.contact.contacts.is_empty());
        let mut state = from.clone();
        state.time = time;
        for node in 0..state.positions.len() {
            let ends = [from, to].map(|end| (end.positions.get(node), end.velocities.get(node)));
            let (x, v) = if touches { straight(ends, s) } else { hermite(ends, length, s) };
            state.positions.set(node, x);
            state.velocities.set(node, v);
        }
        let mix = |a: f64, b: f64| a + s * (b - a);
        for (plane, to) in state.planes.iter_mut().zip(&to.planes) {
            *plane = mix(*plane, *to);
        }
        for (block, to) in state.creep.iter_mut().zip(&to.creep) {
            for (half, to) in block.iter_mut().zip(to) {
                *half = half.between(to, s);
            }
        }
        state.gas = GasState {
            mass: mix(from.gas.mass, to.gas.mass),
            internal_energy: mix(from.gas.internal_energy, to.gas.internal_energy),
        };
        system.place_closing_nodes(&mut state.positions);
        (state, before.between(after, s))
    }
}

type End = (Vector3<f64>, Vector3<f64>);

/// Position (m) and velocity (m/s) of the cubic with these ends.
fn hermite([(x, v), (y, w)]: [End; 2], length: f64, s: f64) -> End {
    let r = 1.0 - s;
    let position =
        x * ((1.0 + 2.0 * s) * r * r) + v * (s * r * r * length) + y * (s * s * (3.0 - 2.0 * s))
            - w * (s * s * r * length);
    let velocity =
        (y - x) * (6.0 * s * r / length) + v * (r * (1.0 - 3.0 * s)) - w * (s * (2.0 - 3.0 * s));
    (position, velocity)
}

/// Position (m) and velocity (m/s) of the straight motion; at its ends the velocity is that of the end.
fn straight([(x, v), (y, w)]: [End; 2], s: f64) -> End {
    (x + (y - x) * s, v + (w - v) * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cubic_has_the_values_and_slopes_of_its_ends() {
        let cubic = |t: f64| Vector3::new(t * t * t, 1.0 - t * t, 2.0 * t);
        let slope = |t: f64| Vector3::new(3.0 * t * t, -2.0 * t, 2.0);
        let (a, b) = (0.3, 1.1);
        for s in [0.0, 0.25, 0.7, 1.0] {
            let t = a + s * (b - a);
            let (x, v) = hermite([(cubic(a), slope(a)), (cubic(b), slope(b))], b - a, s);
            assert!((x - cubic(t)).norm() < 1e-15 && (v - slope(t)).norm() < 1e-14, "{s}");
        }
    }
}
