//! Plane tensors of eight elements at once, each as its isotropic component and two deviatoric ones.
//!
//! ```text
//! stress (mean, half difference, shear)    strain (sum, difference, shear)    S:E = Σ SᵢEᵢ
//! ```

#![expect(clippy::inline_always, reason = "lanes must stay in registers")]

use crate::platform::simd::Wide;

/// S:E of a stress and a strain.
#[inline(always)]
pub fn contract<L: Wide>(stress: [L; 3], strain: [L; 3]) -> L {
    stress[0] * strain[0] + stress[1] * strain[1] + stress[2] * strain[2]
}

/// a − b.
#[inline(always)]
pub fn subtract<L: Wide>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + b.
#[inline(always)]
pub fn add<L: Wide>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Each component times a factor.
#[inline(always)]
pub fn scale<L: Wide>(a: [L; 3], factor: L) -> [L; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Multiplies the components of a strain by the two factors of an isotropic tensor: C or C⁻¹.
#[inline(always)]
pub fn isotropic<L: Wide>(a: [L; 3], [mean, deviator]: [f64; 2]) -> [L; 3] {
    [a[0] * mean, a[1] * deviator, a[2] * deviator]
}
