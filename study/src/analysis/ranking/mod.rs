//! The order of candidates: the values of some parameters, over the same conditions.
//!
//! ```text
//! candidate = one combination of values of the ranked parameters
//! set       = points that are equal in all other parameters: the same conditions
//! order     = fewest points not safe, then the smallest proportion of runs not safe, then the medians of the
//!             measures, the smallest margin among them where it is asked for
//! ```
//! Only sets in which every ranked candidate has a point that has ended count, so all candidates are judged by
//! the same conditions. Without limits the points and runs that do not deploy take the place of those not safe;
//! without verdicts the measures decide alone.

use super::compare::{Measure, Range, Set, Tally, Tolerance};
use super::replicates::Condensed;
use super::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::{BetterSide, ColumnId, DerivedColumn};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

mod field;
mod order;
mod sets;
mod table;

use sets::{candidates, sets, shared};

/// The measures of a ranking where none are asked for, after those that the study limits.
pub const DEFAULT_MEASURES: [ColumnId; 3] =
    [ColumnId::PeakVz, ColumnId::PeakKineticEnergy, ColumnId::T90ZRimSinceRelease];

/// The measures of a ranking where none are asked for: what is limited and has a better side first.
pub fn default_measures(table: &Table, limits: &[ResultLimit]) -> Vec<&'static str> {
    let is_ordered = |limit: &&ResultLimit| {
        matches!(limit.condition, Condition::Bound { .. })
            && limit.measure.column().better != BetterSide::Neither
    };
    let limited = limits.iter().filter(is_ordered).map(|limit| limit.measure.name());
    let all = limited.chain(DEFAULT_MEASURES.map(|measure| table.of_any_film(measure).name()));
    let mut measures = Vec::new();
    for measure in all {
        if !measures.contains(&measure) {
            measures.push(measure);
        }
    }
    measures
}

/// What is ranked, and by what.
pub struct RankingInput<'a> {
    /// The table.
    pub table: &'a Table,
    /// The rows that count.
    pub rows: &'a [usize],
    /// The ranked parameters.
    pub by: &'a [String],
    /// The parameters that repeat a point.
    pub replicates: &'a [String],
    /// The limits of the study.
    pub limits: &'a [ResultLimit],
    /// The names of the measures, the most important one first. Each has a better side, or is the smallest margin.
    pub measures: &'a [&'a str],
    /// The parameters on the axis of one.
    pub zipped: &'a dyn Fn(&str) -> Vec<Zipped>,
}

/// Candidates, the best one first.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// What orders them first.
    pub basis: Basis,
    /// The candidates.
    pub candidates: Vec<Candidate>,
    /// The ranked parameters: columns without cells.
    pub by: Vec<Column>,
    /// The measures, and how each candidate stands to the best one.
    pub measures: Vec<RankedMeasure>,
    /// Whether the points of every set are one job, so that nothing is compared.
    pub is_one_job: bool,
    /// Number of sets of points over which all of them are ranked.
    pub sets: usize,
    /// The other parameters, equal in a set.
    pub matched: Vec<String>,
    /// Parameters that change with the ranked one.
    pub carried: Vec<String>,
    /// Candidates that are not ranked, and why.
    pub left_out: Vec<(Vec<Value>, String)>,
    /// Number of points of the ranked candidates outside these sets.
    pub outside: usize,
    /// Number of points that have not ended, or are infeasible.
    pub not_ended: usize,
    /// Number of ranked points whose measures cannot be trusted and do not count.
    pub not_trusted: usize,
}

/// A measure of a ranking.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedMeasure {
    /// The measure: a column without cells.
    pub column: Column,
    /// Up to which difference values are equal.
    pub tolerance: Tolerance,
    /// Number of sets with a value of every candidate that has one.
    pub sets: usize,
    /// Position of the candidate with the best median of those that deploy in all their points; `None` without one, and
    /// for a measure or a parameter of which no side is better.
    pub best: Option<usize>,
    /// Each candidate against the best one, set by set; `None` for the best one, and without values.
    pub against_best: Vec<Option<Tally>>,
    /// Whether the median of each candidate is equal to that of the best one.
    pub equal: Vec<bool>,
}

/// What orders candidates before their measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Safe points, then safe runs.
    Limits,
    /// Deployed points, then deployed runs.
    Verdicts,
    /// Nothing: no limits and no verdict.
    Measures,
}

/// One candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Values of the ranked parameters.
    pub values: Vec<Value>,
    /// Number of its points.
    pub points: usize,
    /// Points whose runs are all safe.
    pub safe: usize,
    /// Points whose runs all deploy.
    pub deployed: usize,
    /// Points of which a run failed.
    pub failed: usize,
    /// Its runs by the limits.
    pub safe_runs: Proportion,
    /// Its runs by their verdict.
    pub deployed_runs: Proportion,
    /// Of all its runs, those that are not safe, or without limits those that do not deploy. A run that
    /// cannot be judged is one of them, as its point is.
    pub missed: Proportion,
    /// The smallest margin over its runs, with its measure.
    pub margin: Option<(f64, String)>,
    /// Each measure: median over the points, range over their runs.
    pub measures: Vec<Option<Spread>>,
    /// Each measure: the medians of the smallest values, the medians and the largest values of its points.
    pub ranges: Vec<Option<Range>>,
}

