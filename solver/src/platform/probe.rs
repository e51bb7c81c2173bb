//! Work of known size, for whoever measures what a machine can do.
//!
//! ```text
//! a ← a m + c        a multiplication and an addition, never fused, as in every kernel of billow
//! ```
//!
//! As many independent chains as an instruction set has registers for, so that its units and not
//! their latency set the pace.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use crate::platform::simd::{InstructionSet, Lanes, WIDTH, dispatch};

/// Chains of eight numbers at once: all that AVX-512, AVX2 and the baseline hold in registers.
const CHAINS: [usize; 3] = [12, 6, 3];

/// Three chains.
type Chains = [Lanes; 3];

/// Chains that start at different numbers.
#[inline(always)]
fn started(first: f64) -> Chains {
    [Lanes::splat(first), Lanes::splat(first + 1.0), Lanes::splat(first + 2.0)]
}

/// A round. No loop over chains: the compiler would rather gather across them.
#[inline(always)]
fn round([a, b, c]: Chains) -> Chains {
    // The factor below 1 and the term keep every number near 1: neither large nor denormal.
    let (factor, term) = (Lanes::splat(0.999), Lanes::splat(1e-3));
    [a * factor + term, b * factor + term, c * factor + term]
}

/// Where they end. Summed here instead, they would be kept apart by lane and not by chain.
#[inline(always)]
fn store([a, b, c]: Chains, ends: &mut [f64], at: usize) {
    a.store(ends, at);
    b.store(ends, at + WIDTH);
    c.store(ends, at + 2 * WIDTH);
}

#[inline(always)]
fn many_kernel(rounds: u64, ends: &mut [f64]) {
    let (mut a, mut b, mut c, mut d) = (started(1.0), started(4.0), started(7.0), started(10.0));
    for _ in 0..rounds {
        (a, b, c, d) = (round(a), round(b), round(c), round(d));
    }
    store(a, ends, 0);
    store(b, ends, 3 * WIDTH);
    store(c, ends, 6 * WIDTH);
    store(d, ends, 9 * WIDTH);
}

#[inline(always)]
fn some_kernel(rounds: u64, ends: &mut [f64]) {
    let (mut a, mut b) = (started(1.0), started(4.0));
    for _ in 0..rounds {
        (a, b) = (round(a), round(b));
    }
    store(a, ends, 0);
    store(b, ends, 3 * WIDTH);
}

#[inline(always)]
fn few_kernel(rounds: u64, ends: &mut [f64]) {
    let mut a = started(1.0);
    for _ in 0..rounds {
        a = round(a);
    }
    store(a, ends, 0);
}

dispatch! { fn many / many_kernel(rounds: u64, ends: &mut [f64]) }
dispatch! { fn some / some_kernel(rounds: u64, ends: &mut [f64]) }
dispatch! { fn few / few_kernel(rounds: u64, ends: &mut [f64]) }

/// Does so many rounds of multiplications and additions on a path; gives how many pairs of them, and
/// the sum of where the chains end, so that none is left out.
pub fn multiply_add(path: InstructionSet, rounds: u64) -> (u64, f64) {
    let mut ends = [0.0; CHAINS[0] * WIDTH];
    let chains = match path {
        InstructionSet::Avx512 => {
            many(path, rounds, &mut ends);
            CHAINS[0]
        }
        InstructionSet::Avx2 => {
            some(path, rounds, &mut ends);
            CHAINS[1]
        }
        InstructionSet::Scalar => {
            few(path, rounds, &mut ends);
            CHAINS[2]
        }
    };
    (rounds * (chains * WIDTH) as u64, ends.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_counts() {
        for (path, chains) in InstructionSet::ALL.into_iter().zip([3, 6, 12]) {
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
