//! The runs of each point as one: medians, ranges, proportions.
//!
//! ```text
//! point = all parameters but the replicates      runs of a point = its different jobs
//! value = median over the trusted runs;  range = least to largest;  deployed, safe: k of n
//! ```
//! The condensed table has one row per point and is a table as any other: charts and comparisons read it in
//! the place of the rows. A word, or a truth value, is that of all runs or null; `verdict_depends_on` is that of the
//! first run that has one. `smallest_margin` is the smallest over the runs, with its measure, not their median.

use std::collections::BTreeMap;
use std::sync::Arc;

use billow_solver::output::measures::Verdict;

use super::statistics::Spread;
use super::values::{canonical, measured};
use crate::accuracy::PROMISED;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::job::result_limit::Safety;
use crate::job::row::{CellType, ColumnId, DerivedColumn, SAME_JOB_AS};
use crate::store::table::{Column, Table, extrapolated};
use crate::study::Meshes;

/// A table with one row per point.
#[derive(Debug, Clone, PartialEq)]
pub struct Condensed {
    /// The medians. Its parameters are those of the study without the replicates; `job` is that of the first
    /// run.
    pub table: Arc<Table>,
    /// The same table with the smallest values.
    pub least: Arc<Table>,
    /// The same table with the largest values.
    pub largest: Arc<Table>,
    /// The runs of each row.
    pub runs: Vec<Runs>,
}

/// The runs of one point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runs {
    /// Rows of the table, one per different job.
    pub rows: Vec<usize>,
    /// Of these, those on the finest mesh, where the study has several meshes; otherwise all.
    pub finest: Vec<usize>,
    /// Of the runs with a verdict, those that deployed.
    pub deployed: Proportion,
    /// Of the runs that the limits can judge, those that are safe.
    pub safe: Proportion,
    /// Number of these that are unsafe: the others are within their uncertainty.
    pub not_safe: usize,
    /// Number of done runs.
    pub done: usize,
    /// Number of done runs that cannot be trusted.
    pub not_trusted: usize,
    /// Whether a run can be trusted whose measures count. Then those that cannot have no part in medians and ranges.
    pub has_trusted: bool,
    /// Rows of the runs whose measures count.
    pub measured: Vec<usize>,
    /// Number of runs that failed.
    pub failed: usize,
    /// Number of runs without a fold pattern.
    pub infeasible: usize,
    /// Number of runs that have not ended.
    pub pending: usize,
}

/// Which of the values of several runs a table has.
#[derive(Clone, Copy)]
enum Statistic {
    Least,
    Median,
    Largest,
}

impl Condensed {
    /// Condenses some rows of a table. Without replicates each job is a point.
    pub fn of(table: &Table, rows: &[usize], replicates: &[String]) -> Self {
        let runs: Vec<Runs> =
            groups(table, rows, replicates).into_iter().map(|rows| Runs::of(table, rows)).collect();
        let with = |statistic| Arc::new(condensed(table, &runs, replicates, statistic));
        let table = with(Statistic::Median);
        // A single run is its median, its least and its largest one.
        let is_single = runs.iter().all(|runs| runs.measured.len() < 2);
        let of = |statistic| if is_single { Arc::clone(&table) } else { with(statistic) };
        let (least, largest) = (of(Statistic::Least), of(Statistic::Largest));
        Self { table, least, largest, runs }
    }

    /// Least, median and largest value of a measure at a row; `None` where no run has one.
    pub fn spread(&self, name: &str, row: usize) -> Option<[f64; 3]> {
        let value = |table: &Table| match table.column(name)?.cells[row] {
            Value::Number(number) => Some(number),
            _ => None,
        };
        Some([value(&self.least)?, value(&self.table)?, value(&self.largest)?])
    }

    /// Whether all runs of a point deployed; `None` where a run has no verdict.
    pub fn deploys(&self, point: usize) -> Option<bool> {
        self.runs[point].all(|runs| runs.deployed)
    }

    /// What the limits say of a point: safe or unsafe if all its runs are; `None` where that cannot be said.
    pub fn safety(&self, point: usize) -> Option<Safety> {
        let runs = &self.runs[point];
        let all = runs.all(|runs| runs.safe)?;
        Some(match (all, runs.not_safe) {
            (true, _) => Safety::Safe,
            (false, number) if number == runs.safe.of => Safety::Unsafe,
            _ => Safety::Uncertain,
        })
    }

