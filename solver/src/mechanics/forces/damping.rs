//! What takes energy from film: viscosity in its plane, and mass damping for statics.
//!
//! ```text
//! S_v = (2ζ/ω_e) C:Ė      power = A t S_v:Ė ≥ 0      E = (FᵀF − 1)/2,  Ėⁿ = (Eⁿ − Eⁿ⁻¹)/Δt
//! work of a step = ½ A t (S_vⁿ + S_vⁿ⁺¹):(Eⁿ⁺¹ − Eⁿ): that of the forces but for ¼ A t (S_vⁿ⁺¹ − S_vⁿ):ΔFᵀΔF
//! m a = f − c m v         v⁺ = ((1 − c h/2) v⁻ + h f/m)/(1 + c h/2)
//! ```
//!
//! Symbols: ζ damping ratio of the element's own fastest mode, `ω_e` its frequency (rad/s), C
//! plane-stress stiffness (Pa); c mass damping (1/s), h time between the two velocities (s).
//! At a start, where no step was, Ė = sym(FᵀḞ). Ė is nought in any rigid motion and its forces are internal to an element, so viscosity gives
//! neither force nor moment. It resists closing and opening alike, in slack film too: that is what
//! keeps slack nodes from flying.

/// The factors of velocity and of acceleration in a kick of length h (s) under mass damping c
/// (1/s).
pub fn kick_factors(damping: f64, length: f64) -> (f64, f64) {
    let half = 0.5 * damping * length;
    ((1.0 - half) / (1.0 + half), length / (1.0 + half))
}

/// By how much viscosity shortens the stable step: √(1+ζ²) − ζ, for forces of the last velocity.
pub fn stable_share(viscosity: f64) -> f64 {
    (viscosity * viscosity + 1.0).sqrt() - viscosity
}
