//! The effect of each parameter that varies, with all others equal: medians by value, the best and the
//! worst value, and what is not compared.
//!
//! The jobs of a measure are the done jobs that can be trusted and have the measure. Jobs that are equal in
//! all other parameters form a set. The medians of the values are comparable if each value has a job in
//! each set, so some values and some sets are chosen ([`super::medians`]).
//!
//! A value that is not among them is left out, with the reason. A set of jobs counts once, whatever number
//! of points are these jobs.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::output::measures::Verdict;
use serde::{Deserialize, Serialize};

use super::medians::{Extremes, Set, block, extremes};
use super::points::Points;
use crate::analysis::compare::{self, Measure, Range, Sets, Tolerance, canonical, median_range};
use crate::input::keys::numerical;
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{BetterSide, ColumnId};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

/// The parameters that vary, and their effects.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Effects {
    /// Parameters that can be compared, in the order of the study.
    pub effects: Vec<Effect>,
    /// Parameters that vary and cannot be compared, and why.
    pub not_compared: Vec<(String, String)>,
}

/// The effect of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// The parameter.
    pub parameter: String,
    /// Its SI unit; "1" for a dimensionless number, empty for text.
    pub unit: String,
    /// Unit in which its values are shown.
    pub shown: DisplayUnit,
    /// Parameters that change with it.
    pub carried: Vec<String>,
    /// Its values, in plan order.
    pub values: Vec<Value>,
    /// Of the jobs of each value that have a partner: how many deployed, and how many there are.
    pub deployed: Vec<(usize, usize)>,
    /// One entry per measure that can be compared.
    pub measures: Vec<MeasureEffect>,
    /// What is left out: the value, or `None` for all of them; the measure; the reason.
    pub left_out: Vec<(Option<Value>, ColumnId, String)>,
}

/// The effect of one parameter on one measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasureEffect {
    /// The measure.
    pub measure: ColumnId,
    /// Unit in which its medians are shown.
    pub shown: DisplayUnit,
    /// Number of sets in which every value has a job.
    pub sets: usize,
    /// Median of each value; `None` for a value that is left out.
    pub medians: Vec<Option<f64>>,
    /// How far the medians are apart.
    pub extremes: Extremes,
    /// Up to which difference medians are equal.
    pub tolerance: Tolerance,
}

impl Effects {
    /// Effects in some rows of a table. With `replicates` each point counts once, by the medians over its runs.
    /// `zipped` gives the parameters on the axis of one.
    pub fn of(
        table: &Table,
        rows: &[usize],
        replicates: &[String],
        measures: &[ColumnId],
        zipped: &dyn Fn(&str) -> Vec<Zipped>,
    ) -> Self {
        if replicates.is_empty() {
            let trusted = |row| table.is_trusted(row);
            let deploys = |row| table.verdict(row) == Some(Verdict::Deployed) && trusted(row);
            let judged = rows.iter().any(|row| table.verdict(*row).is_some());
            let judges = Judges { trusted: &trusted, deploys: &deploys, judged };
            let of_runs = |column| {
                let tolerance = Tolerance::of(table, rows, column, &zipped("seed"));
                Measure::of_runs(column, tolerance).with_errors(table)
            };
            return Self::of_rows(table, rows, &judges, (measures, &of_runs), zipped);
        }
        let points = Points::of(table, rows, replicates);
        let all_trusted = |point: usize| {
            points.condensed.runs[point].rows.iter().all(|row| table.is_trusted(*row))
        };
        let trusted = |point: usize| points.trusted[point];
        let deploys = |point| points.deploys(point) == Some(true) && all_trusted(point);
        let judged = points.condensed.runs.iter().any(|runs| runs.deployed.of > 0);
        let judges = Judges { trusted: &trusted, deploys: &deploys, judged };
        let rows: Vec<usize> = (0..points.condensed.runs.len()).collect();
        let (condensed, table) = (&points.condensed, &points.condensed.table);
        let of_points = |column| Measure::of_points(condensed, &rows, column, &zipped("seed"));
        Self::of_rows(table, &rows, &judges, (measures, &of_points), zipped)
    }

