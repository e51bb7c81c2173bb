//! The length scales and the noise of a surrogate: those of the largest likelihood.
//!
//! ```text
//! ln p = −n/2 ln σ² − ½ ln |K| − Σ_j (ln ℓ_j − m)²/(2 s²)         σ² = (y − β)ᵀ K⁻¹ (y − β)/n
//! ∂ ln p/∂θ = ½ tr((α αᵀ/σ² − K⁻¹) ∂K/∂θ) − …                      θ = ln ℓ_j, ln η
//! ```
//! The last term keeps an input without effect from any length: m = √2 + ½ ln d, s = √3 of d inputs (C. Hvarfner et al.,
//! "Vanilla Bayesian optimization performs great in high dimensions", 2024). Rprop climbs by the signs of the derivatives
//! (M. Blum and M. Riedmiller, 2013), from three starts.

use nalgebra::Cholesky;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use super::{System, chosen, correlations, scaled};

/// Points that the scales are found with, at most. Chosen: more change them little and cost their cube.
const MAX_POINTS: usize = 128;
/// Steps of Rprop from each start.
const STEPS: usize = 40;
/// Starts: length of every input, and noise.
const STARTS: [[f64; 2]; 3] = [[0.3, 1e-4], [1.0, 1e-2], [2.0, 0.3]];
/// Range of a length, and of the noise over the variance.
const LENGTHS: [f64; 2] = [0.02, 100.0];
const NOISE: [f64; 2] = [1e-8, 30.0];

/// What distinguishes a surrogate beside its points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scales {
    /// ℓ of each input.
    pub lengths: Vec<f64>,
    /// η.
    pub noise: f64,
}

/// The scales of the largest likelihood. `None` where all values are alike, or fewer than three.
pub(super) fn most_likely(points: &[Vec<f64>], values: &[f64], words: &[bool]) -> Option<Scales> {
    let chosen = chosen(points.len(), MAX_POINTS);
    let points: Vec<Vec<f64>> = chosen.iter().map(|k| points[*k].clone()).collect();
    let values: Vec<f64> = chosen.iter().map(|k| values[*k]).collect();
    if values.len() < 3 || values.iter().all(|value| value.total_cmp(&values[0]).is_eq()) {
        return None;
    }
    let climbs: Vec<Option<(f64, Scales)>> =
        STARTS.par_iter().map(|start| climb(&points, &values, words, *start)).collect();
    let better =
        |best: (f64, Scales), other: (f64, Scales)| if other.0 > best.0 { other } else { best };
    let best = climbs.into_iter().flatten().reduce(better)?;
    Some(best.1)
}

/// Rprop from one start: the largest logarithm of the likelihood that it meets, with its scales.
fn climb(
    points: &[Vec<f64>],
    values: &[f64],
    words: &[bool],
    [length, noise]: [f64; 2],
) -> Option<(f64, Scales)> {
    let inputs = words.len();
    let mut place = vec![libm::log(length); inputs];
    place.push(libm::log(noise));
    let range = |k: usize| (if k < inputs { LENGTHS } else { NOISE }).map(libm::log);
    let mut steps = vec![0.3_f64; inputs + 1];
    let mut before = vec![0.0_f64; inputs + 1];
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..STEPS {
        let Some((likelihood, slopes)) = likelihood(points, values, words, &place) else { break };
        if best.as_ref().is_none_or(|(known, _)| likelihood > *known) {
            best = Some((likelihood, place.clone()));
        }
        for k in 0..=inputs {
            let turned = before[k] * slopes[k] < 0.0;
            steps[k] *= if turned { 0.5 } else { 1.2 };
            before[k] = if turned { 0.0 } else { slopes[k] };
            let [low, high] = range(k);
            let sign = if before[k] > 0.0 {
                1.0
            } else if before[k] < 0.0 {
                -1.0
            } else {
                0.0
            };
            place[k] = (place[k] + sign * steps[k].min(1.0)).clamp(low, high);
        }
    }
    let (likelihood, place) = best?;
    Some((likelihood, scales(&place)))
}

fn scales(place: &[f64]) -> Scales {
    let (noise, lengths) = place.split_last().expect("the noise is the last");
    Scales {
        lengths: lengths.iter().map(|length| libm::exp(*length)).collect(),
        noise: libm::exp(*noise),
    }
}

/// The logarithm of the likelihood and its derivatives by the logarithms of lengths and noise.
fn likelihood(
    points: &[Vec<f64>],
    values: &[f64],
    words: &[bool],
    place: &[f64],
) -> Option<(f64, Vec<f64>)> {
    let (n, inputs) = (points.len(), words.len());
    let scales = scales(place);
    let correlations = correlations(points, words, &scales.lengths, |_| scales.noise);
    let system = System::solved(Cholesky::new(correlations.clone())?, values);
    let variance = system.variance(values);
    if variance <= 0.0 {
        return None;
    }
    let determinant: f64 = (0..n).map(|i| libm::log(system.k.l_dirty()[(i, i)])).sum::<f64>() * 2.0;
    let middle = core::f64::consts::SQRT_2 + 0.5 * libm::log(inputs as f64);
    let far = |k: usize| place[k] - middle;
    let prior: f64 = (0..inputs).map(|k| far(k) * far(k) / 6.0).sum();
    let value = -0.5 * n as f64 * libm::log(variance) - 0.5 * determinant - prior;
    let inverse = system.k.inverse();
    let weights = &system.weights;
    let mut slopes = vec![0.0; inputs + 1];
    for i in 0..n {
        for j in 0..i {
            // Both triangles, each with the factor one half.
            let outer = weights[i] * weights[j] / variance - inverse[(i, j)];
            let with = outer * correlations[(i, j)];
            for (k, slope) in slopes.iter_mut().take(inputs).enumerate() {
                let (a, b) = (points[i][k], points[j][k]);
                *slope += with
                    * if words[k] {
                        if a.total_cmp(&b).is_eq() { 0.0 } else { 1.0 / scales.lengths[k] }
                    } else {
                        let s = scaled(a, b, scales.lengths[k]);
                        s * s * (1.0 + s) / (3.0 + 3.0 * s + s * s)
                    };
            }
        }
        let outer = weights[i] * weights[i] / variance - inverse[(i, i)];
        slopes[inputs] += 0.5 * outer * scales.noise;
    }
    for (k, slope) in slopes.iter_mut().take(inputs).enumerate() {
        *slope -= far(k) / 3.0;
    }
    Some((value, slopes))
}
