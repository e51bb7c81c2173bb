//! The grid of a study: axes (single or zipped), single points, a filter.

use super::REPLICATES;
use super::base::Base;
use super::plan_size::PlanSize;
use super::range::RangeInput;
use super::search::{Search, is_search};
use super::target::{self, Column, Target};
use super::variables::variables;
use crate::input::expression::Expression;
use crate::input::keys::{KEYS, STUDY, position};
use crate::input::settings::{list, object, read};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::value::{Value, json_value};
use crate::job::result_limit::ResultLimit;
use crate::platform::error::InputError;

/// What a study varies.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Grid {
    /// Every key varied on an axis or by a point, in the order of the file.
    pub columns: Vec<Column>,
    /// The axes; the first varies slowest.
    pub axes: Vec<Axis>,
    /// Single points, after the product: positions in `columns`, and values.
    pub points: Vec<Vec<(usize, Value)>>,
    /// Which points the study keeps.
    pub filter: Option<Expression>,
    /// The search of a border along one of the axes.
    pub search: Option<Search>,
    /// Names of the measures with a limit.
    limit_names: Vec<String>,
}

/// One axis: keys that vary together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// Positions in [`Grid::columns`].
    pub columns: Vec<usize>,
    /// Values: one row for each step of the axis, one value for each column.
    pub rows: Vec<Vec<Value>>,
    /// What its values are.
    pub kind: AxisKind,
}

/// What the values of an axis are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisKind {
    /// Those of the file.
    Values,
    /// Those with which a search begins.
    Search,
    /// Repetitions of each point.
    Replicates,
}

/// What an axis must look like, for errors.
const AXIS: &str = "a list of values; {\"from\", \"to\", and \"steps\" or \"step\", \"spacing\"}; or \
                    {\"bisect\": [low, high], \"on\"}";

impl Grid {
    /// Reads the grid and the replicates of a study file.
    pub fn read(
        tree: &Json,
        base: &Base,
        limits: &[ResultLimit],
        source: &Source,
        size: PlanSize,
    ) -> Result<Self, InputError> {
        let limit_names = limits.iter().map(|limit| limit.measure.name().to_owned()).collect();
        let mut grid = Self { limit_names, ..Self::default() };
        let members = match tree.get("grid") {
            Some(json) => object(json, &STUDY, "grid", source)?,
            None => &[],
        };
        let mut filter = None;
        let mut points = None;
        for (name, value) in members {
            match name.as_str() {
                "zip" => {
                    let allowed = "a list of objects of lists of equal length";
                    let groups = list(value, "grid.zip", source, allowed)?;
                    for (index, group) in groups.iter().enumerate() {
                        let path = format!("grid.zip[{index}]");
                        grid.zip(group, &path, base, limits, source, size)?;
                    }
                }
                // Points and filter may name every column, so they are read last.
                "points" => points = Some(value),
                "filter" => filter = Some(value),
                _ => {
                    let path = format!("grid.{name}");
                    let column = grid.column(name, &path, value, base, source)?;
                    if is_search(value) {
                        grid.read_search(column, value, &path, limits, source)?;
                        continue;
                    }
                    let values = grid.values(column, value, &path, base, source, size)?;
                    let rows = values.into_iter().map(|value| vec![value]).collect();
                    let kind = AxisKind::Values;
                    grid.axes.push(Axis { columns: vec![column], rows, kind });
                }
            }
        }
        grid.read_replicates(tree.get(REPLICATES), base, source, size)?;
        grid.check_search(source)?;
        if let Some(points) = points {
            grid.read_points(points, base, source)?;
        }
        if let Some(filter) = filter {
            grid.filter = Some(grid.read_filter(filter, base, source)?);
        }
        Ok(grid)
    }

    /// Number of single points, without replicates.
    pub fn single_points(&self) -> usize {
        let Some(search) = &self.search else { return self.points.len() };
        let gives =
            |point: &&Vec<(usize, Value)>| point.iter().any(|(column, _)| *column == search.column);
        let given = self.points.iter().filter(gives).count();
        given + (self.points.len() - given) * search.scan().len()
    }

