//! One row per pair.

use std::io::Write;

use super::Comparison;
use crate::analysis::compare::{self, Compared, Measure, Pair};
use crate::cli::print::{Heading, print_quantities};
use crate::cli::{Format, range};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::platform::error::Result;

/// The figures of a proportion for programs: k, n, and its interval.
const PROPORTION: [&str; 4] = ["deployed", "deployed_of", "deployed_low", "deployed_high"];

impl Comparison<'_> {
    /// Prints one row per pair. A table has fewer columns than csv and json.
    pub(super) fn print_pairs(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let brief = format == Format::Table;
        let all_done = self.pairs.iter().all(|pair| {
            [pair.base, pair.other].iter().all(|row| self.table.status(*row) == Some(Status::Done))
        });
        let outcome: &[&str] = match (brief, all_done, self.points.is_some()) {
            (true, true, _) => &[],
            (true, false, _) => &["status"],
            (false, _, false) => &["job", "status", "verdict"],
            (false, _, true) => &["status", "verdict"],
        };
        let proportions = self.proportions(brief);
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let mut columns: Vec<Heading> = parameters
            .map(|name| {
                let shown = self.table.column(name).map(|column| column.shown.clone());
                Heading { name: name.clone(), unit: shown.unwrap_or_else(|| DisplayUnit::si("")) }
            })
            .collect();
        let sides = |name: &&str| [format!("base_{name}"), format!("other_{name}")];
        columns.extend(outcome.iter().chain(proportions).flat_map(sides).map(Heading::plain));
        for measure in &self.measures {
            let shown = &measure.column.shown;
            columns.extend(self.figures(measure, brief).iter().map(|figure| Heading {
                name: format!("{}_{figure}", measure.column.name),
                unit: match *figure {
                    "difference" => shown.of_difference(),
                    "ratio" | "better" => DisplayUnit::si(""),
                    _ => shown.clone(),
                },
            }));
        }
        let rows: Vec<Vec<Value>> =
            self.pairs.iter().map(|pair| self.row(*pair, outcome, proportions, brief)).collect();
        print_quantities(&columns, &rows, format, out)
    }

    /// The proportions of the runs of each side. A table has them if a run has a verdict.
    fn proportions(&self, brief: bool) -> &'static [&'static str] {
        let Some(points) = &self.points else { return &[] };
        let has_verdicts = points.condensed.runs.iter().any(|runs| runs.deployed.of > 0);
        match (brief, has_verdicts) {
            (true, false) => &[],
            (true, true) => &PROPORTION[..1],
            (false, _) => &PROPORTION,
        }
    }

    /// The figures of a measure. A table has the ratio, or the difference of a signed measure, and the range
    /// of the runs of a point in the cell of the median.
    fn figures(&self, measure: &Measure<'_>, brief: bool) -> &'static [&'static str] {
        match (brief, measure.is_signed(), self.points.is_some()) {
            (true, false, _) => &["base", "other", "ratio", "better"],
            (true, true, _) => &["base", "other", "difference", "better"],
            (false, _, false) => &["base", "other", "difference", "ratio", "better"],
            (false, _, true) => &[
                "base",
                "base_least",
                "base_largest",
                "other",
                "other_least",
                "other_largest",
                "difference",
                "ratio",
                "better",
            ],
        }
    }

    fn row(&self, pair: Pair, outcome: &[&str], proportions: &[&str], brief: bool) -> Vec<Value> {
        let cell = |name: &str, row: usize| {
            self.table.column(name).map_or(Value::Null, |column| column.cells[row].clone())
        };
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let mut row: Vec<Value> = parameters.map(|name| cell(name, pair.other)).collect();
        for name in outcome {
            row.extend([cell(name, pair.base), cell(name, pair.other)]);
        }
        for figure in proportions {
            row.extend([pair.base, pair.other].map(|row| self.proportion(figure, row, brief)));
        }
        let number = |number: Option<f64>| number.map_or(Value::Null, Value::Number);
        for measure in &self.measures {
            let compared = compare::compared(self.table, pair, measure);
            let spread = |row| self.points.as_ref()?.spread(&measure.column.name, row);
            let sides = [spread(pair.base), spread(pair.other)];
            row.extend(self.figures(measure, brief).iter().map(|figure| match *figure {
                "base" => self.value(measure, pair.base, compared.base, brief),
                "other" => self.value(measure, pair.other, compared.other, brief),
                "base_least" => number(sides[0].map(|spread| spread.least)),
                "base_largest" => number(sides[0].map(|spread| spread.largest)),
                "other_least" => number(sides[1].map(|spread| spread.least)),
                "other_largest" => number(sides[1].map(|spread| spread.largest)),
                "difference" => number(Compared::difference(&compared)),
                "ratio" => number(compared.ratio()),
                _ => Value::Text(compared.better.name().to_owned()),
            }));
        }
        row
    }

    /// A value of a pair; for a reader with the range of its runs, and with its mesh error.
    fn value(&self, measure: &Measure<'_>, row: usize, value: Option<f64>, brief: bool) -> Value {
        let Some(value) = value else { return Value::Null };
        if !brief {
            return Value::Number(value);
        }
        if let Some(points) = &self.points
            && let Some(column) = points.table.column(&measure.column.name)
        {
            return points.range(column, row).unwrap_or(Value::Number(value));
        }
        let error = measure.errors.and_then(|errors| compare::measured(self.table, errors, row));
        match error {
            Some(error) => Value::Text(range::with_error(value, error, &measure.column.shown)),
            None => Value::Number(value),
        }
    }

    /// One figure of the proportion of the runs of a point that deployed.
    fn proportion(&self, figure: &str, row: usize, brief: bool) -> Value {
        let Some(points) = &self.points else { return Value::Null };
        let proportion = points.condensed.runs[row].deployed;
        if brief {
            return match proportion {
                Proportion { of: 0, .. } => Value::Null,
                proportion => Value::Text(proportion.to_string()),
            };
        }
        let column = points.table.column(figure);
        column.map_or(Value::Null, |column| column.cells[row].clone())
    }
}
