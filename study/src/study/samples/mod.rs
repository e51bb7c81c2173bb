//! The section `samples` of a study: inputs that are not known exactly, by their distributions.
//!
//! The samples are one axis of the grid on which all inputs vary together. They repeat a point, as replicates do: every
//! point has the same samples, so points are compared sample by sample.

use super::SAMPLES;
use super::grid::{Axis, AxisKind, Context, Grid};
use crate::input::json::Json;
use crate::input::object::{list, members};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

mod distribution;
mod read;
mod sequence;

use distribution::Distribution;
use sequence::Method;

/// The keys of the section.
const KEYS: [&str; 5] = ["number", "of", "method", "seed", "correlations"];
/// What the section must look like, for errors.
const SECTION: &str = "{\"number\": 64, \"of\": {\"film.youngs_modulus\": {\"normal\": [\"3.45 GPa\", \"5 %\"]}}}, and \
                       \"method\", \"seed\", \"correlations\"";
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
            distributions.push(read::distribution(
                (self.columns[column].key, context.assumed),
                value,
                &path,
                source,
            )?);
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
                let place = columns.iter().position(|column| self.columns[*column] == found);
                place.ok_or_else(|| refuse("names a key that is not an input"))
            };
            let pair = (input(a)?, input(b)?);
            let known = |(a, b, _): &(usize, usize, f64)| (*a, *b) == pair || (*b, *a) == pair;
            if all.iter().any(known) {
                return Err(refuse("gives the correlation of two inputs again"));
            }
            if pair.0 == pair.1 || rank.abs() >= 1.0 {
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
    let Some(given) = json.get("number") else {
        return Err(context.source.error(&format!("{SAMPLES}.number"), "", "missing", SECTION));
    };
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

/// With seven digits: what the sequence resolves, and a person can read.
fn rounded(number: f64) -> f64 {
    format!("{number:.6e}").parse().unwrap_or(number)
}
