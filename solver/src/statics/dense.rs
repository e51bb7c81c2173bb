//! Cholesky of a dense front, in part: its first columns are eliminated, the rest is left reduced.
//!
//! ```text
//! A = [A11 A21ᵀ; A21 A22]      A11 = L11 L11ᵀ,  L21 = A21 L11⁻ᵀ,  A22 ← A22 − L21 L21ᵀ
//! ```
//!
//! Columns are stored one after another, each padded to eight rows; only the lower triangle counts.
//! Every entry takes its subtractions in the order of columns, so all instruction sets give the
//! same bits.

#![allow(clippy::inline_always, reason = "inside the elimination")]

use crate::platform::simd::{Lanes, WIDTH, dispatch};

/// Columns updated together.
const TILE: usize = 4;

/// Size of a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Front {
    /// Columns to be eliminated.
    pub pivots: usize,
    /// All columns.
    pub size: usize,
}

impl Front {
    /// Length of a column.
    pub fn stride(self) -> usize {
        self.size.next_multiple_of(WIDTH)
    }

    /// Numbers of the whole.
    pub fn area(self) -> usize {
        self.stride() * self.size.next_multiple_of(TILE)
    }
}

#[inline(always)]
fn eliminate_kernel(matrix: &mut [f64], front: Front, least: &[f64]) -> Option<usize> {
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
                for (own, other) in right[column..stride].iter_mut().zip(&left[column..]) {
                    *own -= other * factor;
                }
            }
            if column < front.pivots {
                let own = &mut rest[local * stride..(local + 1) * stride];
                let pivot = own[column];
                // Written so that what is no number is refused too.
                let sound = pivot > least[column];
                if !sound {
                    return Some(column);
                }
                let root = pivot.sqrt();
                own[column] = root;
                for entry in &mut own[column + 1..] {
                    *entry /= root;
                }
            }
        }
    }
    None
}

/// Takes the columns done from four more, the first of them column `from`.
#[inline(always)]
fn subtract(done: &[f64], columns: &mut [f64], stride: usize, from: usize) {
    for row in (from / WIDTH * WIDTH..stride).step_by(WIDTH) {
        let mut sum: [Lanes; TILE] =
            core::array::from_fn(|c| Lanes::load(columns, c * stride + row));
        for column in done.chunks_exact(stride) {
            let lanes = Lanes::load(column, row);
            let factors = &column[from..from + TILE];
            for (own, factor) in sum.iter_mut().zip(factors) {
                *own = *own - lanes * *factor;
            }
        }
        for (c, own) in sum.into_iter().enumerate() {
            own.store(columns, c * stride + row);
        }
    }
}

dispatch! {
    /// Eliminates the first columns of a front; the first whose pivot is not above its `least`, if
    /// any.
    pub fn eliminate / eliminate_kernel(
        matrix: &mut [f64],
        front: Front,
        least: &[f64],
    ) -> Option<usize>
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::platform::simd::InstructionSet;

    #[test]
    fn a_front_is_eliminated_in_part_with_the_same_bits_on_every_path() {
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
            let done = InstructionSet::ALL.map(|path| {
                let mut own = start.clone();
                assert_eq!(eliminate(path, &mut own, front, &vec![0.0; pivots]), None);
                own
            });
            let lower = |own: &[f64], i: usize, j: usize| own[j * front.stride() + i];
            for j in 0..size {
                for i in j..size {
                    let product: f64 = (0..=j.min(pivots - 1))
                        .map(|k| lower(&done[0], i, k) * lower(&done[0], j, k))
                        .sum();
                    let rest = if j < pivots { 0.0 } else { lower(&done[0], i, j) };
                    assert!((product + rest - full[(i, j)]).abs() < 1e-11, "{i} {j}");
                    for other in &done[1..] {
                        let [a, b] = [&done[0], other].map(|own| lower(own, i, j).to_bits());
                        assert_eq!(a, b);
                    }
                }
            }
        }
    }

    #[test]
    fn a_pivot_below_its_least_is_told() {
        let front = Front { pivots: 2, size: 2 };
        let mut matrix = vec![0.0; front.area()];
        (matrix[0], matrix[1], matrix[front.stride() + 1]) = (1.0, 2.0, 3.0);
        assert_eq!(eliminate(InstructionSet::Scalar, &mut matrix, front, &[0.0; 2]), Some(1));
    }
}
