//! Sensitivity indices of a surrogate: which part of the variance of a measure each input makes, alone and with others
//! (I. M. Sobol', 1993; T. Homma and A. Saltelli, 1996).
//!
//! ```text
//! first order   S_i = Var(E[f | x_i])/V              total   T_i = 1 − Var(E[f | all but x_i])/V
//! V             = Var f + chance²
//! ```
//! R is a product, so these are sums over pairs of points, of integrals over one input each:
//!
//! ```text
//! c_i = ∫ r_i(x, a) dx,   C_i = ∫ r_i(x, a) r_i(x, b) dx        over the values that the input has
//! Var(E[f | inputs of U]) = αᵀ (Π_{i in U} C_i ∘ Π_{i not in U} c_i c_iᵀ) α − (Π c_i · α)²
//! ```
//!
//! Their intervals are those of [`DRAWS`] functions that the surrogate holds for possible (L. Le Gratiet, C. Cannamela and
//! B. Iooss, 2014): each is drawn at [`SUPPORT`] further points, and its indices are exact. They are wider on each side by
//! half of the variance that neither the surrogate sees nor chance makes: its form may be wrong.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::{Surrogate, correlation, correlations, normal};
use billow_solver::platform::random::{hash, unit};

/// Functions drawn.
const DRAWS: usize = 64;
/// Points at which each is drawn. Chosen: twice as many change the intervals by a tenth.
const SUPPORT: usize = 128;
/// Values over which an input is integrated, at most.
const MAX_VALUES: usize = 64;
/// The middle 95 % of the draws lie between these, counted from either end.
const TAIL: f64 = 0.025;

/// The part of the variance of a measure that an input makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Index {
    /// Alone: its first-order index, and its interval.
    pub first: (f64, [f64; 2]),
    /// Alone and together with others: its total index, and its interval.
    pub total: (f64, [f64; 2]),
}

/// The indices of all inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Indices {
    /// One for each input.
    pub inputs: Vec<Index>,
    /// The part of chance, and of what the surrogate does not see.
    pub chance: f64,
}

impl Surrogate {
    /// The indices of its inputs, each of which takes any of its values independently of the others: one of `values` for
    /// each input, repeated where it is more frequent. `None` where the equations are singular.
    pub fn indices(&self, values: &[Vec<f64>]) -> Option<Indices> {
        let values: Vec<Vec<f64>> = values.iter().map(|all| thinned(all)).collect();
        let n = self.points.len();
        let support = (0..SUPPORT as u64).map(|k| {
            let pick = |(j, all): (usize, &Vec<f64>)| {
                let part = unit(hash(k, j as u64 + 1));
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "0 to n"
                )]
                let position = (part * all.len() as f64) as usize;
                all[position.min(all.len() - 1)]
            };
            values.iter().enumerate().map(pick).collect::<Vec<f64>>()
        });
        let points: Vec<Vec<f64>> = self.points.iter().cloned().chain(support).collect();
        let all = points.len();
        // A drawn value has no chance; a trifle keeps the equations regular.
        let noise = |i: usize| if i < n { self.scales.noise } else { 1e-6 };
        let k = Cholesky::new(correlations(&points, &self.words, &self.scales.lengths, noise))?;
        let moments = Moments::of(self, &points, &values);
        let mut start = DVector::from_column_slice(&self.values).add_scalar(-self.system.mean);
        k.l_dirty().view((0, 0), (n, n)).solve_lower_triangular_mut(&mut start);
        let draw = |draw: usize| {
            let mut right = DVector::zeros(all);
            right.rows_mut(0, n).copy_from(&start);
            let deviation = libm::sqrt(self.variance);
            for i in n..all {
                right[i] = deviation * normal(draw as u64 + 1, i as u64);
            }
            k.l_dirty().tr_solve_lower_triangular_mut(&mut right);
            moments.indices(&right, self.chance())
        };
        let mut weights = DVector::zeros(all);
        weights.rows_mut(0, n).copy_from(&self.system.weights);
        let (best, chance) = moments.indices(&weights, self.chance())?;
        let draws: Vec<Vec<[f64; 2]>> = (0..DRAWS).filter_map(|k| Some(draw(k)?.0)).collect();
        let unseen = 0.5 * (1.0 - chance - self.foresees()).max(0.0);
        let index = |input: usize| {
            let of = |which: usize| {
                let value = best[input][which];
                let drawn = draws.iter().map(|draw| draw[input][which]);
                let [low, high] = interval(drawn.collect(), value);
                (value, [low - unseen, high + unseen].map(|end| end.clamp(0.0, 1.0)))
            };
            Index { first: of(0), total: of(1) }
        };
        Some(Indices { inputs: (0..values.len()).map(index).collect(), chance })
    }
}

