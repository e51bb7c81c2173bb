//! The points of a study: jobs that differ in replicates alone are the runs of one point.
//!
//! A measure of a point is the median over its runs that can be trusted; a point without such a run is not
//! trusted. A point deploys, or is safe, if all its runs are.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use serde::{Deserialize, Serialize};

use crate::analysis::replicates::{Condensed, Runs};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::job::row::DerivedColumn;
use crate::store::table::Table;

/// The points in some rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// One row per point: medians over the trusted runs.
    pub condensed: Condensed,
    /// Whether the measures of each point can be trusted.
    pub trusted: Vec<bool>,
}

impl Points {
    /// The points in some rows.
    pub fn of(table: &Table, rows: &[usize], replicates: &[String]) -> Self {
        let condensed = Condensed::of(table, rows, replicates);
        let trusted = condensed.runs.iter().map(|runs| runs.has_trusted).collect();
        Self { condensed, trusted }
    }

    /// Whether all runs of a point deployed; `None` where a run has no verdict.
    pub fn deploys(&self, point: usize) -> Option<bool> {
        all_of(&self.condensed.runs[point], |runs| runs.deployed)
    }

    /// Whether all runs of a point are safe; `None` where that cannot be said.
    pub fn is_safe(&self, point: usize) -> Option<bool> {
        all_of(&self.condensed.runs[point], |runs| runs.safe)
    }

    /// The points that have a job.
    pub fn feasible(&self) -> impl Iterator<Item = usize> {
        let table = &self.condensed.table;
        (0..self.trusted.len()).filter(|point| table.status(*point) != Some(Status::Infeasible))
    }
}

/// Whether all runs meet a condition: not if one does not, unknown while one is not judged.
fn all_of(runs: &Runs, of: fn(&Runs) -> Proportion) -> Option<bool> {
    let judged = of(runs);
    if judged.met < judged.of {
        Some(false)
    } else {
        (judged.of > 0 && judged.of == runs.finest.len()).then_some(true)
    }
}

/// The smallest margin of a point over its runs: the margin, its measure, the row of the run.
pub fn worst_margin(table: &Table, runs: &Runs) -> Option<(f64, String, usize)> {
    let column = table.column(DerivedColumn::SmallestMargin.name())?;
    let names = table.column(DerivedColumn::SmallestMarginOf.name())?;
    let margins = runs.finest.iter().filter_map(|row| match column.cells[*row] {
        Value::Number(margin) => Some((margin, *row)),
        _ => None,
    });
    let (margin, row) = margins.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((margin, names.cells[row].to_string(), row))
}

/// How the points of a study with replicates end.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct PointCounts {
    /// Number of points with a job.
    pub points: usize,
    /// Points whose runs all deploy.
    pub deployed: usize,
    /// Points of which some runs deploy and some do not.
    pub mixed: usize,
    /// Points of which no run deploys.
    pub never: usize,
    /// Other points: a run failed, has not ended or has no verdict.
    pub undecided: usize,
    /// The parameters that repeat a point.
    pub replicates: Vec<String>,
}

impl PointCounts {
    /// Counts the points.
    pub fn of(points: &Points, replicates: &[String]) -> Self {
        let mut counts = Self { replicates: replicates.to_vec(), ..Self::default() };
        for point in points.feasible() {
            counts.points += 1;
            let deployed = points.condensed.runs[point].deployed;
            *match points.deploys(point) {
                Some(true) => &mut counts.deployed,
                _ if deployed.is_mixed() => &mut counts.mixed,
                Some(false) => &mut counts.never,
                None => &mut counts.undecided,
            } += 1;
        }
        counts
    }
}

/// Points whose verdict depends on a numerical choice.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Depends {
    /// Number of such points.
    pub points: usize,
    /// Number of points with a verdict.
    pub of: usize,
    /// The choices, with their numbers of points.
    pub choices: Vec<(String, usize)>,
}

impl Depends {
    /// Counts such points; `None` without any.
    pub fn of(table: &Table, points: &Points) -> Option<Self> {
        let column = table.column(DerivedColumn::VerdictDependsOn.name())?;
        let mut depends = Self { points: 0, of: 0, choices: Vec::new() };
        let mut choices: BTreeMap<String, usize> = BTreeMap::new();
        for runs in &points.condensed.runs {
            let with_verdict = |row: &usize| -> Option<Verdict> { table.verdict(*row) };
            depends.of += usize::from(runs.rows.iter().any(|row| with_verdict(row).is_some()));
            let cells = runs.rows.iter().filter_map(|row| match &column.cells[*row] {
                Value::Text(text) => Some(text.split(", ")),
                _ => None,
            });
            let mut of_point: Vec<&str> = cells.flatten().collect();
            of_point.sort_unstable();
            of_point.dedup();
            depends.points += usize::from(!of_point.is_empty());
            for choice in of_point {
                *choices.entry(choice.to_owned()).or_default() += 1;
            }
        }
        depends.choices = choices.into_iter().collect();
        depends.choices.sort_by_key(|(_, points)| std::cmp::Reverse(*points));
        (depends.points > 0).then_some(depends)
    }
}
