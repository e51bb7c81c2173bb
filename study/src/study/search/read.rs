//! Reads `{"bisect": [low, high], "on": …, "tolerance": …, "spacing": …}`, an axis of the grid.

use super::{Criterion, Search, Spacing, Tolerance};
use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind};
use crate::input::settings::{list, read};
use crate::input::source::Source;
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;
use crate::job::row::ColumnId;
use crate::platform::error::InputError;
use crate::platform::nearest::nearest;
use billow_solver::output::measures::Verdict;

/// The member that makes an axis a search.
const BISECT: &str = "bisect";
/// The criterion of the verdict.
pub(super) const VERDICT: &str = "verdict";
/// The criterion of all limits.
pub(super) const SAFE: &str = "safe";
/// Width of the border where the file gives none (chosen).
const DEFAULT_TOLERANCE: &str = "5 %";
/// Smallest relative tolerance. Chosen: far below what a simulation can tell apart.
const MIN_RELATIVE_TOLERANCE: f64 = 1e-6;
/// What a search must look like, for errors.
const ALLOWED: &str = "{\"bisect\": [low, high], \"on\": \"verdict\", \"safe\" or a limit, \"tolerance\": a quantity or \
                       a percentage, \"spacing\": linear or log}";

/// Whether an axis is a search.
pub(in crate::study) fn is_search(json: &Json) -> bool {
    json.get(BISECT).is_some()
}

impl Search {
    /// A value of the key.
    pub fn value(&self, number: f64) -> Value {
        #[expect(clippy::cast_possible_truncation, reason = "whole numbers of a key")]
        if self.integer { Value::Integer(number as i64) } else { Value::Number(number) }
    }
}

/// A search in the file.
pub(in crate::study) struct SearchFile<'a> {
    /// The key along which it runs.
    pub key: &'static Key,
    pub json: &'a Json,
    /// Its place in the file, as in `grid.N`.
    pub path: &'a str,
    pub source: &'a Source,
}

