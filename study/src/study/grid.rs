//! The grid of a study: axes (single or zipped), single points, a filter.

use super::Limits;
use super::base::Base;
use super::expand;
use crate::input::expression::Expression;
use crate::input::keys::{self, KEYS, Key, Kind, STRATEGY_KEYS, STUDY, WINDOW_KEYS};
use crate::input::settings::{list, object, read};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// What a study varies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// Every key varied on an axis or by a point, in the order of the file.
    pub columns: Vec<Column>,
    /// The axes; the first varies slowest.
    pub axes: Vec<Axis>,
    /// Single points, after the product: positions in `columns`, values.
    pub points: Vec<Vec<(usize, Value)>>,
    /// Which points stay.
    pub filter: Option<Expression>,
}

/// A varied key.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// The shortest name of the key.
    pub name: String,
    pub target: Target,
}

/// Where the value of a column goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Target {
    /// Position in [`KEYS`].
    Key(usize),
    /// Strategy, position in [`STRATEGY_KEYS`].
    Strategy(String, usize),
    /// Strategy, window, position in [`WINDOW_KEYS`].
    Window(String, usize, usize),
}

impl Target {
    pub fn key(&self) -> &'static Key {
        match self {
            Self::Key(at) => &KEYS[*at],
            Self::Strategy(_, at) => &STRATEGY_KEYS[*at],
            Self::Window(_, _, at) => &WINDOW_KEYS[*at],
        }
    }
}

/// One axis: keys that vary together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// Positions in [`Grid::columns`].
    pub columns: Vec<usize>,
    /// Values, one row a step, one value a column.
    pub rows: Vec<Vec<Value>>,
}

/// What an axis may be, for errors.
const AXIS: &str =
    "a list of values, or {\"from\", \"to\", and \"steps\" or \"step\", \"spacing\"}";

impl Grid {
    pub fn read(
        json: Option<&Json>,
        base: &Base,
        source: &Source,
        limits: Limits,
    ) -> Result<Self, InputError> {
        let mut grid = Self { columns: vec![], axes: vec![], points: vec![], filter: None };
        let Some(json) = json else { return Ok(grid) };
        let mut filter = None;
        let mut points = None;
        for (name, value) in object(json, &STUDY, "grid", source)? {
            match name.as_str() {
                "zip" => {
                    let allowed = "a list of objects of lists of equal length";
                    let groups = list(value, "grid.zip", source, allowed)?;
                    for (at, group) in groups.iter().enumerate() {
                        grid.zip(group, &format!("grid.zip[{at}]"), base, source, limits)?;
                    }
                }
                // Points and filter may use every column, so they are read last.
                "points" => points = Some(value),
                "filter" => filter = Some(value),
                _ => {
                    let at = format!("grid.{name}");
                    let column = grid.column(name, &at, value, base, source)?;
                    let values = grid.values(column, value, &at, base, source, limits)?;
                    let rows = values.into_iter().map(|value| vec![value]).collect();
                    grid.axes.push(Axis { columns: vec![column], rows });
                }
            }
        }
        if let Some(points) = points {
            grid.read_points(points, base, source)?;
        }
        if let Some(filter) = filter {
            grid.filter = Some(grid.read_filter(filter, base, source)?);
        }
        Ok(grid)
    }

