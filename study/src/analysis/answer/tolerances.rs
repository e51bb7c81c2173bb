//! What samples of inputs say of each point: how probable it is that it is safe, how its measures spread, and what makes
//! the spread.
//!
//! ```text
//! P(safe)       from the lower end of the Wilson interval of the runs that are safe to the upper end of that of the runs
//!               that are not unsafe: a run within its uncertainty, or without a result, may be either. Its n is the number
//!               of samples, also where replicates repeat them
//! quantile p    x_(⌈np⌉) of the sorted values; interval x_(l) to x_(u) with P(l ≤ Bin(n, p) < u) ≥ 95 %
//! y' = Σ βⱼ xⱼ'           ranks of the measure and of the inputs, standardised; least squares; n samples, k inputs
//! part of input j         βⱼ r(xⱼ', y'): these sum to R² (J. W. Pratt, 1987), also where inputs are correlated; scaled to
//!                         R²_adj = 1 − (1 − R²)(n − 1)/(n − k − 1), so that noise explains nothing
//! spread²       = s² of the samples + s² within a sample + (mesh error/1.96)² + (assumed/1.96)²
//!                 s² of the samples: that of the means of their r runs, less s² within/r
//! ```
//!
//! Intervals of parts are by the jackknife (B. Efron, 1982). Ranks see effects that rise or fall; what no sum of them
//! explains is said as such.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;

use super::{bounds, parameters, parameters_of};
use crate::analysis::replicates::{Condensed, finest, fixed, point_key, source};
use crate::analysis::values::{canonical, measured};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::job::result_limit::{ResultLimit, Safety};
use crate::job::row::{ColumnId, HEADLINE};
use crate::store::table::{Column, Table};

/// Quantiles in the answer.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];
/// Probability that an interval misses on each side.
const MISSED: f64 = 0.025;
/// Groups of samples that the jackknife leaves out in turn, at most. Chosen: more change an end by a few per cent.
const GROUPS: usize = 64;
/// Samples for each input below which the answer has no parts. Chosen: the intervals are then wider than the parts.
const SAMPLES_PER_INPUT: usize = 5;
/// Half width of an interval of 95 % over the standard deviation.
const Z: f64 = 1.959_963_984_540_054;
/// Other causes than inputs, in a budget.
const SAMPLES: &str = "samples";
/// That part of a budget.
pub const MESH: &str = "mesh error";
const ASSUMED: &str = "assumed values";
const REPLICATES: &str = "replicates";
const UNEXPLAINED: &str = "not explained by ranks";

/// What samples say of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tolerance {
    /// Its parameters, and the units in which they are shown.
    #[serde(serialize_with = "parameters")]
    pub parameters: Vec<(String, Value, DisplayUnit)>,
    /// Number of runs that have ended.
    pub runs: usize,
    /// Number of different samples among them.
    pub samples: usize,
    /// Number of these runs without a result that the limits can judge: they failed, or no fold pattern fits.
    pub without_result: usize,
    /// Of all these runs, those that are safe; none without limits.
    pub safe: Proportion,
    /// The probability that a run is safe: an interval, 95 %.
    pub safe_between: [f64; 2],
    /// Number of runs that are unsafe; the others are within their uncertainty, or have no result.
    pub not_safe: usize,
    /// The run with the smallest margin: its job, the margin, the measure.
    pub nearest: Option<(String, f64, String)>,
    /// The measures that have a limit, or the main ones.
    pub measures: Vec<Spread>,
}

/// How a measure spreads over the samples of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// The measure.
    pub measure: String,
    /// Unit in which it is shown.
    #[serde(skip)]
    pub shown: DisplayUnit,
    /// Its quantiles, SI.
    pub quantiles: Vec<Quantile>,
    /// Standard deviation of all that is known together, SI.
    pub deviation: f64,
    /// What makes it, the largest first, as parts of its square: the samples, replicates, mesh error, assumed values.
    pub budget: Vec<Part>,
    /// What makes the spread of the samples, the largest first, as parts of its square: each input, and the rest.
    pub inputs: Vec<Part>,
    /// What is not known, and why.
    pub without: Vec<String>,
}

/// A quantile of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantile {
    /// The part of the values below it.
    pub p: f64,
    /// The value, SI.
    pub value: f64,
    /// Its interval, 95 %, SI; `None` at an end where too few samples give none.
    pub between: [Option<f64>; 2],
}

