//! A surrogate: Gaussian process regression of one measure over a few inputs (C. E. Rasmussen and C. K. I. Williams,
//! "Gaussian Processes for Machine Learning", 2006).
//!
//! ```text
//! y(x) = β + f(x) + e            f ~ GP(0, σ² R),  e ~ N(0, σ² η): chance, and what the surrogate does not see
//! R(x, x')   = Π_j r_j           number: (1 + s + s²/3) e^(−s), s = √5 |x_j − x'_j|/ℓ_j (Matérn 5/2);
//!                                word:   1 if equal, else e^(−1/ℓ_j)
//! mean(x)    = β + rᵀ α          α = K⁻¹ (y − β 1),  K = R + η 1,  β = 1ᵀK⁻¹y / 1ᵀK⁻¹1
//! variance   = σ² (1 − rᵀK⁻¹r + (1 − 1ᵀK⁻¹r)² / 1ᵀK⁻¹1)
//! leave one out:  y_i − mean₋ᵢ(x_i) = α_i/Q_ii,  Q = K⁻¹ − K⁻¹1 1ᵀK⁻¹/1ᵀK⁻¹1      (O. Dubrule, 1983)
//! ```
//!
//! Inputs are coordinates from 0 to 1 ([`Coordinate`]). ℓ and η maximise the likelihood (`fit.rs`); `indices.rs` has the
//! sensitivity indices. All of it is in fixed order and with `libm`: jobs that a search plans must not depend on a machine.

use billow_solver::platform::random::{hash, unit};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

mod coordinate;
mod fit;
mod indices;
pub mod normal;

pub use coordinate::Coordinate;
pub use indices::{Index, Indices};

use fit::Scales;

/// Most points that a surrogate uses. Chosen: its equations then take a tenth of a second.
const MAX_POINTS: usize = 400;

/// A surrogate of one measure.
#[derive(Debug, Clone)]
pub struct Surrogate {
    points: Vec<Vec<f64>>,
    values: Vec<f64>,
    /// Whether each input is a word.
    words: Vec<bool>,
    scales: Scales,
    system: System,
    /// σ², in the unit of the values squared.
    variance: f64,
}

/// The equations of the values: what is solved with K.
#[derive(Debug, Clone)]
struct System {
    k: Cholesky<f64, Dyn>,
    /// β.
    mean: f64,
    /// α.
    weights: DVector<f64>,
    /// K⁻¹ 1.
    ones: DVector<f64>,
}

impl Surrogate {
    /// The surrogate of these values, one at each point; `words` says which inputs are words. Of more than
    /// 400 a part is used. `None` where all values are alike, or fewer than three.
    pub fn fit(points: &[Vec<f64>], values: &[f64], words: &[bool]) -> Option<Self> {
        let chosen = chosen(points.len(), MAX_POINTS);
        let points: Vec<Vec<f64>> = chosen.iter().map(|k| points[*k].clone()).collect();
        let values: Vec<f64> = chosen.iter().map(|k| values[*k]).collect();
        let scales = fit::most_likely(&points, &values, words)?;
        Self::with(points, values, words.to_vec(), scales)
    }

    fn with(
        points: Vec<Vec<f64>>,
        values: Vec<f64>,
        words: Vec<bool>,
        scales: Scales,
    ) -> Option<Self> {
        let system = System::of(&points, &values, &words, &scales)?;
        let variance = system.variance(&values);
        (variance > 0.0).then_some(Self { points, values, words, scales, system, variance })
    }

    /// The same surrogate, which takes its mean at a point as known there: what a batch of points is chosen with.
    pub fn believing(&self, point: &[f64]) -> Option<Self> {
        let (mean, _) = self.at(point);
        let mut points = self.points.clone();
        points.push(point.to_vec());
        let mut values = self.values.clone();
        values.push(mean);
        let system = System::of(&points, &values, &self.words, &self.scales)?;
        Some(Self { points, values, system, ..self.clone() })
    }

    /// Mean and standard deviation of the measure at a point, without chance.
    pub fn at(&self, point: &[f64]) -> (f64, f64) {
        let System { k, mean, weights, ones } = &self.system;
        let r = self.correlations(point);
        let value = mean + r.dot(weights);
        let mut solved = r.clone();
        k.l_dirty().solve_lower_triangular_mut(&mut solved);
        let rest = 1.0 - r.dot(ones);
        let variance = 1.0 - solved.norm_squared() + rest * rest / ones.sum();
        (value, libm::sqrt(self.variance * variance.max(0.0)))
    }

