//! Which points a search runs next.
//!
//! ```text
//! one measure    where a(x) of `expected.rs` is largest
//! two measures   y = max_k w_k y_k + 0.05 Σ_k w_k y_k, y_k from 0 to 1, other weights w for each point of a batch: ParEGO
//!                (J. Knowles, 2006)
//! a batch        each point is taken as known, at its mean, before the next is chosen (D. Ginsbourger et al., 2010)
//! ```
//! A run that failed, or has no fold pattern, keeps no limit, and counts as the worst of the others.

use billow_solver::platform::random::{hash, unit};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use super::expected::{Expected, Surrogates};
use super::{Optimise, Trial, sobol};
use crate::input::value::Value;
use crate::surrogate::{Coordinate, Surrogate, normal};

/// Points at which a(x) is computed: of the Sobol' sequence, and near the best points.
const SPREAD_CANDIDATES: usize = 400;
const NEAR_CANDIDATES: usize = 200;
/// Distances from the best points, as parts of a range.
const NEAR_DISTANCES: [f64; 3] = [0.1, 0.03, 0.01];
/// Best points near which it is computed.
const MAX_CENTRES: usize = 4;
/// Weight of the sum of both measures.
const SUM_WEIGHT: f64 = 0.05;
/// Margin of a point that keeps no limit.
const FAILED_MARGIN: f64 = -1.0;

/// Distance from a refused place, as a part of each range, within which no other is proposed in the batch.
const MIN_DISTANCE_FROM_REFUSED: f64 = 0.05;
/// Proposals that are refused before a batch ends. Chosen: more are a range of which most is not allowed.
const MAX_REFUSED: usize = 64;

/// A search that chooses its next points.
pub(super) struct Search<'a> {
    pub optimise: &'a Optimise,
    /// Its points so far.
    pub trials: &'a [Trial],
    /// Points of a cheap model; none without one.
    pub prior: &'a [Trial],
    /// Number of the generation that it chooses.
    pub generation: u32,
}