/// A part of a spread.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// What makes it.
    pub name: String,
    /// Its part, from 0 to 1.
    pub part: f64,
    /// The interval of the part of an input, 95 %.
    pub between: Option<[f64; 2]>,
}

impl Tolerance {
    /// What samples say of every point; none without samples.
    pub fn all(
        table: &Table,
        limits: &[ResultLimit],
        replicates: &[String],
        sampled: &[String],
    ) -> Vec<Self> {
        if sampled.is_empty() {
            return Vec::new();
        }
        let rows: Vec<usize> = (0..table.rows()).collect();
        // A sample is a row, also where it shares its job.
        let mut groups: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
        let fixed = fixed(table, replicates);
        for row in &rows {
            groups.entry(point_key(&fixed, *row)).or_default().push(*row);
        }
        let points = Condensed::of(table, &rows, replicates);
        let measures = measures(table, limits);
        let feasible: Vec<usize> = points.feasible().collect();
        let of = |point: &usize| {
            let runs = &points.runs[*point];
            let all = &groups[&point_key(&fixed, runs.rows[0])];
            let (nearest, parameters) =
                (runs.worst_margin(table), parameters_of(&points.table, *point));
            Self::of(table, (all, nearest), parameters, (limits, &measures), sampled)
        };
        feasible.iter().map(of).collect()
    }

    /// What the samples of one point say, in these rows; the smallest margin with its measure and row.
    fn of(
        table: &Table,
        (rows, nearest): (&[usize], Option<(f64, String, usize)>),
        parameters: Vec<(String, Value, DisplayUnit)>,
        (limits, measures): (&[ResultLimit], &[ColumnId]),
        sampled: &[String],
    ) -> Self {
        let mut ended = finest(table, rows);
        ended.retain(|row| table.status(*row) != Some(Status::Pending));
        let count = |wanted| ended.iter().filter(|row| table.safety(**row) == Some(wanted)).count();
        let [safe, uncertain, not_safe] = Safety::ALL.map(count);
        let of = if limits.is_empty() { 0 } else { ended.len() };
        let samples = of_samples(table, &ended, sampled).len();
        let met = |met: usize| Proportion { met, of };
        let done = |row: &usize| table.status(*row) == Some(Status::Done);
        let done: Vec<usize> = ended.iter().copied().filter(done).collect();
        let trusted = |row: &usize| table.is_trusted(*row);
        let trusted: Vec<usize> = done.iter().copied().filter(trusted).collect();
        let measured = if trusted.is_empty() { &done } else { &trusted };
        let spread = |measure: &ColumnId| {
            Spread::of(table, table.column(measure.name())?, measured, sampled)
        };
        let with_result = if limits.is_empty() { done.len() } else { safe + uncertain + not_safe };
        let possible = met(of.saturating_sub(not_safe)).wilson_of(samples);
        let job = |row: usize| table.column("job").map(|jobs| jobs.cells[row].to_string());
        Self {
            parameters,
            runs: ended.len(),
            samples,
            without_result: ended.len() - with_result,
            safe: met(safe),
            safe_between: [met(safe).wilson_of(samples)[0], possible[1]],
            not_safe,
            nearest: nearest.and_then(|(margin, name, row)| Some((job(row)?, margin, name))),
            measures: measures.iter().filter_map(spread).collect(),
        }
    }
}

/// The runs of each sample among these rows.
fn of_samples(
    table: &Table,
    rows: &[usize],
    sampled: &[String],
) -> BTreeMap<Vec<String>, Vec<usize>> {
    let inputs: Vec<&Column> = table.parameters().filter(|c| sampled.contains(&c.name)).collect();
    let mut samples: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    for row in rows {
        let key = inputs.iter().map(|input| canonical(&input.cells[*row])).collect();
        samples.entry(key).or_default().push(*row);
    }
    samples
}

/// The measures that have a limit; without one, how soon and how hard.
fn measures(table: &Table, limits: &[ResultLimit]) -> Vec<ColumnId> {
    let mut limited: Vec<ColumnId> = Vec::new();
    for (measure, _) in bounds(limits) {
        if !limited.contains(&measure) {
            limited.push(measure);
        }
    }
    if limited.is_empty() {
        limited = vec![table.of_any_film(HEADLINE[0]), table.of_any_film(ColumnId::PeakVz)];
    }
    limited
}

