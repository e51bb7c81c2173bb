//! The section `samples` of a study: inputs that are not known exactly, by their distributions.
//!
//! The samples are one axis of the grid on which all inputs vary together. They repeat a point, as replicates do: every
//! point has the same samples, so points are compared sample by sample.

use super::SAMPLES;
use super::grid::{Axis, AxisKind, Context, Grid};
use super::range::width;
use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind};
use crate::input::object::{list, members};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

mod distribution;
mod sequence;

use distribution::Distribution;
use sequence::Method;

/// The keys of the section.
const KEYS: [&str; 5] = ["number", "of", "method", "seed", "correlations"];
/// Smallest part of a distribution between the ends that cut it.
const MIN_REST: f64 = 1e-6;
/// Smallest standard deviation over the mean. Chosen: a smaller one is a unit that was forgotten.
const MIN_SPREAD: f64 = 1e-5;
/// The distributions of numbers.
const KINDS: [&str; 5] = ["uniform", "log_uniform", "normal", "log_normal", "triangular"];
/// What the section must look like, for errors.
const SECTION: &str = "{\"number\": 64, \"of\": {\"film.youngs_modulus\": {\"normal\": [\"3.45 GPa\", \"5 %\"]}}}, and \
                       \"method\", \"seed\", \"correlations\"";
/// What a distribution must look like, for errors.
const DISTRIBUTION: &str = "{\"uniform\": [low, high]}, log_uniform, {\"normal\": [mean, deviation or \"5 %\"]}, {\"log_normal\": \
                            [median, \"5 %\"]}, {\"triangular\": [low, peak, high]}, each with \"from\" and \"to\"; or \
                            {\"values\": […], \"weights\": […]}";
/// What correlations must look like, for errors.
const CORRELATIONS: &str = "a list of [key, other key, rank correlation between -1 and 1]";

impl Grid {
    /// Reads the samples, as an axis that repeats a point.
    pub(super) fn read_samples(
        &mut self,
        json: Option<&Json>,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        let source = context.source;
        for (name, value) in members(json, SAMPLES, source, SECTION)? {
            if !KEYS.contains(&name.as_str()) {
                let near = or_nearest(name, KEYS.iter().copied());
                let problem = format!("is not a key of the samples{near}");
                return Err(source.error(
                    &format!("{SAMPLES}.{name}"),
                    value,
                    problem,
                    KEYS.join(", "),
                ));
            }
        }
        let method = method(json, source)?;
        let number = number(json, method, context)?;
        let seed = match json.get("seed") {
            None => 1,
            Some(given) => whole(given, "seed", [0, u32::MAX.into()], source)?,
        };
        let of = format!("{SAMPLES}.of");
        let Some(inputs) = json.get("of") else {
            return Err(source.error(&of, "", "missing", SECTION));
        };
        let mut distributions = Vec::new();
        let mut columns = Vec::new();
        for (name, value) in members(inputs, &of, source, SECTION)? {
            let path = format!("{of}.{name}");
            let column = self.column(name, &path, value, context)?;
            distributions.push(read(self.columns[column].key, value, &path, source)?);
            columns.push(column);
        }
        if columns.is_empty() || columns.len() > sequence::MAX_INPUTS {
            let problem = format!("has {} inputs", columns.len());
            let allowed = format!("1 to {} keys with their distributions", sequence::MAX_INPUTS);
            return Err(source.error(&of, inputs, problem, allowed));
        }
        if distributions.iter().all(|of| matches!(of, Distribution::Choice(_))) {
            let problem = "draws from lists alone: its samples repeat jobs, and a job counts once";
            let allowed =
                "one input with a distribution of numbers at least; lists alone belong to the grid";
            return Err(source.error(&of, inputs, problem, allowed));
        }
        #[expect(clippy::cast_possible_truncation, reason = "checked above")]
        let mut points = sequence::points(method, seed as u32, number, columns.len());
        self.correlate(&mut points, json.get("correlations"), &columns, context)?;
        let mut rows = Vec::with_capacity(number);
        for (sample, point) in points.iter().enumerate() {
            let value = |((column, distribution), p): ((&usize, &Distribution), &f64)| {
                let column = &self.columns[*column];
                let number = match distribution.quantile(*p) {
                    Value::Number(number) => rounded(number),
                    word => return Ok(word),
                };
                let path = format!("{of}.{} (sample {})", column.name, sample + 1);
                column.key.value_silently(&Json::Number(number), &path, source).map_err(|error| {
                    InputError {
                        hint: "give \"from\" and \"to\" within what is allowed".to_owned(),
                        ..error
                    }
                })
            };
            let row = columns.iter().zip(&distributions).zip(point).map(value);
            rows.push(row.collect::<Result<Vec<_>, _>>()?);
        }
        self.axes.push(Axis { columns, rows, kind: AxisKind::Samples });
        Ok(())
    }

