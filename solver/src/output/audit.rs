//! What a result is worth: energy, gas, intersections.

use crate::output::history::History;

/// Energy ledger residual above which a run has drifted and is no result.
pub const RESIDUAL_BOUND: f64 = 1e-2;

/// The audit of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Audit {
    /// Largest energy ledger residual of the stored series.
    pub ledger_residual: f64,
    /// Largest gas balance residual (mass and internal energy) of the stored series.
    pub gas_residual: f64,
    /// Energy dissipated by film viscosity over the work of the gas.
    pub viscous_fraction: f64,
    /// Film through film, whole run; `None` where the model does not count them.
    pub passages: Option<u64>,
    /// Intersections at the worst frame; `None` where the model does not look.
    pub intersections: Option<u64>,
}

impl Audit {
    /// The audit of a history; `counts_passages` where the model does.
    pub fn of(history: &History, counts_passages: bool) -> Self {
        let largest = |name: &str| history.column(name).iter().copied().fold(0.0, f64::max);
        let last = |name: &str| history.column(name).last().copied().unwrap_or(0.0);
        let gas_work = last("gas_work");
        // Counts are whole numbers below 2^53 stored as f64.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
        let count = |name: &str| counts_passages.then(|| largest(name) as u64);
        Self {
            ledger_residual: largest("ledger_residual"),
            gas_residual: largest("gas_residual"),
            viscous_fraction: if gas_work > 0.0 { last("viscous_work") / gas_work } else { 0.0 },
            passages: count("passages"),
            intersections: count("intersections"),
        }
    }
}

/// Time (s) of the first sample whose ledger residual is above [`RESIDUAL_BOUND`], or no number.
pub fn first_drift(history: &History) -> Option<f64> {
    let sound = |residual: f64| residual <= RESIDUAL_BOUND;
    let index = history.column("ledger_residual").iter().position(|value| !sound(*value))?;
    Some(history.column("time")[index])
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::output::history::Sample;
    use crate::output::ledger::Ledger;

    fn sample(time: f64, kinetic: f64, viscous_work: f64, gas_work: f64) -> Sample {
        let ledger = Ledger { kinetic, gas_work, viscous_work, ..Ledger::default() };
        Sample { time, ledger, ..Sample::default() }
    }

    #[test]
    fn drift_is_found_at_its_first_sample() {
        let sound = [sample(0.0, 0.0, 0.0, 0.0), sample(0.1, 3.0, 1.0, 4.0)];
        assert_eq!(first_drift(&History::of(&sound)), None);
        let drifted = [sound[0], sound[1], sample(0.2, 3.1, 1.0, 4.0), sample(0.3, 9.0, 1.0, 4.0)];
        assert_eq!(first_drift(&History::of(&drifted)), Some(0.2));
    }

    #[test]
    fn the_audit_takes_the_worst_and_the_last() {
        let series =
            [sample(0.0, 0.0, 0.0, 0.0), sample(0.1, 3.1, 1.0, 4.0), sample(0.2, 2.0, 2.0, 4.0)];
        let audit = Audit::of(&History::of(&series), false);
        assert!((audit.ledger_residual - 0.1 / 7.1).abs() < 1e-15);
        assert_eq!(audit.viscous_fraction, 0.5);
        assert_eq!((audit.passages, audit.intersections), (None, None));
        assert_eq!(Audit::of(&History::of(&series), true).passages, Some(0));
    }
}