    /// The points that have a job.
    pub fn feasible(&self) -> impl Iterator<Item = usize> {
        let is_feasible = |point: &usize| self.table.status(*point) != Some(Status::Infeasible);
        (0..self.runs.len()).filter(is_feasible)
    }
}

/// A proportion over points as columns: k, n, and its interval. `what` the k do.
pub fn proportion_columns(name: &str, what: &str, all: &[Proportion]) -> [Column; 4] {
    let column = |end: &str, cell_type, meaning: String, cell: &dyn Fn(&Proportion) -> Value| {
        let column =
            Column::plain(&format!("{name}{end}"), cell_type, all.iter().map(cell).collect());
        Column { unit: "1".to_owned(), meaning, ..column }
    };
    let end = |index: usize| {
        move |one: &Proportion| match one.of {
            0 => Value::Null,
            _ => Value::Number(one.wilson()[index]),
        }
    };
    let interval =
        |end: &str| format!("{end} end of the 95 % interval (Wilson) of those that {what}");
    let (met, of) = (format!("number of runs that {what}"), "number of runs that were judged");
    [
        column("", CellType::Integer, met, &|one| integer(one.met)),
        column("_of", CellType::Integer, of.to_owned(), &|one| integer(one.of)),
        column("_low", CellType::Number, interval("lower"), &end(0)),
        column("_high", CellType::Number, interval("upper"), &end(1)),
    ]
}

/// A number of things as a value.
pub fn integer(number: usize) -> Value {
    Value::Integer(i64::try_from(number).unwrap_or(i64::MAX))
}

impl Runs {
    /// Whether all runs meet a condition: not if one does not, unknown while one is not judged.
    fn all(&self, of: fn(&Self) -> Proportion) -> Option<bool> {
        let judged = of(self);
        if judged.met < judged.of {
            return Some(false);
        }
        (judged.of > 0 && judged.of == self.finest.len()).then_some(true)
    }

    /// The smallest margin over the runs: the margin, its measure, the row of the run.
    pub fn worst_margin(&self, table: &Table) -> Option<(f64, String, usize)> {
        let column = table.column(DerivedColumn::SmallestMargin.name())?;
        let names = table.column(DerivedColumn::SmallestMarginOf.name())?;
        let margins = self.finest.iter().filter_map(|row| match column.cells[*row] {
            Value::Number(margin) => Some((margin, *row)),
            _ => None,
        });
        let (margin, row) = margins.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((margin, names.cells[row].to_string(), row))
    }

    /// The runs in some rows of a table.
    fn of(table: &Table, all: Vec<usize>) -> Self {
        let status = |wanted: fn(Status) -> bool| {
            all.iter().filter(|row| table.status(**row).is_some_and(wanted)).count()
        };
        let rows = finest(table, &all);
        let of_done = |row: &usize| table.status(*row) == Some(Status::Done);
        let done = status(|status| status == Status::Done);
        let trusted = |row: &usize| table.is_trusted(*row);
        let not_trusted = done - all.iter().copied().filter(trusted).count();
        let has_trusted = rows.iter().any(trusted);
        let counts = |row: &usize| if has_trusted { trusted(row) } else { of_done(row) };
        let measured: Vec<usize> = rows.iter().copied().filter(counts).collect();
        let pending = status(|status| status == Status::Pending);
        let infeasible = status(|status| status == Status::Infeasible);
        let verdicts = rows.iter().filter_map(|row| table.verdict(*row));
        let judged: Vec<Safety> = rows.iter().filter_map(|row| table.safety(*row)).collect();
        let count = |safety| judged.iter().filter(|one| **one == safety).count();
        Self {
            deployed: Proportion::count(verdicts.map(|verdict| verdict == Verdict::Deployed)),
            safe: Proportion { met: count(Safety::Safe), of: judged.len() },
            not_safe: count(Safety::Unsafe),
            done,
            not_trusted,
            measured,
            has_trusted,
            failed: all.len() - done - pending - infeasible,
            infeasible,
            pending,
            finest: rows,
            rows: all,
        }
    }
}