    /// Makes the inputs of samples depend on each other as the file asks.
    fn correlate(
        &self,
        points: &mut [Vec<f64>],
        json: Option<&Json>,
        columns: &[usize],
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        let source = context.source;
        let path = format!("{SAMPLES}.correlations");
        let mut all = Vec::new();
        for (index, entry) in list(json, &path, source, CORRELATIONS)?.iter().enumerate() {
            let path = format!("{path}[{index}]");
            let refuse = |problem: &str| source.error(&path, entry, problem, CORRELATIONS);
            let Json::List(parts) = entry else { return Err(refuse("is no list")) };
            let [Json::Text(a), Json::Text(b), rank] = parts.as_slice() else {
                return Err(refuse("is not two keys and a number"));
            };
            let rank = match rank {
                Json::Number(rank) => *rank,
                Json::Integer(rank) => *rank as f64,
                _ => return Err(refuse("has a third part that is not a number")),
            };
            let input = |name: &String| {
                let found = super::column::find(name, &path, entry, context.settings, source)?;
                let is = |column: &&usize| self.columns[**column] == found;
                let place =
                    columns.iter().find(is).and_then(|c| columns.iter().position(|o| o == c));
                place.ok_or_else(|| refuse("names a key that is not an input"))
            };
            let pair = (input(a)?, input(b)?);
            let known = |(a, b, _): &(usize, usize, f64)| (*a, *b) == pair || (*b, *a) == pair;
            if all.iter().any(known) {
                return Err(refuse("gives the correlation of two inputs again"));
            }
            if pair.0 == pair.1 || !(-1.0..=1.0).contains(&rank) || rank.abs() >= 1.0 {
                return Err(refuse("is no rank correlation of two inputs"));
            }
            all.push((pair.0, pair.1, rank));
        }
        sequence::correlate(points, &all).ok_or_else(|| {
            let problem = "are correlations that no inputs have together";
            source.error(&path, json, problem, "smaller correlations")
        })
    }
}

fn method(json: &Json, source: &Source) -> Result<Method, InputError> {
    match json.get("method") {
        None => Ok(Method::Sobol),
        Some(Json::Text(text)) if text == "sobol" => Ok(Method::Sobol),
        Some(Json::Text(text)) if text == "latin_hypercube" => Ok(Method::LatinHypercube),
        Some(other) => {
            let path = format!("{SAMPLES}.method");
            Err(source.error(&path, other, "is no method of sampling", "sobol, latin_hypercube"))
        }
    }
}

fn number(json: &Json, method: Method, context: Context<'_>) -> Result<usize, InputError> {
    let most = match method {
        Method::Sobol => context.max_points.min(sequence::MAX_SOBOL),
        Method::LatinHypercube => context.max_points,
    };
    let missing = Json::Null;
    let given = json.get("number").unwrap_or(&missing);
    let number = whole(given, "number", [2, most as u64], context.source)?;
    Ok(usize::try_from(number).unwrap_or(most))
}

fn whole(
    json: &Json,
    key: &str,
    [least, most]: [u64; 2],
    source: &Source,
) -> Result<u64, InputError> {
    match json {
        Json::Integer(number)
            if u64::try_from(*number).is_ok_and(|n| (least..=most).contains(&n)) =>
        {
            Ok(number.unsigned_abs())
        }
        other => {
            let allowed = format!("a whole number, {least} to {most}");
            Err(source.error(
                &format!("{SAMPLES}.{key}"),
                other,
                "is not a whole number in this range",
                allowed,
            ))
        }
    }
}

