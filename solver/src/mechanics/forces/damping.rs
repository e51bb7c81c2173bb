//! Damping of the film: in-plane viscosity, and mass damping.
//!
//! ```text
//! S_v = (2ζ/ω_e) C:Ė      power = A t S_v:Ė ≥ 0      E = (FᵀF − 1)/2,  Ėⁿ = (Eⁿ − Eⁿ⁻¹)/Δt
//! work of a step = ½ A t (S_vⁿ + S_vⁿ⁺¹):(Eⁿ⁺¹ − Eⁿ)
//! m a = f − c m v         v⁺ = ((1 − c h/2) v⁻ + h f/m)/(1 + c h/2)
//! ```
//!
//! Symbols: ζ damping ratio of the element's highest mode, `ω_e` its frequency (rad/s), C plane-stress
//! stiffness (Pa); c mass damping (1/s), h time between the two velocities (s).
//!
//! - At the start of a run there is no previous step: Ė = sym(FᵀḞ).
//! - The work of a step differs from that of the nodal forces by
//!   `¼ A t (S_vⁿ⁺¹ − S_vⁿ):ΔFᵀΔF`, which is of higher order in Δt.
//! - Ė is zero in any rigid motion and the forces are internal to an element: viscosity gives no net
//!   force and no net moment.
//! - Viscosity resists stretching and shortening alike, in slack film too. It slows down slack nodes.

/// Factors of the velocity and of the acceleration (s) in a kick of length h (s) under mass damping c
/// (1/s): (1 − c h/2)/(1 + c h/2) and h/(1 + c h/2).
pub fn kick_factors(damping: f64, length: f64) -> (f64, f64) {
    let half = 0.5 * damping * length;
    ((1.0 - half) / (1.0 + half), length / (1.0 + half))
}

/// Factor √(1+ζ²) − ζ by which viscosity shortens the stable step of central differences when its
/// force uses the velocity of the last half step.
pub fn stable_share(viscosity: f64) -> f64 {
    (viscosity * viscosity + 1.0).sqrt() - viscosity
}