impl Search<'_> {
    /// At most a batch of points, fewer where no others are found. `is_new` says whether the study allows values, and runs
    /// other jobs with them.
    pub fn batch(&self, batch: usize, is_new: &dyn Fn(&[Value]) -> bool) -> Vec<Vec<Value>> {
        let margins = self.margins();
        let two = self.optimise.minimise.len() > 1;
        let mut surrogates = self.surrogates(&margins, 0);
        let mut believed: Vec<Vec<f64>> = Vec::new();
        let (mut chosen, mut refused): (Vec<Vec<Value>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        while chosen.len() < batch && refused.len() < MAX_REFUSED {
            let number = chosen.len();
            let Some(values) = self.best(&surrogates, number, &chosen, &refused) else { break };
            let place = self.optimise.place(&values);
            if !is_new(&values) {
                refused.push(place);
                continue;
            }
            chosen.push(values);
            if two {
                believed.push(place);
                surrogates = self.surrogates(&margins, number + 1);
                for place in &believed {
                    surrogates = surrogates.believing(place);
                }
            } else {
                surrogates = surrogates.believing(&place);
            }
        }
        chosen
    }

    /// The smallest value that is expected at this many points spread evenly, of those expected to keep the limits.
    pub fn of_even_points(&self, number: usize) -> Option<f64> {
        let margins = self.margins();
        let measure = self.surrogates(&margins, 0).measure?;
        let points = sobol(self.optimise.columns.len(), self.optimise.seed).take(number);
        let places = points.map(|point| self.optimise.place(&self.optimise.values(&point)));
        let kept = places.filter(|place| margins.iter().all(|margin| margin.at(place).0 > 0.0));
        kept.map(|place| measure.at(&place).0).reduce(f64::min)
    }

    fn words(&self) -> Vec<bool> {
        self.optimise.coordinates.iter().map(Coordinate::is_word).collect()
    }

    /// The surrogate of the margin of each limit that some points keep and others do not, or that differs.
    fn margins(&self) -> Vec<Expected> {
        let limits = self.trials.first().map_or(0, |trial| trial.margins.len());
        let margin = |trial: &Trial, limit: usize| trial.margins[limit].unwrap_or(FAILED_MARGIN);
        let of = |limit: usize| {
            let values = |of: &[Trial]| -> Vec<f64> {
                of.iter().map(|trial| margin(trial, limit)).collect()
            };
            self.expected(&values(self.trials), &values(self.prior))
        };
        let all: Vec<Option<Expected>> = (0..limits).into_par_iter().map(of).collect();
        all.into_iter().flatten().collect()
    }

    /// What is expected of a number with these values at the points, and those of the cheap model.
    fn expected(&self, values: &[f64], cheap: &[f64]) -> Option<Expected> {
        let places = |of: &[Trial]| -> Vec<Vec<f64>> {
            of.iter().map(|trial| trial.place.clone()).collect()
        };
        let words = self.words();
        let cheap = Surrogate::fit(&places(self.prior), cheap, &words);
        Expected::fit(&places(self.trials), values, &words, cheap.as_ref())
    }

    /// The surrogates for a point of the batch.
    fn surrogates(&self, margins: &[Expected], number: usize) -> Surrogates {
        let worst = |values: &[Option<f64>]| {
            values.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
        };
        // Points without a value count as the worst; the worst of none is infinite.
        let known = |of: &[Trial]| -> Vec<f64> {
            let values = self.scalar(of, number);
            values.iter().map(|value| value.unwrap_or(worst(&values))).collect()
        };
        let (values, cheap) = (known(self.trials), known(self.prior));
        let measure = self.expected(&values, &cheap);
        let mut found = Surrogates { measure, margins: margins.to_vec(), best: None };
        let kept = self.trials.iter().filter(|trial| trial.keeps_limits);
        let means = kept.filter_map(|trial| Some(found.measure.as_ref()?.at(&trial.place).0));
        found.best = means.reduce(f64::min);
        found
    }

    /// What becomes small, as one number for each of these points.
    fn scalar(&self, trials: &[Trial], number: usize) -> Vec<Option<f64>> {
        let of = |trial: &Trial, k: usize| trial.measures[k].filter(|_| trial.is_measured());
        if self.optimise.minimise.len() == 1 {
            return trials.iter().map(|trial| of(trial, 0)).collect();
        }
        // Both ends, then halves: 0, 1, ½, ¼, ¾, …
        let generation = self.generation.saturating_sub(1) as usize;
        let draw = (generation * self.optimise.batch + number) as u64;
        let first = match draw {
            0 => 0.0,
            1 => 1.0,
            other => halves(other - 1),
        };
        let weights = [first, 1.0 - first];
        let scaled = |k: usize| {
            let values = || trials.iter().filter_map(|trial| of(trial, k));
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            move |value: f64| if high > low { (value - low) / (high - low) } else { 0.0 }
        };
        let scaled = [scaled(0), scaled(1)];
        let scalar = |trial: &Trial| {
            let parts = [0, 1].map(|k| of(trial, k).map(|value| weights[k] * scaled[k](value)));
            let [a, b] = [parts[0]?, parts[1]?];
            Some(a.max(b) + SUM_WEIGHT * (a + b))
        };
        trials.iter().map(scalar).collect()
    }

    /// The point where the surrogates expect most, different from all before, and not near a refused place.
    fn best(
        &self,
        surrogates: &Surrogates,
        number: usize,
        chosen: &[Vec<Value>],
        refused: &[Vec<f64>],
    ) -> Option<Vec<Value>> {
        let words = self.words();
        let near = |a: &[f64], b: &[f64]| {
            let mut places = a.iter().zip(b).zip(&words);
            places.all(|((a, b), word)| {
                (a - b).abs() < if *word { 0.5 } else { MIN_DISTANCE_FROM_REFUSED }
            })
        };
        let is_new = |values: &Vec<Value>| {
            let known = || self.trials.iter().any(|trial| trial.values == *values);
            let place = || self.optimise.place(values);
            !chosen.contains(values)
                && !known()
                && (refused.is_empty() || !refused.iter().any(|other| near(other, &place())))
        };
        let score = |values: &Vec<Value>| surrogates.expects(&self.optimise.place(values));
        let mut best: Option<(f64, Vec<Value>)> = None;
        let mut consider = |values: Vec<Value>| {
            if is_new(&values) {
                let score = score(&values);
                if best.as_ref().is_none_or(|(known, _)| score > *known) {
                    best = Some((score, values));
                }
            }
        };
        let seed = hash(u64::from(self.optimise.seed), 1 + u64::from(self.generation));
        let seed = hash(seed, (number + refused.len()) as u64);
        #[expect(clippy::cast_possible_truncation, reason = "any bits are a seed")]
        let spread = sobol(self.optimise.columns.len(), seed as u32).take(SPREAD_CANDIDATES);
        spread.for_each(|point| consider(self.optimise.values(&point)));
        for (k, centre) in self.centres(surrogates).iter().cycle().take(NEAR_CANDIDATES).enumerate()
        {
            let distance = NEAR_DISTANCES[k % NEAR_DISTANCES.len()];
            consider(self.near(centre, distance, hash(seed, k as u64)));
        }
        // From the best on, in ever smaller circles.
        for round in 0..NEAR_CANDIDATES as u64 {
            let Some((_, values)) = &best else { break };
            let centre = self.optimise.place(values);
            let distance = 0.1 * libm::exp(-4.0 * round as f64 / NEAR_CANDIDATES as f64);
            let values = self.near(&centre, distance, hash(!seed, round));
            if is_new(&values) {
                let score = score(&values);
                if best.as_ref().is_some_and(|(known, _)| score > *known) {
                    best = Some((score, values));
                }
            }
        }
        best.map(|(_, values)| values)
    }

    /// The places of the best points so far: those that keep the limits by their measure, then those nearest to it.
    fn centres(&self, surrogates: &Surrogates) -> Vec<Vec<f64>> {
        let worst = |trial: &Trial| {
            trial.margins.iter().map(|m| m.unwrap_or(FAILED_MARGIN)).fold(f64::INFINITY, f64::min)
        };
        let key = |trial: &Trial| match (&surrogates.measure, trial.keeps_limits) {
            (Some(measure), true) => (0, measure.at(&trial.place).0),
            _ => (1, -worst(trial)),
        };
        let mut all: Vec<((i32, f64), &Trial)> = self.trials.iter().map(|t| (key(t), t)).collect();
        all.sort_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        all.into_iter().take(MAX_CENTRES).map(|(_, trial)| trial.place.clone()).collect()
    }

    /// A point near a place: each number moves by a normal distribution, a word changes in one of eight cases.
    fn near(&self, centre: &[f64], distance: f64, seed: u64) -> Vec<Value> {
        let moved = |(j, of): (usize, &Coordinate)| {
            let draw = unit(hash(seed, j as u64 + 1));
            match of {
                Coordinate::Word(words) => {
                    let count = words.len() as f64;
                    let place = if draw < 0.125 { draw / 0.125 } else { (centre[j] + 0.5) / count };
                    of.value(place)
                }
                Coordinate::Whole([low, high]) => {
                    // The middle of the part of a whole number, which moves by one in some of the draws.
                    let count = high - low + 1.0;
                    let middle = (centre[j] * (high - low) + 0.5) / count;
                    let step = distance.max(0.7 / count) * normal::quantile(clamped(draw));
                    of.value(middle + step)
                }
                _ => of.value(centre[j] + distance * normal::quantile(clamped(draw))),
            }
        };
        self.optimise.coordinates.iter().enumerate().map(moved).collect()
    }
}

/// ½, ¼, ¾, ⅛, …: the bits of a number behind the point, in reverse.
fn halves(mut number: u64) -> f64 {
    let (mut value, mut bit) = (0.0, 0.5);
    while number > 0 {
        value += bit * (number & 1) as f64;
        bit *= 0.5;
        number >>= 1;
    }
    value
}

fn clamped(draw: f64) -> f64 {
    draw.clamp(f64::EPSILON, 1.0 - f64::EPSILON)
}
