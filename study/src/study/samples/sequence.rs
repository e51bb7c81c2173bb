//! Points of the unit cube, one for each sample, one coordinate for each input.
//!
//! ```text
//! sobol             Owen-scrambled Sobol sequence (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020): more
//!                   samples extend it
//! latin_hypercube   u_ij = (π_j(i) + r_ij)/n, π_j a permutation of 0 … n − 1: one sample in each of n strata of each input
//! correlated        u' = Φ(L Φ⁻¹(u)),  L Lᵀ = C,  C_jk = 2 sin(π ρ_jk/6) for the rank correlation ρ (Gaussian copula)
//! ```

use billow_solver::platform::random::{hash, unit};
use nalgebra::{Cholesky, DMatrix, DVector};

use crate::surrogate::normal;

/// Samples that the Sobol sequence has.
pub(super) const MAX_SOBOL: usize = 1 << 16;
/// Inputs that it has.
pub(super) const MAX_INPUTS: usize = 256;

/// How samples are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Sobol,
    LatinHypercube,
}

/// The points: inputs of each sample, strictly between 0 and 1.
pub(super) fn points(method: Method, seed: u32, number: usize, inputs: usize) -> Vec<Vec<f64>> {
    match method {
        Method::Sobol => {
            // Within the first of the steps of the sequence, 2⁻²³, so that no coordinate is 0.
            let half = 0.5 * f64::from(f32::EPSILON) / 2.0;
            let coordinate = |sample: u32, input: u32| {
                f64::from(sobol_burley::sample(sample, input, seed)) + half
            };
            let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
            let sample =
                |sample| (0..count(inputs)).map(|input| coordinate(sample, input)).collect();
            (0..count(number)).map(sample).collect()
        }
        Method::LatinHypercube => {
            let columns: Vec<Vec<f64>> = (0..inputs as u64)
                .map(|input| stratified(hash(seed.into(), input + 1), number))
                .collect();
            (0..number)
                .map(|sample| columns.iter().map(|column| column[sample]).collect())
                .collect()
        }
    }
}

/// One number in each of as many equal parts of 0 to 1, in any order.
fn stratified(seed: u64, number: usize) -> Vec<f64> {
    let mut strata: Vec<usize> = (0..number).collect();
    for last in (1..number).rev() {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below last + 1"
        )]
        let other = (unit(hash(seed, last as u64)) * (last + 1) as f64) as usize;
        strata.swap(last, other);
    }
    let within = |sample: usize| unit(hash(!seed, sample as u64)).max(f64::EPSILON);
    let place =
        |(sample, stratum): (usize, &usize)| (*stratum as f64 + within(sample)) / number as f64;
    strata.iter().enumerate().map(place).collect()
}

/// Makes inputs depend on each other: `correlations` are pairs of inputs with their rank correlation. `None` where no
/// inputs are related so.
pub(super) fn correlate(
    points: &mut [Vec<f64>],
    correlations: &[(usize, usize, f64)],
) -> Option<()> {
    let inputs = points.first().map_or(0, Vec::len);
    if correlations.is_empty() {
        return Some(());
    }
    let mut matrix = DMatrix::<f64>::identity(inputs, inputs);
    for (a, b, rank) in correlations {
        let linear = 2.0 * libm::sin(core::f64::consts::PI * rank / 6.0);
        matrix[(*a, *b)] = linear;
        matrix[(*b, *a)] = linear;
    }
    let lower = Cholesky::new(matrix)?.l();
    for point in points {
        let normal = DVector::from_iterator(inputs, point.iter().map(|p| normal::quantile(*p)));
        let normal = &lower * normal;
        for (p, x) in point.iter_mut().zip(normal.iter()) {
            *p = normal::part_below(*x).clamp(f64::EPSILON, 1.0 - f64::EPSILON);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stratum_of_each_input_has_one_sample() {
        for (method, number) in [(Method::Sobol, 64), (Method::LatinHypercube, 50)] {
            let points = points(method, 7, number, 5);
            for input in 0..5 {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "0 to n"
                )]
                let mut strata: Vec<usize> =
                    points.iter().map(|point| (point[input] * number as f64) as usize).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..number).collect::<Vec<_>>(), "{method:?} {input}");
            }
            assert!(points.iter().flatten().all(|p| 0.0 < *p && *p < 1.0));
        }
    }

    #[test]
    fn more_samples_extend_the_sequence_and_another_seed_has_others() {
        let of = |seed, number| points(Method::Sobol, seed, number, 3);
        assert_eq!(of(1, 100)[..64], of(1, 64)[..]);
        assert_ne!(of(1, 8), of(2, 8));
        assert_eq!(of(1, 8)[3], of(1, 8)[3]);
    }

    /// Correlation of the ranks of two inputs.
    fn rank_correlation(points: &[Vec<f64>]) -> f64 {
        let rank = |input: usize| -> Vec<f64> {
            let below =
                |point: &Vec<f64>| points.iter().filter(|o| o[input] < point[input]).count();
            points.iter().map(|point| below(point) as f64).collect()
        };
        let (a, b) = (rank(0), rank(1));
        let n = points.len() as f64;
        let mean = 0.5 * (n - 1.0);
        let sum: f64 = a.iter().zip(&b).map(|(a, b)| (a - mean) * (b - mean)).sum();
        sum / (n * (n * n - 1.0) / 12.0)
    }

    #[test]
    fn inputs_are_correlated_as_asked() {
        let mut points = points(Method::Sobol, 1, 1024, 2);
        assert!(rank_correlation(&points).abs() < 0.02);
        correlate(&mut points, &[(0, 1, -0.7)]).unwrap();
        assert!((rank_correlation(&points) + 0.7).abs() < 0.02, "{}", rank_correlation(&points));
        let impossible = [(0, 1, 0.9), (0, 2, 0.9), (1, 2, -0.9)];
        let mut three = vec![vec![0.2, 0.5, 0.7]];
        assert_eq!(correlate(&mut three, &impossible), None);
    }
}
