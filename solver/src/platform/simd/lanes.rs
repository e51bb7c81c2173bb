//! Eight `f64` values in a plain array: the portable implementation of [`Wide`], and the reference for
//! the vector registers.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

use super::{NodeSum, Vectors, WIDTH, Wide};

/// One value for each of eight elements.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
#[repr(C, align(64))]
pub struct Lanes(pub [f64; WIDTH]);

impl Lanes {
    #[expect(
        clippy::needless_range_loop,
        reason = "an iterator is not inlined into a target feature"
    )]
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        // A plain loop: `array::map` and `array::from_fn` are not inlined into a function with another
        // target feature.
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            lanes[lane] = operation(self.0[lane], other.0[lane]);
        }
        Self(lanes)
    }

    /// Sum of the lanes in a fixed order: ((0+4)+(2+6)) + ((1+5)+(3+7)).
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }

    /// Largest lane; NaN lanes are ignored.
    pub fn largest(self) -> f64 {
        self.0.into_iter().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a })
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.zip(self, |a, _| a * factor)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}

impl Wide for Lanes {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; WIDTH])
    }
    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        let mut lanes = [0.0; WIDTH];
        lanes.copy_from_slice(&column[first..first + WIDTH]);
        Self(lanes)
    }
    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        column[first..first + WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn lanes(self) -> Lanes {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "as in `zip`")]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            lanes[lane] = if self.0[lane] > 0.0 { yes.0[lane] } else { no.0[lane] };
        }
        Self(lanes)
    }
    #[inline(always)]
    #[expect(unsafe_code, reason = "the trait's contract")]
    unsafe fn gather(column: &[f64], indices: &[u32]) -> Self {
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            // SAFETY: the caller guarantees that every index is below the length of `column`.
            lanes[lane] = unsafe { *column.get_unchecked(indices[lane] as usize) };
        }
        Self(lanes)
    }
    #[inline(always)]
    fn from_node_sums(rows: &[NodeSum]) -> [Vectors; 2] {
        let mut columns = [Vectors::<Self>::default(); 2];
        for (lane, row) in rows[..WIDTH].iter().enumerate() {
            for (vectors, [x, y, z, _]) in columns.iter_mut().zip([row.film, row.normal]) {
                (vectors.x.0[lane], vectors.y.0[lane], vectors.z.0[lane]) = (x, y, z);
            }
        }
        columns
    }
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "as in `zip`")]
    fn to_node_sums(film: &Vectors, normal: &Vectors) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        for lane in 0..WIDTH {
            rows[lane] = NodeSum {
                film: [film.x.0[lane], film.y.0[lane], film.z.0[lane], 0.0],
                normal: [normal.x.0[lane], normal.y.0[lane], normal.z.0[lane], 0.0],
            };
        }
        rows
    }
}
