//! Eight values in the registers of AVX2 and of AVX-512, and four in one register of AVX2.
//!
//! Every operation is one instruction (two on AVX2) and gives the bits of eight scalar operations.
//! Plain arrays ([`Lanes`](super::Lanes)) leave the choice of instructions to the compiler, which turns some long
//! kernels into scalar code; these types do not.
//!
//! # Safety
//! **Invariant**: code that uses [`Avx2`] and [`Avx2Half`] runs only where AVX2 is detected, code that uses
//! [`Avx512`] only where AVX-512 F and DQ are detected. `dispatch_wide!` and `dispatch_parts!` alone name these types,
//! and only inside functions they enter after detection. Every unsafe block below rests on this invariant.

#![expect(unsafe_code, reason = "each intrinsic needs its instruction set")]
#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

#[allow(clippy::wildcard_imports, reason = "forty intrinsics, each named once")]
use core::arch::x86_64::*;
use core::ops::{Add, Mul, Neg, Sub};

use super::{NodeSum, Vectors, WIDTH, Wide};

mod transpose;

use transpose::{from_rows_of_four, interleave_pair, to_half_rows_of_eight, to_rows_of_four};

/// Four values in one register: half a group, for a kernel that needs many registers. Invariant: AVX2 is present.
#[derive(Debug, Clone, Copy)]
pub struct Avx2Half(__m256d);

/// Eight values in two registers: lanes 0 to 3 and 4 to 7.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(Avx2Half, Avx2Half);

/// Eight values in one register. Invariant: AVX-512 F and DQ are present.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(__m512d);

macro_rules! operators {
    ($trait:ident, $method:ident, $avx2:ident, $avx512:ident) => {
        impl $trait for Avx2Half {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: AVX2 is present (module invariant).
                unsafe { Self($avx2(self.0, other.0)) }
            }
        }
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
        impl $trait for Avx512 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: AVX-512 is present (module invariant).
                unsafe { Self($avx512(self.0, other.0)) }
            }
        }
    };
}
operators!(Add, add, _mm256_add_pd, _mm512_add_pd);
operators!(Sub, sub, _mm256_sub_pd, _mm512_sub_pd);
operators!(Mul, mul, _mm256_mul_pd, _mm512_mul_pd);

macro_rules! scaled {
    ($type:ident) => {
        impl Mul<f64> for $type {
            type Output = Self;
            #[inline(always)]
            fn mul(self, factor: f64) -> Self {
                self * Self::splat(factor)
            }
        }
    };
}
scaled!(Avx2Half);
scaled!(Avx2);
scaled!(Avx512);

impl Neg for Avx2Half {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe { Self(_mm256_xor_pd(self.0, _mm256_set1_pd(-0.0))) }
    }
}

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe { Self(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))) }
    }
}

/// The operations that are one instruction, and loads and stores, of one register.
macro_rules! one_register {
    ($splat:ident, $load:ident, $store:ident, $sqrt:ident, $over:ident, $max:ident) => {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: the instruction set is present (module invariant).
            unsafe { Self($splat(value)) }
        }

        #[inline(always)]
        fn load(column: &[f64], first: usize) -> Self {
            let values = column[first..first + Self::COUNT].as_ptr();
            // SAFETY: the instruction set is present (module invariant); `values` points to as many values.
            unsafe { Self($load(values)) }
        }

        #[inline(always)]
        fn store(self, column: &mut [f64], first: usize) {
            let values = column[first..first + Self::COUNT].as_mut_ptr();
            // SAFETY: the instruction set is present (module invariant); `values` points to as many values,
            // borrowed mutably.
            unsafe { $store(values, self.0) }
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: the instruction set is present (module invariant).
            unsafe { Self($sqrt(self.0)) }
        }

        #[inline(always)]
        fn over(self, other: Self) -> Self {
            // SAFETY: the instruction set is present (module invariant).
            unsafe { Self($over(self.0, other.0)) }
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: the instruction set is present (module invariant).
            unsafe { Self($max(self.0, other.0)) }
        }
    };
}

impl Wide for Avx2Half {
    const COUNT: usize = WIDTH / 2;

