//! The effect of each parameter that varies, with all others equal: medians by value, the best and the
//! worst value, and what is not compared.
//!
//! The jobs of a measure are the done jobs that can be trusted and have the measure. Jobs that are equal in
//! all other parameters form a set. The medians of the values are comparable if each value has a job in
//! each set. So some values and some sets are chosen: those with the most independent comparisons,
//!
//! ```text
//! (values − 1) · sets → max
//! ```
//!
//! A value that is not among them is left out, with the reason. A set of jobs counts once, whatever number
//! of points are these jobs.

use std::collections::BTreeSet;

use billow_solver::output::measures::Verdict;

use super::trust::is_trusted;
use crate::analysis::compare::{self, Measure, Sets, Tolerance, canonical};
use crate::analysis::statistics::Spread;
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{BetterSide, ColumnId};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

/// The parameters that vary, and their effects.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Effects {
    /// Parameters that can be compared, in the order of the study.
    pub effects: Vec<Effect>,
    /// Parameters that vary and cannot be compared, and why.
    pub not_compared: Vec<(String, String)>,
}

/// The effect of one parameter.
#[derive(Debug, Clone, PartialEq)]
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
    /// Values that are left out of a measure: the value, the measure, the reason.
    pub left_out: Vec<(Value, ColumnId, String)>,
}

/// The effect of one parameter on one measure.
#[derive(Debug, Clone, PartialEq)]
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

/// The best and the worst values of a parameter by one measure: positions in [`Effect::values`], the
/// extreme one first, then those that are equal to it up to the tolerance.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Extremes {
    /// All medians are equal up to the tolerance.
    Equal,
    /// The measure has a better side. `best` is empty when no value deploys in all its jobs.
    Judged {
        /// The values with the best medians of those that deploy in all their jobs.
        best: Vec<usize>,
        /// The values with the worst medians.
        worst: Vec<usize>,
    },
    /// Neither side is better, or no spread of the measure is known.
    Range {
        /// The values with the lowest medians.
        lowest: Vec<usize>,
        /// The values with the highest medians.
        highest: Vec<usize>,
    },
}

impl Effects {
    /// Effects in some rows of a table. `zipped` gives the parameters on the axis of one.
    pub fn of(
        table: &Table,
        rows: &[usize],
        measures: &[ColumnId],
        zipped: &dyn Fn(&str) -> Vec<Zipped>,
    ) -> Self {
        let measures: Vec<(ColumnId, Measure<'_>)> = measures
            .iter()
            .filter_map(|id| {
                let column = table.column(id.name())?;
                let tolerance = Tolerance::of(table, rows, column, &zipped("seed"));
                Some((*id, Measure { column, tolerance }))
            })
            .collect();
        let mut effects = Self::default();
        for parameter in table.parameters() {
            if compare::values(parameter, rows).len() < 2 {
                continue;
            }
            let study = Comparable { table, rows, parameter, zipped: zipped(&parameter.name) };
            match study.effect(&measures) {
                Ok(effect) => effects.effects.push(effect),
                Err(reason) => effects.not_compared.push((parameter.name.clone(), reason)),
            }
        }
        effects
    }
}

/// One row of a set per value of the parameter.
type Set = Vec<Option<usize>>;

/// A parameter that varies in some rows.
struct Comparable<'a> {
    table: &'a Table,
    rows: &'a [usize],
    parameter: &'a Column,
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
        let judged = self.judged();
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
                is_trusted(self.table, row)
                    && compare::measured(self.table, measure.column, row).is_some()
            };
            let (sets, _) = self.sets(&effect.values, &has);
            let Some((chosen, block)) = block(&sets, effect.values.len()) else { continue };
            for index in (0..effect.values.len()).filter(|index| !chosen.contains(index)) {
                let reason = self.left_out(&effect.values[index], index, &sets, &has);
                effect.left_out.push((effect.values[index].clone(), *id, reason));
            }
            let medians = (0..effect.values.len()).map(|index| {
                let rows = block.iter().filter_map(|set| set[index]);
                let numbers =
                    rows.filter_map(|row| compare::measured(self.table, measure.column, row));
                chosen.contains(&index).then(|| Spread::of(numbers))?.map(|spread| spread.median)
            });
            let medians: Vec<Option<f64>> = medians.collect();
            effect.measures.push(MeasureEffect {
                measure: *id,
                shown: measure.column.shown.clone(),
                sets: block.len(),
                extremes: extremes(&medians, measure, &always),
                medians,
                tolerance: measure.tolerance,
            });
        }
        if effect.measures.is_empty() {
            return Err(format!(
                "no two trusted done jobs that differ in {} alone have the same measure",
                effect.parameter
            ));
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
            let of_value = |text: &String| {
                rows.iter().copied().find(|row| canonical(&self.parameter.cells[*row]) == *text)
            };
            let set: Set = texts.iter().map(of_value).collect();
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
            let deployed = jobs.iter().filter(|row| {
                self.table.verdict(**row) == Some(Verdict::Deployed)
                    && is_trusted(self.table, **row)
            });
            (deployed.count(), jobs.len())
        };
        (0..values.len()).map(of_value).collect()
    }

    /// Whether a job has a verdict.
    fn judged(&self) -> bool {
        self.rows.iter().any(|row| self.table.verdict(*row).is_some())
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

    /// Why a value is left out of a measure.
    fn left_out(
        &self,
        value: &Value,
        index: usize,
        sets: &[Set],
        has: &dyn Fn(usize) -> bool,
    ) -> String {
        let with = sets.iter().filter(|set| set[index].is_some()).count();
        let is_value = |row: &&usize| canonical(&self.parameter.cells[**row]) == canonical(value);
        if with > 0 {
            format!("it is in {with} of {} sets", sets.len())
        } else if self.rows.iter().filter(is_value).any(|row| has(*row)) {
            format!("no job differs from it in {} alone", self.parameter.name)
        } else {
            "no trusted done job has the measure".to_owned()
        }
    }
}

