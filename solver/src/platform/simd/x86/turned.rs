//! Columns turned into rows and back, four and eight at a time.

// SAFETY, of every function and block below: called by `super` alone, under the instruction set its
// registers are named for; `couple` reads `NodeSum` in the order it is laid out in (`repr(C)`), aligned.

use core::arch::x86_64::{
    __m256d, __m512d, _mm256_loadu_pd, _mm256_permute2f128_pd, _mm256_setzero_pd,
    _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm512_load_pd, _mm512_setzero_pd,
    _mm512_shuffle_f64x2, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
};

use crate::platform::simd::NodeSum;

/// Of four vectors one by one, their columns.
#[inline(always)]
pub(super) unsafe fn unfour(
    a: &[f64; 4],
    b: &[f64; 4],
    c: &[f64; 4],
    d: &[f64; 4],
) -> [__m256d; 3] {
    unsafe {
        let (a, b) = (_mm256_loadu_pd(a.as_ptr()), _mm256_loadu_pd(b.as_ptr()));
        let (c, d) = (_mm256_loadu_pd(c.as_ptr()), _mm256_loadu_pd(d.as_ptr()));
        let (xz, yw) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (xz_later, yw_later) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(xz, xz_later),
            _mm256_permute2f128_pd::<0x20>(yw, yw_later),
            _mm256_permute2f128_pd::<0x31>(xz, xz_later),
        ]
    }
}

/// Four vectors one by one.
#[inline(always)]
pub(super) unsafe fn four(x: __m256d, y: __m256d, z: __m256d) -> [__m256d; 4] {
    unsafe {
        let zero = _mm256_setzero_pd();
        let (even, odd) = (_mm256_unpacklo_pd(x, y), _mm256_unpackhi_pd(x, y));
        let (last_even, last_odd) = (_mm256_unpacklo_pd(z, zero), _mm256_unpackhi_pd(z, zero));
        [
            _mm256_permute2f128_pd::<0x20>(even, last_even),
            _mm256_permute2f128_pd::<0x20>(odd, last_odd),
            _mm256_permute2f128_pd::<0x31>(even, last_even),
            _mm256_permute2f128_pd::<0x31>(odd, last_odd),
        ]
    }
}

/// Of two sums, numbers of even places beside each other, and those of odd ones.
#[inline(always)]
pub(super) unsafe fn couple(one: &NodeSum, other: &NodeSum) -> [__m512d; 2] {
    unsafe {
        let one = _mm512_load_pd(core::ptr::from_ref(one).cast());
        let other = _mm512_load_pd(core::ptr::from_ref(other).cast());
        [_mm512_unpacklo_pd(one, other), _mm512_unpackhi_pd(one, other)]
    }
}

/// Eight vectors, x and y beside z and nought: of the even lanes 0 2 and 4 6, of the odd 1 3 and 5 7.
#[inline(always)]
pub(super) unsafe fn fours([x, y, z]: [__m512d; 3]) -> [[__m512d; 2]; 2] {
    unsafe {
        let zero = _mm512_setzero_pd();
        let (even, odd) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
        let (last_even, last_odd) = (_mm512_unpacklo_pd(z, zero), _mm512_unpackhi_pd(z, zero));
        [
            [
                _mm512_shuffle_f64x2::<0x44>(even, last_even),
                _mm512_shuffle_f64x2::<0xEE>(even, last_even),
            ],
            [
                _mm512_shuffle_f64x2::<0x44>(odd, last_odd),
                _mm512_shuffle_f64x2::<0xEE>(odd, last_odd),
            ],
        ]
    }
}
