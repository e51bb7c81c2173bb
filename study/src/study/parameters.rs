//! The parameters of a study: their names, values and units.

use super::Study;
use super::column;
use crate::input::json::Json;
use crate::input::keys::Key;
use crate::input::source::Source;
use crate::input::units::DisplayUnits;
use crate::input::value::{Value, short_number};
use crate::job::Parameters;
use crate::job::point::Point;

/// A key of a study.
#[derive(Debug, Clone)]
pub struct StudyKey {
    /// Its shortest name: the name of its column where the study varies it.
    pub name: String,
    /// Its row in the table of keys.
    pub key: &'static Key,
    /// Its value outside the grid, SI.
    pub value: Value,
}

/// A parameter that changes together with another one on an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Zipped {
    /// Its name.
    pub name: String,
    /// The steps of the axis: value of the other parameter, value of this one.
    pub steps: Vec<(Value, Value)>,
}

/// Notes on parameters with different values that look the same in a table.
pub(super) fn alike(points: &[Point]) -> Vec<String> {
    let number = |point: &Point, index: usize| match point.job.parameters[index].1 {
        Value::Number(number) => Some(number),
        _ => None,
    };
    let names = points.first().map_or(&[][..], |point| &point.job.parameters).iter();
    let of_parameter = |(index, (name, _)): (usize, &(String, Value))| {
        let mut values: Vec<f64> = points.iter().filter_map(|point| number(point, index)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let pair = values.windows(2).find(|pair| short_number(pair[0]) == short_number(pair[1]))?;
        let (shown, [a, b]) = (short_number(pair[0]), [pair[0], pair[1]]);
        Some(format!("{name} has two values that a table shows as {shown}: {a} and {b}"))
    };
    names.enumerate().filter_map(of_parameter).collect()
}

impl Study {
    /// Names of the varied parameters, in the order of [`crate::job::Job::parameters`].
    pub fn parameter_names(&self) -> Vec<String> {
        self.grid.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// Dotted paths of the varied parameters, in the same order.
    pub fn parameter_paths(&self) -> impl Iterator<Item = &'static str> {
        self.grid.columns.iter().map(|column| column.key.path)
    }

    /// Varied parameters on the same axis as this one, which change together with it.
    pub fn zipped_with(&self, parameter: &str) -> Vec<Zipped> {
        let named = |column: &usize| self.grid.columns[*column].name == parameter;
        let axis = self.grid.axes.iter().find(|axis| axis.columns.iter().any(named));
        let Some(axis) = axis else { return Vec::new() };
        let by = axis.columns.iter().position(named).unwrap_or(0);
        let others = axis.columns.iter().enumerate().filter(|(index, _)| *index != by);
        let zipped = |(index, column): (usize, &usize)| Zipped {
            name: self.grid.columns[*column].name.clone(),
            steps: axis.rows.iter().map(|row| (row[by].clone(), row[index].clone())).collect(),
        };
        others.map(zipped).collect()
    }

    /// Reads a value of a varied parameter as a user writes it on a command line: a number (SI), a
    /// quantity with its unit, a word. `None` when the parameter is unknown, or does not allow the
    /// value.
    pub fn parameter_value(&self, parameter: &str, text: &str) -> Option<Value> {
        let column = self.grid.columns.iter().find(|column| column.name == parameter)?;
        let key = column.key;
        let text = text.trim();
        let number = || {
            let whole = text.parse::<i64>().ok().map(Json::Integer);
            whole.or_else(|| {
                text.parse::<f64>().ok().filter(|number| number.is_finite()).map(Json::Number)
            })
        };
        let flag = || text.parse::<bool>().ok().map(Json::Bool);
        let written = [number(), flag(), Some(Json::Text(text.to_owned()))];
        written.iter().flatten().find_map(|json| key.read(json).ok())
    }

    /// SI unit of a varied parameter: "1" for a pure number, empty for a word.
    pub fn unit(&self, parameter: &str) -> &'static str {
        let column = self.grid.columns.iter().find(|column| column.name == parameter);
        column.map_or("", |column| column.key.unit())
    }

    /// The units in which its parameters and measures are shown: those that the file writes, or asks for
    /// under `units`.
    pub fn display_units(&self) -> &DisplayUnits {
        &self.units
    }

    /// Parameters as text, in these units: "N=5 height=1 m".
    pub fn label(&self, parameters: &Parameters, units: &DisplayUnits) -> String {
        let text = |(name, value): &(String, Value)| {
            format!("{name}={}", units.of(name, self.unit(name)).quantity(value))
        };
        parameters.iter().map(text).collect::<Vec<_>>().join(" ")
    }

    /// A key by its path or its last part; `None` for another name.
    pub fn key(&self, name: &str) -> Option<StudyKey> {
        let source = Source::new("");
        let column = column::find(name, name, &Json::Null, &self.settings, &source).ok()?;
        let (key, value) = (column.key, self.settings.at(column.index).clone());
        Some(StudyKey { name: column.name, key, value })
    }
}