/// The data of a ranking: points, and sets of them with one point per candidate.
struct Field<'a> {
    points: &'a Condensed,
    by: &'a [String],
    table: &'a Table,
    measures: Vec<Measure<'a>>,
    /// Positions of the ranked candidates in a set.
    chosen: Vec<usize>,
    sets: Vec<Set>,
    basis: Basis,
    /// Position among the measures at which the smallest margin orders.
    margin_at: Option<usize>,
}

impl Ranking {
    /// Ranks the candidates of an input.
    ///
    /// # Errors
    /// Why nothing can be ranked.
    pub fn of(input: &RankingInput<'_>) -> Result<Self, String> {
        let replicates: Vec<String> =
            input.replicates.iter().filter(|name| !input.by.contains(name)).cloned().collect();
        let points = Condensed::of(input.table, input.rows, &replicates);
        let table = &points.table;
        let all: Vec<usize> = (0..table.rows()).collect();
        let ended: Vec<usize> =
            all.iter().copied().filter(|point| has_ended(table, *point)).collect();
        let values = candidates(table, input.by);
        if ended.is_empty() {
            return Err("no point has ended".to_owned());
        }
        let (sets, matched, carried) = sets(table, &ended, input, &values);
        let shared = shared(&sets, values.len());
        let Some((chosen, kept)) = shared else {
            return Err(format!(
                "no two values of {} have ended points that are equal in all other parameters",
                input.by.join(", ")
            ));
        };
        let zipped = (input.zipped)("seed");
        let is_margin = |name: &&str| *name == DerivedColumn::SmallestMargin.name();
        let measures = input.measures.iter().filter(|name| !is_margin(name));
        let measures = measures.filter_map(|name| table.column(name));
        let measures = measures.map(|column| Measure::of_points(&points, &ended, column, &zipped));
        let field = Field {
            points: &points,
            by: input.by,
            table,
            measures: measures.collect(),
            sets: kept,
            basis: basis(input.limits, &points),
            margin_at: input.measures.iter().position(is_margin),
            chosen,
        };
        let mut ranking = field.ranked(&values);
        ranking.left_out = left_out(&field.chosen, &values, &sets);
        ranking.outside =
            ended.len() - ranked_points(&field).count() - left_out_points(&field, &sets);
        ranking.not_ended = all.len() - ended.len();
        (ranking.matched, ranking.carried) = (matched, carried);
        let by = input.by.iter().filter_map(|name| input.table.column(name));
        ranking.by = by.map(|column| column.like(column.name.clone(), Vec::new())).collect();
        Ok(ranking)
    }
}

/// What orders candidates first.
fn basis(limits: &[ResultLimit], points: &Condensed) -> Basis {
    if !limits.is_empty() {
        Basis::Limits
    } else if points.runs.iter().any(|runs| runs.deployed.of > 0) {
        Basis::Verdicts
    } else {
        Basis::Measures
    }
}

fn has_ended(table: &Table, point: usize) -> bool {
    !matches!(table.status(point), None | Some(Status::Pending | Status::Infeasible))
}

/// The points of the ranked candidates in the sets.
fn ranked_points<'a>(field: &'a Field<'_>) -> impl Iterator<Item = usize> + 'a {
    field.sets.iter().flat_map(|set| field.chosen.iter().filter_map(|index| set[*index]))
}

/// Number of points of the candidates that are left out.
fn left_out_points(field: &Field<'_>, sets: &[Set]) -> usize {
    let of_set = |set: &Set| {
        let points = set.iter().enumerate();
        points.filter(|(index, p)| p.is_some() && !field.chosen.contains(index)).count()
    };
    sets.iter().map(of_set).sum()
}

/// The candidates that are not ranked.
fn left_out(chosen: &[usize], values: &[Vec<Value>], sets: &[Set]) -> Vec<(Vec<Value>, String)> {
    let others = values.iter().enumerate().filter(|(index, _)| !chosen.contains(index));
    let reason = |index: usize| match sets.iter().filter(|set| set[index].is_some()).count() {
        0 => "none of its points has ended".to_owned(),
        with => format!("it is in {with} of {} sets of equal conditions", sets.len()),
    };
    others.map(|(index, values)| (values.clone(), reason(index))).collect()
}

impl Ranking {
    /// The values of the ranked parameters as a reader sees them.
    pub fn label(&self, values: &[Value]) -> String {
        let pairs = self.by.iter().zip(values);
        let texts: Vec<String> = pairs
            .map(|(column, value)| format!("{}={}", column.name, column.shown.quantity(value)))
            .collect();
        texts.join(", ")
    }
}

/// A value of a measure, with the sign with which the smaller one is better.
fn penalty(measure: &Measure<'_>, value: f64) -> f64 {
    let side = ColumnId::from_name(&measure.column.name).map(|id| id.column().better);
    if side == Some(BetterSide::Larger) { -value } else { value }
}

#[cfg(test)]
mod tests;
