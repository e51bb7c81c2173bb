//! Pairs of the values of one parameter as tables: one row per pair, and one row per value and measure.

use super::{Better, Compared, Measure, Pair, Sets, Tally, compared, tallies};
use crate::analysis::replicates::{Condensed, integer, proportion_columns};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::row::CellType;
use crate::store::table::{Column, Table};

/// Outcomes of a pair, with their columns.
const OUTCOMES: [(&str, Better); 10] = [
    ("other_better", Better::Other),
    ("base_better", Better::Base),
    ("ties", Better::Tie),
    ("only_other", Better::OnlyOther),
    ("only_base", Better::OnlyBase),
    ("neither", Better::Neither),
    ("other_lower", Better::Lower),
    ("other_higher", Better::Higher),
    ("same_job", Better::SameJob),
    ("pending", Better::Pending),
];

/// The two rows of a pair, with the words of their columns.
type Side = (&'static str, fn(&Pair) -> usize);
const SIDES: [Side; 2] = [("base", |pair| pair.base), ("other", |pair| pair.other)];

/// The pairs of the values of one parameter, and what is compared in them.
pub struct Comparison<'a> {
    /// The rows that are paired: single runs, or points as medians.
    pub table: &'a Table,
    /// The points, where they are paired.
    pub points: Option<&'a Condensed>,
    /// The compared parameter.
    pub by: &'a Column,
    /// The rows that are equal in all other parameters.
    pub sets: Sets,
    /// The pairs.
    pub pairs: Vec<Pair>,
    /// The measures.
    pub measures: Vec<Measure<'a>>,
}

impl Comparison<'_> {
    /// One row per pair.
    pub fn pairs(&self) -> Table {
        let cells = |column: &Column, of: fn(&Pair) -> usize| -> Vec<Value> {
            self.pairs.iter().map(|pair| column.cells[of(pair)].clone()).collect()
        };
        let parameters = self.sets.matched.iter().chain([&self.by.name]).chain(&self.sets.carried);
        let parameters = parameters.filter_map(|name| self.table.column(name));
        let mut columns: Vec<Column> =
            parameters.map(|column| column.like(&column.name, cells(column, SIDES[1].1))).collect();
        let outcome = ["job", "status", "verdict"].into_iter();
        for name in outcome.skip(usize::from(self.points.is_some())) {
            let Some(column) = self.table.column(name) else { continue };
            columns.extend(
                SIDES.map(|(side, of)| column.like(format!("{side}_{name}"), cells(column, of))),
            );
        }
        if let Some(points) = self.points {
            let [base, other] = SIDES.map(|(side, of)| {
                let runs = self.pairs.iter().map(|pair| points.runs[of(pair)].deployed);
                let runs: Vec<Proportion> = runs.collect();
                proportion_columns(&format!("{side}_deployed"), "deployed", &runs)
            });
            columns.extend(base.into_iter().zip(other).flat_map(<[Column; 2]>::from));
        }
        columns.extend(self.measures.iter().flat_map(|measure| self.measured(measure)));
        Table { columns }
    }

    /// The columns of a measure of the pairs.
    fn measured(&self, measure: &Measure<'_>) -> Vec<Column> {
        let name = &measure.column.name;
        let all: Vec<Compared> =
            self.pairs.iter().map(|pair| compared(self.table, *pair, measure)).collect();
        let column = |figure: &str, numbers: Vec<Option<f64>>| {
            let cells = numbers.into_iter().map(|n| n.map_or(Value::Null, Value::Number)).collect();
            let column = measure.column.like(format!("{name}_{figure}"), cells);
            Column { cell_type: CellType::Number, ..column }
        };
        let of = |figure: &str, number: fn(&Compared) -> Option<f64>| {
            column(figure, all.iter().map(number).collect())
        };
        let values: [fn(&Compared) -> Option<f64>; 2] = [|pair| pair.base, |pair| pair.other];
        let mut columns = Vec::new();
        for ((side, row), value) in SIDES.into_iter().zip(values) {
            columns.push(of(side, value));
            for (end, index) in
                [("least", 0), ("largest", 2)].into_iter().filter(|_| self.points.is_some())
            {
                let numbers = self
                    .pairs
                    .iter()
                    .map(|pair| Some(self.points?.spread(name, row(pair))?[index]));
                columns.push(column(&format!("{side}_{end}"), numbers.collect()));
            }
            for (end, errors) in ["below", "above"].into_iter().zip(measure.errors.iter().flatten())
            {
                let numbers = self.pairs.iter();
                let numbers = numbers.map(|pair| super::measured(self.table, errors, row(pair)));
                columns.push(column(&format!("{side}_error_{end}"), numbers.collect()));
            }
        }
        let difference = of("difference", Compared::difference);
        let shown = measure.column.shown.of_difference();
        columns.push(Column { shown, ..difference });
        let ratio = of("ratio", Compared::ratio);
        let plain = Column::plain(&ratio.name, CellType::Number, Vec::new());
        columns.push(Column { cells: ratio.cells, ..plain });
        let better = all.iter().map(|pair| Value::Text(pair.better.name().to_owned()));
        columns.push(Column::plain(&format!("{name}_better"), CellType::Text, better.collect()));
        columns
    }

    /// One row per other value and measure. For a reader a difference has the unit of its measure.
    pub fn summary(&self, for_reader: bool) -> Table {
        let all = tallies(self.table, &self.pairs, &self.by.name, &self.measures);
        let column = |name: &str, cell_type, cell: &dyn Fn(&Tally) -> Value| {
            Column::plain(name, cell_type, all.iter().map(cell).collect())
        };
        let values = all.iter().map(|tally| tally.value.clone());
        let mut columns = vec![
            self.by.like(&self.by.name, values.collect()),
            column("measure", CellType::Text, &|tally| Value::Text(tally.measure.clone())),
            column("pairs", CellType::Integer, &|tally| integer(tally.pairs())),
        ];
        for (name, outcome) in OUTCOMES {
            if matches!(outcome, Better::Other | Better::Base) {
                let share =
                    |tally: &Tally| Proportion { met: tally.count(outcome), of: tally.pairs() };
                let shares: Vec<Proportion> = all.iter().map(share).collect();
                let what = format!("have the outcome {}", outcome.name());
                let [met, _, low, high] = proportion_columns(name, &what, &shares);
                columns.extend([met, low, high]);
            } else {
                let count = |tally: &Tally| integer(tally.count(outcome));
                columns.push(column(name, CellType::Integer, &count));
            }
        }
        let ends = [("median", 0), ("least", 1), ("largest", 2)];
        let end = |spread: Option<Spread>, index: usize| {
            spread.map(|spread| [spread.median, spread.least, spread.largest][index])
        };
        columns.extend(ends.map(|(word, index)| {
            column(&format!("{word}_ratio"), CellType::Number, &|tally| {
                end(tally.ratio, index).map_or(Value::Null, Value::Number)
            })
        }));
        columns.extend(ends.map(|(word, index)| {
            column(&format!("{word}_difference"), CellType::Number, &|tally| {
                let Some(difference) = end(tally.difference, index) else { return Value::Null };
                let measure = self.measures.iter().find(|known| known.column.name == tally.measure);
                match measure.filter(|_| for_reader) {
                    Some(known) => {
                        Value::Text(known.column.shown.of_difference().brief(difference))
                    }
                    None => Value::Number(difference),
                }
            })
        }));
        Table { columns }
    }
}