impl Spread {
    /// The spread of a measure over these rows; `None` without two values.
    fn of(table: &Table, column: &Column, rows: &[usize], sampled: &[String]) -> Option<Self> {
        let values_of = source(table, column);
        let inputs: Vec<&Column> =
            table.parameters().filter(|c| sampled.contains(&c.name)).collect();
        let value = |row: &usize| measured(table, values_of, *row);
        let with_value: Vec<usize> =
            rows.iter().copied().filter(|row| value(row).is_some()).collect();
        let samples = of_samples(table, &with_value, sampled);
        let (mut values, mut means) = (Vec::new(), Vec::new());
        let (mut within, mut of_means) = (0.0, 0.0);
        for rows in samples.values() {
            let of_sample: Vec<f64> = rows.iter().filter_map(value).collect();
            let (mean, variance) = moments(&of_sample);
            means.push(mean);
            within += variance / samples.len() as f64;
            of_means += variance / (rows.len() * samples.len()) as f64;
            values.extend(of_sample);
        }
        if values.len() < 2 {
            return None;
        }
        values.sort_by(f64::total_cmp);
        let quantiles = QUANTILES.map(|p| Quantile::of(&values, p, samples.len()));
        let first: Vec<usize> = samples.values().map(|rows| rows[0]).collect();
        let between = (moments(&means).1 - of_means).max(0.0);
        let mut without = Vec::new();
        let mut variances = vec![(SAMPLES, between), (REPLICATES, within)];
        let id = ColumnId::from_name(&column.name);
        let half = |which: usize| -> Option<f64> {
            let sides = with_value.iter().map(|row| table.error_parts(id?, *row)[which]);
            let halves: Option<Vec<f64>> =
                sides.map(|sides| sides.map(|[a, b]| 0.5 * (a + b) / Z)).collect();
            halves.map(|halves| moments(&halves).0)
        };
        for (which, name) in [MESH, ASSUMED].into_iter().enumerate() {
            match half(which) {
                Some(deviation) => variances.push((name, deviation * deviation)),
                None => without.push(format!("{name}: not known")),
            }
        }
        let all: f64 = variances.iter().map(|(_, variance)| variance).sum();
        let part = |(name, variance): (&str, f64)| Part::new(name, variance / all);
        let budget = variances.into_iter().filter(|(_, variance)| *variance > 0.0).map(part);
        let inputs = of_inputs(&inputs, &first, &means).unwrap_or_else(|problem| {
            without.push(problem);
            Vec::new()
        });
        Some(Self {
            measure: column.name.clone(),
            shown: column.shown.clone(),
            quantiles: quantiles.to_vec(),
            deviation: libm::sqrt(all),
            budget: largest_first(budget.collect()),
            inputs: largest_first(inputs),
            without,
        })
    }
}

impl Quantile {
    /// Of sorted values; `samples` of them are independent.
    fn of(sorted: &[f64], p: f64, samples: usize) -> Self {
        let at = |rank: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "at least 0"
            )]
            let index = (rank.max(0.0) as usize).min(sorted.len() - 1);
            sorted[index]
        };
        let (n, all) = (samples as f64, sorted.len() as f64);
        let [low, high] = ranks(samples, p);
        // Ranks of the samples among all values.
        let place = |rank: usize| at((rank as f64 - 0.5) / n * all);
        Self {
            p,
            value: at(libm::ceil(all * p) - 1.0),
            between: [low.map(place), high.filter(|rank| *rank <= samples).map(place)],
        }
    }
}

/// Ranks l and u, from 1, between whose values a quantile of `n` values is in 19 of 20 cases: P(Bin(n, p) < l) and
/// P(Bin(n, p) ≥ u) are at most 2.5 %.
fn ranks(n: usize, p: f64) -> [Option<usize>; 2] {
    // The logarithm of P(Bin = k): of many samples the probabilities at the ends are below the smallest f64.
    let mut term = n as f64 * libm::log1p(-p);
    let odds = libm::log(p / (1.0 - p));
    let mut below = 0.0;
    let (mut low, mut high) = (None, None);
    for k in 0..=n {
        // `below` is P(Bin < k).
        if below <= MISSED && k > 0 {
            low = Some(k);
        }
        if high.is_none() && 1.0 - below <= MISSED {
            high = Some(k);
        }
        below += libm::exp(term);
        term += libm::log((n - k) as f64 / (k + 1) as f64) + odds;
    }
    [low, high]
}

