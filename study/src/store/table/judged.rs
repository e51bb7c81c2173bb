//! Columns that follow from the others: margins of the limits of the study, and the numerical choices on
//! which a verdict depends.

use std::collections::{BTreeMap, BTreeSet};

use super::extrapolated::names;
use super::{Column, Table};
use crate::accuracy::promised::promise;
use crate::accuracy::row::uncertainty;
use crate::accuracy::{NO_ERROR_REASON, PROMISED};
use crate::input::keys::numerical::is_numerical;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::result_limit::{AllJudged, Judged, ResultLimit, Safety};
use crate::job::row::{CellType, ColumnId, DerivedColumn, SAME_JOB_AS};

impl Table {
    /// The table with the columns of these limits (extrapolated values count, where there are any), and with
    /// `verdict_depends_on` where the study varies a numerical choice.
    #[must_use]
    pub fn judged(mut self, limits: &[ResultLimit]) -> Self {
        let mut new = Vec::new();
        if !limits.is_empty() {
            let safety: Vec<Option<AllJudged>> =
                (0..self.rows()).map(|row| self.all_judged(limits, row)).collect();
            let cells = |of: fn(&AllJudged, &[ResultLimit]) -> Value| {
                safety
                    .iter()
                    .map(|row| row.as_ref().map_or(Value::Null, |row| of(row, limits)))
                    .collect()
            };
            new.push(derived(DerivedColumn::Safety, cells(|row, _| row.safety.into())));
            let smallest = cells(|row, _| Value::Number(row.smallest_margin));
            new.push(derived(DerivedColumn::SmallestMargin, smallest));
            let name =
                cells(|row, limits| Value::Text(limits[row.limit].measure.name().to_owned()));
            new.push(derived(DerivedColumn::SmallestMarginOf, name));
            new.extend(limits.iter().map(|limit| self.margins(limit)));
        }
        let numerical = self.numerical_parameters();
        if !numerical.is_empty() {
            new.push(derived(DerivedColumn::VerdictDependsOn, self.verdict_depends_on(&numerical)));
        }
        let last = self.columns.iter().position(|column| column.name == SAME_JOB_AS);
        let last = last.unwrap_or(self.columns.len());
        self.columns.splice(last..last, new);
        self
    }

    /// All limits of a row.
    fn all_judged(&self, limits: &[ResultLimit], row: usize) -> Option<AllJudged> {
        let value = |column| self.estimate(column, row).unwrap_or(&Value::Null);
        AllJudged::of(limits, self.status(row)?, value, |measure| self.uncertainty(measure, row))
    }

    /// What a limit says of a row.
    pub fn judge(&self, limit: &ResultLimit, row: usize) -> Option<Judged> {
        let value = self.estimate(limit.measure, row).unwrap_or(&Value::Null);
        limit.judge(self.status(row)?, value, self.uncertainty(limit.measure, row))
    }

    /// What the column `safety` says of a row.
    pub fn safety(&self, row: usize) -> Option<Safety> {
        Safety::of_cell(&self.column(DerivedColumn::Safety.name())?.cells[row])
    }

    /// Mesh error of the value that a row stands for, below and above it, and its change over the ranges of the assumed
    /// values likewise, SI.
    pub fn error_parts(&self, measure: ColumnId, row: usize) -> [Option<[f64; 2]>; 2] {
        let number = |name: &str| match self.column(name)?.cells[row] {
            Value::Number(number) => Some(number),
            _ => None,
        };
        let Some(promised) = promise(measure.name()) else { return [None; 2] };
        let [value, below, above] = names(measure.name());
        let [below, above] = if number(&value).is_some() {
            [number(&below), number(&above)]
        } else {
            promised.error_columns.map(number)
        };
        let [less, more] = promised.assumed_columns.map(number);
        [below.zip(above), less.zip(more)].map(|sides| sides.map(<[f64; 2]>::from))
    }

    /// Uncertainty of the value that a row stands for, SI, below and above it; `None` where it is not known.
    pub fn uncertainty(&self, measure: ColumnId, row: usize) -> Option<[f64; 2]> {
        let near = self.value(ColumnId::NearThreshold, row) == Some(&Value::Bool(true));
        let reason = self.column(NO_ERROR_REASON).map(|column| &column.cells[row]);
        let reason = match reason {
            Some(Value::Text(reason)) => Some(reason.as_str()),
            _ => None,
        };
        uncertainty(measure, near, reason, |index| self.error_parts(PROMISED[index].measure, row))
    }

    /// The margins of one limit.
    fn margins(&self, limit: &ResultLimit) -> Column {
        let margin = |row| Some(Value::Number(self.judge(limit, row)?.margin));
        let cells = (0..self.rows()).map(|row| margin(row).unwrap_or(Value::Null)).collect();
        Column::new(limit.column_name(), (CellType::Number, "1"), limit.margin_meaning(), cells)
    }

    /// The parameters that are numerical choices.
    fn numerical_parameters(&self) -> Vec<usize> {
        let parameters = self.parameters().enumerate();
        parameters
            .filter(|(_, column)| is_numerical(&column.name))
            .map(|(index, _)| index)
            .collect()
    }

