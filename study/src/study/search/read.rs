//! Reads `{"bisect": [low, high], "on": …, "tolerance": …, "spacing": …}`, an axis of the grid.

use super::{Criterion, Search, Spacing};
use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind, SEARCH_KEYS};
use crate::input::object::{Object, list};
use crate::input::source::Source;
use crate::job::result_limit::ResultLimit;
use crate::job::row::ColumnId;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// The member that makes an axis a search.
const BISECT: &str = "bisect";
/// The criterion of the verdict.
const VERDICT: &str = "verdict";
/// The criterion of all limits.
const SAFE: &str = "safe";

/// Whether an axis is a search.
pub(in crate::study) fn is_search(json: &Json) -> bool {
    json.get(BISECT).is_some()
}

impl Search {
    /// Reads the search along a key, which is a column of the grid; `limits` are those of the study.
    ///
    /// # Errors
    /// A key without numbers, ends or a tolerance that are not allowed, an unknown criterion.
    pub fn read(
        json: &Json,
        path: &str,
        (column, key): (usize, &Key),
        limits: &[ResultLimit],
        source: &Source,
    ) -> Result<Self, InputError> {
        let object = Object::new(json, path, "a search", SEARCH_KEYS, &[BISECT], source)?;
        let refuse = |problem: &str, allowed: &str| Err(source.error(path, json, problem, allowed));
        let integer = match key.kind {
            KeyKind::Integer(..) => true,
            KeyKind::Quantity(_) => false,
            _ => return refuse("is a search of a key that does not hold numbers", "other keys"),
        };
        let allowed = "two values, the smaller one first";
        let ends_path = format!("{path}.{BISECT}");
        let items = list(json.get(BISECT).unwrap_or(&Json::Null), &ends_path, source, allowed)?;
        let [low, high] = items else {
            return refuse("`bisect` is not a list of two values", allowed);
        };
        let end = |index, json| key.finite(json, &format!("{ends_path}[{index}]"), source);
        let ends = [end(0, low)?, end(1, high)?];
        if ends[0] >= ends[1] {
            return refuse("`bisect` does not begin below its end", allowed);
        }
        let spacing = object.text("spacing")?;
        let spacing =
            if spacing.as_deref() == Some("log") { Spacing::Log } else { Spacing::Linear };
        if spacing == Spacing::Log && ends[0] <= 0.0 {
            return refuse("has logarithmic spacing, so `bisect` must begin above 0", allowed);
        }
        let criterion = criterion(&object, limits)?;
        let tolerance = object.needed("tolerance")?;
        Ok(Self { column, ends, spacing, criterion, tolerance, integer })
    }
}

fn criterion(object: &Object<'_>, limits: &[ResultLimit]) -> Result<Criterion, InputError> {
    let names = || limits.iter().map(|limit| limit.measure.name());
    let name = object.needed_text("on")?;
    let known = || [VERDICT, SAFE].into_iter().chain(names().filter(|name| *name != VERDICT));
    let problem = match name.as_str() {
        SAFE if limits.is_empty() => {
            let problem = "searches the border of `safe` without limits";
            return Err(object.error("on", problem, "\"limits\" of the study"));
        }
        SAFE => return Ok(Criterion::Safe),
        _ if names().any(|known| known == name) => {
            let index = names().position(|known| known == name);
            return Ok(Criterion::Limit(index.unwrap_or_default()));
        }
        VERDICT => return Ok(Criterion::Deployed),
        _ if ColumnId::from_name(&name).is_some() => "has no limit".to_owned(),
        _ => format!(
            "is neither verdict, safe nor a limit of the study{}",
            or_nearest(&name, known())
        ),
    };
    Err(object.error("on", problem, known().collect::<Vec<_>>().join(", ")))
}
