//! BDF2 with variable steps, for positions and velocities.
//!
//! ```text
//! ẏ(t') = (a y' − b y + c y⁻)/h        r = h/h⁻,  a = (1+2r)/(1+r),  b = 1+r,  c = r²/(1+r)
//! first step: a = b = 1, c = 0         (implicit Euler)
//! ẋ' = v',  M v̇' = f(x') − c_m M v'    ⇒  x' minimises Π + ½ w |x' − x̂|²_M
//! w = α² + c_m α,  α = a/h
//! e ≈ 0.35 (x' − x − h v − ½ h² (v − v⁻)/h⁻)           error of the step; first step: ½ (x' − x − h v)
//! ```
//!
//! Symbols: y⁻ at the start of the last step, of length h⁻; `c_m` mass damping. Order 2; A-stable for equal steps,
//! zero-stable for r < 1 + √2 (E. Hairer, S. Nørsett, G. Wanner, "Solving Ordinary Differential Equations I",
//! III.5). It damps what is fast against the step: that energy is numerical dissipation.

use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::system::FilmState;

/// Share of the difference from the prediction that is the error of a step: (2/9)/(1/4 + 1/6 + 2/9) at equal steps.
const ERROR_SHARE: f64 = 0.35;
/// The same of implicit Euler.
const FIRST_ERROR_SHARE: f64 = 0.5;

/// Start of the last step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LastStep {
    /// Positions, m.
    pub positions: Field,
    /// Velocities, m/s.
    pub velocities: Field,
    /// Length of the step, s.
    pub length: f64,
}

/// The coefficients of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Method<'a> {
    state: &'a FilmState,
    last: Option<&'a LastStep>,
    length: f64,
    a: f64,
    b: f64,
    c: f64,
}

impl<'a> Method<'a> {
    /// The step of `length` (s) from a state; `last`: the step before.
    pub(super) fn new(state: &'a FilmState, last: Option<&'a LastStep>, length: f64) -> Self {
        let (a, b, c) = match last {
            None => (1.0, 1.0, 0.0),
            Some(last) => {
                let r = length / last.length;
                ((1.0 + 2.0 * r) / (1.0 + r), 1.0 + r, r * r / (1.0 + r))
            }
        };
        Self { state, last, length, a, b, c }
    }

    /// w (1/s²), and x̂ (m) in `target`, with this mass damping (1/s).
    pub(super) fn inertia(&self, mass_damping: f64, target: &mut Field) -> f64 {
        let rate = self.a / self.length;
        let weight = rate * rate + mass_damping * rate;
        for node in 0..target.len() {
            // ẏ' = rate y' − known
            let (known_x, known_v) = (self.known(node, |s| &s.positions, |l| &l.positions), {
                self.known(node, |s| &s.velocities, |l| &l.velocities)
            });
            let free = known_x * (rate + mass_damping) + known_v;
            target.set(node, free / weight);
        }
        weight
    }

    /// (b y − c y⁻)/h of a node.
    fn known(
        &self,
        node: usize,
        now: impl Fn(&FilmState) -> &Field,
        before: impl Fn(&LastStep) -> &Field,
    ) -> nalgebra::Vector3<f64> {
        let mut sum = now(self.state).get(node) * self.b;
        if let Some(last) = self.last {
            sum -= before(last).get(node) * self.c;
        }
        sum / self.length
    }

    /// Velocity (m/s) of a node after the step, at this position (m).
    pub(super) fn velocity(
        &self,
        node: usize,
        position: nalgebra::Vector3<f64>,
    ) -> nalgebra::Vector3<f64> {
        position * (self.a / self.length) - self.known(node, |s| &s.positions, |l| &l.positions)
    }

    /// a, b and c.
    pub(super) fn coefficients(&self) -> [f64; 3] {
        [self.a, self.b, self.c]
    }

    /// Predicted displacements, m.
    pub(super) fn predict(&self, displacements: &mut Field) {
        let h = self.length;
        for node in 0..displacements.len() {
            let velocity = self.state.velocities.get(node);
            let mut moved = velocity * h;
            if let Some(last) = self.last {
                let rate = (velocity - last.velocities.get(node)) / last.length;
                moved += rate * (0.5 * h * h);
            }
            displacements.set(node, moved);
        }
    }

    /// Mean error of the step, m: √(Σ m |e|²/Σ m).
    pub(super) fn error(&self, mass: &[f64], positions: &Field, predicted: &Field) -> f64 {
        let share = if self.last.is_some() { ERROR_SHARE } else { FIRST_ERROR_SHARE };
        let (mut sum, mut total) = (0.0, 0.0);
        for (node, mass) in mass.iter().enumerate() {
            let moved = positions.get(node) - self.state.positions.get(node);
            sum += mass * (moved - predicted.get(node)).norm_squared();
            total += mass;
        }
        share * (sum / total).sqrt()
    }

    /// Order of the error in the length of the step.
    pub(super) fn error_order(&self) -> i32 {
        if self.last.is_some() { 3 } else { 2 }
    }
}