    /// The numerical parameters on which the verdict of each row depends: with all other parameters equal,
    /// another value gives another verdict.
    fn verdict_depends_on(&self, numerical: &[usize]) -> Vec<Value> {
        let parameters: Vec<&Column> = self.parameters().collect();
        let names = |which: &[usize]| {
            let names: Vec<&str> =
                which.iter().map(|index| parameters[*index].name.as_str()).collect();
            Value::Text(names.join(", "))
        };
        let alone: Vec<Vec<bool>> =
            numerical.iter().map(|one| self.has_other_verdicts(&parameters, &[*one])).collect();
        let together = self.has_other_verdicts(&parameters, numerical);
        let cell = |row: usize| {
            if self.verdict(row).is_none() || !together[row] {
                return Value::Null;
            }
            let of_row = numerical.iter().zip(&alone).filter(|(_, depends)| depends[row]);
            let of_row: Vec<usize> = of_row.map(|(index, _)| *index).collect();
            // No single one changes it: they do together.
            names(if of_row.is_empty() { numerical } else { &of_row })
        };
        (0..self.rows()).map(cell).collect()
    }

    /// For each row whether the rows that differ in these parameters alone have more than one verdict.
    fn has_other_verdicts(&self, parameters: &[&Column], free: &[usize]) -> Vec<bool> {
        let key = |row: usize| -> Vec<String> {
            let fixed = parameters.iter().enumerate().filter(|(index, _)| !free.contains(index));
            fixed.map(|(_, column)| column.cells[row].to_string()).collect()
        };
        let mut verdicts: BTreeMap<Vec<String>, BTreeSet<&'static str>> = BTreeMap::new();
        let keys: Vec<Vec<String>> = (0..self.rows()).map(key).collect();
        for (row, key) in keys.iter().enumerate() {
            if let (Some(verdict), Some(Status::Done)) = (self.verdict(row), self.status(row)) {
                verdicts.entry(key.clone()).or_default().insert(verdict.name());
            }
        }
        keys.iter().map(|key| verdicts.get(key).is_some_and(|known| known.len() > 1)).collect()
    }
}

/// A derived column with these cells.
fn derived(column: DerivedColumn, cells: Vec<Value>) -> Column {
    let row = column.row();
    Column::new(row.name, (row.cell_type, row.unit), row.meaning, cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::AssumedRanges;
    use crate::analysis::fixture::with_error;
    use crate::job::point::Point;
    use crate::job::result_limit::Condition;
    use crate::job::row::Cells;
    use crate::job::{Job, JobId};
    use crate::run::fixture;
    use crate::store::journal::Record;

    /// Two designs, three seeds each, with these verdicts and speeds.
    fn table(verdicts: [&str; 6], speeds: [f64; 6]) -> Table {
        let mut points: Vec<Point> = fixture::points(6);
        let mut records = BTreeMap::new();
        for (index, point) in points.iter_mut().enumerate() {
            let number = |value: usize| Value::Integer(i64::try_from(value).unwrap());
            let parameters =
                vec![("N".to_owned(), number(index / 3)), ("seed".to_owned(), number(index % 3))];
            point.job = Job { parameters: parameters.into(), ..point.job.clone() };
            let mut cells = Cells::new(Status::Done);
            cells.set(ColumnId::Verdict, verdicts[index]);
            cells.set(ColumnId::PeakVz, speeds[index]);
            let job: JobId = point.job.id.clone();
            let record = Record { job: job.clone(), cells, file_hash: None, file_stamp: None };
            records.insert(job, record);
        }
        Table::build(&points, &records, &|_| String::new(), &AssumedRanges::default())
    }

    #[test]
    fn a_verdict_that_differs_between_seeds_is_marked() {
        let table = table(
            ["deployed", "deployed", "deployed", "deployed", "stalled", "deployed"],
            [1.0; 6],
        );
        let judged = table.clone().judged(&[]);
        let depends = judged.column("verdict_depends_on").unwrap();
        let null = Value::Null;
        let seed = Value::Text("seed".to_owned());
        assert_eq!(
            depends.cells,
            [null.clone(), null.clone(), null, seed.clone(), seed.clone(), seed]
        );
        let names = |table: &Table| table.columns.last().unwrap().name.clone();
        assert_eq!(names(&judged), names(&table), "the last column stays the last");
        assert!(judged.column("safety").is_none(), "no limits, no margins");
    }

    #[test]
    fn limits_give_margins_and_say_which_is_the_smallest() {
        let bound = Condition::Bound { bound: 20.0, above: false, or_equal: false };
        let deployed = Condition::Is(Value::Text("deployed".to_owned()));
        let limit =
            |measure, condition| ResultLimit { measure, condition, text: "< 20 m/s".to_owned() };
        let limits = [limit(ColumnId::PeakVz, bound), limit(ColumnId::Verdict, deployed)];
        let mut verdicts = ["deployed"; 6];
        verdicts[3] = "stalled";
        // The fixture's third point is infeasible.
        let table = table(verdicts, [10.0, 25.0, 0.0, 10.0, 0.0, 0.0]);
        let judged = with_error(table, "peak_vz", 0.0).judged(&limits);
        let cells =
            |name: &str| [0, 1, 3].map(|row| judged.column(name).unwrap().cells[row].clone());
        assert_eq!(
            cells("safety"),
            [Safety::Safe, Safety::Unsafe, Safety::Unsafe].map(Value::from)
        );
        assert_eq!(cells("smallest_margin"), [0.5, -0.25, -1.0].map(Value::Number));
        let names = ["peak_vz", "peak_vz", "verdict"].map(|name| Value::Text(name.to_owned()));
        assert_eq!(cells("smallest_margin_of"), names);
        assert_eq!(cells("margin_peak_vz"), [0.5, -0.25, 0.5].map(Value::Number));
        assert_eq!(cells("margin_verdict"), [1.0, 1.0, -1.0].map(Value::Number));
    }
}
