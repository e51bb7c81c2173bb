//! The values of one choice, each pair of them over the points that are equal in all else: which is gentler,
//! and which deploys where the other does not.

use serde::{Deserialize, Serialize};

use super::points::Points;
use crate::analysis::compare::{self, Better, Measure, Pair, Sets, Tally, Tolerance, canonical};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{CellType, ColumnId};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

/// The parameter that is a choice by itself.
const STRATEGY: &str = "strategy";
/// Most values of which each pair is compared. Chosen: six have fifteen pairs.
const MAX_VALUES: usize = 6;

/// The measures of a pair: the loads first, which say what is gentler. Smaller is better in all of them.
const MEASURES: [ColumnId; 4] = [
    ColumnId::PeakVz,
    ColumnId::PeakKineticEnergy,
    ColumnId::T90ZRimSinceRelease,
    ColumnId::FilmStress99,
];
/// Number of them that are loads of the deployment.
const LOADS: usize = 2;

/// Two values of a choice, all other parameters being equal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Versus {
    /// The value that is lower in more of the loads.
    pub value: Value,
    /// The value with which it is compared.
    pub than: Value,
    /// What the loads say.
    pub loads: Loads,
    /// Number of pairs of points that have ended.
    pub pairs: usize,
    /// Pairs in which only the first value deploys in all runs.
    pub only_value: usize,
    /// Pairs in which only the second value does.
    pub only_than: usize,
    /// One entry per measure that a pair has.
    pub measures: Vec<MeasureVersus>,
}

/// What the loads of a pair of values say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loads {
    /// Each load is lower, or equal, in every pair.
    Gentler,
    /// Each load is lower in most pairs.
    MostlyGentler,
    /// The loads are equal in every pair.
    Equal,
    /// Anything else.
    Mixed,
    /// No pair has a load.
    Unknown,
}

/// One measure of two values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasureVersus {
    /// The measure.
    pub measure: ColumnId,
    /// Pairs in which both have it.
    pub pairs: usize,
    /// Of these, where the first value is lower.
    pub lower: usize,
    /// Of these, where it is higher.
    pub higher: usize,
    /// Of these, where both are equal up to the tolerance.
    pub ties: usize,
    /// Pairs in which only the first value has it.
    pub only_value: usize,
    /// Pairs in which only the second value has it.
    pub only_than: usize,
    /// Median of the first over the second.
    pub ratio: Option<f64>,
    /// Up to which difference values are equal.
    pub tolerance: Tolerance,
}

/// The parameter that is the choice of a study: the strategy, or the first one with words.
pub fn choice<'a>(table: &'a Table, rows: &[usize]) -> Option<&'a Column> {
    let varies = |column: &&Column| compare::values(column, rows).len() > 1;
    let strategy = table.parameters().find(|column| column.name == STRATEGY).filter(varies);
    let words = |column: &&Column| column.cell_type == CellType::Text && varies(column);
    strategy.or_else(|| table.parameters().find(words))
}

/// Each pair of values of a choice, in plan order; none for more than a few values.
pub fn pairwise(points: &Points, by: &str, zipped: &dyn Fn(&str) -> Vec<Zipped>) -> Vec<Versus> {
    let table = &points.condensed.table;
    let ended = |point: &usize| {
        !matches!(table.status(*point), None | Some(Status::Pending | Status::Infeasible))
    };
    let rows: Vec<usize> = (0..table.rows()).filter(ended).collect();
    let Some(column) = table.column(by) else { return Vec::new() };
    let values = compare::values(column, &rows);
    if values.len() > MAX_VALUES {
        return Vec::new();
    }
    let measures: Vec<Measure<'_>> = MEASURES
        .iter()
        .filter_map(|id| table.column(id.name()))
        .map(|column| Measure::of_points(&points.condensed, &rows, column, &zipped("seed")))
        .collect();
    let sets = Sets::new(table, &rows, by, &zipped(by));
    let comparison = Comparison { points, table, by, column, sets, measures };
    let mut found = Vec::new();
    for (index, first) in values.iter().enumerate() {
        found
            .extend(values[index + 1..].iter().filter_map(|other| comparison.versus(first, other)));
    }
    found
}