impl Part {
    fn new(name: &str, part: f64) -> Self {
        Self { name: name.to_owned(), part, between: None }
    }
}

fn largest_first(mut parts: Vec<Part>) -> Vec<Part> {
    parts.sort_by(|a, b| b.part.total_cmp(&a.part));
    parts
}

/// The part of each input in the spread of the samples, and the rest: `values` of a measure, one at each row.
///
/// # Errors
/// Why there are none.
fn of_inputs(inputs: &[&Column], rows: &[usize], values: &[f64]) -> Result<Vec<Part>, String> {
    let needed = SAMPLES_PER_INPUT * inputs.len().max(2);
    if rows.len() < needed {
        return Err(format!("what each input makes: {} samples, {needed} needed", rows.len()));
    }
    let columns: Vec<Vec<f64>> = inputs.iter().map(|input| numbers(input, rows)).collect();
    let all: Vec<usize> = (0..rows.len()).collect();
    let parts = pratt(&columns, values, &all)
        .ok_or("what each input makes: the ranks do not separate them")?;
    let groups = rows.len().min(GROUPS);
    let without = |group: usize| {
        let kept: Vec<usize> = all.iter().copied().filter(|i| i % groups != group).collect();
        pratt(&columns, values, &kept)
    };
    let jackknife: Option<Vec<Vec<f64>>> = (0..groups).map(without).collect();
    let of_input = |(index, input): (usize, &&Column)| {
        let between = jackknife.as_ref().map(|jackknife| {
            let of: Vec<f64> = jackknife.iter().map(|parts| parts[index]).collect();
            let g = groups as f64;
            let half = Z * libm::sqrt(moments(&of).1 / g) * (g - 1.0);
            [parts[index] - half, parts[index] + half].map(|end| end.clamp(0.0, 1.0))
        });
        Part { between, ..Part::new(&input.name, parts[index]) }
    };
    let mut found: Vec<Part> = inputs.iter().enumerate().map(of_input).collect();
    found.push(Part::new(UNEXPLAINED, (1.0 - parts.iter().sum::<f64>()).max(0.0)));
    Ok(found)
}

/// The values of an input as numbers; words by their order.
fn numbers(input: &Column, rows: &[usize]) -> Vec<f64> {
    let mut words: Vec<String> = rows.iter().map(|row| canonical(&input.cells[*row])).collect();
    words.sort();
    words.dedup();
    let number = |row: &usize| match &input.cells[*row] {
        Value::Number(number) => *number,
        Value::Integer(number) => *number as f64,
        other => words.binary_search(&canonical(other)).unwrap_or(0) as f64,
    };
    rows.iter().map(number).collect()
}

