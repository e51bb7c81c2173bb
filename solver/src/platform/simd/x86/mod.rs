//! Eight values in the registers of AVX2 and of AVX-512.
//!
//! Every operation is one instruction (two on AVX2) and gives the bits of eight scalar operations.
//! Plain arrays ([`Lanes`](super::Lanes)) leave the choice of instructions to the compiler, which turns some long
//! kernels into scalar code; these types do not.
//!
//! # Safety
//! **Invariant**: code that uses [`Avx2`] runs only where AVX2 is detected, code that uses [`Avx512`]
//! only where AVX-512 F and DQ are detected. `dispatch_wide!` alone names the two types, and only
//! inside functions it enters after detection. Every unsafe block below rests on this invariant.

#![expect(unsafe_code, reason = "each intrinsic needs its instruction set")]
#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

#[allow(clippy::wildcard_imports, reason = "forty intrinsics, each named once")]
use core::arch::x86_64::*;
use core::ops::{Add, Mul, Neg, Sub};

use super::{NodeSum, Vectors, WIDTH, Wide};

mod transpose;

use transpose::{from_rows_of_four, interleave_pair, to_half_rows_of_eight, to_rows_of_four};

/// Eight values in two registers: lanes 0 to 3 and 4 to 7. Invariant: AVX2 is present.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(__m256d, __m256d);

/// Eight values in one register. Invariant: AVX-512 F and DQ are present.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(__m512d);

macro_rules! operators {
    ($trait:ident, $method:ident, $avx2:ident, $avx512:ident) => {
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: AVX2 is present (module invariant).
                unsafe { Self($avx2(self.0, other.0), $avx2(self.1, other.1)) }
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

impl Mul<f64> for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(factor)
    }
}

impl Mul<f64> for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(factor)
    }
}

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_xor_pd(self.0, sign), _mm256_xor_pd(self.1, sign))
        }
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

impl Wide for Avx2 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe { Self(_mm256_set1_pd(value), _mm256_set1_pd(value)) }
    }

    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        let values = column[first..first + WIDTH].as_ptr();
        // SAFETY: AVX2 is present (module invariant); `values` points to eight values.
        unsafe { Self(_mm256_loadu_pd(values), _mm256_loadu_pd(values.add(4))) }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        let values = column[first..first + WIDTH].as_mut_ptr();
        // SAFETY: AVX2 is present (module invariant); `values` points to eight values, borrowed mutably.
        unsafe {
            _mm256_storeu_pd(values, self.0);
            _mm256_storeu_pd(values.add(4), self.1);
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe { Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe { Self(_mm256_div_pd(self.0, other.0), _mm256_div_pd(self.1, other.1)) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe { Self(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)) }
    }

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        // SAFETY: AVX2 is present (module invariant).
        unsafe {
            let zero = _mm256_setzero_pd();
            let low = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, zero);
            let high = _mm256_cmp_pd::<_CMP_GT_OQ>(self.1, zero);
            Self(_mm256_blendv_pd(no.0, yes.0, low), _mm256_blendv_pd(no.1, yes.1, high))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], indices: &[u32; WIDTH]) -> Self {
        // SAFETY: AVX2 is present (module invariant). `indices` holds two times four indices; the caller
        // guarantees that each is below the length of `column` and below 2^31, so positive as an `i32`.
        unsafe {
            let (values, indices) = (column.as_ptr(), indices.as_ptr());
            let low = _mm_loadu_si128(indices.cast());
            let high = _mm_loadu_si128(indices.add(4).cast());
            Self(_mm256_i32gather_pd::<8>(values, low), _mm256_i32gather_pd::<8>(values, high))
        }
    }

    #[inline(always)]
    fn to_node_sums(film: &Vectors<Self>, normal: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        // SAFETY: AVX2 is present (module invariant); `film` and `normal` of a sum are four values each,
        // and `rows` is borrowed mutably.
        unsafe {
            let film = [
                to_rows_of_four(film.x.0, film.y.0, film.z.0),
                to_rows_of_four(film.x.1, film.y.1, film.z.1),
            ];
            let normal = [
                to_rows_of_four(normal.x.0, normal.y.0, normal.z.0),
                to_rows_of_four(normal.x.1, normal.y.1, normal.z.1),
            ];
            for lane in 0..WIDTH {
                _mm256_storeu_pd(rows[lane].film.as_mut_ptr(), film[lane / 4][lane % 4]);
                _mm256_storeu_pd(rows[lane].normal.as_mut_ptr(), normal[lane / 4][lane % 4]);
            }
        }
        rows
    }

    #[inline(always)]
    fn from_node_sums([a, b, c, d, e, f, g, h]: &[NodeSum; WIDTH]) -> [Vectors<Self>; 2] {
        // SAFETY: AVX2 is present (module invariant).
        unsafe {
            let [x, y, z] = from_rows_of_four(&a.film, &b.film, &c.film, &d.film);
            let [u, v, w] = from_rows_of_four(&e.film, &f.film, &g.film, &h.film);
            let film = Vectors { x: Self(x, u), y: Self(y, v), z: Self(z, w) };
            let [x, y, z] = from_rows_of_four(&a.normal, &b.normal, &c.normal, &d.normal);
            let [u, v, w] = from_rows_of_four(&e.normal, &f.normal, &g.normal, &h.normal);
            [film, Vectors { x: Self(x, u), y: Self(y, v), z: Self(z, w) }]
        }
    }
}

impl Wide for Avx512 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe { Self(_mm512_set1_pd(value)) }
    }

    #[inline(always)]
    fn load(column: &[f64], first: usize) -> Self {
        // SAFETY: AVX-512 is present (module invariant); the pointer is to a slice of eight values.
        unsafe { Self(_mm512_loadu_pd(column[first..first + WIDTH].as_ptr())) }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], first: usize) {
        // SAFETY: AVX-512 is present (module invariant); the pointer is to a slice of eight values,
        // borrowed mutably.
        unsafe { _mm512_storeu_pd(column[first..first + WIDTH].as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe { Self(_mm512_sqrt_pd(self.0)) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe { Self(_mm512_div_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe { Self(_mm512_max_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        // SAFETY: AVX-512 is present (module invariant).
        unsafe {
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_setzero_pd());
            Self(_mm512_mask_blend_pd(positive, no.0, yes.0))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], indices: &[u32; WIDTH]) -> Self {
        // SAFETY: AVX-512 is present (module invariant). `indices` holds eight indices; the caller
        // guarantees that each is below the length of `column` and below 2^31, so positive as an `i32`.
        unsafe {
            let indices = _mm256_loadu_si256(indices.as_ptr().cast());
            Self(_mm512_i32gather_pd::<8>(indices, column.as_ptr()))
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
    fn from_node_sums(rows: &[NodeSum; WIDTH]) -> [Vectors<Self>; 2] {
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

#[cfg(test)]
mod tests;