    /// Effects in some rows of a table with one row per point.
    fn of_rows<'a>(
        table: &'a Table,
        rows: &[usize],
        judges: &Judges<'_>,
        (ids, measure): (&[ColumnId], &dyn Fn(&'a Column) -> Measure<'a>),
        zipped: &dyn Fn(&str) -> Vec<Zipped>,
    ) -> Self {
        let named = |id: &ColumnId| Some((*id, measure(table.column(id.name())?)));
        let measures: Vec<(ColumnId, Measure<'_>)> = ids.iter().filter_map(named).collect();
        let mut effects = Self::default();
        for parameter in table.parameters() {
            if compare::values(parameter, rows).len() < 2 {
                continue;
            }
            let keys = parameter.cells.iter().map(canonical).collect();
            let study = Comparable {
                table,
                rows,
                judges,
                parameter,
                keys,
                zipped: zipped(&parameter.name),
            };
            match study.effect(&measures) {
                Ok(effect) => effects.effects.push(effect),
                Err(reason) => effects.not_compared.push((parameter.name.clone(), reason)),
            }
        }
        effects
    }
}

/// What is known of each row.
struct Judges<'a> {
    /// Whether its measures can be trusted.
    trusted: &'a dyn Fn(usize) -> bool,
    /// Whether it deployed, and can be trusted.
    deploys: &'a dyn Fn(usize) -> bool,
    /// Whether any job has a verdict.
    judged: bool,
}

/// A parameter that varies in some rows.
struct Comparable<'a> {
    table: &'a Table,
    rows: &'a [usize],
    judges: &'a Judges<'a>,
    parameter: &'a Column,
    /// The value of the parameter in each row of the table, as it is matched.
    keys: Vec<String>,
    zipped: Vec<Zipped>,
}

