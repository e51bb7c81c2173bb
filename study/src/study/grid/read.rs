//! Reads the grid: axes (lists of values, ranges, searches, groups of keys that vary together), single points, a
//! filter.

use super::{Axis, AxisKind, Context, Grid};
use crate::input::expression;
use crate::input::json::Json;
use crate::input::keys::{self, KEYS, STUDY, position};
use crate::input::object::{list, members, object};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::platform::error::InputError;
use crate::study::column::{self, Column};
use crate::study::filter::Filter;
use crate::study::search::{Search, is_search};
use crate::study::{OPTIMISE, REPLICATES, SAMPLES, range};

/// What an axis must look like, for errors.
const AXIS: &str = "a list of values; {\"from\", \"to\", and \"steps\" or \"step\", \"spacing\"}; or \
                    {\"bisect\": [low, high], \"on\"}";
/// The key that names a strategy.
const STRATEGY: usize = position(KEYS, "strategy");

impl Grid {
    /// Reads the grid and the replicates of a study file.
    pub fn read(tree: &Json, context: Context<'_>) -> Result<Self, InputError> {
        let mut grid = Self::default();
        let members = match tree.get("grid") {
            Some(json) => object(json, &STUDY, "grid", context.source)?,
            None => &[],
        };
        let mut filter = None;
        let mut points = None;
        for (name, value) in members {
            match name.as_str() {
                "zip" => {
                    let allowed = "a list of objects of lists of equal length";
                    let groups = list(value, "grid.zip", context.source, allowed)?;
                    for (index, group) in groups.iter().enumerate() {
                        grid.read_zip(group, &format!("grid.zip[{index}]"), context)?;
                    }
                }
                // Points and filter may name every column, so they are read last.
                "points" => points = Some(value),
                "filter" => filter = Some(value),
                _ => {
                    let path = format!("grid.{name}");
                    let column = grid.column(name, &path, value, context)?;
                    if is_search(value) {
                        grid.read_search(column, value, &path, context)?;
                        continue;
                    }
                    grid.read_axis(column, value, &path, AxisKind::Values, context)?;
                }
            }
        }
        let optimise = tree.get(OPTIMISE);
        let beside = members.iter().find(|_| optimise.is_some());
        if let Some((name, value)) = beside {
            let allowed = "what varies under optimise.over, words and whole numbers too; replicates and samples repeat \
                           each point";
            let path = format!("grid.{name}");
            return Err(context.source.error(&path, value, "is given beside optimise", allowed));
        }
        grid.read_optimise(optimise, context)?;
        grid.read_samples(tree.get(SAMPLES), context)?;
        grid.read_replicates(tree.get(REPLICATES), context)?;
        grid.read_meshes(tree.get("solver").and_then(|solver| solver.get("meshes")), context)?;
        grid.check_search(context.source)?;
        if let Some(points) = points {
            grid.read_points(points, context)?;
        }
        if let Some(filter) = filter {
            grid.read_filter(filter, context)?;
        }
        Ok(grid)
    }

    /// Reads an axis of one column.
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
    fn read_zip(
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
    fn read_search(
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
    fn check_search(&self, source: &Source) -> Result<(), InputError> {
        let count = self.replicate_count();
        let decides = Proportion { met: count, of: count }.majority().is_some();
        let Some(search) = self.search.as_ref().filter(|_| count > 1 && !decides) else {
            return Ok(());
        };
        let path = format!("grid.{}.bisect", self.columns[search.column].name);
        let problem = format!(
            "{count} replicates are too few to decide a value, as all can end alike by chance: give at least 4"
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

    /// Reads one value of a column.
    pub(in crate::study) fn value_of(
        &self,
        column: usize,
        json: &Json,
        path: &str,
        context: Context<'_>,
    ) -> Result<Value, InputError> {
        value(&self.columns[column], json, path, context)
    }

    /// Reads the single points.
    fn read_points(&mut self, json: &Json, context: Context<'_>) -> Result<(), InputError> {
        let Context { settings, source, .. } = context;
        let allowed = "a list of objects, as in [{\"N\": 6, \"M\": 3}]";
        for (number, point) in list(json, "grid.points", source, allowed)?.iter().enumerate() {
            let path = format!("grid.points[{number}]");
            let mut values: Vec<(usize, Value)> = Vec::new();
            for (name, json) in members(point, &path, source, allowed)? {
                let path = format!("{path}.{name}");
                let found = column::find(name, &path, json, settings, source)?;
                let value = value(&found, json, &path, context)?;
                let known = self.columns.iter().position(|known| *known == found);
                let column = known.unwrap_or_else(|| {
                    self.columns.push(found);
                    self.columns.len() - 1
                });
                if self.is_replicate(column) {
                    let problem = "is a replicate, of which every point has all values";
                    return Err(source.error(&path, json, problem, "keys that are not replicates"));
                }
                if values.iter().any(|(other, _)| *other == column) {
                    let problem = "gives this key twice";
                    return Err(source.error(&path, json, problem, "each key once"));
                }
                values.push((column, value));
            }
            self.points.push(values);
        }
        Ok(())
    }

    /// Reads the condition that the points of the product must meet.
    fn read_filter(&mut self, json: &Json, context: Context<'_>) -> Result<(), InputError> {
        let Context { settings, source, .. } = context;
        let Json::Text(text) = json else {
            let problem = format!("is {}, not a text", json.kind());
            let allowed = "a condition, as in \"N == 6 and feasible\"";
            return Err(source.error("grid.filter", json, problem, allowed));
        };
        let filter = Filter::read(text, &self.columns, settings);
        let filter = filter.map_err(|error| {
            // The problem shows the expression, so the value does not repeat it.
            let problem = error.to_string();
            source.error("grid.filter", "", problem, error.allowed)
        })?;
        if let Some(input) = self.repeated_in(text, |kind| kind == AxisKind::Samples) {
            let problem =
                format!("names {input}, an input that is sampled: every point has all samples");
            let allowed = "a condition on the other keys; \"from\" and \"to\" cut a distribution";
            return Err(source.error("grid.filter", json, problem, allowed));
        }
        let replicate = self.repeated_in(text, AxisKind::repeats);
        if let Some(replicate) = replicate.filter(|_| self.search.is_some()) {
            let problem =
                format!("names {replicate}, a replicate, of which a search needs all values");
            let allowed = "a condition on the other keys";
            return Err(source.error("grid.filter", json, problem, allowed));
        }
        self.filter = Some(filter);
        Ok(())
    }

    /// The first key on an axis of such a kind that a condition names.
    fn repeated_in(&self, condition: &str, is: fn(AxisKind) -> bool) -> Option<String> {
        expression::names(condition).into_iter().find(|name| {
            let named = |column: &usize| keys::find(name) == Some(self.columns[*column].index);
            self.axes.iter().any(|axis| is(axis.kind) && axis.columns.iter().any(named))
        })
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
fn value(
    column: &Column,
    json: &Json,
    path: &str,
    context: Context<'_>,
) -> Result<Value, InputError> {
    let Context { settings, source, .. } = context;
    let value = column.key.value(json, path, source)?;
    if let (STRATEGY, Value::Text(name)) = (column.index, &value) {
        settings.check_strategy(name, path, source)?;
    }
    Ok(value)
}
