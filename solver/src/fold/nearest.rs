//! The nearest feasible value of a key, when a design is infeasible.

/// A single change that makes an infeasible design feasible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Key of [`crate::fold::FoldDesign`], as in JSON.
    pub key: &'static str,
    /// Nearest feasible value, SI.
    pub value: f64,
}