/// The values and the sets with the most independent comparisons, of those sets in which every one of these
/// values has a job; `None` when no set has two values.
fn block(sets: &[Set], values: usize) -> Option<(Vec<usize>, Vec<&Set>)> {
    let number = |index: &usize| sets.iter().filter(|set| set[*index].is_some()).count();
    let mut order: Vec<usize> = (0..values).collect();
    // The sort is stable: values of equally many sets stay in plan order.
    order.sort_by_key(|index| std::cmp::Reverse(number(index)));
    let mut complete: Vec<&Set> = sets.iter().collect();
    let mut best: Option<(usize, usize)> = None;
    for (others, index) in order.iter().enumerate() {
        complete.retain(|set| set[*index].is_some());
        let comparisons = others * complete.len();
        if comparisons > 0 && best.is_none_or(|(_, most)| comparisons >= most) {
            best = Some((others + 1, comparisons));
        }
    }
    let (number, _) = best?;
    let chosen = order[..number].to_vec();
    let block = sets.iter().filter(|set| chosen.iter().all(|index| set[*index].is_some()));
    Some((chosen.clone(), block.collect()))
}

/// The best and the worst of some medians. `always` says which values deploy in all their jobs.
fn extremes(medians: &[Option<f64>], measure: &Measure<'_>, always: &[bool]) -> Extremes {
    let mut order: Vec<(usize, f64)> = medians
        .iter()
        .enumerate()
        .filter_map(|(index, median)| Some((index, (*median)?)))
        .collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (Some(lowest), Some(highest)) = (order.first(), order.last()) else {
        return Extremes::Equal;
    };
    if measure.tolerance.is_tie(lowest.1, highest.1) {
        return Extremes::Equal;
    }
    let tied = |order: &mut dyn Iterator<Item = &(usize, f64)>| -> Vec<usize> {
        let Some((first, extreme)) = order.next() else { return Vec::new() };
        let equal = order.take_while(|(_, median)| measure.tolerance.is_tie(*extreme, *median));
        [*first].into_iter().chain(equal.map(|(index, _)| *index)).collect()
    };
    let deploys = |entry: &&(usize, f64)| always[entry.0];
    let (lowest, highest) = (tied(&mut order.iter()), tied(&mut order.iter().rev()));
    match measure.side() {
        BetterSide::Smaller => {
            let best = tied(&mut order.iter().filter(deploys));
            Extremes::Judged { best, worst: highest }
        }
        BetterSide::Larger => {
            let best = tied(&mut order.iter().rev().filter(deploys));
            Extremes::Judged { best, worst: lowest }
        }
        BetterSide::Neither => Extremes::Range { lowest, highest },
    }
}