/// Of the runs of a point, those on the mesh that stands for it, where values are extrapolated from several: the finest
/// of those on which most of them have a value, so that a pilot counts only once all its runs do.
pub fn finest(table: &Table, rows: &[usize]) -> Vec<usize> {
    let mesh = table.parameters().find(|column| column.name == MESH_PARAMETER);
    let Some(mesh) = mesh.filter(|_| table.has_extrapolated()) else { return rows.to_vec() };
    let mut with_value: BTreeMap<i64, usize> = BTreeMap::new();
    for row in rows {
        if let Value::Integer(n) = mesh.cells[*row] {
            *with_value.entry(n).or_default() += usize::from(table.is_extrapolated_at(*row));
        }
    }
    let best = with_value.into_iter().max_by_key(|(n, count)| (*count, *n)).map(|(n, _)| n);
    let is_best = |row: &usize| best.is_some_and(|best| mesh.cells[*row] == Value::Integer(best));
    rows.iter().copied().filter(is_best).collect()
}

/// The column with the values that a point takes for a measure: the extrapolated ones, where there are.
pub fn source<'a>(table: &'a Table, column: &'a Column) -> &'a Column {
    let of_error = PROMISED.iter().find_map(|promised| {
        let side = promised.error_columns.iter().position(|name| *name == column.name)?;
        Some(extrapolated::names(promised.measure.name())[1 + side].clone())
    });
    let name = of_error.unwrap_or_else(|| extrapolated::names(&column.name)[0].clone());
    table.column(&name).unwrap_or(column)
}

/// The parameters that are no replicates: they tell points apart.
pub fn fixed<'a>(table: &'a Table, replicates: &[String]) -> Vec<&'a Column> {
    table.parameters().filter(|column| !replicates.contains(&column.name)).collect()
}

/// The values of these parameters in a row, equal for the runs of one point.
pub fn point_key(fixed: &[&Column], row: usize) -> Vec<String> {
    fixed.iter().map(|column| canonical(&column.cells[row])).collect()
}

/// Whether a replicate is the mesh, and values are extrapolated from these meshes: its runs repeat no point.
pub fn is_mesh(name: &str, meshes: &Meshes) -> bool {
    !meshes.list.is_empty() && name == MESH_PARAMETER
}

/// The rows of each point, in the order of their first rows.
pub fn rows_of_points(table: &Table, rows: &[usize], replicates: &[String]) -> Vec<Vec<usize>> {
    let fixed = fixed(table, replicates);
    let mut positions: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for row in rows {
        let position = *positions.entry(point_key(&fixed, *row)).or_insert(groups.len());
        if position == groups.len() {
            groups.push(Vec::new());
        }
        groups[position].push(*row);
    }
    groups
}

/// The same with one row per job.
fn groups(table: &Table, rows: &[usize], replicates: &[String]) -> Vec<Vec<usize>> {
    let job = table.column("job");
    let of_jobs = |rows: Vec<usize>| {
        let mut kept: Vec<usize> = Vec::new();
        for row in rows {
            let same = |known: &usize| job.is_some_and(|job| job.cells[*known] == job.cells[row]);
            if !kept.iter().any(same) {
                kept.push(row);
            }
        }
        kept
    };
    rows_of_points(table, rows, replicates).into_iter().map(of_jobs).collect()
}

