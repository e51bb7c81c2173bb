//! The section `limits` of a study: what its results must meet to be safe.

use crate::input::json::Json;
use crate::input::keys::STUDY;
use crate::input::object::object;
use crate::input::source::Source;
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::{COLUMNS, CellType, ColumnGroup, RowColumn};
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;
use billow_solver::output::measures::Verdict;

/// Every verdict.
const VERDICTS: [Verdict; 3] = [Verdict::Deployed, Verdict::Partial, Verdict::Stalled];
/// Comparisons, the longer ones first: text, whether the value must be above, whether the bound is allowed.
const COMPARISONS: [(&str, bool, bool); 4] =
    [("<=", false, true), (">=", true, true), ("<", false, false), (">", true, false)];

/// Reads the limits, in the order of the file.
pub(super) fn read(json: Option<&Json>, source: &Source) -> Result<Vec<ResultLimit>, InputError> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let mut limits: Vec<ResultLimit> = Vec::new();
    for (name, value) in object(json, &STUDY, "limits", source)? {
        let path = format!("limits.{name}");
        let column = column(name).ok_or_else(|| {
            let said = [
                "is not a measure that can have a limit",
                "verdict, peak_vz, film_stress_99, t_deployed_since_release",
            ];
            unknown(said, can_be_limited, name, (&path, value), source)
        })?;
        if limits.iter().any(|known| known.measure == column.id) {
            let problem = format!("limits {} twice", column.name);
            return Err(source.error(&path, value, problem, "each measure once"));
        }
        let condition = condition(column, value, &path, source)?;
        let text = match value {
            Json::Text(text) => text.trim().to_owned(),
            other => other.to_string(),
        };
        limits.push(ResultLimit { measure: column.id, condition, text });
    }
    Ok(limits)
}

/// The column that a limit may name: an outcome, a measure or part of the audit.
fn column(name: &str) -> Option<&'static RowColumn> {
    COLUMNS.iter().find(|column| column.name == name && can_be_limited(column))
}

fn can_be_limited(column: &RowColumn) -> bool {
    let group =
        matches!(column.group, ColumnGroup::Outcome | ColumnGroup::Measures | ColumnGroup::Audit);
    group && (column.cell_type != CellType::Text || column.name == "verdict")
}

fn condition(
    column: &RowColumn,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Condition, InputError> {
    match column.cell_type {
        CellType::Text => verdict(json, path, source),
        CellType::Bool => match json {
            Json::Bool(value) => Ok(Condition::Is(Value::Bool(*value))),
            _ => Err(source.error(path, json, "is not a truth value", "true, false")),
        },
        CellType::Integer | CellType::Number => bound(column, json, path, source),
    }
}

fn verdict(json: &Json, path: &str, source: &Source) -> Result<Condition, InputError> {
    let word = match json {
        Json::Text(text) => text.trim(),
        _ => "",
    };
    if VERDICTS.iter().any(|verdict| verdict.name() == word) {
        return Ok(Condition::Is(Value::Text(word.to_owned())));
    }
    let names = VERDICTS.map(Verdict::name);
    let near = or_nearest(word, names.iter().copied());
    Err(source.error(path, json, format!("is not a verdict{near}"), names.join(", ")))
}

fn bound(
    column: &RowColumn,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Condition, InputError> {
    let dimension = Dimension::all().find(|known| known.si() == column.unit);
    let allowed = match dimension {
        Some(Dimension::Number) | None => "<, <=, > or >= and a number, as in \"< 0.1\"".to_owned(),
        Some(dimension) => format!(
            "<, <=, > or >= and {} with a unit ({}), as in \"< 25 {}\"",
            dimension.name(),
            dimension.units().join(", "),
            dimension.si()
        ),
    };
    let refuse = |problem: &str| Err(source.error(path, json, problem, allowed.clone()));
    let Json::Text(text) = json else {
        return refuse("does not say on which side the measure must be");
    };
    let text = text.trim();
    let found = COMPARISONS.iter().find_map(|(sign, above, or_equal)| {
        Some((text.strip_prefix(sign)?.trim(), *above, *or_equal))
    });
    let Some((quantity, above, or_equal)) = found else {
        return refuse("does not begin with <, <=, > or >=");
    };
    let plain = quantity.parse::<f64>().ok().filter(|number| number.is_finite());
    let bound = match (dimension, plain) {
        (Some(Dimension::Number) | None, Some(number)) => number,
        (Some(dimension), None) => match units::parse(quantity, dimension) {
            Ok(bound) => bound,
            Err(error) => return refuse(&error.problem),
        },
        (Some(_), Some(_)) => return refuse("has no unit"),
        (None, None) => return refuse("is not a number"),
    };
    Ok(Condition::Bound { bound, above, or_equal })
}

/// Most measures that an error lists.
const MAX_LISTED: usize = 8;

/// The error of a name that is not that of a column that `can` stand there. It names the nearest column, else those that
/// begin with the same word, else `examples`; `problem`: what the name is not.
pub(super) fn unknown(
    [problem, examples]: [&str; 2],
    can: fn(&RowColumn) -> bool,
    name: &str,
    (path, value): (&str, &Json),
    source: &Source,
) -> InputError {
    let known = || COLUMNS.iter().filter(|column| can(column)).map(|column| column.name);
    let near = or_nearest(name, known());
    let first = name.split('_').next();
    let alike: Vec<&str> =
        known().filter(|known| known.split('_').next() == first).take(MAX_LISTED).collect();
    let alike = alike.join(", ");
    let listed = if near.is_empty() && !alike.is_empty() { &alike } else { examples };
    let problem = format!("{problem}{near}");
    source
        .error(path, value, problem, format!("{listed} and other measures"))
        .with_hint("docs/reference/columns.md lists the measures")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::syntax;
    use crate::job::row::ColumnId;

    fn limits(text: &str) -> Result<Vec<ResultLimit>, InputError> {
        read(Some(&syntax::parse(text, "s.json").unwrap()), &Source::new("s.json"))
    }

    #[test]
    fn limits_are_read_with_their_units() {
        let text = r#"{"film_stress_99": "< 100 MPa", "peak_vz": "<= 25 m/s", "verdict": "deployed",
            "volume_ratio": ">0.9", "passages": "< 1", "numerically_damped": false}"#;
        let read = limits(text).unwrap();
        let bound = |bound, above, or_equal| Condition::Bound { bound, above, or_equal };
        let conditions: Vec<&Condition> = read.iter().map(|limit| &limit.condition).collect();
        let expected = [
            bound(1e8, false, false),
            bound(25.0, false, true),
            Condition::Is(Value::Text("deployed".to_owned())),
            bound(0.9, true, false),
            bound(1.0, false, false),
            Condition::Is(Value::Bool(false)),
        ];
        assert_eq!(conditions, expected.iter().collect::<Vec<_>>());
        assert_eq!(read[0].measure, ColumnId::FilmStress99);
    }
}
