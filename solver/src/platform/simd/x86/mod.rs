//! Eight numbers in the registers of AVX2 and of AVX-512.
//!
//! Plain arrays leave it to the compiler what becomes of a long kernel, and of one it makes scalars and
//! moves. Here every operation is one instruction (two on AVX2), with the bits of plain numbers. The
//! types are made and used only inside functions entered where the instruction set was detected: those
//! of `dispatch_wide!`.

#![expect(unsafe_code, reason = "an instruction is called where its set was detected")]
#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]
// SAFETY, of every block below: the types are used only under the target feature they are named for.

#[allow(clippy::wildcard_imports, reason = "forty instructions, each named once")]
use core::arch::x86_64::*;
use core::ops::{Add, Mul, Neg, Sub};

use super::{Lanes, NodeSum, Vectors, WIDTH, Wide};

mod turned;

use turned::{couple, four, fours, unfour};

/// Eight numbers in two registers.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(__m256d, __m256d);

/// Eight numbers in one register.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(__m512d);

macro_rules! operators {
    ($name:ident, $other:ident, $trait:ident, $method:ident, $two:ident, $one:ident) => {
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                unsafe { Self($two(self.0, other.0), $two(self.1, other.1)) }
            }
        }
        impl $trait for Avx512 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                unsafe { Self($one(self.0, other.0)) }
            }
        }
    };
}
operators!(Avx2, Avx512, Add, add, _mm256_add_pd, _mm512_add_pd);
operators!(Avx2, Avx512, Sub, sub, _mm256_sub_pd, _mm512_sub_pd);
operators!(Avx2, Avx512, Mul, mul, _mm256_mul_pd, _mm512_mul_pd);

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
        unsafe { Self(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))) }
    }
}

impl Wide for Avx2 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        unsafe { Self(_mm256_set1_pd(value), _mm256_set1_pd(value)) }
    }

    #[inline(always)]
    fn load(column: &[f64], at: usize) -> Self {
        let own = column[at..at + WIDTH].as_ptr();
        unsafe { Self(_mm256_loadu_pd(own), _mm256_loadu_pd(own.add(4))) }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], at: usize) {
        let own = column[at..at + WIDTH].as_mut_ptr();
        unsafe {
            _mm256_storeu_pd(own, self.0);
            _mm256_storeu_pd(own.add(4), self.1);
        }
    }

    #[inline(always)]
    fn lanes(self) -> Lanes {
        let mut lanes = [0.0; WIDTH];
        self.store(&mut lanes, 0);
        Lanes(lanes)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        unsafe { Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        unsafe { Self(_mm256_div_pd(self.0, other.0), _mm256_div_pd(self.1, other.1)) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        unsafe { Self(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)) }
    }

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        unsafe {
            let zero = _mm256_setzero_pd();
            let low = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, zero);
            let high = _mm256_cmp_pd::<_CMP_GT_OQ>(self.1, zero);
            Self(_mm256_blendv_pd(no.0, yes.0, low), _mm256_blendv_pd(no.1, yes.1, high))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], at: &[u32; WIDTH]) -> Self {
        unsafe {
            let (own, at) = (column.as_ptr(), at.as_ptr());
            let (low, high) = (_mm_loadu_si128(at.cast()), _mm_loadu_si128(at.add(4).cast()));
            Self(_mm256_i32gather_pd::<8>(own, low), _mm256_i32gather_pd::<8>(own, high))
        }
    }

    #[inline(always)]
    fn rows(first: &Vectors<Self>, second: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        unsafe {
            let film =
                [four(first.x.0, first.y.0, first.z.0), four(first.x.1, first.y.1, first.z.1)];
            let normal = [
                four(second.x.0, second.y.0, second.z.0),
                four(second.x.1, second.y.1, second.z.1),
            ];
            for lane in 0..WIDTH {
                _mm256_storeu_pd(rows[lane].film.as_mut_ptr(), film[lane / 4][lane % 4]);
                _mm256_storeu_pd(rows[lane].normal.as_mut_ptr(), normal[lane / 4][lane % 4]);
            }
        }
        rows
    }

    #[inline(always)]
    fn columns([a, b, c, d, e, f, g, h]: &[NodeSum; WIDTH]) -> [Vectors<Self>; 2] {
        unsafe {
            let [x, y, z] = unfour(&a.film, &b.film, &c.film, &d.film);
            let [u, v, w] = unfour(&e.film, &f.film, &g.film, &h.film);
            let film = Vectors { x: Self(x, u), y: Self(y, v), z: Self(z, w) };
            let [x, y, z] = unfour(&a.normal, &b.normal, &c.normal, &d.normal);
            let [u, v, w] = unfour(&e.normal, &f.normal, &g.normal, &h.normal);
            [film, Vectors { x: Self(x, u), y: Self(y, v), z: Self(z, w) }]
        }
    }
}