impl Comparable<'_> {
    /// The effect of the parameter.
    ///
    /// # Errors
    /// Why nothing can be compared.
    fn effect(&self, measures: &[(ColumnId, Measure<'_>)]) -> Result<Effect, String> {
        let values = compare::values(self.parameter, self.rows);
        let (all, carried) = self.sets(&values, &|row| {
            !matches!(self.table.status(row), Some(Status::Pending | Status::Infeasible) | None)
        });
        if all.is_empty() {
            return Err(self.without_sets());
        }
        let deployed = self.deployed(&values, &all);
        let judged = self.judges.judged;
        let always: Vec<bool> =
            deployed.iter().map(|(deployed, jobs)| !judged || deployed == jobs).collect();
        let mut effect = Effect {
            parameter: self.parameter.name.clone(),
            unit: self.parameter.unit.clone(),
            shown: self.parameter.shown.clone(),
            carried,
            deployed,
            measures: Vec::new(),
            left_out: Vec::new(),
            values,
        };
        for (id, measure) in measures {
            let has = |row| {
                (self.judges.trusted)(row)
                    && compare::measured(self.table, measure.column, row).is_some()
            };
            let (sets, _) = self.sets(&effect.values, &has);
            let Some((chosen, block)) = block(&sets, effect.values.len()) else {
                effect.left_out.push((None, *id, self.without_measure()));
                continue;
            };
            for index in (0..effect.values.len()).filter(|index| !chosen.contains(index)) {
                let reason = self.left_out(&effect.values[index], index, &sets, &has);
                effect.left_out.push((Some(effect.values[index].clone()), *id, reason));
            }
            let ranges = (0..effect.values.len()).map(|index| {
                let rows = block.iter().filter_map(|set| set[index]);
                let ranges: Vec<Range> =
                    rows.filter_map(|row| measure.range(self.table, row)).collect();
                median_range(&ranges).filter(|_| chosen.contains(&index))
            });
            let ranges: Vec<Option<Range>> = ranges.collect();
            // Of a mesh, or a model, no value is better: it computes another number for the same capsule.
            let of_method = numerical::is_of_method(&self.parameter.name);
            let side = if of_method { BetterSide::Neither } else { measure.side() };
            effect.measures.push(MeasureEffect {
                measure: *id,
                shown: measure.column.shown.clone(),
                sets: block.len(),
                extremes: extremes(&ranges, measure, &always, side),
                medians: ranges.iter().map(|range| range.map(|range| range[1])).collect(),
                tolerance: measure.tolerance,
            });
        }
        if effect.measures.is_empty() {
            return Err(self.without_measure());
        }
        Ok(effect)
    }

    /// The sets of different jobs among the rows that `has` keeps, each once, and the parameters that
    /// change with this one. A set of one job compares nothing.
    fn sets(&self, values: &[Value], has: &dyn Fn(usize) -> bool) -> (Vec<Set>, Vec<String>) {
        let rows: Vec<usize> = self.rows.iter().copied().filter(|row| has(*row)).collect();
        let sets = Sets::new(self.table, &rows, &self.parameter.name, &self.zipped);
        let texts: Vec<String> = values.iter().map(canonical).collect();
        let job = |row: usize| self.table.column("job").map(|job| job.cells[row].to_string());
        let mut seen = BTreeSet::new();
        let mut kept = Vec::new();
        for rows in &sets.sets {
            let mut first: BTreeMap<&str, usize> = BTreeMap::new();
            for row in rows {
                first.entry(&self.keys[*row]).or_insert(*row);
            }
            let set: Set = texts.iter().map(|text| first.get(text.as_str()).copied()).collect();
            let jobs: Vec<Option<String>> = set.iter().map(|row| row.and_then(job)).collect();
            let different: BTreeSet<&String> = jobs.iter().flatten().collect();
            if different.len() > 1 && seen.insert(jobs) {
                kept.push(set);
            }
        }
        (kept, sets.carried)
    }

    /// Of the different jobs of each value in the sets: how many deployed, and how many there are.
    fn deployed(&self, values: &[Value], sets: &[Set]) -> Vec<(usize, usize)> {
        let of_value = |index: usize| {
            let rows: Vec<usize> = sets.iter().filter_map(|set| set[index]).collect();
            let jobs = self.table.one_row_per_job(&rows);
            let deployed = jobs.iter().filter(|row| (self.judges.deploys)(**row));
            (deployed.count(), jobs.len())
        };
        (0..values.len()).map(of_value).collect()
    }

    /// Why no two jobs differ in this parameter alone.
    fn without_sets(&self) -> String {
        let name = &self.parameter.name;
        let (planned, _) = self.sets(&compare::values(self.parameter, self.rows), &|_| true);
        if !planned.is_empty() {
            return format!("no two finished jobs differ in {name} alone");
        }
        let jobs = self.table.one_row_per_job(self.rows).len();
        if jobs < self.rows.len() {
            return format!("points that differ in {name} alone are one job, or there are none");
        }
        format!("no two points differ in {name} alone")
    }

    /// Why no values have comparable medians of a measure.
    fn without_measure(&self) -> String {
        let name = &self.parameter.name;
        format!("no two trusted done jobs that differ in {name} alone have the measure")
    }

    /// Why a value is left out of a measure.
    fn left_out(
        &self,
        value: &Value,
        index: usize,
        sets: &[Set],
        has: &dyn Fn(usize) -> bool,
    ) -> String {
        let with = sets.iter().filter(|set| set[index].is_some()).count();
        let key = canonical(value);
        let is_value = |row: &&usize| self.keys[**row] == key;
        if with > 0 {
            format!("it is in {with} of {} sets", sets.len())
        } else if self.rows.iter().filter(is_value).any(|row| has(*row)) {
            format!("no job differs from it in {} alone", self.parameter.name)
        } else {
            "no trusted done job has the measure".to_owned()
        }
    }
}
