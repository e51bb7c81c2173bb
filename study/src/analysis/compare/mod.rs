//! Comparing: what does one parameter do, all else equal?
//!
//! Rows that are equal in all other parameters make a set; in a set, the row with the base value and
//! each row with another one make a pair. Parameters are matched on their canonical text (the
//! shortest digits that read back as the number), never on nearly equal floats. A parameter that
//! stands on one axis with the compared one and follows from it changes with it, so it is not matched
//! (a strategy that brings its own residual gas).
//!
//! ```text
//! difference = other − base        ratio = other / base
//! tie:  |other − base| ≤ tie · max(|base|, |other|)
//! ```
//!
//! A measure counts only where its job is done; a job that failed, or has no pattern, has none, and
//! neither has one in which the thing measured never happened. A pair of which only one side has the
//! measure is an outcome (`only_base`, `only_other`) and is never dropped. A pair with a job still to
//! run is `pending` and counts for nothing.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::row::{self, Kind};
use crate::store::table::{Column, Table};

/// Measures of which less is better: sooner, or safer.
pub const SMALLER_IS_BETTER: [&str; 13] = [
    "t_50_z_rim",
    "t_90_z_rim",
    "t_50_volume",
    "t_90_volume",
    "t_deployed",
    "t_settled",
    "peak_vz",
    "peak_kinetic_energy",
    "overshoot",
    "ringing_rms",
    "film_stress",
    "peak_lid_force",
    "interlayer_pressure",
];
/// Measures of which more is better.
pub const LARGER_IS_BETTER: [&str; 2] = ["volume_ratio", "height_ratio"];
/// Largest relative difference of a tie, where nobody says otherwise: rounding, no physics.
pub const TIE: f64 = 1e-9;

/// A value as it is matched: numbers in shortest digits (8 = 8.0, −0 = 0), texts in quotes.
pub fn canonical(value: &Value) -> String {
    match value {
        Value::Number(number) => format!("{}", number + 0.0),
        Value::Text(text) => format!("{text:?}"),
        other => other.to_string(),
    }
}

/// Values of a column in some rows, each once, in the order of first appearance.
pub fn values(column: &Column, rows: &[usize]) -> Vec<Value> {
    let mut known = BTreeSet::new();
    let cells = rows.iter().map(|row| &column.cells[*row]);
    cells.filter(|value| known.insert(canonical(value))).cloned().collect()
}

/// Rows that are equal in all parameters but one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sets {
    /// The parameters matched.
    pub matched: Vec<String>,
    /// Parameters that change with the compared one.
    pub carried: Vec<String>,
    /// Rows of each set, in table order; sets in the order of their first row.
    pub sets: Vec<Vec<usize>>,
}

impl Sets {
    /// Sorts rows of a table into sets. `zipped` are the parameters on the axis of `by`.
    pub fn new(table: &Table, rows: &[usize], by: &str, zipped: &[String]) -> Self {
        let compared = table.parameters().find(|column| column.name == by);
        let follows = |column: &Column| {
            zipped.contains(&column.name)
                && compared.is_some_and(|compared| is_function(column, compared))
        };
        let others = || table.parameters().filter(|column| column.name != by);
        let matched: Vec<&Column> = others().filter(|column| !follows(column)).collect();
        let mut places: BTreeMap<Vec<String>, usize> = BTreeMap::new();
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for row in rows {
            let key = matched.iter().map(|column| canonical(&column.cells[*row])).collect();
            let place = *places.entry(key).or_insert(sets.len());
            if place == sets.len() {
                sets.push(Vec::new());
            }
            sets[place].push(*row);
        }
        Self {
            matched: matched.iter().map(|column| column.name.clone()).collect(),
            carried: others().filter(|column| follows(column)).map(|c| c.name.clone()).collect(),
            sets,
        }
    }
}

/// Whether each value of `of` comes with one value of `column`.
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

/// The pairs of some sets, and the rows left without a partner.
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

/// Which side of a pair a measure speaks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// The base value's job.
    Base,
    /// The other value's job.
    Other,
    /// Neither by more than the tie.
    Tie,
    /// Only the base value's job has the measure.
    OnlyBase,
    /// Only the other value's job has it.
    OnlyOther,
    /// Neither has it.
    Neither,
    /// A job is still to run.
    Pending,
    /// Both have it, and they differ, but less is not better, nor is more.
    Differ,
}

impl Better {
    /// As in the column `better`.
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

    /// What it is with base and other in each other's place.
    #[must_use]
    pub fn turned(self) -> Self {
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
    /// Of the base value's job.
    pub base: Option<f64>,
    /// Of the other value's job.
    pub other: Option<f64>,
    /// Which side it speaks for.
    pub better: Better,
}

impl Compared {
    /// Other less base.
    pub fn difference(&self) -> Option<f64> {
        Some(self.other? - self.base?)
    }

    /// Other over base; none over a base of zero.
    pub fn ratio(&self) -> Option<f64> {
        let base = self.base.filter(|base| *base != 0.0)?;
        Some(self.other? / base)
    }
}

/// Compares one measure of a pair; `tie` is the largest relative difference of a tie.
pub fn compared(table: &Table, pair: Pair, measure: &Column, tie: f64) -> Compared {
    let base = measured(table, measure, pair.base);
    let other = measured(table, measure, pair.other);
    let pending = [pair.base, pair.other].iter().any(|row| status(table, *row) == row::PENDING);
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
    // Equal infinities differ by no number.
    let equal =
        base.total_cmp(&other).is_eq() || (other - base).abs() <= tie * base.abs().max(other.abs());
    let smaller = if base < other { Better::Base } else { Better::Other };
    if equal {
        Better::Tie
    } else if SMALLER_IS_BETTER.contains(&measure) {
        smaller
    } else if LARGER_IS_BETTER.contains(&measure) {
        smaller.turned()
    } else {
        Better::Differ
    }
}

/// Status of a row.
pub fn status(table: &Table, row: usize) -> &str {
    match table.column("status").map(|column| &column.cells[row]) {
        Some(Value::Text(status)) => status,
        _ => "",
    }
}

/// A measure of a row, if its job is done and has it.
pub fn measured(table: &Table, measure: &Column, row: usize) -> Option<f64> {
    if status(table, row) != row::DONE {
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
    matches!(column.kind, Kind::Number | Kind::Integer)
}

/// One measure over all pairs of the base with one other value.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// The other value.
    pub value: Value,
    /// The measure.
    pub measure: String,
    /// How many pairs came out how; those pending are not pairs yet.
    pub counts: BTreeMap<&'static str, usize>,
    /// Ratios of the pairs that have both.
    pub ratio: Option<Spread>,
}

impl Tally {
    /// Pairs that came out like this.
    pub fn count(&self, better: Better) -> usize {
        self.counts.get(better.name()).copied().unwrap_or(0)
    }

    /// Pairs of which both jobs have ended.
    pub fn pairs(&self) -> usize {
        self.counts.values().sum::<usize>() - self.count(Better::Pending)
    }
}

/// Sums pairs up: by other value, and there by measure.
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
            for one in &compared {
                *counts.entry(one.better.name()).or_default() += 1;
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