struct Comparison<'a> {
    points: &'a Points,
    table: &'a Table,
    by: &'a str,
    column: &'a Column,
    sets: Sets,
    measures: Vec<Measure<'a>>,
}

impl Comparison<'_> {
    /// Two values, the gentler one first; `None` where no points differ in this choice alone.
    fn versus(&self, first: &Value, other: &Value) -> Option<Versus> {
        let straight = self.one_way(first, other)?;
        let lower = |versus: &Versus| -> usize { loads(versus).map(|measure| measure.lower).sum() };
        let exchanged = self.one_way(other, first)?;
        Some(if lower(&exchanged) > lower(&straight) { exchanged } else { straight })
    }

    fn one_way(&self, value: &Value, than: &Value) -> Option<Versus> {
        let key = canonical(value);
        let (pairs, _) = compare::pairs(self.table, &self.sets, self.by, than);
        let pairs =
            pairs.into_iter().filter(|pair| canonical(&self.column.cells[pair.other]) == key);
        let pairs = compare::pairs_of_jobs(self.table, &pairs.collect::<Vec<_>>());
        if pairs.is_empty() {
            return None;
        }
        let trusted =
            |pair: &&Pair| self.points.trusted[pair.base] && self.points.trusted[pair.other];
        let trusted: Vec<Pair> = pairs.iter().filter(trusted).copied().collect();
        let tallies = compare::tallies(self.table, &trusted, self.by, &self.measures);
        let measures = tallies.iter().zip(&self.measures).filter_map(|(tally, measure)| {
            let versus = MeasureVersus::of(tally, measure)?;
            (versus.pairs + versus.only_value + versus.only_than > 0).then_some(versus)
        });
        let only = |deploys: fn(&Pair) -> usize, not: fn(&Pair) -> usize| {
            let deployed = |point| self.points.deploys(point);
            let is_only = |pair: &&Pair| {
                deployed(deploys(pair)) == Some(true) && deployed(not(pair)) == Some(false)
            };
            pairs.iter().filter(is_only).count()
        };
        let mut versus = Versus {
            value: value.clone(),
            than: than.clone(),
            loads: Loads::Unknown,
            pairs: pairs.len(),
            only_value: only(|pair| pair.other, |pair| pair.base),
            only_than: only(|pair| pair.base, |pair| pair.other),
            measures: measures.collect(),
        };
        versus.loads = judged(&versus);
        Some(versus)
    }
}

impl MeasureVersus {
    fn of(tally: &Tally, measure: &Measure<'_>) -> Option<Self> {
        let [lower, higher, ties] =
            [Better::Other, Better::Base, Better::Tie].map(|b| tally.count(b));
        Some(Self {
            measure: ColumnId::from_name(&tally.measure)?,
            pairs: lower + higher + ties,
            lower,
            higher,
            ties,
            only_value: tally.count(Better::OnlyOther),
            only_than: tally.count(Better::OnlyBase),
            ratio: tally.ratio.map(|spread| spread.median),
            tolerance: measure.tolerance,
        })
    }
}

/// The loads of two values.
fn loads(versus: &Versus) -> impl Iterator<Item = &MeasureVersus> {
    let is_load = |measure: &&MeasureVersus| MEASURES[..LOADS].contains(&measure.measure);
    versus.measures.iter().filter(is_load).filter(|measure| measure.pairs > 0)
}

fn judged(versus: &Versus) -> Loads {
    let all = |holds: fn(&MeasureVersus) -> bool| loads(versus).all(holds);
    if loads(versus).next().is_none() {
        Loads::Unknown
    } else if all(|load| load.ties == load.pairs) {
        Loads::Equal
    } else if all(|load| load.higher == 0) {
        Loads::Gentler
    } else if all(|load| 2 * load.lower > load.pairs) {
        Loads::MostlyGentler
    } else {
        Loads::Mixed
    }
}
