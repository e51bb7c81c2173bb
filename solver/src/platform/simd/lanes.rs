//! Eight plain numbers: what every machine has, and what other registers are checked against.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

use super::{NodeSum, Vectors, WIDTH, Wide};

/// One number of each of eight elements.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
#[repr(C, align(64))]
pub struct Lanes(pub [f64; WIDTH]);

impl Lanes {
    /// The same number eight times.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; WIDTH])
    }

    /// Eight numbers from `column[at..]`.
    #[inline(always)]
    pub fn load(column: &[f64], at: usize) -> Self {
        let mut lanes = [0.0; WIDTH];
        lanes.copy_from_slice(&column[at..at + WIDTH]);
        Self(lanes)
    }

    /// Writes to `column[at..]`.
    #[inline(always)]
    pub fn store(self, column: &mut [f64], at: usize) {
        column[at..at + WIDTH].copy_from_slice(&self.0);
    }

    #[expect(clippy::needless_range_loop, reason = "iterators are not inlined either")]
    #[inline(always)]
    fn zip(self, other: Self, join: impl Fn(f64, f64) -> f64) -> Self {
        // A plain loop: the array's own `map` and `from_fn` are not inlined into another instruction set.
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            lanes[lane] = join(self.0[lane], other.0[lane]);
        }
        Self(lanes)
    }

    /// Square roots.
    #[must_use]
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }

    /// Quotients.
    #[must_use]
    #[inline(always)]
    pub fn over(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    /// The larger of each pair.
    #[must_use]
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// `yes` where this is above 0, else `no`.
    #[must_use]
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "as in `zip`")]
    pub fn if_positive(self, yes: Self, no: Self) -> Self {
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            lanes[lane] = if self.0[lane] > 0.0 { yes.0[lane] } else { no.0[lane] };
        }
        Self(lanes)
    }

    /// Sum of the eight, as a tree: ((0+4)+(2+6)) + ((1+5)+(3+7)).
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }

    /// Largest of the eight.
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
        Self::splat(value)
    }
    #[inline(always)]
    fn load(column: &[f64], at: usize) -> Self {
        Self::load(column, at)
    }
    #[inline(always)]
    fn store(self, column: &mut [f64], at: usize) {
        self.store(column, at);
    }
    #[inline(always)]
    fn lanes(self) -> Lanes {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.over(other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.max(other)
    }
    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        self.if_positive(yes, no)
    }
    #[inline(always)]
    #[expect(unsafe_code, reason = "as the trait says")]
    unsafe fn gather(column: &[f64], at: &[u32; WIDTH]) -> Self {
        let mut lanes = [0.0; WIDTH];
        for lane in 0..WIDTH {
            // SAFETY: the caller's promise.
            lanes[lane] = unsafe { *column.get_unchecked(at[lane] as usize) };
        }
        Self(lanes)
    }
    #[inline(always)]
    fn columns(rows: &[NodeSum; WIDTH]) -> [Vectors; 2] {
        let mut columns = [Vectors::<Self>::default(); 2];
        for (lane, row) in rows.iter().enumerate() {
            for (own, [x, y, z, _]) in columns.iter_mut().zip([row.film, row.normal]) {
                (own.x.0[lane], own.y.0[lane], own.z.0[lane]) = (x, y, z);
            }
        }
        columns
    }
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "as in `zip`")]
    fn rows(first: &Vectors, second: &Vectors) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        for lane in 0..WIDTH {
            rows[lane] = NodeSum {
                film: [first.x.0[lane], first.y.0[lane], first.z.0[lane], 0.0],
                normal: [second.x.0[lane], second.y.0[lane], second.z.0[lane], 0.0],
            };
        }
        rows
    }
}
