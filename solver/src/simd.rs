//! Eight elements at a time: plain arithmetic on `[f64; 8]`, compiled for several instruction sets.
//!
//! A kernel is written once over [`Lanes`] and is `#[inline(always)]`; `dispatch!` instantiates it
//! under `#[target_feature]` and picks at run time. Every lane does the same additions,
//! multiplications, divisions and square roots in the same order on every path, nothing is
//! contracted to a fused multiply-add, and sums over lanes are one fixed tree: the bits are equal,
//! the build needs no flags.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

mod corners;
mod vectors;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

pub use corners::{Corners, NodeSum, vectors_at};
pub use vectors::Vectors;

/// Elements handled at once.
pub const WIDTH: usize = 8;

/// Instruction set a kernel runs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Path {
    /// What every x86-64 (or other) machine has.
    Scalar,
    /// AVX2: four at a time.
    Avx2,
    /// AVX-512: eight at a time.
    Avx512,
}

impl Path {
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
    pub fn best() -> Self {
        let [scalar, rest @ ..] = Self::ALL;
        rest.into_iter().rev().find(|path| path.available()).unwrap_or(scalar)
    }
}

/// Defines `pub fn $name(path, arguments…)` that runs the `#[inline(always)]` function `$kernel` on
/// the instruction set of `path`.
///
/// A path this machine lacks runs as scalar: the bits are the same.
macro_rules! dispatch {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {
        $(#[$meta])*
        #[expect(unsafe_code, reason = "each instruction set is entered only where it is detected")]
        $vis fn $name(path: $crate::simd::Path, $($arg: $ty),*) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $ty),*) $(-> $ret)? {
                    $kernel($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512($($arg: $ty),*) $(-> $ret)? {
                    $kernel($($arg),*)
                }
                use $crate::simd::Path;
                match path {
                    // SAFETY: the features are there, just asked for.
                    Path::Avx2 if path.available() => return unsafe { avx2($($arg),*) },
                    // SAFETY: as above.
                    Path::Avx512 if path.available() => return unsafe { avx512($($arg),*) },
                    _ => {}
                }
            }
            let _ = path;
            $kernel($($arg),*)
        }
    };
}
pub(crate) use dispatch;

/// Defines `pub fn $name(path, arguments…)` as `dispatch!` does, for a kernel that is written over any
/// [`Wide`] and runs on the registers of each instruction set.
macro_rules! dispatch_wide {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {
        $(#[$meta])*
        #[expect(unsafe_code, reason = "each instruction set is entered only where it is detected")]
        $vis fn $name(path: $crate::simd::Path, $($arg: $ty),*) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $ty),*) $(-> $ret)? {
                    $kernel::<$crate::simd::x86::Avx2>($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512($($arg: $ty),*) $(-> $ret)? {
                    $kernel::<$crate::simd::x86::Avx512>($($arg),*)
                }
                use $crate::simd::Path;
                match path {
                    // SAFETY: the features are there, just asked for.
                    Path::Avx2 if path.available() => return unsafe { avx2($($arg),*) },
                    // SAFETY: as above.
                    Path::Avx512 if path.available() => return unsafe { avx512($($arg),*) },
                    _ => {}
                }
            }
            let _ = path;
            $kernel::<$crate::simd::Lanes>($($arg),*)
        }
    };
}
pub(crate) use dispatch_wide;

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
}

/// One number of each of eight elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(align(64))]
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
    #[expect(clippy::needless_range_loop, reason = "as in `zip`")]
    fn rows(first: &Vectors, second: &Vectors) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        for lane in 0..WIDTH {
            rows[lane] = NodeSum {
                film: [first.x.0[lane], first.y.0[lane], first.z.0[lane], 0.0],
                area: [second.x.0[lane], second.y.0[lane], second.z.0[lane], 0.0],
            };
        }
        rows
    }
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
        let scalar = run(Path::Scalar, &values);
        for path in Path::ALL {
            assert_eq!(run(path, &values).to_bits(), scalar.to_bits(), "{}", path.name());
        }
        assert!(Path::best().available());
    }
}