    /// The replicates as JSON; empty without any.
    pub fn resolved_replicates(&self) -> Vec<(String, Json)> {
        let member = |axis: &Axis| {
            let values = axis.rows.iter().map(|row| Json::from(json_value(&row[0]))).collect();
            (self.columns[axis.columns[0]].name.clone(), Json::List(values))
        };
        self.replicates().map(member).collect()
    }

    /// The grid as JSON: each axis is a group of `zip`, since a list keeps the order of the axes and an
    /// object may not.
    pub fn resolved(&self) -> Json {
        let name = |column: usize| self.columns[column].name.clone();
        let json = |value: &Value| Json::from(json_value(value));
        let mut grid = Vec::new();
        let grouped: Vec<&Axis> =
            self.axes.iter().filter(|axis| axis.kind != AxisKind::Replicates).collect();
        let groups = grouped.iter().map(|axis| {
            if let (AxisKind::Search, Some(search)) = (axis.kind, &self.search) {
                let json = search.to_json(&|limit| self.limit_names[limit].clone());
                return Json::Object(vec![(name(axis.columns[0]), json)]);
            }
            let columns = axis.columns.iter().enumerate().map(|(index, column)| {
                let values = axis.rows.iter().map(|row| json(&row[index])).collect();
                (name(*column), Json::List(values))
            });
            Json::Object(columns.collect())
        });
        if !grouped.is_empty() {
            grid.push(("zip".to_owned(), Json::List(groups.collect())));
        }
        let points = self.points.iter().map(|point| {
            let members = point.iter().map(|(column, value)| (name(*column), json(value)));
            Json::Object(members.collect())
        });
        if !self.points.is_empty() {
            grid.push(("points".to_owned(), Json::List(points.collect())));
        }
        if let Some(filter) = &self.filter {
            grid.push(("filter".to_owned(), Json::Text(filter.text().to_owned())));
        }
        Json::Object(grid)
    }

    fn zip(
        &mut self,
        group: &Json,
        path: &str,
        base: &Base,
        limits: &[ResultLimit],
        source: &Source,
        size: PlanSize,
    ) -> Result<(), InputError> {
        let allowed = "an object of lists of equal length";
        let Json::Object(members) = group else {
            let problem = format!("is {}, not an object", group.kind());
            return Err(source.error(path, &group.brief(), problem, allowed));
        };
        let mut columns = Vec::new();
        let mut lists: Vec<Vec<Value>> = Vec::new();
        for (name, value) in members {
            let path = format!("{path}.{name}");
            let column = self.column(name, &path, value, base, source)?;
            if let (true, [_]) = (is_search(value), members.as_slice()) {
                return self.read_search(column, value, &path, limits, source);
            }
            let values = self.values(column, value, &path, base, source, size)?;
            if let Some(first) = lists.first()
                && first.len() != values.len()
            {
                let problem =
                    format!("has {} values, the first list {}", values.len(), first.len());
                return Err(source.error(&path, &value.brief(), problem, allowed));
            }
            columns.push(column);
            lists.push(values);
        }
        let Some(length) = lists.first().map(Vec::len) else {
            return Err(source.error(path, "{}", "is empty", allowed));
        };
        let rows = (0..length)
            .map(|row| lists.iter().map(|values| values[row].clone()).collect())
            .collect();
        self.axes.push(Axis { columns, rows, kind: AxisKind::Values });
        Ok(())
    }

    /// Adds the column of a key; refuses a key that another axis varies.
    pub(super) fn column(
        &mut self,
        name: &str,
        path: &str,
        value: &Json,
        base: &Base,
        source: &Source,
    ) -> Result<usize, InputError> {
        let column = target::find(name, path, value, base, source)?;
        if self.columns.iter().any(|known| known.target == column.target) {
            let problem = format!("varies {}, which another axis varies already", column.name);
            return Err(source.error(path, &value.brief(), problem, "each key once"));
        }
        self.columns.push(column);
        Ok(self.columns.len() - 1)
    }