fn condensed(table: &Table, runs: &[Runs], replicates: &[String], statistic: Statistic) -> Table {
    let is_replicate = |column: &Column| replicates.contains(&column.name);
    let parameters = table.parameters().count();
    let columns = table.columns.iter().enumerate();
    let columns = columns.filter(|(index, column)| {
        let left_out = *index <= parameters && is_replicate(column);
        !left_out && !extrapolated::is_extrapolated(&column.name)
    });
    let stands_alone = |(row, runs): (usize, &Runs)| runs.rows == [row] && runs.measured == [row];
    let is_same = runs.len() == table.rows() && runs.iter().enumerate().all(stands_alone);
    let column = |(index, column): (usize, &Column)| {
        let number = matches!(column.cell_type, CellType::Number | CellType::Integer);
        let is_measure = index > parameters && number;
        let values_of = source(table, column);
        // Single runs of a large study share its cells.
        let keeps_type = !is_measure || column.cell_type == CellType::Number;
        if is_same && keeps_type && column.name != SAME_JOB_AS && std::ptr::eq(values_of, column) {
            return column.clone();
        }
        let is_margin = column.name == DerivedColumn::SmallestMargin.name();
        let cell = |runs: &Runs| {
            if is_margin && !matches!(statistic, Statistic::Largest) {
                let worst = runs.worst_margin(table);
                return worst.map_or(Value::Null, |(margin, ..)| Value::Number(margin));
            }
            if is_measure {
                let values =
                    runs.measured.iter().filter_map(|row| measured(table, values_of, *row));
                return Spread::of(values).map_or(Value::Null, |spread| {
                    Value::Number(match statistic {
                        Statistic::Least => spread.least,
                        Statistic::Median => spread.median,
                        Statistic::Largest => spread.largest,
                    })
                });
            }
            let first = &column.cells[runs.rows[0]];
            if column.name == "job" || index <= parameters {
                return first.clone();
            }
            if column.name == ColumnId::Status.name() {
                return Value::Text(status(table, runs).name().to_owned());
            }
            if column.name == DerivedColumn::SmallestMarginOf.name() {
                let worst = runs.worst_margin(table);
                return worst.map_or(Value::Null, |(_, name, _)| Value::Text(name));
            }
            if column.name == DerivedColumn::VerdictDependsOn.name() {
                let mut cells = runs.rows.iter().map(|row| &column.cells[*row]);
                return cells.find(|cell| **cell != Value::Null).cloned().unwrap_or(Value::Null);
            }
            let first = &column.cells[runs.finest[0]];
            let same = runs.finest.iter().all(|row| column.cells[*row] == *first);
            if same && column.name != SAME_JOB_AS { first.clone() } else { Value::Null }
        };
        Column {
            cell_type: if is_measure { CellType::Number } else { column.cell_type },
            cells: runs.iter().map(cell).collect(),
            name: column.name.clone(),
            unit: column.unit.clone(),
            shown: column.shown.clone(),
            meaning: column.meaning.clone(),
        }
    };
    Table { columns: columns.map(column).collect() }
}

/// The status of a point: pending while a run is, done if a run is, otherwise that of the first run.
fn status(table: &Table, runs: &Runs) -> Status {
    if runs.pending > 0 {
        Status::Pending
    } else if runs.done > 0 {
        Status::Done
    } else {
        table.status(runs.rows[0]).unwrap_or(Status::Pending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::fixture;

    /// Strategy a with three seeds of which one failed, strategy b with two seeds that are one job.
    fn table() -> Table {
        fixture::table(
            "job strategy seed status   verdict  peak_vz safe
             1   a        1    done     deployed 10.0    true
             2   a        2    done     stalled  14.0    false
             3   a        3    unstable -        99.0    false
             4   b        1    done     deployed 5.0     true
             4   b        2    done     deployed 5.0     true",
        )
    }

    #[test]
    fn runs_become_medians_ranges_and_proportions() {
        let all = [0, 1, 2, 3, 4];
        let condensed = Condensed::of(&table(), &all, &["seed".to_owned()]);
        assert_eq!(condensed.table.rows(), 2);
        let names: Vec<&str> = condensed.table.parameters().map(|column| &*column.name).collect();
        assert_eq!(names, ["strategy"]);
        assert_eq!(
            condensed.spread("peak_vz", 0),
            Some([10.0, 12.0, 14.0]),
            "without the failed run"
        );
        assert_eq!(condensed.spread("peak_vz", 1), Some([5.0; 3]));
        let [a, b] = condensed.runs.as_slice() else { panic!() };
        assert_eq!((a.deployed, a.done, a.failed), (Proportion { met: 1, of: 2 }, 2, 1));
        assert_eq!(
            (b.deployed, b.rows.len()),
            (Proportion { met: 1, of: 1 }, 1),
            "one job counts once"
        );
        assert_eq!(condensed.table.verdict(0), None, "the runs disagree");
        assert_eq!(condensed.table.verdict(1), Some(Verdict::Deployed));
        assert_eq!(condensed.table.status(0), Some(Status::Done));
    }

    #[test]
    fn without_replicates_each_job_is_a_point() {
        let condensed = Condensed::of(&table(), &[0, 1, 3], &[]);
        assert_eq!(condensed.table.column("peak_vz"), condensed.largest.column("peak_vz"));
        assert_eq!(condensed.runs.len(), 3);
        assert_eq!(condensed.table.parameters().count(), 2);
    }
}
