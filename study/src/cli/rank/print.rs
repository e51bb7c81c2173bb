//! A ranking as a table, and its notes.

use std::fmt::Write as _;
use std::io::Write;

use super::Printed;
use crate::analysis::compare;
use crate::analysis::ranking::{Basis, Candidate};
use crate::analysis::statistics::Spread;
use crate::cli::Format;
use crate::cli::print::{Heading, count, print_quantities};
use crate::input::units::DisplayUnit;
use crate::input::value::{Value, brief_number};
use crate::job::proportion::Proportion;
use crate::platform::error::Result;
use crate::study::Study;

/// Most candidates that a note names as left out.
const MAX_LEFT_OUT: usize = 6;

impl Printed<'_> {
    /// Prints one row per candidate.
    pub(super) fn print(
        &self,
        top: Option<usize>,
        format: Format,
        out: &mut dyn Write,
    ) -> Result<()> {
        let candidates = &self.ranking.candidates;
        let shown = top.unwrap_or(candidates.len()).min(candidates.len());
        let brief = format == Format::Table;
        let rows: Vec<Vec<Value>> = candidates[..shown]
            .iter()
            .enumerate()
            .map(|(index, candidate)| {
                if brief {
                    self.brief_row(index, candidate)
                } else {
                    self.full_row(index, candidate)
                }
            })
            .collect();
        let headings = if brief { self.brief_headings() } else { self.full_headings() };
        print_quantities(&headings, &rows, format, out)
    }

    fn shown(&self, name: &str) -> DisplayUnit {
        let column = self.table.column(name);
        column.map_or_else(|| DisplayUnit::si(""), |column| column.shown.clone())
    }

    fn by_headings(&self) -> Vec<Heading> {
        let by = self.by.iter().map(|name| Heading { name: name.clone(), unit: self.shown(name) });
        [Heading::plain("rank")].into_iter().chain(by).collect()
    }

    fn has_limits(&self) -> bool {
        self.ranking.basis == Basis::Limits
    }

    /// The columns of a table. Cells with a range have their unit in the header.
    fn brief_headings(&self) -> Vec<Heading> {
        let mut headings = self.by_headings();
        headings.push(Heading::plain("points"));
        if self.has_limits() {
            headings.push(Heading::plain("safe"));
            headings.extend(self.with_runs.then(|| Heading::plain("safe_runs")));
        }
        headings.push(Heading::plain("deployed"));
        headings.extend(self.with_runs.then(|| Heading::plain("deployed_runs")));
        if self.has_limits() {
            headings.extend(["smallest_margin", "of"].map(Heading::plain));
        }
        let measures = self
            .measures
            .iter()
            .map(|id| Heading { name: id.name().to_owned(), unit: self.shown(id.name()) });
        headings.extend(measures);
        headings.push(Heading::plain("dominated_by"));
        headings
    }

    fn brief_row(&self, index: usize, candidate: &Candidate) -> Vec<Value> {
        let mut row = by_cells(index, candidate);
        row.push(integer(candidate.points));
        let of = |met: usize| Value::Text(format!("{met} of {}", candidate.points));
        let runs = |runs: Proportion| {
            if runs.of == 0 { Value::Null } else { Value::Text(runs.to_string()) }
        };
        if self.has_limits() {
            row.push(of(candidate.safe));
            row.extend(self.with_runs.then(|| runs(candidate.safe_runs)));
        }
        row.push(if candidate.deployed_runs.of == 0 {
            Value::Null
        } else {
            of(candidate.deployed)
        });
        row.extend(self.with_runs.then(|| runs(candidate.deployed_runs)));
        if self.has_limits() {
            row.extend(margin(candidate));
        }
        for (spread, id) in candidate.measures.iter().zip(&self.measures) {
            let unit = self.shown(id.name());
            row.push(spread.map_or(Value::Null, |spread| Value::Text(ranged(&spread, &unit))));
        }
        row.push(candidate.dominated_by.map_or(Value::Null, integer));
        row
    }

    /// The columns for programs: numbers alone.
    fn full_headings(&self) -> Vec<Heading> {
        let mut headings = self.by_headings();
        let fixed = [
            "points",
            "safe",
            "safe_runs",
            "judged_runs",
            "safe_runs_low",
            "safe_runs_high",
            "deployed",
            "deployed_runs",
            "runs_with_verdict",
            "deployed_runs_low",
            "deployed_runs_high",
            "failed",
            "smallest_margin",
            "smallest_margin_of",
        ];
        headings.extend(fixed.map(Heading::plain));
        for id in &self.measures {
            let ends = ["", "_least", "_largest"].map(|end| format!("{}{end}", id.name()));
            headings.extend(ends.map(Heading::plain));
        }
        headings.push(Heading::plain("dominated_by"));
        headings
    }

    fn full_row(&self, index: usize, candidate: &Candidate) -> Vec<Value> {
        let mut row = by_cells(index, candidate);
        let runs = |runs: Proportion| {
            let [low, high] = runs
                .wilson()
                .map(|end| if runs.of == 0 { Value::Null } else { Value::Number(end) });
            [integer(runs.met), integer(runs.of), low, high]
        };
        row.push(integer(candidate.points));
        row.push(if self.has_limits() { integer(candidate.safe) } else { Value::Null });
        row.extend(runs(candidate.safe_runs));
        row.push(integer(candidate.deployed));
        row.extend(runs(candidate.deployed_runs));
        row.push(integer(candidate.failed));
        row.extend(margin(candidate));
        for spread in &candidate.measures {
            row.extend(spread.map_or([const { Value::Null }; 3], |spread| {
                [spread.median, spread.least, spread.largest].map(Value::Number)
            }));
        }
        row.push(candidate.dominated_by.map_or(Value::Null, integer));
        row
    }

    /// How the candidates are ordered, over which points, and what is left out.
    pub(super) fn notes(&self, top: Option<usize>, study: &Study) -> Vec<String> {
        let ranking = &self.ranking;
        let measures: Vec<&str> = self.measures.iter().map(|id| id.name()).collect();
        let measures = measures.join(", ");
        let runs =
            |missed: &str| if self.with_runs { format!(", {missed}") } else { String::new() };
        let order = match ranking.basis {
            Basis::Limits => format!(
                "points not safe ({}){}, smallest margin, medians of {measures}",
                self.limits.join(", "),
                runs("runs not safe")
            ),
            Basis::Verdicts => format!(
                "points not deployed{}, medians of {measures} (the study has no limits)",
                runs("runs not deployed")
            ),
            Basis::Measures => format!("medians of {measures} alone: no limits and no verdict"),
        };
        let mut notes = vec![format!("order: {order}")];
        let all: Vec<usize> = (0..self.table.rows()).collect();
        let varies = |name: &&String| {
            let column = self.table.column(name);
            column.is_some_and(|column| compare::values(column, &all).len() > 1)
        };
        let matched: Vec<String> = ranking.matched.iter().filter(varies).cloned().collect();
        if !matched.is_empty() {
            notes.push(format!(
                "over {} of points that are equal in {}",
                count(ranking.sets, "set"),
                listed(&matched, study)
            ));
        }
        if !ranking.carried.is_empty() {
            let by = self.by.join(", ");
            notes.push(format!(
                "note: {} changes with {by}, so it is not matched",
                ranking.carried.join(", ")
            ));
        }
        for (values, reason) in ranking.left_out.iter().take(MAX_LEFT_OUT) {
            notes.push(format!("left out: {}: {reason}", self.label(values)));
        }
        let more = ranking.left_out.len().saturating_sub(MAX_LEFT_OUT);
        if more > 0 {
            notes.push(format!("left out: {more} more candidates"));
        }
        for (number, why) in [
            (ranking.outside, "without a partner at every candidate"),
            (ranking.not_ended, "not ended, or infeasible"),
        ] {
            if number > 0 {
                notes.push(format!("left out: {} {why}", count(number, "point")));
            }
        }
        if ranking.not_trusted > 0 {
            notes.push(format!(
                "note: {} with a passage, an intersection or numerically_damped: the measures do not count",
                count(ranking.not_trusted, "point")
            ));
        }
        for (id, sets) in self.measures.iter().zip(&ranking.measure_sets) {
            if *sets < ranking.sets {
                let name = id.name();
                notes.push(format!(
                    "note: {name} over {sets} of {} sets: the others lack it",
                    ranking.sets
                ));
            }
        }
        let all = ranking.candidates.len();
        if let Some(top) = top.filter(|top| *top < all) {
            notes.push(format!("{top} of {all} candidates (--top)"));
        }
        notes
    }

    fn label(&self, values: &[Value]) -> String {
        let pairs = self.by.iter().zip(values);
        let texts: Vec<String> = pairs
            .map(|(name, value)| format!("{name}={}", self.shown(name).quantity(value)))
            .collect();
        texts.join(", ")
    }
}

