//! What the searches of a study found, with what decides each border.

use std::collections::BTreeMap;

use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::result_limit::Safety;
use crate::job::row::{CellType, ColumnId, DerivedColumn};
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::{Border, Criterion, Level, SearchResult};

/// The searches of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Searches {
    /// The parameter along which they search.
    pub parameter: String,
    /// Its SI unit.
    pub unit: String,
    /// Unit in which its values are shown.
    pub shown: DisplayUnit,
    /// What changes at a border: `safe`, `deployed`, `peak_vz < 25 m/s`.
    pub criterion: String,
    /// Number of runs of each value.
    pub replicates: usize,
    /// The other parameters, with one cell per search.
    pub parameters: Vec<Column>,
    /// One entry per search, in plan order.
    pub found: Vec<Found>,
}

/// What one search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Values, runs, outcome.
    pub border: Border,
    /// The measure that decides: that of the smallest margin in most runs beyond the border.
    pub limit: Option<String>,
}

impl Searches {
    /// The searches of a results folder; `None` for a study without one. `table` is its table.
    pub fn of(stored: &Stored<'_>, table: &Table) -> Option<Self> {
        let (parameter, criterion) = stored.study.searched()?;
        let limits = stored.study.result_limits();
        let column = |name: &str| table.parameters().find(|column| column.name == name);
        let borders = stored.borders();
        let names = borders.first().map_or(&[][..], |border| border.parameters.as_slice());
        let parameters = names.iter().enumerate().filter_map(|(index, (name, _))| {
            let cells = borders.iter().map(|border| border.parameters[index].1.clone());
            Some(column(name)?.like(name, cells.collect()))
        });
        let parameters = parameters.collect();
        let found = borders.into_iter().map(|border| Found {
            limit: match criterion {
                Criterion::Deployed => Some("verdict".to_owned()),
                Criterion::Limit(index) => limits.get(index).map(|l| l.measure.name().to_owned()),
                Criterion::Safe => deciding(table, parameter, &border),
            },
            border,
        });
        Some(Self {
            parameter: parameter.to_owned(),
            unit: stored.study.unit(parameter).to_owned(),
            shown: column(parameter)
                .map_or_else(|| DisplayUnit::si(""), |column| column.shown.clone()),
            criterion: criterion.text(limits),
            replicates: stored.study.replicate_count(),
            parameters,
            found: found.collect(),
        })
    }

    /// The searches as a table, one row per search: its number, the parameters, the status, then what was found.
    pub fn table(&self) -> Table {
        let column = |name: &str, cell_type, of: &dyn Fn(&Found) -> Value| {
            Column::plain(name, cell_type, self.found.iter().map(of).collect())
        };
        let text = |text: &str| Value::Text(text.to_owned());
        let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let value = |name: &str, of: &dyn Fn(&Found) -> Option<f64>| Column {
            unit: self.unit.clone(),
            shown: self.shown.clone(),
            ..column(name, CellType::Number, &|found| of(found).map_or(Value::Null, Value::Number))
        };
        let border = |found: &Found| match found.border.outcome {
            SearchResult::Border { low, high, .. } => Some([low, high]),
            _ => None,
        };
        let numbers = (1..=self.found.len()).map(number).collect();
        let mut columns = vec![Column::plain("search", CellType::Integer, numbers)];
        columns.extend(self.parameters.iter().cloned());
        // A column with this name ends the parameters of a table.
        columns.push(column(ColumnId::Status.name(), CellType::Text, &|found| {
            let open = found.border.outcome == SearchResult::Open;
            text(if open { Status::Pending.name() } else { Status::Done.name() })
        }));
        columns.extend([
            column("outcome", CellType::Text, &|found| text(found.outcome())),
            value("low", &|found| border(found).map(|ends| ends[0])),
            value("high", &|found| border(found).map(|ends| ends[1])),
            column("below", CellType::Text, &|found| {
                found
                    .met_below()
                    .map_or(Value::Null, |met| text(if met { "met" } else { "not met" }))
            }),
            column("limit", CellType::Text, &|found| {
                found.limit.as_ref().map_or(Value::Null, |limit| text(limit))
            }),
            value("from", &|found| found.decided(self.replicates).map(|ends| ends[0])),
            value("to", &|found| found.decided(self.replicates).map(|ends| ends[1])),
            column("changes", CellType::Text, &|found| self.changes(found)),
            column("values", CellType::Integer, &|found| number(found.border.levels.len())),
            column("not_decided", CellType::Integer, &|found| {
                number(found.undecided(self.replicates).len())
            }),
            column("runs", CellType::Integer, &|found| {
                number(found.sum(|level| level.met.of + level.not_judged))
            }),
            column("not_judged", CellType::Integer, &|found| {
                number(found.sum(|level| level.not_judged))
            }),
            column("open", CellType::Integer, &|found| number(found.sum(|level| level.open))),
        ]);
        Table { columns }
    }