impl Wide for Avx512 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        unsafe { Self(_mm512_set1_pd(value)) }
    }

    #[inline(always)]
    fn load(column: &[f64], at: usize) -> Self {
        unsafe { Self(_mm512_loadu_pd(column[at..at + WIDTH].as_ptr())) }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64], at: usize) {
        unsafe { _mm512_storeu_pd(column[at..at + WIDTH].as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn lanes(self) -> Lanes {
        let mut lanes = [0.0; WIDTH];
        self.store(&mut lanes, 0);
        Lanes(lanes)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        unsafe { Self(_mm512_sqrt_pd(self.0)) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        unsafe { Self(_mm512_div_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        unsafe { Self(_mm512_max_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn if_positive(self, yes: Self, no: Self) -> Self {
        unsafe {
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_setzero_pd());
            Self(_mm512_mask_blend_pd(positive, no.0, yes.0))
        }
    }

    #[inline(always)]
    unsafe fn gather(column: &[f64], at: &[u32; WIDTH]) -> Self {
        unsafe {
            let at = _mm256_loadu_si256(at.as_ptr().cast());
            Self(_mm512_i32gather_pd::<8>(at, column.as_ptr()))
        }
    }

    #[inline(always)]
    fn rows(first: &Vectors<Self>, second: &Vectors<Self>) -> [NodeSum; WIDTH] {
        let mut rows = [NodeSum::default(); WIDTH];
        unsafe {
            let f = fours([first.x.0, first.y.0, first.z.0]);
            let g = fours([second.x.0, second.y.0, second.z.0]);
            for at in 0..WIDTH {
                let [f, g] = [f[at % 2][at / 4], g[at % 2][at / 4]];
                let row = if at % 4 < 2 {
                    _mm512_shuffle_f64x2::<0x88>(f, g)
                } else {
                    _mm512_shuffle_f64x2::<0xDD>(f, g)
                };
                _mm512_store_pd(core::ptr::from_mut(&mut rows[at]).cast(), row);
            }
        }
        rows
    }

    #[inline(always)]
    fn columns(rows: &[NodeSum; WIDTH]) -> [Vectors<Self>; 2] {
        unsafe {
            // x z, x z of the normal; y and a rest likewise: two lanes of each.
            let (first, second) = (couple(&rows[0], &rows[1]), couple(&rows[2], &rows[3]));
            let (third, fourth) = (couple(&rows[4], &rows[5]), couple(&rows[6], &rows[7]));
            let x = _mm512_shuffle_f64x2::<0x88>(first[0], second[0]);
            let y = _mm512_shuffle_f64x2::<0x88>(first[1], second[1]);
            let z = _mm512_shuffle_f64x2::<0xDD>(first[0], second[0]);
            let x_later = _mm512_shuffle_f64x2::<0x88>(third[0], fourth[0]);
            let y_later = _mm512_shuffle_f64x2::<0x88>(third[1], fourth[1]);
            let z_later = _mm512_shuffle_f64x2::<0xDD>(third[0], fourth[0]);
            [
                Vectors {
                    x: Self(_mm512_shuffle_f64x2::<0x88>(x, x_later)),
                    y: Self(_mm512_shuffle_f64x2::<0x88>(y, y_later)),
                    z: Self(_mm512_shuffle_f64x2::<0x88>(z, z_later)),
                },
                Vectors {
                    x: Self(_mm512_shuffle_f64x2::<0xDD>(x, x_later)),
                    y: Self(_mm512_shuffle_f64x2::<0xDD>(y, y_later)),
                    z: Self(_mm512_shuffle_f64x2::<0xDD>(z, z_later)),
                },
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::platform::simd::{InstructionSet, Lanes, Vectors, WIDTH, Wide, dispatch_wide};

    /// Every operation, one after the other, of eight numbers and eight others.
    #[inline(always)]
    fn kernel<L: Wide>(values: &[f64], at: &[u32; WIDTH], out: &mut Vec<u64>) {
        let (a, b) = (L::load(values, 0), L::load(values, WIDTH));
        // SAFETY: the test's places are below 16.
        let gathered = unsafe { L::gather(values, at) };
        let told = [
            a + b,
            a - b,
            a * b,
            a * 0.3,
            -a,
            a.over(b),
            a.sqrt(),
            a.max(b),
            b.max(a),
            a.if_positive(b, L::splat(7.0)),
            gathered,
        ];
        for lanes in told {
            for number in lanes.lanes().0 {
                // Which NaN it is may differ: all that follows from it is none either.
                out.push(if number.is_nan() { 1 } else { number.to_bits() });
            }
        }
        let one = Vectors { x: a.max(L::splat(0.0)), y: gathered, z: L::splat(3.0) };
        let other = Vectors { x: gathered, y: L::splat(5.0), z: a.max(L::splat(0.0)) };
        let rows = L::rows(&one, &other);
        for row in &rows {
            for number in row.film.into_iter().chain(row.normal) {
                out.push(if number.is_nan() { 1 } else { number.to_bits() });
            }
        }
        for Vectors { x, y, z } in L::columns(&rows) {
            for number in [x, y, z].into_iter().flat_map(|column| column.lanes().0) {
                out.push(if number.is_nan() { 1 } else { number.to_bits() });
            }
        }
    }
    dispatch_wide! { fn run / kernel(values: &[f64], at: &[u32; WIDTH], out: &mut Vec<u64>) }

    #[test]
    fn registers_do_what_plain_numbers_do() {
        let odd = [0.0, -0.0, f64::NAN, f64::INFINITY, -1.5, 2.5e-310, 3.7, -f64::INFINITY];
        for turn in 0..WIDTH {
            let values: Vec<f64> =
                odd.into_iter().chain((0..WIDTH).map(|lane| odd[(lane + turn) % WIDTH])).collect();
            let at = [3, 15, 0, 9, 9, 1, 12, 6];
            let mut plain = Vec::new();
            kernel::<Lanes>(&values, &at, &mut plain);
            assert_eq!(plain.len(), 25 * WIDTH);
            for path in InstructionSet::ALL {
                let mut own = Vec::new();
                run(path, &values, &at, &mut own);
                assert_eq!(own, plain, "{}", path.name());
            }
        }
    }
}
