//! The points of a study: how their runs end, and which verdicts depend on a numerical choice.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{named, parameters, parameters_of};
use crate::analysis::replicates::{Condensed, Runs};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::row::DerivedColumn;
use crate::store::table::Table;

/// How the points of a study with replicates end.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
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
    #[serde(rename = "not_decided")]
    pub undecided: usize,
    /// The parameters that repeat a point.
    pub replicates: Vec<String>,
}

impl PointCounts {
    /// Counts the points.
    pub fn of(points: &Condensed, replicates: &[String]) -> Self {
        let mut counts = Self { replicates: replicates.to_vec(), ..Self::default() };
        for point in points.feasible() {
            counts.points += 1;
            let deployed = points.runs[point].deployed;
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

/// A point whose runs do not all end alike.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MixedPoint {
    /// Its parameters, and the units in which they are shown.
    #[serde(serialize_with = "parameters")]
    pub parameters: Vec<(String, Value, DisplayUnit)>,
    /// Of the runs with a verdict, those that deployed.
    pub deployed: Proportion,
    /// Of the runs that the limits can judge, those that are safe.
    pub safe: Proportion,
    /// Number of these that are unsafe: the others are within their uncertainty.
    pub not_safe: usize,
}

impl MixedPoint {
    /// The points of which some runs deploy, or are safe, and some do not.
    pub fn all(points: &Condensed) -> Vec<Self> {
        let of = |point: usize| {
            let Runs { deployed, safe, not_safe, .. } = points.runs[point];
            let missed = Proportion { met: not_safe, ..safe };
            let mixed = deployed.is_mixed() || safe.is_mixed() || missed.is_mixed();
            let parameters = || parameters_of(&points.table, point);
            mixed.then(|| Self { parameters: parameters(), deployed, safe, not_safe })
        };
        (0..points.runs.len()).filter_map(of).collect()
    }
}

/// Points whose verdict depends on a numerical choice.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct VerdictSensitivity {
    /// Number of such points.
    pub points: usize,
    /// Number of points with a verdict.
    pub of: usize,
    /// The choices, with their numbers of points.
    #[serde(serialize_with = "named")]
    pub choices: Vec<(String, usize)>,
}

impl VerdictSensitivity {
    /// Counts such points; `None` without any.
    pub fn of(table: &Table, points: &Condensed) -> Option<Self> {
        let column = table.column(DerivedColumn::VerdictDependsOn.name())?;
        let mut found = Self { points: 0, of: 0, choices: Vec::new() };
        let mut choices: BTreeMap<String, usize> = BTreeMap::new();
        for runs in &points.runs {
            found.of += usize::from(runs.rows.iter().any(|row| table.verdict(*row).is_some()));
            let cells = runs.rows.iter().filter_map(|row| match &column.cells[*row] {
                Value::Text(text) => Some(text.split(", ")),
                _ => None,
            });
            let mut of_point: Vec<&str> = cells.flatten().collect();
            of_point.sort_unstable();
            of_point.dedup();
            found.points += usize::from(!of_point.is_empty());
            for choice in of_point {
                *choices.entry(choice.to_owned()).or_default() += 1;
            }
        }
        found.choices = choices.into_iter().collect();
        found.choices.sort_by_key(|(_, points)| std::cmp::Reverse(*points));
        (found.points > 0).then_some(found)
    }
}
