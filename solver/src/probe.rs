//! Work of known size, for whoever measures what a machine can do.
//!
//! ```text
//! a ← a m + c        a multiplication and an addition, never fused, as in every kernel of billow
//! ```
//!
//! As many independent chains as an instruction set has registers for, so that its units and not
//! their latency set the pace.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use crate::simd::{Lanes, Path, WIDTH, dispatch};

/// Chains of eight numbers at once: all that AVX-512, AVX2 and the baseline hold in registers.
const CHAINS: [usize; 3] = [12, 6, 3];

#[inline(always)]
fn chains<const COUNT: usize>(rounds: u64) -> f64 {
    // m < 1 and c keep every number near c/(1 − m): neither large nor denormal.
    let (m, c) = (Lanes::splat(0.999), Lanes::splat(1e-3));
    let mut a = [Lanes::default(); COUNT];
    for (k, lanes) in a.iter_mut().enumerate() {
        *lanes = Lanes::splat(1.0 + k as f64);
    }
    for _ in 0..rounds {
        for lanes in &mut a {
            *lanes = *lanes * m + c;
        }
    }
    a.iter().map(|lanes| lanes.sum()).sum()
}

#[inline(always)]
fn many_kernel(rounds: u64) -> f64 {
    chains::<{ CHAINS[0] }>(rounds)
}

#[inline(always)]
fn some_kernel(rounds: u64) -> f64 {
    chains::<{ CHAINS[1] }>(rounds)
}

#[inline(always)]
fn few_kernel(rounds: u64) -> f64 {
    chains::<{ CHAINS[2] }>(rounds)
}

dispatch! { fn many / many_kernel(rounds: u64) -> f64 }
dispatch! { fn some / some_kernel(rounds: u64) -> f64 }
dispatch! { fn few / few_kernel(rounds: u64) -> f64 }

/// Does so many rounds of multiplications and additions on a path; gives how many pairs of them, and
/// a number that depends on each, so that none is left out.
pub fn multiply_add(path: Path, rounds: u64) -> (u64, f64) {
    let pairs = |chains: usize| rounds * (chains * WIDTH) as u64;
    match path {
        Path::Avx512 => (pairs(CHAINS[0]), many(path, rounds)),
        Path::Avx2 => (pairs(CHAINS[1]), some(path, rounds)),
        Path::Scalar => (pairs(CHAINS[2]), few(path, rounds)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_counts() {
        for (path, chains) in Path::ALL.into_iter().zip([3, 6, 12]) {
            let (pairs, sum) = multiply_add(path, 2);
            assert_eq!(pairs, 2 * 8 * chains);
            let mut expected = 0.0;
            for k in 0..chains {
                let mut a = 1.0 + k as f64;
                for _ in 0..2 {
                    a = a * 0.999 + 1e-3;
                }
                expected += 8.0 * a;
            }
            assert!((sum / expected - 1.0).abs() < 1e-14, "{}: {sum} {expected}", path.name());
        }
    }
}