    pub(super) fn values(
        &self,
        column: usize,
        json: &Json,
        path: &str,
        base: &Base,
        source: &Source,
        size: PlanSize,
    ) -> Result<Vec<Value>, InputError> {
        let target = &self.columns[column].target;
        let items = match json {
            Json::List(items) => items,
            Json::Object(members) => {
                if is_search(json) {
                    let problem = "is a search, which cannot vary together with another key";
                    return Err(source.error(
                        path,
                        &json.brief(),
                        problem,
                        "an axis of its key alone",
                    ));
                }
                let key = target.key();
                return RangeInput { key, members, json, path, source }.values(size);
            }
            other => {
                let mut error = source.error(
                    path,
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
            return Err(source.error(path, "[]", "is an empty axis", AXIS));
        }
        items
            .iter()
            .enumerate()
            .map(|(number, item)| value(target, item, &format!("{path}[{number}]"), base, source))
            .collect()
    }

    fn read_points(&mut self, json: &Json, base: &Base, source: &Source) -> Result<(), InputError> {
        let allowed = "a list of objects, as in [{\"N\": 6, \"M\": 3}]";
        for (number, point) in list(json, "grid.points", source, allowed)?.iter().enumerate() {
            let path = format!("grid.points[{number}]");
            let Json::Object(members) = point else {
                let problem = format!("is {}, not an object", point.kind());
                return Err(source.error(&path, &point.brief(), problem, allowed));
            };
            let mut values: Vec<(usize, Value)> = Vec::new();
            for (name, json) in members {
                let path = format!("{path}.{name}");
                let found = target::find(name, &path, json, base, source)?;
                let value = value(&found.target, json, &path, base, source)?;
                let known = self.columns.iter().position(|known| known.target == found.target);
                let column = known.unwrap_or_else(|| {
                    self.columns.push(found);
                    self.columns.len() - 1
                });
                if self.is_replicate(column) {
                    let problem = "is a replicate, of which every point has all values";
                    return Err(source.error(
                        &path,
                        &json.brief(),
                        problem,
                        "keys that are not replicates",
                    ));
                }
                if values.iter().any(|(other, _)| *other == column) {
                    let problem = "gives this key twice";
                    return Err(source.error(&path, &json.brief(), problem, "each key once"));
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
        Expression::condition(text, &variables(&self.columns, base)).map_err(|error| {
            // The problem shows the expression, so the value does not repeat it.
            let problem = error.to_string();
            source.error("grid.filter", "", problem, error.allowed)
        })
    }
}

/// The key that names a strategy.
const STRATEGY: usize = position(KEYS, "strategy");

/// Reads one value of a column.
fn value(
    target: &Target,
    json: &Json,
    path: &str,
    base: &Base,
    source: &Source,
) -> Result<Value, InputError> {
    let key = target.key();
    let value = read(key, json, path, source)?;
    if let (Target::Key(STRATEGY), Value::Text(name)) = (target, &value) {
        base.check_strategy(name, path, source)?;
    }
    Ok(value)
}

/// Refuses an override of a key that the grid varies: it has no effect.
pub(super) fn refuse_varied(grid: &Grid, source: &Source) -> Result<(), InputError> {
    for (path, _) in &source.sets {
        let varied = grid.columns.iter().enumerate().find(|(index, column)| {
            let on_axis = grid.axes.iter().any(|axis| axis.columns.contains(index));
            on_axis && matches!(column.target, Target::Key(key) if KEYS[key].path == path)
        });
        if let Some((index, column)) = varied {
            let name = &column.name;
            if grid.is_replicate(index) {
                let problem = "the study repeats each point with values of this key, so the override has no effect";
                let allowed = format!("--set 'replicates.{name}=[…]'");
                return Err(source.error(path, "", problem, allowed));
            }
            return Err(source.error(
                path,
                "",
                "the grid varies this key together with others (zip), so the override has no effect",
                format!("--set 'grid.zip=[{{\"{name}\": […], …}}]'"),
            ));
        }
    }
    Ok(())
}
