//! One axis of a grid: a list of values, a range, or a group of keys that vary together.

use super::{Axis, AxisKind, Context, Grid};
use crate::input::json::Json;
use crate::input::keys::{KEYS, position};
use crate::input::object::{members, read};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::platform::error::InputError;
use crate::study::column::{self, Column};
use crate::study::range;
use crate::study::search::{Search, is_search};

/// What an axis must look like, for errors.
const AXIS: &str = "a list of values; {\"from\", \"to\", and \"steps\" or \"step\", \"spacing\"}; or \
                    {\"bisect\": [low, high], \"on\"}";
/// The key that names a strategy.
const STRATEGY: usize = position(KEYS, "strategy");

impl Grid {
    pub(in crate::study) fn read_axis(
        &mut self,
        column: usize,
        json: &Json,
        path: &str,
        kind: AxisKind,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let values = self.values(column, json, path, context)?;
        let rows = values.into_iter().map(|value| vec![value]).collect();
        self.axes.push(Axis { columns: vec![column], rows, kind });
        Ok(())
    }

    /// Reads a group of keys that vary together.
    pub(super) fn read_zip(
        &mut self,
        group: &Json,
        path: &str,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let allowed = "an object of lists of equal length";
        let members = members(group, path, context.source, allowed)?;
        let mut columns = Vec::new();
        let mut lists: Vec<Vec<Value>> = Vec::new();
        for (name, value) in members {
            let path = format!("{path}.{name}");
            let column = self.column(name, &path, value, context)?;
            if let (true, [_]) = (is_search(value), members) {
                return self.read_search(column, value, &path, context);
            }
            let values = self.values(column, value, &path, context)?;
            if let Some(first) = lists.first()
                && first.len() != values.len()
            {
                let problem =
                    format!("has {} values, the first list {}", values.len(), first.len());
                return Err(context.source.error(&path, value, problem, allowed));
            }
            columns.push(column);
            lists.push(values);
        }
        let Some(length) = lists.first().map(Vec::len) else {
            return Err(context.source.error(path, "{}", "is empty", allowed));
        };
        let rows = (0..length)
            .map(|row| lists.iter().map(|values| values[row].clone()).collect())
            .collect();
        self.axes.push(Axis { columns, rows, kind: AxisKind::Values });
        Ok(())
    }

    /// Reads a search as an axis of this column.
    pub(super) fn read_search(
        &mut self,
        column: usize,
        json: &Json,
        path: &str,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Context { source, limits, .. } = context;
        if self.search.is_some() {
            let allowed = "one search in a study; the other axes as lists";
            return Err(source.error(path, json, "is a second search", allowed));
        }
        let key = self.columns[column].key;
        let search = Search::read(json, path, (column, key), limits, source)?;
        let rows = search.scan().into_iter().map(|number| vec![search.value(number)]).collect();
        self.axes.push(Axis { columns: vec![column], rows, kind: AxisKind::Search });
        self.search = Some(search);
        Ok(())
    }

    /// Refuses a search whose replicates can never decide.
    pub(super) fn check_search(&self, source: &Source) -> Result<(), InputError> {
        let count = self.replicate_count();
        let decides = Proportion { met: count, of: count }.majority().is_some();
        let Some(search) = self.search.as_ref().filter(|_| count > 1 && !decides) else {
            return Ok(());
        };
        let path = format!("grid.{}.bisect", self.columns[search.column].name);
        let problem = format!(
            "{count} replicates can never exclude one half: their Wilson interval is too wide"
        );
        Err(source
            .error(&path, "", problem, "no replicates, or 4 and more")
            .with_hint("give \"replicates\": {\"seed\": 5}"))
    }

    /// Adds the column of a key; refuses a key that another axis varies.
    pub(in crate::study) fn column(
        &mut self,
        name: &str,
        path: &str,
        value: &Json,
        context: Context<'_>,
    ) -> Result<usize, InputError> {
        let Context { settings, source, .. } = context;
        let column = column::find(name, path, value, settings, source)?;
        if self.columns.contains(&column) {
            let problem = format!("varies {}, which another axis varies already", column.name);
            return Err(source.error(path, value, problem, "each key once"));
        }
        self.columns.push(column);
        Ok(self.columns.len() - 1)
    }

    /// The values of an axis of one column: those of a list or of a range.
    fn values(
        &self,
        column: usize,
        json: &Json,
        path: &str,
        context: Context<'_>,
    ) -> Result<Vec<Value>, InputError> {
        let Context { source, max_points, .. } = context;
        let column = &self.columns[column];
        let items = match json {
            Json::List(items) => items,
            Json::Object(_) => {
                if is_search(json) {
                    let problem = "is a search, which cannot vary together with another key";
                    return Err(source.error(path, json, problem, "an axis of its key alone"));
                }
                return range::values(column.key, json, path, source, max_points);
            }
            other => {
                let mut error =
                    source.error(path, other, format!("is {}, not an axis", other.kind()), AXIS);
                if let Some(key) = KEYS.get(column.index) {
                    error.hint = format!("a single value belongs to {}", key.path);
                }
                return Err(error);
            }
        };
        if items.is_empty() {
            return Err(source.error(path, "[]", "is an empty axis", AXIS));
        }
        items
            .iter()
            .enumerate()
            .map(|(number, item)| value(column, item, &format!("{path}[{number}]"), context))
            .collect()
    }
}

/// Reads one value of a column.
pub(super) fn value(
    column: &Column,
    json: &Json,
    path: &str,
    context: Context<'_>,
) -> Result<Value, InputError> {
    let Context { settings, source, .. } = context;
    let value = read(column.key, json, path, source)?;
    if let (STRATEGY, Value::Text(name)) = (column.index, &value) {
        settings.check_strategy(name, path, source)?;
    }
    Ok(value)
}