/// Names of parameters; the searched one with what of it is common.
fn listed(names: &[String], study: &Study) -> String {
    let mut text = names.join(", ");
    if let Some((searched, _)) =
        study.searched().filter(|(name, _)| names.iter().any(|n| n == name))
    {
        let _ = write!(text, " (of {searched} the values that every candidate has)");
    }
    text
}

fn integer(number: usize) -> Value {
    Value::Integer(i64::try_from(number).unwrap_or(i64::MAX))
}

/// The smallest margin and its measure.
fn margin(candidate: &Candidate) -> [Value; 2] {
    candidate.margin.as_ref().map_or([const { Value::Null }; 2], |(margin, measure)| {
        [Value::Number(*margin), Value::Text(measure.clone())]
    })
}

/// A median with its range, in a unit: "12.3 (9.8 to 15)".
fn ranged(spread: &Spread, unit: &DisplayUnit) -> String {
    let [least, median, largest] =
        [spread.least, spread.median, spread.largest].map(|value| brief_number(unit.number(value)));
    if least == largest { median } else { format!("{median} ({least} to {largest})") }
}

/// Rank and values of a candidate.
fn by_cells(index: usize, candidate: &Candidate) -> Vec<Value> {
    [integer(index + 1)].into_iter().chain(candidate.values.iter().cloned()).collect()
}
