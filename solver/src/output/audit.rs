//! The audit: how far a result can be trusted. Energy, gas, film through film.

use crate::output::history::History;
use crate::output::measures::{first_rebound, peak};

/// Upper bound of the energy ledger residual, a fraction of the energy moved. A run with a larger one at
/// any sample fails as `energy_drift`. Chosen.
pub const MAX_LEDGER_RESIDUAL: f64 = 1e-2;

/// Upper bound of the residual of the gas balance, a fraction of what the gas received. A run with a larger one at any
/// sample fails as `inconsistent`. Chosen: mass and energy of the gas add up to rounding in every model, below 1e-12.
pub const MAX_GAS_RESIDUAL: f64 = 1e-7;

/// Numerical dissipation over the work of the gas above which a run is marked `numerically_damped`.
/// Chosen: kinetic energies are then wrong by about as much.
pub const MAX_NUMERICAL_FRACTION: f64 = 0.05;

/// The audit of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Audit {
    /// Largest energy ledger residual at any sample, a fraction ([`crate::output::ledger`]).
    pub ledger_residual: f64,
    /// Largest residual of the gas balance at any sample, a fraction: the larger one of mass and energy.
    pub gas_residual: f64,
    /// Energy lost in the film's material over the work of the gas, at the end; 0 where the gas did no
    /// positive work.
    pub material_loss_fraction: f64,
    /// Numerical dissipation over the work of the gas, both until the first peak of `z_rim` (of film without rings: of the
    /// kinetic energy), or until the end where there is none; 0 where the gas did no positive work.
    pub numerical_fraction: f64,
    /// Passages of film through film counted over the whole run; `None` if the model does not count them.
    pub passages: Option<u64>,
    /// Largest number of intersections of the mesh at any sample; `None` if the model does not count them.
    /// Between samples only passages are counted.
    pub intersections: Option<u64>,
}

impl Audit {
    /// Whether numerical dissipation took more than [`MAX_NUMERICAL_FRACTION`] of the work of the gas, or
    /// gave as much.
    pub fn numerically_damped(&self) -> bool {
        // Written so that NaN is marked too.
        let small = self.numerical_fraction.abs() <= MAX_NUMERICAL_FRACTION;
        !small
    }

    /// The audit of a history; `counts_passages`: whether the model counts passages and intersections.
    pub fn of(history: &History, counts_passages: bool) -> Self {
        let largest = |name: &str| history.column(name).iter().copied().fold(0.0, f64::max);
        let of_gas_work = |name: &str, index: Option<usize>| {
            let at = |name: &str| index.map_or(0.0, |index| history.column(name)[index]);
            let gas_work = at("gas_work");
            if gas_work > 0.0 { at(name) / gas_work } else { 0.0 }
        };
        let end = history.len().checked_sub(1);
        let first_peak = if history.has_rings() {
            first_rebound(history.column("z_rim")).0
        } else {
            peak(history.column("kinetic_energy")).map(|(index, _)| index)
        };
        // Histories store counts as f64; all are whole numbers below 2^53.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
        let count = |name: &str| counts_passages.then(|| largest(name) as u64);
        Self {
            ledger_residual: largest("ledger_residual"),
            gas_residual: largest("gas_residual"),
            material_loss_fraction: of_gas_work("material_loss", end),
            numerical_fraction: of_gas_work("numerical_dissipation", first_peak.or(end)),
            passages: count("passages"),
            intersections: count("intersections"),
        }
    }
}

/// Time (s) of the first sample whose value in a column is above a bound or NaN.
pub fn first_above(history: &History, column: &str, bound: f64) -> Option<f64> {
    let within_bound = |residual: f64| residual <= bound;
    let index = history.column(column).iter().position(|value| !within_bound(*value))?;
    Some(history.column("time")[index])
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::output::history::Sample;
    use crate::output::ledger::Ledger;

    fn sample(time: f64, kinetic: f64, material_loss: f64, gas_work: f64) -> Sample {
        let ledger = Ledger { kinetic, gas_work, material_loss, ..Ledger::default() };
        Sample { time, ledger, ..Sample::default() }
    }

    #[test]
    fn the_first_sample_above_the_bound_is_found() {
        let first_drift =
            |history: &History| first_above(history, "ledger_residual", MAX_LEDGER_RESIDUAL);
        let within = [sample(0.0, 0.0, 0.0, 0.0), sample(0.1, 3.0, 1.0, 4.0)];
        assert_eq!(first_drift(&History::of(&within)), None);
        let drifting =
            [within[0], within[1], sample(0.2, 3.1, 1.0, 4.0), sample(0.3, 9.0, 1.0, 4.0)];
        assert_eq!(first_drift(&History::of(&drifting)), Some(0.2));
    }

    #[test]
    fn the_audit_takes_the_largest_residual_and_the_last_works() {
        let series =
            [sample(0.0, 0.0, 0.0, 0.0), sample(0.1, 3.1, 1.0, 4.0), sample(0.2, 2.0, 2.0, 4.0)];
        let audit = Audit::of(&History::of(&series), false);
        assert!((audit.ledger_residual - 0.1 / 7.1).abs() < 1e-15);
        assert_eq!(audit.material_loss_fraction, 0.5);
        assert_eq!((audit.passages, audit.intersections), (None, None));
        assert_eq!(Audit::of(&History::of(&series), true).passages, Some(0));
    }

    #[test]
    fn numerical_dissipation_is_judged_at_the_first_peak_and_marked() {
        let at = |time: f64, z_rim: f64, numerical_dissipation: f64, gas_work: f64| {
            let ledger = Ledger { gas_work, numerical_dissipation, ..Ledger::default() };
            Sample { time, z_rim, ledger, ..Sample::default() }
        };
        let start = at(0.0, 0.04, 0.0, 0.0);
        let series = |at_peak: f64| {
            Audit::of(
                &History::of(&[start, at(0.1, 0.9, at_peak, 4.0), at(0.2, 0.5, 3.0, 4.0)]),
                false,
            )
        };
        assert_eq!(series(0.2).numerical_fraction, 0.05);
        assert!(!series(0.2).numerically_damped() && series(0.21).numerically_damped());
        assert!(series(-0.21).numerically_damped() && series(f64::NAN).numerically_damped());
        // Of film without rings until the largest kinetic energy.
        let moving = |time: f64, kinetic: f64, numerical_dissipation: f64| {
            let ledger =
                Ledger { kinetic, gas_work: 4.0, numerical_dissipation, ..Ledger::default() };
            Sample { time, ledger, ..Sample::default() }
        };
        let samples = [moving(0.0, 0.0, 0.0), moving(0.1, 2.0, 0.1), moving(0.2, 1.0, 3.0)];
        let free = Audit::of(&History::of(&samples).without_rings(), false);
        assert_eq!(free.numerical_fraction, 0.025);
        let rising = Audit::of(&History::of(&[start, at(0.1, 0.9, 0.4, 4.0)]), false);
        assert_eq!(rising.numerical_fraction, 0.1);
        assert!(rising.numerically_damped());
    }
}
