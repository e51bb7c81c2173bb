//! Partial Cholesky factorisation of a dense front: eliminates its first columns and leaves the Schur
//! complement in the others.
//!
//! ```text
//! A = [A11 A21ᵀ; A21 A22]      A11 = L11 L11ᵀ,  L21 = A21 L11⁻ᵀ,  A22 ← A22 − L21 L21ᵀ
//! ```
//!
//! Columns are stored one after the other, each padded to a multiple of eight rows; only the lower triangle
//! is used. Every entry takes its subtractions in the order of columns, so every instruction set gives
//! the same bits.

#![allow(clippy::inline_always, reason = "inside the elimination")]

use crate::platform::simd::{Lanes, WIDTH, dispatch};

/// Number of columns updated together. Chosen: their sums fit the registers.
const TILE: usize = 4;

/// Size of a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Front {
    /// Number of columns to eliminate.
    pub pivots: usize,
    /// Number of columns.
    pub size: usize,
}

impl Front {
    /// Stored length of a column.
    pub fn stride(self) -> usize {
        self.size.next_multiple_of(WIDTH)
    }

    /// Number of stored entries.
    pub fn area(self) -> usize {
        self.stride() * self.size.next_multiple_of(TILE)
    }
}

#[inline(always)]
fn eliminate_kernel(matrix: &mut [f64], front: Front, min_pivots: &[f64]) -> Option<usize> {
    let stride = front.stride();
    for from in (0..front.size).step_by(TILE) {
        let (done, rest) = matrix.split_at_mut(from * stride);
        let done = &done[..front.pivots.min(from) * stride];
        subtract(done, &mut rest[..TILE * stride], stride, from);
        for column in from..(from + TILE).min(front.size) {
            let local = column - from;
            for earlier in from..column.min(front.pivots) {
                let (left, right) = rest.split_at_mut(local * stride);
                let left = &left[(earlier - from) * stride..(earlier - from + 1) * stride];
                let factor = left[column];
                for (entry, other) in right[column..stride].iter_mut().zip(&left[column..]) {
                    *entry -= other * factor;
                }
            }
            if column < front.pivots {
                let current = &mut rest[local * stride..(local + 1) * stride];
                let pivot = current[column];
                // Written so that NaN is refused too.
                let positive = pivot > min_pivots[column];
                if !positive {
                    return Some(column);
                }
                let root = pivot.sqrt();
                current[column] = root;
                for entry in &mut current[column + 1..] {
                    *entry /= root;
                }
            }
        }
    }
    None
}

/// Subtracts the eliminated columns from [`TILE`] further columns, the first of which is column `from`.
#[inline(always)]
fn subtract(done: &[f64], columns: &mut [f64], stride: usize, from: usize) {
    for row in (from / WIDTH * WIDTH..stride).step_by(WIDTH) {
        let mut sum: [Lanes; TILE] =
            core::array::from_fn(|c| Lanes::load(columns, c * stride + row));
        for column in done.chunks_exact(stride) {
            let lanes = Lanes::load(column, row);
            let factors = &column[from..from + TILE];
            for (entry, factor) in sum.iter_mut().zip(factors) {
                *entry = *entry - lanes * *factor;
            }
        }
        for (c, entry) in sum.into_iter().enumerate() {
            entry.store(columns, c * stride + row);
        }
    }
}

dispatch! {
    /// Eliminates the first columns of a front. Stops at the first column whose pivot is not above its
    /// bound in `min_pivots`, and returns it.
    pub fn eliminate / eliminate_kernel(
        matrix: &mut [f64],
        front: Front,
        min_pivots: &[f64],
    ) -> Option<usize>
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::platform::simd::InstructionSet;

    #[test]
    fn partial_elimination_gives_the_same_bits_on_every_instruction_set() {
        for (pivots, size) in [(1, 1), (3, 7), (6, 6), (5, 21), (16, 33), (30, 31)] {
            let front = Front { pivots, size };
            let entry = |i: usize, j: usize| libm::sin((3 * i + 7 * j) as f64);
            let half = DMatrix::from_fn(size, size, entry);
            let full = &half * half.transpose() + DMatrix::identity(size, size);
            let mut start = vec![0.0; front.area()];
            for j in 0..size {
                for i in j..size {
                    start[j * front.stride() + i] = full[(i, j)];
                }
            }
            let done = InstructionSet::ALL.map(|instruction_set| {
                let mut matrix = start.clone();
                assert_eq!(
                    eliminate(instruction_set, &mut matrix, front, &vec![0.0; pivots]),
                    None
                );
                matrix
            });
            let lower = |matrix: &[f64], i: usize, j: usize| matrix[j * front.stride() + i];
            for j in 0..size {
                for i in j..size {
                    let product: f64 = (0..=j.min(pivots - 1))
                        .map(|k| lower(&done[0], i, k) * lower(&done[0], j, k))
                        .sum();
                    let rest = if j < pivots { 0.0 } else { lower(&done[0], i, j) };
                    assert!((product + rest - full[(i, j)]).abs() < 1e-11, "{i} {j}");
                    for other in &done[1..] {
                        let [a, b] = [&done[0], other].map(|matrix| lower(matrix, i, j).to_bits());
                        assert_eq!(a, b);
                    }
                }
            }
        }
    }

    #[test]
    fn a_pivot_below_its_bound_is_returned() {
        let front = Front { pivots: 2, size: 2 };
        let mut matrix = vec![0.0; front.area()];
        (matrix[0], matrix[1], matrix[front.stride() + 1]) = (1.0, 2.0, 3.0);
        assert_eq!(eliminate(InstructionSet::Scalar, &mut matrix, front, &[0.0; 2]), Some(1));
    }
}
