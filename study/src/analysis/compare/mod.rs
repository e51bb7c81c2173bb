//! Comparison: the effect of one parameter with all others equal.
//!
//! Rows that are equal in all other parameters form a set. In a set, the row with the base value and
//! each row with another value form a pair. Parameters are matched by their canonical text (the
//! shortest digits that read back as the number), never by nearly equal floats. A parameter on the
//! same axis as the compared one that is a function of it changes with it, so it is not matched
//! (example: a strategy with its residual gas).
//!
//! ```text
//! difference = other − base        ratio = other / base
//! tie:  |other − base| ≤ tie · max(|base|, |other|)
//! ```
//!
//! Only done jobs have measures, and only when the measured event happened. A pair of which only one
//! side has the measure is an outcome (`only_base`, `only_other`) and is never ignored. A pair with a
//! pending job is `pending` and does not count.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{BetterSide, COLUMNS, CellType, ColumnId};
use crate::store::table::{Column, Table};

/// Largest relative difference of a tie, unless the user gives another. Chosen: above rounding errors,
/// far below any effect of interest.
pub const DEFAULT_TIE: f64 = 1e-9;

/// Names of the measures of which that side is better, in the order of the table.
pub fn measures_with(side: BetterSide) -> Vec<&'static str> {
    COLUMNS.iter().filter(|column| column.better == side).map(|column| column.name).collect()
}

/// Which side of a measure is better.
fn better_side(measure: &str) -> BetterSide {
    ColumnId::from_name(measure).map_or(BetterSide::Neither, |id| id.column().better)
}

/// The text by which values are matched: numbers in shortest digits (8 = 8.0, −0 = 0), texts in
/// quotes.
pub fn canonical(value: &Value) -> String {
    match value {
        Value::Number(number) => format!("{}", number + 0.0),
        Value::Text(text) => format!("{text:?}"),
        other => other.to_string(),
    }
}

/// Different values of a column in some rows, in the order of first appearance.
pub fn values(column: &Column, rows: &[usize]) -> Vec<Value> {
    let mut known = BTreeSet::new();
    let cells = rows.iter().map(|row| &column.cells[*row]);
    cells.filter(|value| known.insert(canonical(value))).cloned().collect()
}

/// Sets of rows that are equal in all parameters except one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sets {
    /// The matched parameters.
    pub matched: Vec<String>,
    /// Parameters that change with the compared one and are not matched.
    pub carried: Vec<String>,
    /// Rows of each set, in table order; sets in the order of their first row.
    pub sets: Vec<Vec<usize>>,
}

impl Sets {
    /// Puts rows of a table into sets. `zipped` are the parameters on the axis of `by`.
    pub fn new(table: &Table, rows: &[usize], by: &str, zipped: &[String]) -> Self {
        let compared = table.parameters().find(|column| column.name == by);
        let follows = |column: &Column| {
            zipped.contains(&column.name)
                && compared.is_some_and(|compared| is_function(column, compared))
        };
        let others = || table.parameters().filter(|column| column.name != by);
        let matched: Vec<&Column> = others().filter(|column| !follows(column)).collect();
        let mut set_of: BTreeMap<Vec<String>, usize> = BTreeMap::new();
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for row in rows {
            let key = matched.iter().map(|column| canonical(&column.cells[*row])).collect();
            let index = *set_of.entry(key).or_insert(sets.len());
            if index == sets.len() {
                sets.push(Vec::new());
            }
            sets[index].push(*row);
        }
        Self {
            matched: matched.iter().map(|column| column.name.clone()).collect(),
            carried: others().filter(|column| follows(column)).map(|c| c.name.clone()).collect(),
            sets,
        }
    }
}

/// Whether each value of `of` comes with a single value of `column`.
fn is_function(column: &Column, of: &Column) -> bool {
    let mut seen: BTreeMap<String, String> = BTreeMap::new();
    column.cells.iter().zip(&of.cells).all(|(value, of)| {
        let value = canonical(value);
        *seen.entry(canonical(of)).or_insert_with(|| value.clone()) == value
    })
}

/// Two rows of one set: positions in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The row with the base value.
    pub base: usize,
    /// The row with another value.
    pub other: usize,
}

/// The pairs of some sets, and the rows without a partner.
pub fn pairs(table: &Table, sets: &Sets, by: &str, base: &Value) -> (Vec<Pair>, Vec<usize>) {
    let Some(column) = table.column(by) else { return (Vec::new(), Vec::new()) };
    let is_base = |row: &usize| canonical(&column.cells[*row]) == canonical(base);
    let mut pairs = Vec::new();
    let mut alone = Vec::new();
    for set in &sets.sets {
        let (bases, others): (Vec<usize>, Vec<usize>) = set.iter().copied().partition(is_base);
        match (bases.split_first(), others.as_slice()) {
            (Some((base, more)), [_, ..]) => {
                pairs.extend(others.iter().map(|other| Pair { base: *base, other: *other }));
                alone.extend(more);
            }
            _ => alone.extend(set),
        }
    }
    alone.sort_unstable();
    (pairs, alone)
}

