//! The floor of the membrane pass on this machine: its arithmetic and its memory, each as fast as it goes alone.
//!
//! ```text
//! arithmetic    99 products, 108 sums, 3 quotients and a root an element, in chains that do not wait for each other
//! streaming     188 bytes read and 128 written an element, in an array of the size of the film's state
//! ```
//!
//! Counted in the compiled pass of film with loss: 194 products, 224 sums and comparisons, 6 quotients and 2 roots for
//! 16 elements (2026-11-27). Bytes: constants 40, history 72 and creep 24, corners, positions, and sums over nodes.

use std::hint::black_box;
use std::time::Instant;

use billow_solver::platform::simd::InstructionSet;

/// Repeats of a measurement, of which the least counts.
const REPEATS: u32 = 15;
/// Groups of elements in a measurement of the arithmetic.
const GROUPS: u32 = 20_000;
/// Values of an element that are read and written, 16 bytes each: (188 + 128)/16.
const VALUES: usize = 20;

/// The least time of `run`, ns.
fn least(mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        1e9 * start.elapsed().as_secs_f64()
    };
    (0..REPEATS).map(time).fold(f64::INFINITY, f64::min)
}

/// The streaming of a film of this many elements, ns an element.
pub fn streaming(elements: usize) -> f64 {
    let mut state = vec![1.0_f64; elements * VALUES];
    let pass = || black_box(&mut state).iter_mut().for_each(|value| *value *= 0.999);
    least(pass) / elements as f64
}

/// The arithmetic on this instruction set, ns an element; `None` where it is not known.
pub fn arithmetic(set: InstructionSet) -> Option<f64> {
    let lanes = match set {
        InstructionSet::Scalar => 2,
        InstructionSet::Avx2 => 4,
        InstructionSet::Avx512 => 8,
    };
    #[cfg(target_arch = "x86_64")]
    if set.available() {
        #[expect(unsafe_code, reason = "calls a function compiled for a detected instruction set")]
        // SAFETY: the instruction set is available.
        let run = || unsafe {
            match set {
                InstructionSet::Scalar => x86::scalar(),
                InstructionSet::Avx2 => x86::avx2(),
                InstructionSet::Avx512 => x86::avx512(),
            }
        };
        return Some(least(run) / f64::from(GROUPS * lanes));
    }
    let _ = lanes;
    None
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    #[allow(clippy::wildcard_imports, reason = "fifteen intrinsics, each named once")]
    use core::arch::x86_64::*;
    use std::hint::black_box;

    use super::GROUPS;

    macro_rules! chains {
        ($($name:ident $feature:literal: $set:ident $mul:ident $add:ident $div:ident $root:ident;)*) => {$(
            #[target_feature(enable = $feature)]
            pub fn $name() {
                let (one, small) = (black_box($set(1.0)), black_box($set(1e-9)));
                let (mut x, mut y) = ([one; 9], [one; 4]);
                for _ in 0..GROUPS {
                    for _ in 0..11 {
                        for value in &mut x {
                            *value = $add($mul(*value, one), small);
                        }
                    }
                    for value in &mut x {
                        *value = $add(*value, small);
                    }
                    y = [$div(one, y[0]), $div(one, y[1]), $div(one, y[2]), $root(y[3])];
                }
                black_box((x, y));
            }
        )*};
    }
    chains! {
        scalar "sse2": _mm_set1_pd _mm_mul_pd _mm_add_pd _mm_div_pd _mm_sqrt_pd;
        avx2 "avx2": _mm256_set1_pd _mm256_mul_pd _mm256_add_pd _mm256_div_pd _mm256_sqrt_pd;
        avx512 "avx512f": _mm512_set1_pd _mm512_mul_pd _mm512_add_pd _mm512_div_pd _mm512_sqrt_pd;
    }
}
