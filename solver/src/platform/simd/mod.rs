//! Kernels that process eight elements at a time, compiled for several instruction sets.
//!
//! A kernel is written once, generic over [`Wide`], and is `#[inline(always)]`; `dispatch_wide!`
//! compiles it for the vector registers of each instruction set and selects one at run time. A kernel
//! that fills these registers takes parts of a group (`dispatch_parts!`). A kernel
//! that the compiler vectorises well is written over [`Lanes`], plain arrays, and uses `dispatch!`.
//!
//! All instruction sets give the same bits: every lane does the same additions, multiplications,
//! divisions and square roots in the same order, nothing is contracted to a fused multiply-add, and a
//! sum over lanes has one fixed order. The build needs no flags.

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
pub use corners::{Columns, Corners, NodeSum, nodes_of, vectors_at};
pub(crate) use dispatch::{dispatch, dispatch_parts, dispatch_wide, select};
pub use lanes::Lanes;
pub use vectors::Vectors;

/// Elements processed together: lanes of a [`Wide`].
pub const WIDTH: usize = 8;

/// Instruction set a kernel runs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// The baseline of the target; available on every machine.
    Scalar,
    /// AVX2: four `f64` a register.
    Avx2,
    /// AVX-512 (F and DQ): eight `f64` a register.
    Avx512,
}

impl InstructionSet {
    /// Every instruction set, the widest last.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Avx2, Self::Avx512];

    /// Name: `scalar`, `avx2`, `avx512`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The instruction set of this name; `None` for an unknown name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|instruction_set| instruction_set.name() == name)
    }

    /// Whether this machine supports it.
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

    /// The widest instruction set that this machine supports.
    pub fn detect() -> Self {
        let [scalar, rest @ ..] = Self::ALL;
        rest.into_iter().rev().find(|instruction_set| instruction_set.available()).unwrap_or(scalar)
    }
}

/// One `f64` for each element of a group, or of a part of it, in the registers of an instruction set. Every operation
/// gives the bits of as many scalar operations.
pub trait Wide:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Neg<Output = Self>
{
    /// Number of values: those of a group, or a part of them.
    const COUNT: usize = WIDTH;
    /// One value in every lane.
    fn splat(value: f64) -> Self;
    /// The values from `column[first..]`.
    fn load(column: &[f64], first: usize) -> Self;
    /// Writes the values to `column[first..]`.
    fn store(self, column: &mut [f64], first: usize);
    /// The values as a plain array, zero beyond their number.
    #[inline(always)]
    fn lanes(self) -> Lanes {
        let mut lanes = [0.0; WIDTH];
        self.store(&mut lanes, 0);
        Lanes(lanes)
    }
    /// Square root of each lane.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Quotient of each pair of lanes.
    #[must_use]
    fn over(self, other: Self) -> Self;
    /// The larger of each pair of lanes; `other` where either is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The lane of `yes` where this lane is above 0, else that of `no` (also for NaN).
    #[must_use]
    fn if_positive(self, yes: Self, no: Self) -> Self;
    /// The values at these indices of a column.
    ///
    /// # Safety
    /// There must be an index for each value, below the length of `column`.
    #[expect(unsafe_code, reason = "indices are checked once, not at each call")]
    unsafe fn gather(column: &[f64], indices: &[u32]) -> Self;
    /// Transposes film forces and normals to one [`NodeSum`] a lane; zero beyond their number.
    fn to_node_sums(film: &Vectors<Self>, normal: &Vectors<Self>) -> [NodeSum; WIDTH];
    /// Transposes as many sums to their film forces and their normals.
    fn from_node_sums(rows: &[NodeSum]) -> [Vectors<Self>; 2];
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "equal bits are the property")]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_summed_in_a_fixed_order() {
        let lanes = Lanes([1e16, 1.0, -1e16, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!(lanes.sum(), ((1e16 + 1.0) + (-1e16 + 1.0)) + (2.0 + 2.0));
        assert_eq!(lanes.largest(), 1e16);
    }

    #[inline(always)]
    fn kernel(values: &[f64]) -> f64 {
        let mut sum = Lanes::default();
        for first in (0..values.len()).step_by(WIDTH) {
            let a = Lanes::load(values, first);
            sum += (a * a + a * 0.1).sqrt().over(a + Lanes::splat(3.0));
        }
        sum.sum()
    }
    dispatch! { fn run / kernel(values: &[f64]) -> f64 }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let values: Vec<f64> = (0..800).map(|k| f64::from(k) * 0.371 + 0.01).collect();
        let scalar = run(InstructionSet::Scalar, &values);
        for instruction_set in InstructionSet::ALL {
            let sum = run(instruction_set, &values);
            assert_eq!(sum.to_bits(), scalar.to_bits(), "{}", instruction_set.name());
        }
        assert!(InstructionSet::detect().available());
    }

    #[test]
    fn names_are_read_back_and_unknown_ones_refused() {
        for instruction_set in InstructionSet::ALL {
            assert_eq!(InstructionSet::from_name(instruction_set.name()), Some(instruction_set));
        }
        assert_eq!(InstructionSet::from_name("AVX2"), None);
        assert_eq!(InstructionSet::from_name(""), None);
    }
}
