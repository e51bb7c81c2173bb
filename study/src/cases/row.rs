//! One judged quantity of a case.

/// One judged quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was measured, with its unit where it has one.
    pub quantity: String,
    /// What billow gives.
    pub value: f64,
    /// What it should be; none for a bound from one side.
    pub reference: Option<f64>,
    /// |value/reference − 1|; by how much a one-sided bound is used: the value itself below a
    /// ceiling, the share missing to a floor.
    pub error: f64,
    /// Largest error allowed.
    pub band: f64,
    /// Observed order of convergence, where one was looked at.
    pub order: Option<f64>,
    /// In band, with the order asked for.
    pub pass: bool,
    /// Why not; also what else a reader should know of the value.
    pub note: String,
}

impl Row {
    /// A value that should be `reference`, to this relative band.
    pub fn new(quantity: &str, value: f64, reference: f64, band: f64) -> Self {
        let error = (value / reference - 1.0).abs();
        Self::judged(quantity, value, Some(reference), error, band)
    }

    /// A size that should be nought, at most `ceiling`.
    pub fn at_most(quantity: &str, value: f64, ceiling: f64) -> Self {
        Self::judged(quantity, value, None, value, ceiling)
    }

    /// A value that should be `floor` or more.
    pub fn at_least(quantity: &str, value: f64, floor: f64) -> Self {
        let error = if value >= floor { 0.0 } else { (1.0 - value / floor).abs() };
        Self { reference: Some(floor), ..Self::judged(quantity, value, None, error, 0.0) }
    }

    /// A value that should lie between two numbers: to half their difference about their middle.
    pub fn within(quantity: &str, value: f64, from: f64, to: f64) -> Self {
        let middle = 0.5 * (from + to);
        let half = 0.5 * (to - from) / middle;
        Self::new(quantity, value, middle, half).with_note(&format!("asked for {from} to {to}"))
    }

    fn judged(quantity: &str, value: f64, reference: Option<f64>, error: f64, band: f64) -> Self {
        let quantity = quantity.to_owned();
        // No NaN passes.
        let pass = error <= band && value.is_finite();
        let note = if pass { String::new() } else { "out of band".to_owned() };
        Self { quantity, value, reference, error, band, order: None, pass, note }
    }

    /// What stands for a case that came to no end.
    pub fn failed(reason: &str) -> Self {
        Self {
            quantity: "run".to_owned(),
            value: f64::NAN,
            reference: None,
            error: f64::NAN,
            band: 0.0,
            order: None,
            pass: false,
            note: reason.to_owned(),
        }
    }

    /// With an observed order that is told and not judged.
    #[must_use]
    pub fn with_order(mut self, order: f64) -> Self {
        self.order = Some(order);
        self
    }

    /// With an observed order that must be `least` or more.
    #[must_use]
    pub fn with_least_order(mut self, order: f64, least: f64) -> Self {
        let enough = order >= least;
        if !enough {
            self.pass = false;
            self.note = format!("order {order:.3}, asked for {least}");
        }
        self.with_order(order)
    }

    /// With one more word to its reader.
    #[must_use]
    pub fn with_note(mut self, note: &str) -> Self {
        if !self.note.is_empty() {
            self.note.push_str("; ");
        }
        self.note.push_str(note);
        self
    }

    /// With the errors of three steps or meshes, signed.
    #[must_use]
    pub fn with_errors(self, errors: [f64; 3]) -> Self {
        let [a, b, c] = errors;
        self.with_note(&format!("errors {a:.2e} {b:.2e} {c:.2e}"))
    }
}

/// The larger of two errors; no number is the largest of all (`max` would let it pass).
pub fn worse(a: f64, b: f64) -> f64 {
    if b <= a || a.is_nan() { a } else { b }
}

/// Order of convergence seen in the errors of two steps (or meshes), the finer half the coarser.
pub fn order(coarse: f64, fine: f64) -> f64 {
    libm::log2((coarse / fine).abs())
}

/// The order three values of halved steps (or meshes) show among themselves, without knowing what
/// they tend to.
pub fn own_order([coarse, middle, fine]: [f64; 3]) -> f64 {
    order(coarse - middle, middle - fine)
}

/// The value at step nought of two values of halved steps (or meshes), for second order.
pub fn richardson(coarse: f64, fine: f64) -> f64 {
    (4.0 * fine - coarse) / 3.0
}
