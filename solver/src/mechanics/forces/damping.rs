//! Numerical damping of the film, and mass damping.
//!
//! ```text
//! D = (κ + 2ζ/(ω_e Δt)) ΔS        ΔS = Sⁿ − Sⁿ⁻¹, ΔÊ likewise
//! κ = ½ (Sⁿ:Êⁿ⁻¹ − Sⁿ⁻¹:Êⁿ)/(ΔS:ΔÊ), from −½ to ½
//! numerical dissipation of a step = A t (½ (Dⁿ⁻¹ + Dⁿ):ΔE − ½ (Sⁿ:Êⁿ⁻¹ − Sⁿ⁻¹:Êⁿ)/(1 + g))
//!
//! m a = f − c m v         v⁺ = ((1 − c h/2) v⁻ + h f/m)/(1 + c h/2)
//! ```
//!
//! Symbols: D numerical stress (Pa); S stress and Ê elastic strain of
//! [`crate::mechanics::material_loss`]; ζ numerical damping ratio of the element's highest mode, `ω_e`
//! its frequency (rad/s); c mass damping (1/s), h time between the two velocities (s).
//!
//! - `2ζ/ω_e` Ṡ damps stress that changes. It acts on film that carries tension and leaves slack film
//!   alone: ΔS is 0 there. ΔS:ΔÊ ≥ 0 because W is convex.
//! - κ ΔS completes the impulse of a step in which the film goes taut or slack. Central differences give
//!   such a step the mean of its two end stresses; the energy ½ (Sⁿ:Êⁿ⁻¹ − Sⁿ⁻¹:Êⁿ) per volume is then
//!   missing (or too much), because W = ½ S:Ê in every regime. κ is 0 within a regime.
//! - Numerical dissipation counts both, the work of D and the energy missing: it is what the numerics
//!   take from the film, and negative where they give.
//! - D follows the change of S: it is zero in any rigid motion, and internal to an element. It has no
//!   net force and no net moment.

/// Factors of the velocity and of the acceleration (s) in a kick of length h (s) under mass damping c
/// (1/s): (1 − c h/2)/(1 + c h/2) and h/(1 + c h/2).
pub fn kick_factors(damping: f64, length: f64) -> (f64, f64) {
    let half = 0.5 * damping * length;
    ((1.0 - half) / (1.0 + half), length / (1.0 + half))
}

/// Factor √(1+ζ²) − ζ by which numerical damping of this ratio ζ shortens the stable step of central
/// differences: its force uses the change of stress over the last step.
pub fn stable_share(ratio: f64) -> f64 {
    (ratio * ratio + 1.0).sqrt() - ratio
}