    /// The intervals in which the outcome changes, where there are several.
    fn changes(&self, found: &Found) -> Value {
        let SearchResult::NotMonotone(changes) = &found.border.outcome else { return Value::Null };
        let text = |[low, high]: &[f64; 2]| {
            let high = self.shown.quantity(&Value::Number(*high));
            format!("{} to {high}", self.shown.text(&Value::Number(*low)))
        };
        Value::Text(changes.iter().map(text).collect::<Vec<_>>().join("; "))
    }
}

impl Found {
    /// Name of the outcome.
    fn outcome(&self) -> &'static str {
        match self.border.outcome {
            SearchResult::Open => "open",
            SearchResult::Border { .. } => "border",
            SearchResult::NotMonotone(_) => "not_monotone",
            SearchResult::NoChange { met: true } => "always_met",
            SearchResult::NoChange { met: false } => "never_met",
            SearchResult::Undecided => "undecided",
        }
    }

    /// The smallest and the largest value at which the outcome is decided.
    pub fn decided(&self, replicates: usize) -> Option<[f64; 2]> {
        let decided = |level: &&Level| level.outcome(replicates).is_some();
        let mut levels = self.border.levels.iter().filter(decided).map(|level| level.value);
        let first = levels.next()?;
        Some([first, levels.next_back().unwrap_or(first)])
    }

    /// The values at which the outcome is not decided.
    pub fn undecided(&self, replicates: usize) -> Vec<f64> {
        let levels = self.border.levels.iter();
        let undecided = levels.filter(|level| level.outcome(replicates).is_none());
        undecided.map(|level| level.value).collect()
    }

    /// Number of values inside the border at which the runs disagree.
    pub fn undecided_inside(&self, replicates: usize) -> usize {
        let SearchResult::Border { low, high, .. } = self.border.outcome else { return 0 };
        self.undecided(replicates).iter().filter(|value| low < **value && **value < high).count()
    }

    /// Number of runs of all values that are counted so.
    pub fn sum(&self, of: fn(&Level) -> usize) -> usize {
        self.border.levels.iter().map(of).sum()
    }

    /// Whether the criterion is met below the border.
    fn met_below(&self) -> Option<bool> {
        match self.border.outcome {
            SearchResult::Border { met_below, .. } => Some(met_below),
            _ => None,
        }
    }
}

/// The measure that most unsafe runs have as that of their smallest margin, at the value next to the border on
/// its unsafe side, or without a border at every value.
fn deciding(table: &Table, parameter: &str, border: &Border) -> Option<String> {
    // Without a border every value that is not safe says what decides.
    let side = match border.outcome {
        SearchResult::Border { low, high, met_below } => Some(if met_below { high } else { low }),
        SearchResult::NoChange { met: false } => None,
        _ => return None,
    };
    let names = table.column(DerivedColumn::SmallestMarginOf.name())?;
    let searched = table.parameters().find(|column| column.name == parameter)?;
    let is_side = |row: &usize| {
        side.is_none_or(|side| match (searched.cell_type, &searched.cells[*row]) {
            (CellType::Text, Value::Text(text)) => text.parse() == Ok(side),
            (_, Value::Number(number)) => number.total_cmp(&side).is_eq(),
            (_, Value::Integer(number)) => (*number as f64).total_cmp(&side).is_eq(),
            _ => false,
        })
    };
    let fixed = |row: &usize| {
        border.parameters.iter().all(|(name, value)| {
            let column = table.parameters().find(|column| column.name == *name);
            // A column of texts and numbers stores its numbers as text.
            column.is_some_and(|column| column.cells[*row].to_string() == value.to_string())
        })
    };
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for row in (0..table.rows()).filter(is_side).filter(fixed) {
        if table.safety(row).is_some_and(|safety| safety != Safety::Safe) {
            *counts.entry(names.cells[row].to_string()).or_default() += 1;
        }
    }
    // The first name of those that are equally frequent.
    counts.into_iter().rev().max_by_key(|(_, runs)| *runs).map(|(name, _)| name)
}