    one_register!(
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_sqrt_pd,
        _mm256_div_pd,
        _mm256_max_pd
    );

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe {
            let positive = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, _mm256_setzero_pd());
            Self(_mm256_blendv_pd(no.0, yes.0, positive))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], indices: &[u32]) -> Self {
        // SAFETY: AVX2 is present (module invariant); the caller guarantees that four indices are below the
        // length of `column`.
        unsafe {
            let value = |lane: usize| *column.get_unchecked(indices[lane] as usize);
            Self(_mm256_setr_pd(value(0), value(1), value(2), value(3)))
        }
    }

    #[inline(always)]
    fn to_node_sums(film: &Vectors<Self>, normal: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        // SAFETY: AVX2 is present (module invariant); `film` and `normal` of a sum are four values each,
        // and `rows` is borrowed mutably.
        unsafe {
            let film = to_rows_of_four(film.x.0, film.y.0, film.z.0);
            let normal = to_rows_of_four(normal.x.0, normal.y.0, normal.z.0);
            for lane in 0..Self::COUNT {
                _mm256_storeu_pd(rows[lane].film.as_mut_ptr(), film[lane]);
                _mm256_storeu_pd(rows[lane].normal.as_mut_ptr(), normal[lane]);
            }
        }
        rows
    }

    #[inline(always)]
    fn from_node_sums(rows: &[NodeSum]) -> [Vectors<Self>; 2] {
        let [a, b, c, d] = [&rows[0], &rows[1], &rows[2], &rows[3]];
        // SAFETY: AVX2 is present (module invariant).
        unsafe {
            let [x, y, z] = from_rows_of_four(&a.film, &b.film, &c.film, &d.film);
            let film = Vectors { x: Self(x), y: Self(y), z: Self(z) };
            let [x, y, z] = from_rows_of_four(&a.normal, &b.normal, &c.normal, &d.normal);
            [film, Vectors { x: Self(x), y: Self(y), z: Self(z) }]
        }
    }
}

impl Avx2 {
    /// Both halves of vectors as eight.
    #[inline(always)]
    fn joined(low: Vectors<Avx2Half>, high: Vectors<Avx2Half>) -> Vectors<Self> {
        Vectors { x: Self(low.x, high.x), y: Self(low.y, high.y), z: Self(low.z, high.z) }
    }
}

/// An operation on both halves.
macro_rules! on_both {
    ($($method:ident($($other:ident),*))*) => {$(
        #[inline(always)]
        fn $method(self, $($other: Self),*) -> Self {
            Self(self.0.$method($($other.0),*), self.1.$method($($other.1),*))
        }
    )*};
}

impl Wide for Avx2 {
    on_both! { sqrt() over(other) max(other) if_positive(yes, no) }

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(Wide::splat(value), Wide::splat(value))
    }

    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        Self(Wide::load(column, first), Wide::load(column, first + Avx2Half::COUNT))
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        self.0.store(column, first);
        self.1.store(column, first + Avx2Half::COUNT);
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], indices: &[u32]) -> Self {
        // SAFETY: the caller guarantees that eight indices are below the length of `column`.
        unsafe {
            let (low, high) = indices.split_at(Avx2Half::COUNT);
            Self(Wide::gather(column, low), Wide::gather(column, high))
        }
    }

    #[inline(always)]
    fn to_node_sums(film: &Vectors<Self>, normal: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let low = |v: &Vectors<Self>| Vectors { x: v.x.0, y: v.y.0, z: v.z.0 };
        let high = |v: &Vectors<Self>| Vectors { x: v.x.1, y: v.y.1, z: v.z.1 };
        let mut rows = Wide::to_node_sums(&low(film), &low(normal));
        let others = Wide::to_node_sums(&high(film), &high(normal));
        rows[Avx2Half::COUNT..].copy_from_slice(&others[..Avx2Half::COUNT]);
        rows
    }

    #[inline(always)]
    fn from_node_sums(rows: &[NodeSum]) -> [Vectors<Self>; 2] {
        let [film, normal] = Wide::from_node_sums(&rows[..Avx2Half::COUNT]);
        let [other_film, other_normal] = Wide::from_node_sums(&rows[Avx2Half::COUNT..]);
        [Self::joined(film, other_film), Self::joined(normal, other_normal)]
    }
}

