//! Reads the distribution of an input.

use super::distribution::Distribution;
use crate::accuracy::{ASSUMED_KEYS, AssumedRanges};
use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind};
use crate::input::object::{list, members};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;
use crate::study::range::width;

/// Smallest part of a distribution between the ends that cut it.
const MIN_REST: f64 = 1e-6;
/// Smallest standard deviation over the mean. Chosen: a smaller one is a unit that was forgotten.
const MIN_SPREAD: f64 = 1e-5;
/// The distributions of numbers.
const KINDS: [&str; 5] = ["uniform", "log_uniform", "normal", "log_normal", "triangular"];
/// What a distribution must look like, for errors.
const DISTRIBUTION: &str = "{\"uniform\": [low, high]}, log_uniform, {\"normal\": [mean, deviation or \"5 %\"]}, {\"log_normal\": \
                            [median, \"5 %\"]}, {\"triangular\": [low, peak, high]}, each with \"from\" and \"to\"; or \
                            {\"values\": […], \"weights\": […]}, {\"assumed\": true}";
/// Coulomb friction, which is assumed too: none to that of polyimide on polyimide (ASTM D1894, the maker's table).
const FRICTION: &str = "contact.friction";
const FRICTION_RANGE: [f64; 2] = [0.0, 0.48];

/// Reads the distribution of a key; `ranges` are those of what is assumed.
pub(super) fn distribution(
    (key, ranges): (&Key, &AssumedRanges),
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Distribution, InputError> {
    let refuse = |problem: &str| source.error(path, json, problem, DISTRIBUTION);
    if let Json::List(items) = json
        && items.len() > 1
    {
        let hint =
            format!("{{\"values\": {json}}}, or two numbers as {{\"uniform\": [low, high]}}");
        return Err(refuse("is a list, not an object").with_hint(hint));
    }
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
    if name == "assumed" {
        return truncated(assumed((key, ranges), json, path, source)?, key, json, path, source);
    }
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

/// The distribution of what is assumed, over its whole range.
fn assumed(
    (key, ranges): (&Key, &AssumedRanges),
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Distribution, InputError> {
    if json.get("assumed") != Some(&Json::Bool(true)) {
        return Err(source.error(path, json, "is not true", "{\"assumed\": true}"));
    }
    if key.path == FRICTION {
        return Ok(Distribution::Uniform(FRICTION_RANGE));
    }
    let position = ASSUMED_KEYS.iter().position(|known| *known == key.path).ok_or_else(|| {
        let allowed = format!("{} or {FRICTION}", ASSUMED_KEYS.join(", "));
        source.error(path, json, "is not among what is assumed: give its distribution", allowed)
    })?;
    Ok(Distribution::LogUniform(ranges.0[position]))
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
