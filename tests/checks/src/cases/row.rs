//! One quantity of a case, compared with its reference.

use super::reference::rows;
use super::{Outcome, Result};

/// One quantity and its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the quantity, with its unit if it has one.
    pub quantity: String,
    /// Computed value.
    pub value: f64,
    /// Expected value, or floor; `None` for a ceiling.
    pub reference: Option<f64>,
    /// |value/reference − 1|. For a ceiling, the value itself; for a floor, the relative amount by
    /// which the value is below it.
    pub error: f64,
    /// Largest allowed error.
    pub band: f64,
    /// Observed order of convergence, if it was determined.
    pub order: Option<f64>,
    /// Whether the error is in band and the order is high enough.
    pub pass: bool,
    /// Reason for a failure; empty for a row that passes.
    pub note: String,
}

impl Row {
    /// A value compared with a reference, within a relative band.
    pub fn new(quantity: &str, value: f64, reference: f64, band: f64) -> Self {
        let error = (value / reference - 1.0).abs();
        Self::judged(quantity, value, Some(reference), error, band)
    }

    /// A value that should be zero and may be at most `ceiling`.
    pub fn at_most(quantity: &str, value: f64, ceiling: f64) -> Self {
        Self::judged(quantity, value, None, value, ceiling)
    }

    /// Values that should be zero and may be at most `ceiling`.
    pub fn each_at_most<const N: usize>(ceiling: f64, values: [(&str, f64); N]) -> Vec<Self> {
        values.map(|(quantity, value)| Self::at_most(quantity, value, ceiling)).into()
    }

    /// A value that must be `floor` or more.
    pub fn at_least(quantity: &str, value: f64, floor: f64) -> Self {
        let error = if value >= floor { 0.0 } else { (1.0 - value / floor).abs() };
        Self { reference: Some(floor), ..Self::judged(quantity, value, None, error, 0.0) }
    }

    /// A value that must lie between two numbers. The reference is their mean, the band half their
    /// difference over the mean.
    pub fn within(quantity: &str, value: f64, from: f64, to: f64) -> Self {
        let middle = 0.5 * (from + to);
        let half = 0.5 * (to - from) / middle;
        Self::new(quantity, value, middle, half)
    }

    fn judged(quantity: &str, value: f64, reference: Option<f64>, error: f64, band: f64) -> Self {
        let quantity = quantity.to_owned();
        // NaN does not pass.
        let pass = error <= band && value.is_finite();
        let note = if pass { String::new() } else { "out of tolerance".to_owned() };
        Self { quantity, value, reference, error, band, order: None, pass, note }
    }

    /// The row of a case that failed to run.
    pub fn failed(reason: &str) -> Self {
        let note = reason.to_owned();
        Self { note, ..Self::judged("run", f64::NAN, None, f64::NAN, 0.0) }
    }

    /// With an observed order, for information.
    #[must_use]
    pub fn with_order(mut self, order: f64) -> Self {
        self.order = Some(order);
        self
    }

    /// With an observed order that must be `least` or more to pass.
    #[must_use]
    pub fn with_least_order(mut self, order: f64, least: f64) -> Self {
        let enough = order >= least;
        if !enough {
            self.pass = false;
            self.note = format!("order {order:.3}, at least {least} required");
        }
        self.with_order(order)
    }

    /// The value of the finest of three steps or meshes, each half of the one before. With `least`, both observed orders
    /// must be that or more; otherwise the last one is reported.
    pub fn refined(
        quantity: &str,
        values: [f64; 3],
        reference: f64,
        band: f64,
        least: Option<f64>,
    ) -> Self {
        let errors = values.map(|value| value / reference - 1.0);
        let last = order(errors[1], errors[2]);
        let row = Self::new(quantity, values[2], reference, band);
        match least {
            Some(least) => row.with_least_order(order(errors[0], errors[1]).min(last), least),
            None => row.with_order(last),
        }
    }
}

/// The rows of every entry of a table of reference numbers.
pub fn each(table: &str, of_entry: impl FnMut(Vec<f64>) -> Outcome) -> Outcome {
    Ok(rows(table).into_iter().map(of_entry).collect::<Result<Vec<_>>>()?.concat())
}

/// The rows of quantities (name, reference, band) on three steps or meshes, each half as coarse as the one before:
/// [`Row::refined`].
pub fn refined<S: AsRef<str>, const N: usize>(
    meshes: [u32; 3],
    quantities: [(S, f64, f64); N],
    least: Option<f64>,
    mut run: impl FnMut(u32) -> Result<[f64; N]>,
) -> Outcome {
    let found = [run(meshes[0])?, run(meshes[1])?, run(meshes[2])?];
    let row = |(index, (name, reference, band)): (usize, (S, f64, f64))| {
        let values = found.map(|values| values[index]);
        Row::refined(name.as_ref(), values, reference, band, least)
    };
    Ok(quantities.into_iter().enumerate().map(row).collect())
}

/// The rows of quantities (name, reference) of taut film, of second order: the value of the finest of three meshes with
/// the least order, and Richardson's extrapolation. Bands of both, and the least order.
pub fn converged<S: AsRef<str>, const N: usize>(
    meshes: [u32; 3],
    quantities: [(S, f64); N],
    [raw, band, least]: [f64; 3],
    mut run: impl FnMut(u32) -> Result<[f64; N]>,
) -> Outcome {
    let found = [run(meshes[0])?, run(meshes[1])?, run(meshes[2])?];
    let rows = |(index, (name, reference)): (usize, (S, f64))| {
        let (name, values) = (name.as_ref(), found.map(|values| values[index]));
        let limit = (4.0 * values[2] - values[1]) / 3.0;
        let finest = format!("{name}, finest mesh");
        [
            Row::refined(&finest, values, reference, raw, Some(least)),
            Row::new(&format!("{name}, Richardson"), limit, reference, band),
        ]
    };
    Ok(quantities.into_iter().enumerate().flat_map(rows).collect())
}

/// The larger of two errors. NaN counts as the largest, unlike in `f64::max`.
pub fn worse(a: f64, b: f64) -> f64 {
    if b <= a || a.is_nan() { a } else { b }
}

/// Order of convergence from the errors of two steps (or meshes), the finer half the coarser:
/// log2 |coarse/fine|.
pub fn order(coarse: f64, fine: f64) -> f64 {
    libm::log2((coarse / fine).abs())
}

/// Order of convergence from three values of halved steps (or meshes), without a reference value.
pub fn self_convergence_order([coarse, middle, fine]: [f64; 3]) -> f64 {
    order(coarse - middle, middle - fine)
}
