//! A ranking as a table.

use super::{Basis, Candidate, Ranking};
use crate::analysis::replicates::{integer, proportion_columns};
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::row::{CellType, DerivedColumn};
use crate::store::table::{Column, Table};

impl Ranking {
    /// One row per candidate, the best one first.
    pub fn table(&self) -> Table {
        let candidates = &self.candidates;
        let column = |name: &str, cell_type, cell: &dyn Fn(&Candidate) -> Value| {
            Column::plain(name, cell_type, candidates.iter().map(cell).collect())
        };
        let count = |name: &str, of: &dyn Fn(&Candidate) -> Option<usize>| {
            column(name, CellType::Integer, &|one| of(one).map_or(Value::Null, integer))
        };
        let runs = |name: &str, what: &str, of: fn(&Candidate) -> Proportion| {
            let all: Vec<Proportion> = candidates.iter().map(of).collect();
            proportion_columns(name, what, &all)
        };
        let mut rank = 0;
        let ranks = candidates.iter().map(|_| {
            rank += 1;
            integer(rank)
        });
        let mut columns = vec![Column::plain("rank", CellType::Integer, ranks.collect())];
        columns.extend(self.by.iter().enumerate().map(|(index, by)| {
            let cells = candidates.iter().map(|candidate| candidate.values[index].clone());
            by.like(by.name.clone(), cells.collect())
        }));
        columns.push(count("points", &|one| Some(one.points)));
        let has_limits = self.basis == Basis::Limits;
        columns.push(count("safe", &|one| Some(one.safe).filter(|_| has_limits)));
        columns.extend(runs("safe_runs", "are safe", |one| one.safe_runs));
        let has_verdict = |one: &Candidate| one.deployed_runs.of > 0;
        columns.push(count("deployed", &|one| Some(one.deployed).filter(|_| has_verdict(one))));
        columns.extend(runs("deployed_runs", "deployed", |one| one.deployed_runs));
        columns.push(count("failed", &|one| Some(one.failed)));
        let margin = |one: &Candidate| one.margin.clone();
        columns.push(column(DerivedColumn::SmallestMargin.name(), CellType::Number, &|one| {
            margin(one).map_or(Value::Null, |(margin, _)| Value::Number(margin))
        }));
        columns.push(column(DerivedColumn::SmallestMarginOf.name(), CellType::Text, &|one| {
            margin(one).map_or(Value::Null, |(_, measure)| Value::Text(measure))
        }));
        for (index, measure) in self.measures.iter().enumerate() {
            let of = |end: usize| {
                let cell = |one: &Candidate| {
                    one.measures[index].map_or(Value::Null, |spread| {
                        Value::Number([spread.median, spread.least, spread.largest][end])
                    })
                };
                candidates.iter().map(cell).collect::<Vec<Value>>()
            };
            let name = &measure.column.name;
            for (end, suffix) in ["", "_least", "_largest"].into_iter().enumerate() {
                let column = measure.column.like(format!("{name}{suffix}"), of(end));
                columns.push(Column { cell_type: CellType::Number, ..column });
            }
        }
        Table { columns }
    }
}
