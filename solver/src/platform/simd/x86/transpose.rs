//! Transposition between columns (one component of several vectors) and rows (one vector each).
//!
//! # Safety
//! The caller of a function must run where the instruction set of its registers is present: AVX2 for
//! `__m256d`, AVX-512 F for `__m512d`.

use core::arch::x86_64::{
    __m256d, __m512d, _mm256_loadu_pd, _mm256_permute2f128_pd, _mm256_setzero_pd,
    _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm512_load_pd, _mm512_setzero_pd,
    _mm512_shuffle_f64x2, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
};

use crate::platform::simd::NodeSum;

/// The x, y and z columns of four rows; entry 3 of a row is ignored.
#[inline(always)]
pub(super) unsafe fn from_rows_of_four(
    a: &[f64; 4],
    b: &[f64; 4],
    c: &[f64; 4],
    d: &[f64; 4],
) -> [__m256d; 3] {
    // SAFETY: the caller guarantees AVX2; each load reads an array of four values.
    unsafe {
        let (a, b) = (_mm256_loadu_pd(a.as_ptr()), _mm256_loadu_pd(b.as_ptr()));
        let (c, d) = (_mm256_loadu_pd(c.as_ptr()), _mm256_loadu_pd(d.as_ptr()));
        let (xz, yw) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (xz_high, yw_high) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(xz, xz_high),
            _mm256_permute2f128_pd::<0x20>(yw, yw_high),
            _mm256_permute2f128_pd::<0x31>(xz, xz_high),
        ]
    }
}

/// Four rows (x, y, z, 0) of three columns.
#[inline(always)]
pub(super) unsafe fn to_rows_of_four(x: __m256d, y: __m256d, z: __m256d) -> [__m256d; 4] {
    // SAFETY: the caller guarantees AVX2.
    unsafe {
        let zero = _mm256_setzero_pd();
        let (even, odd) = (_mm256_unpacklo_pd(x, y), _mm256_unpackhi_pd(x, y));
        let (z_even, z_odd) = (_mm256_unpacklo_pd(z, zero), _mm256_unpackhi_pd(z, zero));
        [
            _mm256_permute2f128_pd::<0x20>(even, z_even),
            _mm256_permute2f128_pd::<0x20>(odd, z_odd),
            _mm256_permute2f128_pd::<0x31>(even, z_even),
            _mm256_permute2f128_pd::<0x31>(odd, z_odd),
        ]
    }
}

/// Two sums interleaved: their entries 0, 2, 4, 6 in the first register, 1, 3, 5, 7 in the second.
#[inline(always)]
pub(super) unsafe fn interleave_pair(a: &NodeSum, b: &NodeSum) -> [__m512d; 2] {
    // SAFETY: the caller guarantees AVX-512 F; a `NodeSum` is eight values in order, aligned to 64 bytes
    // (`repr(C, align(64))`).
    unsafe {
        let a = _mm512_load_pd(core::ptr::from_ref(a).cast());
        let b = _mm512_load_pd(core::ptr::from_ref(b).cast());
        [_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b)]
    }
}

/// Halves of eight rows, two lanes a register as (x, y of both lanes, then z, 0 of both): lanes 0 2
/// and 4 6, then lanes 1 3 and 5 7.
#[inline(always)]
pub(super) unsafe fn to_half_rows_of_eight([x, y, z]: [__m512d; 3]) -> [[__m512d; 2]; 2] {
    // SAFETY: the caller guarantees AVX-512 F.
    unsafe {
        let zero = _mm512_setzero_pd();
        let (even, odd) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
        let (z_even, z_odd) = (_mm512_unpacklo_pd(z, zero), _mm512_unpackhi_pd(z, zero));
        [
            [
                _mm512_shuffle_f64x2::<0x44>(even, z_even),
                _mm512_shuffle_f64x2::<0xEE>(even, z_even),
            ],
            [_mm512_shuffle_f64x2::<0x44>(odd, z_odd), _mm512_shuffle_f64x2::<0xEE>(odd, z_odd)],
        ]
    }
}
