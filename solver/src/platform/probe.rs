//! Floating-point throughput of the machine: a known number of multiply-add pairs.
//!
//! ```text
//! a ← a m + c        one multiplication and one addition, never fused, as in every kernel of billow
//! ```
//!
//! Each chain depends on its previous value. An instruction set runs as many independent chains as it
//! has registers for, so that the throughput of its units limits the speed, not their latency.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use crate::platform::simd::{InstructionSet, Lanes, WIDTH, dispatch};

/// Independent chains of eight values on AVX-512, AVX2 and the baseline.
/// Chosen: as many as the vector registers of each hold.
const CHAINS: [usize; 3] = [12, 6, 3];

/// Three chains, eight values each.
type Chains = [Lanes; 3];

/// Three chains with different start values.
#[inline(always)]
fn start(first: f64) -> Chains {
    [Lanes::splat(first), Lanes::splat(first + 1.0), Lanes::splat(first + 2.0)]
}

/// One multiply-add of each chain. Written without a loop over the chains, which the compiler would
/// vectorise across chains with gathers.
#[inline(always)]
fn round([a, b, c]: Chains) -> Chains {
    // Factor 0.999 and term 1e-3 keep every value near 1: no overflow, no denormals.
    let (factor, term) = (Lanes::splat(0.999), Lanes::splat(1e-3));
    [a * factor + term, b * factor + term, c * factor + term]
}

/// Stores the final values. A sum here would make the compiler vectorise across chains.
#[inline(always)]
fn store([a, b, c]: Chains, ends: &mut [f64], first: usize) {
    a.store(ends, first);
    b.store(ends, first + WIDTH);
    c.store(ends, first + 2 * WIDTH);
}

#[inline(always)]
fn twelve_chains_kernel(rounds: u64, ends: &mut [f64]) {
    let (mut a, mut b, mut c, mut d) = (start(1.0), start(4.0), start(7.0), start(10.0));
    for _ in 0..rounds {
        (a, b, c, d) = (round(a), round(b), round(c), round(d));
    }
    store(a, ends, 0);
    store(b, ends, 3 * WIDTH);
    store(c, ends, 6 * WIDTH);
    store(d, ends, 9 * WIDTH);
}

#[inline(always)]
fn six_chains_kernel(rounds: u64, ends: &mut [f64]) {
    let (mut a, mut b) = (start(1.0), start(4.0));
    for _ in 0..rounds {
        (a, b) = (round(a), round(b));
    }
    store(a, ends, 0);
    store(b, ends, 3 * WIDTH);
}

#[inline(always)]
fn three_chains_kernel(rounds: u64, ends: &mut [f64]) {
    let mut a = start(1.0);
    for _ in 0..rounds {
        a = round(a);
    }
    store(a, ends, 0);
}

dispatch! { fn twelve_chains / twelve_chains_kernel(rounds: u64, ends: &mut [f64]) }
dispatch! { fn six_chains / six_chains_kernel(rounds: u64, ends: &mut [f64]) }
dispatch! { fn three_chains / three_chains_kernel(rounds: u64, ends: &mut [f64]) }

/// Runs `rounds` rounds on an instruction set. Returns the number of multiply-add pairs done, and the
/// sum of all final values, so that the compiler cannot drop any of them.
pub fn multiply_add(instruction_set: InstructionSet, rounds: u64) -> (u64, f64) {
    let mut ends = [0.0; CHAINS[0] * WIDTH];
    let chains = match instruction_set {
        InstructionSet::Avx512 => {
            twelve_chains(instruction_set, rounds, &mut ends);
            CHAINS[0]
        }
        InstructionSet::Avx2 => {
            six_chains(instruction_set, rounds, &mut ends);
            CHAINS[1]
        }
        InstructionSet::Scalar => {
            three_chains(instruction_set, rounds, &mut ends);
            CHAINS[2]
        }
    };
    (rounds * (chains * WIDTH) as u64, ends.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_final_values_are_exact() {
        for (instruction_set, chains) in InstructionSet::ALL.into_iter().zip([3, 6, 12]) {
            let (pairs, sum) = multiply_add(instruction_set, 2);
            assert_eq!(pairs, 2 * 8 * chains);
            let mut expected = 0.0;
            for k in 0..chains {
                let mut a = 1.0 + k as f64;
                for _ in 0..2 {
                    a = a * 0.999 + 1e-3;
                }
                expected += 8.0 * a;
            }
            assert!((sum / expected - 1.0).abs() < 1e-14, "{sum} {expected}");
        }
    }
}