/// Reads the distribution of a key.
fn read(key: &Key, json: &Json, path: &str, source: &Source) -> Result<Distribution, InputError> {
    let refuse = |problem: &str| source.error(path, json, problem, DISTRIBUTION);
    let parts = members(json, path, source, DISTRIBUTION)?;
    let kinds: Vec<&(String, Json)> =
        parts.iter().filter(|(name, _)| name != "from" && name != "to").collect();
    let given = |name: &str| json.get(name);
    if let Some(values) = given("values") {
        let known = ["values", "weights"];
        if let Some((name, _)) = parts.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            let near = or_nearest(name, known.iter().copied());
            return Err(refuse(&format!("has {name} beside a list of values{near}")));
        }
        return choice(key, values, given("weights"), path, source);
    }
    let [(name, numbers)] = kinds.as_slice() else {
        return Err(refuse("is not one distribution"));
    };
    if !matches!(key.kind, KeyKind::Quantity(_)) {
        let allowed = "{\"values\": […], \"weights\": […]}";
        return Err(source.error(
            path,
            json,
            "is a distribution of numbers, and the key has whole numbers or words",
            allowed,
        ));
    }
    let place = format!("{path}.{name}");
    let items = list(numbers, &place, source, DISTRIBUTION)?;
    let number = |index: usize| match items.get(index) {
        Some(item) => key.finite(item, &format!("{place}[{index}]"), source),
        None => Err(refuse("has too few numbers")),
    };
    let ordered = |numbers: &[f64]| {
        let rises = numbers.windows(2).all(|pair| pair[0] <= pair[1])
            && numbers[0] < numbers[numbers.len() - 1];
        if rises {
            Ok(())
        } else {
            Err(refuse("does not rise: its values are all alike, or in another order"))
        }
    };
    let expected = if name == "triangular" { 3 } else { 2 };
    if items.len() != expected {
        return Err(refuse(&format!("has {} numbers, not {expected}", items.len())));
    }
    let of = match name.as_str() {
        "uniform" => Distribution::Uniform([number(0)?, number(1)?]),
        "log_uniform" => Distribution::LogUniform([number(0)?, number(1)?]),
        "triangular" => Distribution::Triangular([number(0)?, number(1)?, number(2)?]),
        "normal" => {
            let mean = number(0)?;
            let deviation =
                relative(&items[1]).map(|part| part * mean.abs()).or_else(|| width(key, &items[1]));
            let deviation = deviation.filter(|deviation| *deviation > MIN_SPREAD * mean.abs());
            let refused = || {
                refuse(
                    "has hardly any standard deviation; it is in the unit of the key, or in per cent of the mean",
                )
            };
            Distribution::Normal([mean, deviation.ok_or_else(refused)?])
        }
        "log_normal" => {
            let refused = || {
                refuse("has no spread above 0 in per cent, the standard deviation of the logarithm")
            };
            let deviation = relative(&items[1]).filter(|part| *part > 0.0).ok_or_else(refused)?;
            Distribution::LogNormal([number(0)?, deviation])
        }
        _ => {
            let near = or_nearest(name, KINDS.iter().copied());
            return Err(refuse(&format!("is no distribution{near}")));
        }
    };
    match &of {
        Distribution::Uniform(ends) => ordered(ends)?,
        Distribution::Triangular(ends) => ordered(ends)?,
        Distribution::LogUniform(ends) => {
            ordered(ends)?;
            if ends[0] <= 0.0 {
                return Err(refuse("has a logarithm, so its values must be above 0"));
            }
        }
        Distribution::LogNormal([median, _]) if *median <= 0.0 => {
            return Err(refuse("has a logarithm, so its median must be above 0"));
        }
        _ => {}
    }
    truncated(of, key, json, path, source)
}

/// A distribution between the ends that the file gives it.
fn truncated(
    of: Distribution,
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Distribution, InputError> {
    let end = |name: &str| {
        json.get(name).map(|end| key.finite(end, &format!("{path}.{name}"), source)).transpose()
    };
    let (from, to) = (end("from")?, end("to")?);
    if from.is_none() && to.is_none() {
        return Ok(of);
    }
    // Far beyond any value that is drawn.
    let ends = [from.unwrap_or(-f64::MAX), to.unwrap_or(f64::MAX)];
    // Further out the quantiles of the rest have too few digits.
    if ends[0] >= ends[1] || of.part_below(ends[1]) - of.part_below(ends[0]) < MIN_REST {
        let problem = "has hardly anything between \"from\" and \"to\"";
        return Err(source.error(path, json, problem, DISTRIBUTION));
    }
    Ok(Distribution::Truncated(Box::new(of), ends))
}

/// Reads values with their weights.
fn choice(
    key: &Key,
    values: &Json,
    weights: Option<&Json>,
    path: &str,
    source: &Source,
) -> Result<Distribution, InputError> {
    let place = format!("{path}.values");
    let items = list(values, &place, source, DISTRIBUTION)?;
    let value =
        |(index, item): (usize, &Json)| key.value(item, &format!("{place}[{index}]"), source);
    let read: Vec<Value> = items.iter().enumerate().map(value).collect::<Result<_, _>>()?;
    let weights = match weights {
        None => vec![1.0; read.len()],
        Some(json) => {
            let place = format!("{path}.weights");
            let weight = |item: &Json| match item {
                Json::Integer(weight) if *weight > 0 => Ok(*weight as f64),
                Json::Number(weight) if *weight > 0.0 && weight.is_finite() => Ok(*weight),
                other => Err(source.error(&place, other, "is no weight", "numbers above 0")),
            };
            let weights = list(json, &place, source, DISTRIBUTION)?;
            weights.iter().map(weight).collect::<Result<Vec<_>, _>>()?
        }
    };
    let differ = read.iter().any(|value| *value != read[0]);
    if read.len() != weights.len() || !differ {
        let problem = "are not two or more different values, each with a weight";
        return Err(source.error(&place, values, problem, DISTRIBUTION));
    }
    Ok(Distribution::Choice(read.into_iter().zip(weights).collect()))
}

/// A text in per cent as a part.
fn relative(json: &Json) -> Option<f64> {
    let Json::Text(text) = json else { return None };
    let number = text.trim().strip_suffix('%')?.trim().parse::<f64>().ok()?;
    number.is_finite().then_some(number / 100.0)
}

/// With seven digits: what the sequence resolves, and a person can read.
fn rounded(number: f64) -> f64 {
    format!("{number:.6e}").parse().unwrap_or(number)
}