    fn correlations(&self, point: &[f64]) -> DVector<f64> {
        let of = |known: &Vec<f64>| correlation(known, point, &self.words, &self.scales.lengths);
        DVector::from_iterator(self.points.len(), self.points.iter().map(of))
    }

    /// Standard deviation of chance, and of what the surrogate does not see.
    pub fn chance(&self) -> f64 {
        libm::sqrt(self.variance * self.scales.noise)
    }

    /// How well it foresees points that it does not know: the part of the variance of its values that it foresees where each
    /// is left out in turn; 1 for all, 0 or less for none.
    pub fn foresees(&self) -> f64 {
        let n = self.values.len() as f64;
        let mean = self.values.iter().sum::<f64>() / n;
        // That of the mean of the others.
        let others = n / (n - 1.0);
        let square = |value: &f64| (value - mean) * others * ((value - mean) * others);
        1.0 - self.error_left_out() * n / self.values.iter().map(square).sum::<f64>()
    }

    /// Mean square of the errors where each of its values is left out in turn.
    pub fn error_left_out(&self) -> f64 {
        let System { k, weights, ones, .. } = &self.system;
        let inverse = k.inverse();
        let square = |i: usize| {
            let error = weights[i] / (inverse[(i, i)] - ones[i] * ones[i] / ones.sum());
            error * error
        };
        (0..self.values.len()).map(square).sum::<f64>() / self.values.len() as f64
    }
}

impl System {
    /// `None` where two points are one to K.
    fn of(points: &[Vec<f64>], values: &[f64], words: &[bool], scales: &Scales) -> Option<Self> {
        let k = correlations(points, words, &scales.lengths, |_| scales.noise);
        Some(Self::solved(Cholesky::new(k)?, values))
    }

    fn solved(k: Cholesky<f64, Dyn>, values: &[f64]) -> Self {
        let ones = k.solve(&DVector::repeat(values.len(), 1.0));
        let values = DVector::from_column_slice(values);
        let mean = ones.dot(&values) / ones.sum();
        let weights = k.solve(&values.add_scalar(-mean));
        Self { k, mean, weights, ones }
    }

    /// σ²: (y − β)ᵀ K⁻¹ (y − β)/n.
    fn variance(&self, values: &[f64]) -> f64 {
        let pairs = values.iter().zip(self.weights.iter());
        pairs.map(|(value, weight)| (value - self.mean) * weight).sum::<f64>() / values.len() as f64
    }
}

/// R of two points.
fn correlation(a: &[f64], b: &[f64], words: &[bool], lengths: &[f64]) -> f64 {
    let (mut product, mut sum) = (1.0, 0.0);
    for j in 0..a.len() {
        if words[j] {
            sum += if a[j].total_cmp(&b[j]).is_eq() { 0.0 } else { 1.0 / lengths[j] };
        } else {
            let s = scaled(a[j], b[j], lengths[j]);
            product *= 1.0 + s + s * s / 3.0;
            sum += s;
        }
    }
    product * libm::exp(-sum)
}

/// K of some points; `noise` is that of each.
fn correlations(
    points: &[Vec<f64>],
    words: &[bool],
    lengths: &[f64],
    noise: impl Fn(usize) -> f64,
) -> DMatrix<f64> {
    let mut k = DMatrix::zeros(points.len(), points.len());
    for i in 0..points.len() {
        for j in 0..i {
            k[(i, j)] = correlation(&points[i], &points[j], words, lengths);
            k[(j, i)] = k[(i, j)];
        }
        k[(i, i)] = 1.0 + noise(i);
    }
    k
}

/// s of two numbers.
fn scaled(a: f64, b: f64, length: f64) -> f64 {
    const ROOT_OF_5: f64 = 2.236_067_977_499_79;
    ROOT_OF_5 * (a - b).abs() / length
}

/// At most `most` of some positions, in order: by a hash, as every second or third of the points of a grid may have one
/// value of an axis.
pub fn chosen(all: usize, most: usize) -> Vec<usize> {
    let mut positions: Vec<usize> = (0..all).collect();
    if all > most {
        positions.sort_by_key(|position| hash(17, *position as u64));
        positions.truncate(most);
        positions.sort_unstable();
    }
    positions
}

/// A number of the standard normal distribution.
fn normal(seed: u64, index: u64) -> f64 {
    normal::quantile(unit(hash(seed, index)).clamp(f64::EPSILON, 1.0 - f64::EPSILON))
}

#[cfg(test)]
mod tests;