impl Wide for Avx512 {
    one_register!(
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_sqrt_pd,
        _mm512_div_pd,
        _mm512_max_pd
    );

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe {
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_setzero_pd());
            Self(_mm512_mask_blend_pd(positive, no.0, yes.0))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], indices: &[u32]) -> Self {
        // SAFETY: AVX-512 is present (module invariant); the caller guarantees that eight indices are below
        // the length of `column`.
        unsafe {
            let value = |lane: usize| *column.get_unchecked(indices[lane] as usize);
            Self(_mm512_setr_pd(
                value(0),
                value(1),
                value(2),
                value(3),
                value(4),
                value(5),
                value(6),
                value(7),
            ))
        }
    }

    #[inline(always)]
    fn to_node_sums(film: &Vectors<Self>, normal: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        // SAFETY: AVX-512 is present (module invariant); a `NodeSum` is eight values aligned to 64 bytes
        // (`repr(C, align(64))`), and `rows` is borrowed mutably.
        unsafe {
            let film = to_half_rows_of_eight([film.x.0, film.y.0, film.z.0]);
            let normal = to_half_rows_of_eight([normal.x.0, normal.y.0, normal.z.0]);
            for lane in 0..WIDTH {
                let [film, normal] = [film[lane % 2][lane / 4], normal[lane % 2][lane / 4]];
                let row = if lane % 4 < 2 {
                    _mm512_shuffle_f64x2::<0x88>(film, normal)
                } else {
                    _mm512_shuffle_f64x2::<0xDD>(film, normal)
                };
                _mm512_store_pd(core::ptr::from_mut(&mut rows[lane]).cast(), row);
            }
        }
        rows
    }

    #[inline(always)]
    fn from_node_sums(rows: &[NodeSum]) -> [Vectors<Self>; 2] {
        let rows = &rows[..WIDTH];
        // SAFETY: AVX-512 is present (module invariant).
        unsafe {
            // A pair of rows gives film x, film z, normal x, normal z of its two lanes in the first
            // register, and film y, padding, normal y, padding in the second.
            let first = interleave_pair(&rows[0], &rows[1]);
            let second = interleave_pair(&rows[2], &rows[3]);
            let third = interleave_pair(&rows[4], &rows[5]);
            let fourth = interleave_pair(&rows[6], &rows[7]);
            // Film then normal, of lanes 0 to 3.
            let x = _mm512_shuffle_f64x2::<0x88>(first[0], second[0]);
            let y = _mm512_shuffle_f64x2::<0x88>(first[1], second[1]);
            let z = _mm512_shuffle_f64x2::<0xDD>(first[0], second[0]);
            // Film then normal, of lanes 4 to 7.
            let x_high = _mm512_shuffle_f64x2::<0x88>(third[0], fourth[0]);
            let y_high = _mm512_shuffle_f64x2::<0x88>(third[1], fourth[1]);
            let z_high = _mm512_shuffle_f64x2::<0xDD>(third[0], fourth[0]);
            [
                Vectors {
                    x: Self(_mm512_shuffle_f64x2::<0x88>(x, x_high)),
                    y: Self(_mm512_shuffle_f64x2::<0x88>(y, y_high)),
                    z: Self(_mm512_shuffle_f64x2::<0x88>(z, z_high)),
                },
                Vectors {
                    x: Self(_mm512_shuffle_f64x2::<0xDD>(x, x_high)),
                    y: Self(_mm512_shuffle_f64x2::<0xDD>(y, y_high)),
                    z: Self(_mm512_shuffle_f64x2::<0xDD>(z, z_high)),
                },
            ]
        }
    }
}

/// Aligns the stack of the function that it is inlined into to 64 bytes, for the registers that the compiler stores there.
/// Where no local needs the alignment, it decides on the frame before it knows of them, and stores them across cache lines.
#[inline(always)]
pub(crate) fn align_frame() {
    core::hint::black_box(&mut super::Lanes::default());
}

#[cfg(test)]
mod tests;
