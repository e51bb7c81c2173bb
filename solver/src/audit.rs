//! What a result is worth: energy, gas, intersections.

/// The audit of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Audit {
    /// Largest energy ledger residual of the stored series.
    pub ledger_residual: f64,
    /// Largest gas balance residual (mass and internal energy) of the stored series.
    pub gas_residual: f64,
    /// Energy dissipated by film viscosity over the work of the gas.
    pub viscous_fraction: f64,
    /// Film through film, whole run; `None` where the model has no film to pass.
    pub passages: Option<u64>,
    /// Intersections at the worst frame; `None` where the model has no film to intersect.
    pub intersections: Option<u64>,
}