/// Mean, and variance of a sample (0 for one value).
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, if values.len() > 1 { squares / (n - 1.0) } else { 0.0 })
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
fn pratt(inputs: &[Vec<f64>], values: &[f64], places: &[usize]) -> Option<Vec<f64>> {
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

#[cfg(test)]
mod tests {
    use billow_solver::platform::random::{hash, unit};

    use super::*;
    use crate::analysis::fixture;

    /// Samples of y = 3 a + b + noise, with a limit.
    fn table(samples: u64) -> Table {
        let number = |seed: u64, index: u64| unit(hash(seed, index));
        let row = |i: u64| {
            let (a, b) = (number(1, i), number(2, i));
            let y = 10.0 + 3.0 * a + b + 0.1 * number(3, i);
            let safe = if y < 13.0 { "safe" } else { "unsafe" };
            format!("j{i} {a} {b} done {y} {safe}")
        };
        fixture::table_of("job a b status peak_vz safety", (1..=samples).map(row))
    }

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn parts_are_those_of_the_variance_of_a_sum() {
        let (table, inputs) = (table(400), names(&["a", "b"]));
        let found = Tolerance::all(&table, &fixture::limits(13.0), &inputs, &inputs);
        let [point] = found.as_slice() else { panic!("{found:?}") };
        let spread = point.measures.iter().find(|one| one.measure == "peak_vz").unwrap();
        // Var = 9/12 + 1/12 + 0.01/12.
        let part = |name: &str| spread.inputs.iter().find(|part| part.name == name).unwrap();
        for (name, exact) in [("a", 0.899), ("b", 0.0999)] {
            let Part { part, between, .. } = part(name).clone();
            let [low, high] = between.unwrap();
            assert!((part - exact).abs() < 0.04, "{name}: {part}");
            assert!(low < part && part < high && high - low < 0.2, "{name}: {low} {high}");
        }
        for parts in [&spread.inputs, &spread.budget] {
            assert!((parts.iter().map(|part| part.part).sum::<f64>() - 1.0).abs() < 1e-12);
        }
        assert!((spread.deviation - libm::sqrt(10.01 / 12.0)).abs() < 0.05);
        assert_eq!(point.safe.of, 400);
        let exact = point.safe.met as f64 / 400.0;
        assert!(point.safe_between[0] < exact && exact < point.safe_between[1]);
    }

    #[test]
    fn ranks_of_quantiles_are_those_of_the_binomial_distribution() {
        // Conover, "Practical nonparametric statistics": the median of 20 is between x₆ and x₁₅.
        assert_eq!(ranks(20, 0.5), [Some(6), Some(15)]);
        // Of many samples, where 0.05ⁿ is below the smallest f64: the mirror, and the normal distribution.
        for n in [256, 5000] {
            let ([low, high], [other, _]) = (ranks(n, 0.95), ranks(n, 0.05));
            assert_eq!(other, high.map(|rank| n + 1 - rank), "{n}");
            let half = Z * libm::sqrt(n as f64 * 0.95 * 0.05);
            let exact = 0.95 * n as f64 - half;
            assert!((low.unwrap() as f64 - exact).abs() < 2.5, "{n}: {low:?} to {high:?}");
        }
        // 0.95¹⁰ > 2.5 %: ten samples say nothing of what is below the quantile of 5 %.
        assert_eq!(ranks(10, 0.05)[0], None);
        let sorted: Vec<f64> = (1..=100).map(f64::from).collect();
        let median = Quantile::of(&sorted, 0.5, 100);
        assert!((median.value - 50.0).abs() < 1e-12);
        assert_eq!(median.between, [Some(40.0), Some(61.0)]);
    }

    #[test]
    fn noise_explains_little() {
        let explained = |trial: u64| -> f64 {
            let draw = |seed: u64| -> Vec<f64> {
                (1..=64).map(|i| unit(hash(100 * trial + seed, i))).collect()
            };
            let inputs: Vec<Vec<f64>> = (1..=8).map(draw).collect();
            pratt(&inputs, &draw(9), &(0..64).collect::<Vec<_>>()).unwrap().iter().sum()
        };
        let mean = (0..60).map(explained).sum::<f64>() / 60.0;
        assert!(mean < 0.06, "{mean}");
    }

    #[test]
    fn runs_without_a_result_widen_the_interval_and_replicates_do_not_narrow_it() {
        let row = |i: u32| {
            let (sample, seed) = (i / 2, i % 2);
            let outcome = if sample < 8 { "done 10.0 safe" } else { "unstable - -" };
            format!("j{i} {sample}.5 {seed} {outcome}")
        };
        let table = fixture::table_of("job a seed status peak_vz safety", (0..20).map(row));
        let limits = fixture::limits(30.0);
        let found = Tolerance::all(&table, &limits, &names(&["a", "seed"]), &names(&["a"]));
        let [point] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((point.runs, point.samples, point.without_result), (20, 10, 4));
        assert_eq!(point.safe, Proportion { met: 16, of: 20 });
        let ten = Proportion { met: 8, of: 10 };
        assert!((point.safe_between[0] - ten.wilson()[0]).abs() < 1e-12);
        assert!((point.safe_between[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn few_samples_tell_no_parts() {
        let (table, inputs) = (table(9), names(&["a", "b"]));
        let found = Tolerance::all(&table, &[], &inputs, &inputs);
        let spread = &found[0].measures.last().unwrap();
        assert_eq!((spread.inputs.len(), spread.budget[0].name.as_str()), (0, "samples"));
        assert!(spread.without[2].contains("9 samples, 10 needed"), "{:?}", spread.without);
    }
}
