//! Eight elements at a time: kernels compiled for several instruction sets.
//!
//! A kernel is written once over any [`Wide`] and is `#[inline(always)]`; `dispatch_wide!` instantiates
//! it on the registers of each instruction set, under `#[target_feature]`, and picks at run time. What
//! the compiler does well by itself is written over [`Lanes`], plain arrays, and goes by `dispatch!`. Every
//! lane does the same additions, multiplications, divisions and square roots in the same order on every
//! path, nothing is contracted to a fused multiply-add, and sums over lanes are one fixed tree: the bits
//! are equal, the build needs no flags.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, Mul, Neg, Sub};

mod column;
mod corners;
mod dispatch;
mod lanes;
mod vectors;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

pub use column::Column;
pub use corners::{Columns, Corners, NodeSum, vectors_at};
pub(crate) use dispatch::{dispatch, dispatch_wide};
pub use lanes::Lanes;
pub use vectors::Vectors;

/// Elements handled at once.
pub const WIDTH: usize = 8;

/// Instruction set a kernel runs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every x86-64 (or other) machine has.
    Scalar,
    /// AVX2: four at a time.
    Avx2,
    /// AVX-512: eight at a time.
    Avx512,
}

impl InstructionSet {
    /// Every path, the widest last.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Avx2, Self::Avx512];

    /// Name: `scalar`, `avx2`, `avx512`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this machine has it.
    pub fn available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The widest this machine has.
    pub fn detect() -> Self {
        let [scalar, rest @ ..] = Self::ALL;
        rest.into_iter().rev().find(|path| path.available()).unwrap_or(scalar)
    }
}

/// One number of each of eight elements, in whatever an instruction set has for it. All of its
/// operations give the bits that eight plain numbers would.
pub trait Wide:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Neg<Output = Self>
{
    /// The same number eight times.
    fn splat(value: f64) -> Self;
    /// Eight numbers from `column[at..]`.
    fn load(column: &[f64], at: usize) -> Self;
    /// Writes to `column[at..]`.
    fn store(self, column: &mut [f64], at: usize);
    /// As plain numbers.
    fn lanes(self) -> Lanes;
    /// Square roots.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Quotients.
    #[must_use]
    fn over(self, other: Self) -> Self;
    /// The larger of each pair; the other where either is no number.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// `yes` where this is above 0, else `no`.
    #[must_use]
    fn if_positive(self, yes: Self, no: Self) -> Self;
    /// The numbers at these places of a column.
    ///
    /// # Safety
    /// The column must reach beyond each place, and no place be 2^31 or more.
    #[expect(unsafe_code, reason = "places are checked once, not at each call")]
    unsafe fn gather(column: &[f64], at: &[u32; WIDTH]) -> Self;
    /// Vectors one by one: the first three numbers of each four from `first`, the last three from
    /// `second`, as [`NodeSum`] has them.
    fn rows(first: &Vectors<Self>, second: &Vectors<Self>) -> [NodeSum; WIDTH];
    /// Back from there.
    fn columns(rows: &[NodeSum; WIDTH]) -> [Vectors<Self>; 2];
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "bits are what is asked")]
mod tests {
    use super::*;

    #[test]
    fn a_sum_is_a_fixed_tree() {
        let lanes = Lanes([1e16, 1.0, -1e16, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!(lanes.sum(), ((1e16 + 1.0) + (-1e16 + 1.0)) + (2.0 + 2.0));
        assert_eq!(lanes.largest(), 1e16);
    }

    #[inline(always)]
    fn kernel(values: &[f64]) -> f64 {
        let mut sum = Lanes::default();
        for at in (0..values.len()).step_by(WIDTH) {
            let a = Lanes::load(values, at);
            sum += (a * a + a * 0.1).sqrt().over(a + Lanes::splat(3.0));
        }
        sum.sum()
    }
    dispatch! { fn run / kernel(values: &[f64]) -> f64 }

    #[test]
    fn every_path_gives_the_same_bits() {
        let values: Vec<f64> = (0..800).map(|k| f64::from(k) * 0.371 + 0.01).collect();
        let scalar = run(InstructionSet::Scalar, &values);
        for path in InstructionSet::ALL {
            assert_eq!(run(path, &values).to_bits(), scalar.to_bits(), "{}", path.name());
        }
        assert!(InstructionSet::detect().available());
    }
}