/// Which job of a pair is better in a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// The job with the base value.
    Base,
    /// The job with the other value.
    Other,
    /// Equal up to the tie.
    Tie,
    /// Only the job with the base value has the measure.
    OnlyBase,
    /// Only the job with the other value has the measure.
    OnlyOther,
    /// Neither job has the measure.
    Neither,
    /// A job has not ended yet.
    Pending,
    /// The values differ, but neither side of this measure is better.
    Differ,
}

impl Better {
    /// Name, as in the column `better`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Other => "other",
            Self::Tie => "tie",
            Self::OnlyBase => "only_base",
            Self::OnlyOther => "only_other",
            Self::Neither => "neither",
            Self::Pending => "pending",
            Self::Differ => "differ",
        }
    }

    /// The result with base and other exchanged.
    #[must_use]
    pub fn exchanged(self) -> Self {
        match self {
            Self::Base => Self::Other,
            Self::Other => Self::Base,
            Self::OnlyBase => Self::OnlyOther,
            Self::OnlyOther => Self::OnlyBase,
            same => same,
        }
    }
}

/// One measure of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// Value of the job with the base value.
    pub base: Option<f64>,
    /// Value of the job with the other value.
    pub other: Option<f64>,
    /// Which job is better.
    pub better: Better,
}

impl Compared {
    /// Other minus base.
    pub fn difference(&self) -> Option<f64> {
        Some(self.other? - self.base?)
    }

    /// Other over base; `None` for a base of zero.
    pub fn ratio(&self) -> Option<f64> {
        let base = self.base.filter(|base| *base != 0.0)?;
        Some(self.other? / base)
    }
}

/// Compares one measure of a pair; `tie` is the largest relative difference of a tie.
pub fn compared(table: &Table, pair: Pair, measure: &Column, tie: f64) -> Compared {
    let base = measured(table, measure, pair.base);
    let other = measured(table, measure, pair.other);
    let pending =
        [pair.base, pair.other].iter().any(|row| table.status(*row) == Some(Status::Pending));
    let better = match (base, other) {
        _ if pending => Better::Pending,
        (None, None) => Better::Neither,
        (Some(_), None) => Better::OnlyBase,
        (None, Some(_)) => Better::OnlyOther,
        (Some(base), Some(other)) => judge(&measure.name, base, other, tie),
    };
    Compared { base, other, better }
}

fn judge(measure: &str, base: f64, other: f64, tie: f64) -> Better {
    // The difference of equal infinities is NaN.
    let equal =
        base.total_cmp(&other).is_eq() || (other - base).abs() <= tie * base.abs().max(other.abs());
    let smaller = if base < other { Better::Base } else { Better::Other };
    if equal {
        return Better::Tie;
    }
    match better_side(measure) {
        BetterSide::Smaller => smaller,
        BetterSide::Larger => smaller.exchanged(),
        BetterSide::Neither => Better::Differ,
    }
}

/// A measure of a row; `None` unless its job is done and has the measure.
pub fn measured(table: &Table, measure: &Column, row: usize) -> Option<f64> {
    if table.status(row) != Some(Status::Done) {
        return None;
    }
    match measure.cells[row] {
        Value::Number(number) if !number.is_nan() => Some(number),
        Value::Integer(number) => Some(number as f64),
        _ => None,
    }
}

/// Whether a column can be compared as a measure.
pub fn is_measure(column: &Column) -> bool {
    matches!(column.cell_type, CellType::Number | CellType::Integer)
}

/// One measure over all pairs of the base with one other value.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// The other value.
    pub value: Value,
    /// The measure.
    pub measure: String,
    /// Number of pairs by name of [`Better`]; pending ones included.
    pub counts: BTreeMap<&'static str, usize>,
    /// Ratios of the pairs in which both jobs have the measure.
    pub ratio: Option<Spread>,
}

impl Tally {
    /// Number of pairs with this result.
    pub fn count(&self, better: Better) -> usize {
        self.counts.get(better.name()).copied().unwrap_or(0)
    }

    /// Number of pairs of which both jobs have ended.
    pub fn pairs(&self) -> usize {
        self.counts.values().sum::<usize>() - self.count(Better::Pending)
    }
}

/// Counts pairs by other value and measure.
pub fn tallies(
    table: &Table,
    pairs: &[Pair],
    by: &str,
    measures: &[&Column],
    tie: f64,
) -> Vec<Tally> {
    let Some(column) = table.column(by) else { return Vec::new() };
    let others: Vec<usize> = pairs.iter().map(|pair| pair.other).collect();
    let mut tallies = Vec::new();
    for value in values(column, &others) {
        let of_value = |pair: &&Pair| canonical(&column.cells[pair.other]) == canonical(&value);
        for measure in measures {
            let compared: Vec<Compared> = pairs
                .iter()
                .filter(of_value)
                .map(|pair| compared(table, *pair, measure, tie))
                .collect();
            let mut counts = BTreeMap::new();
            for pair in &compared {
                *counts.entry(pair.better.name()).or_default() += 1;
            }
            tallies.push(Tally {
                value: value.clone(),
                measure: measure.name.clone(),
                counts,
                ratio: Spread::of(compared.iter().filter_map(Compared::ratio)),
            });
        }
    }
    tallies
}

#[cfg(test)]
mod tests;
