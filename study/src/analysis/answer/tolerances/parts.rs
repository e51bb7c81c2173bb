//! What makes the spread of some samples: the part of each input.
//!
//! ```text
//! y' = Σ βⱼ xⱼ'           ranks of the measure and of the inputs, standardised; least squares; n samples, k inputs
//! part of input j         βⱼ r(xⱼ', y'): these sum to R² (J. W. Pratt, 1987), also where inputs are correlated; scaled to
//!                         R²_adj = 1 − (1 − R²)(n − 1)/(n − k − 1), so that noise explains nothing
//! ```
//!
//! Intervals are by the jackknife (B. Efron, 1982). Ranks see effects that rise or fall; what no sum of them explains is
//! said as such.

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;

use super::moments;
use crate::job::proportion::Z;

/// Groups of samples that the jackknife leaves out in turn, at most. Chosen: more change an end by a few per cent.
const GROUPS: usize = 64;
/// What the inputs do not make.
const UNEXPLAINED: &str = "not explained by ranks";

/// A part of a spread.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// What makes it.
    pub name: String,
    /// Its part, from 0 to 1.
    pub part: f64,
    /// The interval of the part of an input, 95 %.
    pub between: Option<[f64; 2]>,
    /// What an input makes together with others too, and its interval: its total index.
    pub total: Option<(f64, [f64; 2])>,
}

impl Part {
    pub(super) fn new(name: &str, part: f64) -> Self {
        Self { name: name.to_owned(), part, between: None, total: None }
    }
}

pub(super) fn largest_first(mut parts: Vec<Part>) -> Vec<Part> {
    parts.sort_by(|a, b| b.part.total_cmp(&a.part));
    parts
}

/// The part of each input in the spread of the samples by ranks, and the rest: `values` of a measure, one for each of
/// the numbers of an input. `None` where the ranks do not separate them.
pub(super) fn of_ranks(inputs: &[(String, Vec<f64>)], values: &[f64]) -> Option<Vec<Part>> {
    let columns: Vec<Vec<f64>> = inputs.iter().map(|(_, numbers)| numbers.clone()).collect();
    let all: Vec<usize> = (0..values.len()).collect();
    let parts = pratt(&columns, values, &all)?;
    let groups = values.len().min(GROUPS);
    let without = |group: usize| {
        let kept: Vec<usize> = all.iter().copied().filter(|i| i % groups != group).collect();
        pratt(&columns, values, &kept)
    };
    let jackknife: Option<Vec<Vec<f64>>> = (0..groups).map(without).collect();
    let of_input = |(index, (name, _)): (usize, &(String, Vec<f64>))| {
        let between = jackknife.as_ref().map(|jackknife| {
            let of: Vec<f64> = jackknife.iter().map(|parts| parts[index]).collect();
            let g = groups as f64;
            let half = Z * libm::sqrt(moments(&of).1 / g) * (g - 1.0);
            [parts[index] - half, parts[index] + half].map(|end| end.clamp(0.0, 1.0))
        });
        Part { between, ..Part::new(name, parts[index]) }
    };
    let mut found: Vec<Part> = inputs.iter().enumerate().map(of_input).collect();
    found.push(Part::new(UNEXPLAINED, (1.0 - parts.iter().sum::<f64>()).max(0.0)));
    Some(found)
}

/// Standardised ranks of the values at these places, equal values with their mean rank; `None` where all are equal.
fn standardised_ranks(values: &[f64], places: &[usize]) -> Option<Vec<f64>> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| values[places[*a]].total_cmp(&values[places[*b]]));
    let mut ranks = vec![0.0; places.len()];
    let mut from = 0;
    for chunk in order.chunk_by(|a, b| values[places[*a]].total_cmp(&values[places[*b]]).is_eq()) {
        let mean = from as f64 + 0.5 * (chunk.len() - 1) as f64;
        for place in chunk {
            ranks[*place] = mean;
        }
        from += chunk.len();
    }
    let (mean, variance) = moments(&ranks);
    let deviation = libm::sqrt(variance);
    (deviation > 0.0).then(|| ranks.iter().map(|rank| (rank - mean) / deviation).collect())
}

/// The part of each input in the spread of the ranks of some values, at these places; not below 0, and together not more
/// than the ranks explain.
pub(super) fn pratt(inputs: &[Vec<f64>], values: &[f64], places: &[usize]) -> Option<Vec<f64>> {
    let (n, k) = (places.len(), inputs.len());
    let y = DVector::from_vec(standardised_ranks(values, places)?);
    let ranks: Option<Vec<Vec<f64>>> =
        inputs.iter().map(|input| standardised_ranks(input, places)).collect();
    let x = DMatrix::from_vec(n, k, ranks?.concat());
    let correlation = x.transpose() * &y / (n as f64 - 1.0);
    let matrix = x.transpose() * &x / (n as f64 - 1.0);
    let beta = Cholesky::new(matrix)?.solve(&correlation);
    let parts: Vec<f64> = beta.iter().zip(correlation.iter()).map(|(b, r)| b * r).collect();
    let explained: f64 = parts.iter().sum();
    let adjusted = 1.0 - (1.0 - explained) * (n as f64 - 1.0) / (n as f64 - k as f64 - 1.0);
    let positive: f64 = parts.iter().map(|part| part.max(0.0)).sum();
    let scale = if positive > 0.0 { adjusted.max(0.0) / positive } else { 0.0 };
    Some(parts.iter().map(|part| scale * part.max(0.0)).collect())
}