/// The integrals over each input.
struct Moments {
    /// `c_i` at each point.
    single: Vec<DVector<f64>>,
    /// `C_i` at each pair of points.
    pairs: Vec<DMatrix<f64>>,
}

impl Moments {
    fn of(surrogate: &Surrogate, points: &[Vec<f64>], values: &[Vec<f64>]) -> Self {
        let n = points.len();
        let (mut single, mut pairs) = (Vec::new(), Vec::new());
        for (input, values) in values.iter().enumerate() {
            let (words, lengths) =
                (&surrogate.words[input..=input], &surrogate.scales.lengths[input..=input]);
            let r = DMatrix::from_fn(values.len(), n, |v, i| {
                correlation(&values[v..=v], &points[i][input..=input], words, lengths)
            });
            let over = 1.0 / values.len() as f64;
            single.push(DVector::from_fn(n, |i, _| r.column(i).sum() * over));
            let mut of_input = DMatrix::zeros(n, n);
            for i in 0..n {
                for j in 0..=i {
                    of_input[(i, j)] = r.column(i).dot(&r.column(j)) * over;
                    of_input[(j, i)] = of_input[(i, j)];
                }
            }
            pairs.push(of_input);
        }
        Self { single, pairs }
    }

    /// First-order and total index of each input for a function with these weights, and the part of chance. `None` for a
    /// function without variance.
    fn indices(&self, weights: &DVector<f64>, chance: f64) -> Option<(Vec<[f64; 2]>, f64)> {
        let (n, inputs) = (weights.len(), self.single.len());
        let mean: f64 =
            (0..n).map(|i| weights[i] * self.single.iter().map(|c| c[i]).product::<f64>()).sum();
        // Sums over pairs: of all inputs, of one alone, of all but one.
        let (mut of_all, mut alone, mut others) = (0.0, vec![0.0; inputs], vec![0.0; inputs]);
        let (mut up, mut down) = (vec![1.0; inputs + 1], vec![1.0; inputs + 1]);
        let (mut up_single, mut down_single) = (up.clone(), up.clone());
        for i in 0..n {
            for j in 0..=i {
                let with = weights[i] * weights[j] * if i == j { 1.0 } else { 2.0 };
                for k in 0..inputs {
                    let c = self.single[k][i] * self.single[k][j];
                    up[k + 1] = up[k] * self.pairs[k][(i, j)];
                    up_single[k + 1] = up_single[k] * c;
                    let back = inputs - 1 - k;
                    let c = self.single[back][i] * self.single[back][j];
                    down[k + 1] = down[k] * self.pairs[back][(i, j)];
                    down_single[k + 1] = down_single[k] * c;
                }
                of_all += with * up[inputs];
                for k in 0..inputs {
                    let after = inputs - 1 - k;
                    alone[k] += with * up_single[k] * self.pairs[k][(i, j)] * down_single[after];
                    let c = self.single[k][i] * self.single[k][j];
                    others[k] += with * up[k] * c * down[after];
                }
            }
        }
        let variance = of_all - mean * mean;
        let whole = variance + chance * chance;
        if variance <= 0.0 || whole <= 0.0 {
            return None;
        }
        let of = |k: usize| {
            [(alone[k] - mean * mean) / whole, (of_all - others[k]) / whole]
                .map(|index| index.clamp(0.0, 1.0))
        };
        Some(((0..inputs).map(of).collect(), chance * chance / whole))
    }
}

/// The middle 95 % of some draws, with the value itself.
fn interval(mut drawn: Vec<f64>, value: f64) -> [f64; 2] {
    drawn.sort_by(f64::total_cmp);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of the draws"
    )]
    let cut = (TAIL * drawn.len() as f64) as usize;
    let end = |place: Option<&f64>| place.copied().unwrap_or(value);
    let low = end(drawn.get(cut)).min(value);
    [low, end(drawn.len().checked_sub(cut + 1).and_then(|place| drawn.get(place))).max(value)]
}

/// At most [`MAX_VALUES`] of some values, evenly among them.
fn thinned(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len().min(MAX_VALUES);
    (0..count).map(|k| sorted[(2 * k + 1) * sorted.len() / (2 * count)]).collect()
}