    /// Whether nothing varies.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty() && self.filter.is_none()
    }

    fn zip(
        &mut self,
        group: &Json,
        at: &str,
        base: &Base,
        source: &Source,
        limits: Limits,
    ) -> Result<(), InputError> {
        let allowed = "an object of lists of equal length";
        let Json::Object(members) = group else {
            let problem = format!("is {}, not an object", group.kind());
            return Err(source.error(at, &group.brief(), problem, allowed));
        };
        let mut columns = Vec::new();
        let mut lists: Vec<Vec<Value>> = Vec::new();
        for (name, value) in members {
            let at = format!("{at}.{name}");
            let column = self.column(name, &at, value, base, source)?;
            let values = self.values(column, value, &at, base, source, limits)?;
            if let Some(first) = lists.first()
                && first.len() != values.len()
            {
                let problem =
                    format!("has {} values, the first list {}", values.len(), first.len());
                return Err(source.error(&at, &value.brief(), problem, allowed));
            }
            columns.push(column);
            lists.push(values);
        }
        let Some(length) = lists.first().map(Vec::len) else {
            return Err(source.error(at, "{}", "is empty", allowed));
        };
        let rows = (0..length)
            .map(|row| lists.iter().map(|values| values[row].clone()).collect())
            .collect();
        self.axes.push(Axis { columns, rows });
        Ok(())
    }

    /// The column of a key new to the axes.
    fn column(
        &mut self,
        name: &str,
        at: &str,
        value: &Json,
        base: &Base,
        source: &Source,
    ) -> Result<usize, InputError> {
        let (short, target) = target(name, at, value, base, source)?;
        if self.columns.iter().any(|column| column.target == target) {
            let problem = format!("varies {short}, which another axis varies already");
            return Err(source.error(at, &value.brief(), problem, "each key once"));
        }
        self.columns.push(Column { name: short, target });
        Ok(self.columns.len() - 1)
    }

    fn values(
        &self,
        column: usize,
        json: &Json,
        at: &str,
        base: &Base,
        source: &Source,
        limits: Limits,
    ) -> Result<Vec<Value>, InputError> {
        let target = &self.columns[column].target;
        let items = match json {
            Json::List(items) => items,
            Json::Object(members) => {
                if members.iter().any(|(name, _)| name == "bisect") {
                    let problem = "boundary search (`bisect`) is not part of this version";
                    return Err(source.error(at, &json.brief(), problem, AXIS));
                }
                return expand::range(target.key(), members, json, at, source, limits);
            }
            other => {
                let mut error = source.error(
                    at,
                    &other.brief(),
                    format!("is {}, not an axis", other.kind()),
                    AXIS,
                );
                if let Target::Key(key) = target {
                    error.hint = format!("a single value belongs to {}", KEYS[*key].path);
                }
                return Err(error);
            }
        };
        if items.is_empty() {
            return Err(source.error(at, "[]", "is an empty axis", AXIS));
        }
        items
            .iter()
            .enumerate()
            .map(|(number, item)| value(target, item, &format!("{at}[{number}]"), base, source))
            .collect()
    }

    fn read_points(&mut self, json: &Json, base: &Base, source: &Source) -> Result<(), InputError> {
        let allowed = "a list of objects, as in [{\"N\": 6, \"M\": 3}]";
        for (number, point) in list(json, "grid.points", source, allowed)?.iter().enumerate() {
            let at = format!("grid.points[{number}]");
            let Json::Object(members) = point else {
                let problem = format!("is {}, not an object", point.kind());
                return Err(source.error(&at, &point.brief(), problem, allowed));
            };
            let mut values: Vec<(usize, Value)> = Vec::new();
            for (name, json) in members {
                let at = format!("{at}.{name}");
                let (short, target) = target(name, &at, json, base, source)?;
                let value = value(&target, json, &at, base, source)?;
                let known = self.columns.iter().position(|column| column.target == target);
                let column = known.unwrap_or_else(|| {
                    self.columns.push(Column { name: short, target });
                    self.columns.len() - 1
                });
                if values.iter().any(|(other, _)| *other == column) {
                    let problem = "gives this key twice";
                    return Err(source.error(&at, &json.brief(), problem, "each key once"));
                }
                values.push((column, value));
            }
            self.points.push(values);
        }
        Ok(())
    }

    fn read_filter(
        &self,
        json: &Json,
        base: &Base,
        source: &Source,
    ) -> Result<Expression, InputError> {
        let Json::Text(text) = json else {
            let problem = format!("is {}, not a text", json.kind());
            let allowed = "a condition, as in \"N == 6 and feasible\"";
            return Err(source.error("grid.filter", &json.brief(), problem, allowed));
        };
        Expression::condition(text, &expand::variables(self, base)).map_err(|error| {
            // The expression stands above the caret, so it is not repeated as the value.
            let problem = error.to_string();
            source.error("grid.filter", "", problem, error.allowed)
        })
    }
}

/// What the name of an axis means: its shortest name, and where its values go.
fn target(
    name: &str,
    at: &str,
    value: &Json,
    base: &Base,
    source: &Source,
) -> Result<(String, Target), InputError> {
    if let Some(key) = keys::find(name).filter(|key| KEYS[*key].varies()) {
        return Ok((keys::short_name(key).to_owned(), Target::Key(key)));
    }
    let refuse =
        |problem: String, allowed: String| Err(source.error(at, &value.brief(), problem, allowed));
    if let Some(rest) = name.strip_prefix("strategies.") {
        let allowed = "strategies.<name>.release_time, .preinflation_mass, .inflow[0].rate, …";
        let parts: Vec<&str> = rest.split('.').collect();
        let Some(strategy) = parts.first().and_then(|part| base.strategies.get(*part)) else {
            base.check_strategy(parts.first().unwrap_or(&""), at, source)?;
            return refuse("is no key of a strategy".to_owned(), allowed.to_owned());
        };
        let found = match parts[1..] {
            [leaf] => STRATEGY_KEYS
                .iter()
                .position(|key| key.path == leaf)
                .map(|key| Target::Strategy(parts[0].to_owned(), key)),
            [window, leaf] => window
                .strip_prefix("inflow[")
                .and_then(|index| index.strip_suffix(']')?.parse::<usize>().ok())
                .filter(|index| *index < strategy.inflow.len())
                .zip(WINDOW_KEYS.iter().position(|key| key.path == leaf))
                .map(|(index, key)| Target::Window(parts[0].to_owned(), index, key)),
            _ => None,
        };
        return match found {
            Some(Target::Window(strategy, index, key)) => {
                let name =
                    format!("strategies.{strategy}.inflow[{index}].{}", WINDOW_KEYS[key].path);
                Ok((name, Target::Window(strategy, index, key)))
            }
            Some(target) => Ok((name.to_owned(), target)),
            None => refuse("is no key of that strategy".to_owned(), allowed.to_owned()),
        };
    }
    let known = || {
        let varied = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
        varied.flat_map(|(at, key)| [keys::short_name(at), key.path])
    };
    let near = keys::nearest(name, known().chain(["zip", "points", "filter"]));
    let near = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
    let twins: Vec<&str> =
        KEYS.iter().filter(|key| key.leaf() == name).map(|key| key.path).collect();
    if twins.len() > 1 {
        return refuse("is the name of several keys".to_owned(), twins.join(", "));
    }
    let allowed = "keys of the study, as N or film.thickness; zip, points, filter".to_owned();
    refuse(format!("is no key a grid can vary{near}"), allowed)
}

/// One value of a column.
fn value(
    target: &Target,
    json: &Json,
    at: &str,
    base: &Base,
    source: &Source,
) -> Result<Value, InputError> {
    let key = target.key();
    let value = read(key, json, at, source)?;
    if let (Target::Key(_), Kind::Text, Value::Text(name)) = (target, key.kind, &value)
        && key.path == "strategy"
    {
        base.check_strategy(name, at, source)?;
    }
    Ok(value)
}