impl SearchFile<'_> {
    pub fn refuse<T>(&self, problem: &str, allowed: &str) -> Result<T, InputError> {
        Err(self.source.error(self.path, &self.json.brief(), problem, allowed))
    }

    /// Reads it as the search along a column of the grid; `limits` are those of the study.
    ///
    /// # Errors
    /// A key without numbers, ends or a tolerance that are not allowed, an unknown criterion.
    pub fn read(&self, column: usize, limits: &[ResultLimit]) -> Result<Search, InputError> {
        let Json::Object(members) = self.json else {
            return self.refuse("is not an object", ALLOWED);
        };
        let known = [BISECT, "on", "tolerance", "spacing"];
        if let Some((name, _)) = members.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            return self.refuse(&format!("`{name}` is not a key of a search"), ALLOWED);
        }
        let integer = match self.key.kind {
            KeyKind::Integer(..) => true,
            KeyKind::Quantity(_) => false,
            _ => return self.refuse("is a search of a key that does not hold numbers", ALLOWED),
        };
        let spacing = match self.json.get("spacing") {
            None => Spacing::Linear,
            Some(Json::Text(text)) if text == "linear" => Spacing::Linear,
            Some(Json::Text(text)) if text == "log" => Spacing::Log,
            Some(_) => return self.refuse("`spacing` is neither \"linear\" nor \"log\"", ALLOWED),
        };
        let ends = self.ends()?;
        if spacing == Spacing::Log && ends[0] <= 0.0 {
            return self.refuse("has logarithmic spacing, so `bisect` must begin above 0", ALLOWED);
        }
        let criterion = self.criterion(limits)?;
        let tolerance = self.tolerance(ends)?;
        let default = || Json::Text(DEFAULT_TOLERANCE.to_owned());
        let written_tolerance = self.json.get("tolerance").cloned().unwrap_or_else(default);
        Ok(Search { column, ends, spacing, criterion, tolerance, written_tolerance, integer })
    }

    fn ends(&self) -> Result<[f64; 2], InputError> {
        let path = format!("{}.{BISECT}", self.path);
        let json = self.json.get(BISECT).unwrap_or(&Json::Null);
        let allowed = "two values, the smaller one first";
        let items = list(json, &path, self.source, allowed)?;
        let [low, high] = items else {
            return self.refuse("`bisect` is not a list of two values", allowed);
        };
        let end = |json: &Json, index: usize| match read(
            self.key,
            json,
            &format!("{path}[{index}]"),
            self.source,
        )? {
            Value::Number(number) if number.is_finite() => Ok(number),
            Value::Integer(number) => Ok(number as f64),
            _ => self.refuse("`bisect` has an end that is not a finite number", allowed),
        };
        let ends = [end(low, 0)?, end(high, 1)?];
        if ends[0] >= ends[1] {
            return self.refuse("`bisect` does not begin below its end", allowed);
        }
        Ok(ends)
    }

    fn criterion(&self, limits: &[ResultLimit]) -> Result<Criterion, InputError> {
        let names = || limits.iter().map(|limit| limit.measure.name());
        let allowed = [VERDICT, SAFE].into_iter().chain(names().filter(|name| *name != VERDICT));
        let allowed = allowed.collect::<Vec<_>>().join(", ");
        let Some(Json::Text(name)) = self.json.get("on") else {
            return self.refuse("has no `on`: what changes at the border", &allowed);
        };
        if name == SAFE {
            if limits.is_empty() {
                return self.refuse(
                    "searches the border of `safe` without limits",
                    "\"limits\" of the study",
                );
            }
            return Ok(Criterion::Safe);
        }
        let current = name;
        if let Some(index) = names().position(|known| known == current) {
            return Ok(Criterion::Limit(index));
        }
        if name == VERDICT {
            return Ok(Criterion::Deployed);
        }
        let near = nearest(name, [VERDICT, SAFE].into_iter().chain(names()));
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
        let problem = if ColumnId::from_name(current).is_some() {
            format!("`on`: {name} has no limit")
        } else {
            format!("`on`: {name} is neither verdict, safe nor a limit of the study{near}")
        };
        self.refuse(&problem, &allowed)
    }

    fn tolerance(&self, ends: [f64; 2]) -> Result<Tolerance, InputError> {
        let dimension = match self.key.kind {
            KeyKind::Quantity(quantity) => quantity.dimension,
            _ => Dimension::Number,
        };
        let refuse = |json: &Json, problem: &str| {
            let width = match dimension {
                Dimension::Number => "a number above 0".to_owned(),
                other => format!("{} above 0 ({})", other.name(), other.units().join(", ")),
            };
            let allowed = format!("a percentage of the border, as in \"5 %\", or {width}");
            Err(self.source.error(
                &format!("{}.tolerance", self.path),
                &json.brief(),
                problem,
                allowed,
            ))
        };
        let default = Json::Text(DEFAULT_TOLERANCE.to_owned());
        let json = self.json.get("tolerance").unwrap_or(&default);
        let tolerance = match json {
            Json::Text(text) if text.trim_end().ends_with('%') => {
                match units::parse(text, Dimension::Number) {
                    Ok(part) => Tolerance::Relative(part),
                    Err(error) => return refuse(json, &error.problem),
                }
            }
            Json::Text(text) => match units::parse(text, dimension) {
                Ok(width) => Tolerance::Absolute(width),
                Err(error) => return refuse(json, &error.problem),
            },
            Json::Number(number) => Tolerance::Absolute(*number),
            Json::Integer(number) => Tolerance::Absolute(*number as f64),
            other => return refuse(other, &format!("is {}, not a quantity", other.kind())),
        };
        let smallest = match tolerance {
            Tolerance::Absolute(_) => MIN_RELATIVE_TOLERANCE * (ends[1] - ends[0]),
            Tolerance::Relative(_) => MIN_RELATIVE_TOLERANCE,
        };
        match tolerance {
            Tolerance::Absolute(width) | Tolerance::Relative(width) if width >= smallest => {
                Ok(tolerance)
            }
            _ => refuse(json, "is not positive, or below a millionth"),
        }
    }
}

/// Whether a row meets a criterion; `None` where nothing can be said.
pub(super) fn meets(
    criterion: Criterion,
    verdict: Option<Verdict>,
    met: &[Option<bool>],
) -> Option<bool> {
    match criterion {
        Criterion::Deployed => verdict.map(|verdict| verdict == Verdict::Deployed),
        Criterion::Limit(index) => met.get(index).copied().flatten(),
        Criterion::Safe if met.contains(&Some(false)) => Some(false),
        Criterion::Safe => met.iter().try_fold(true, |all, met| met.map(|met| all && met)),
    }
}
