//! What a reader of a comparison must know, on stderr.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::Comparison;
use crate::analysis::compare::{ToleranceSource, pairs_of_jobs};
use crate::analysis::replicates::is_mesh;
use crate::cli::print::count;
use crate::cli::{best, legend};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::BetterSide;

/// What a cell of a point holds.
const MEDIANS: &str = "median [least to largest]";

impl Comparison<'_> {
    /// Prints, on stderr, which value is the base, which ratios are better, and what is not compared.
    pub(super) fn print_notes(&self, base: &Value, alone: &[usize]) {
        let by = &self.by.name;
        let base = self.by.shown.quantity(base);
        let mut text = format!("base: {by} = {base}; ratio: other / base");
        for (noun, side) in [("smaller", BetterSide::Smaller), ("larger", BetterSide::Larger)] {
            let measures = self.measures.iter().filter(|measure| measure.side() == side);
            let names: Vec<&str> = measures.map(|measure| measure.column.name.as_str()).collect();
            if !names.is_empty() {
                let _ = write!(text, "; better: {noun} {}", names.join(", "));
            }
        }
        eprintln!("{text}");
        let ties = self.measures.iter().map(|measure| {
            let source = match measure.tolerance.source {
                ToleranceSource::Given => "--tie",
                ToleranceSource::Ranges => "no spread of the method is known",
                ToleranceSource::Seeds => "spread over the seeds",
                ToleranceSource::MeshError => {
                    "of a pair the larger one; the median where one is not known"
                }
                ToleranceSource::Method => "spread of the method",
                ToleranceSource::Unknown => "spread not known: lower or higher, not better",
            };
            let limit = best::within(&measure.tolerance);
            format!("{} within {limit} ({source})", measure.column.name)
        });
        let ranges = self.measures.iter().any(|measure| measure.ranges.is_some())
            && self.replicates.iter().any(|name| !is_mesh(name, &self.meshes));
        let overlap = if ranges { "; or the ranges over the runs overlap" } else { "" };
        eprintln!("tie: {}{overlap}", ties.collect::<Vec<_>>().join(", "));
        if let Some(points) = self.points {
            let (rows, runs) = (self.table.rows(), points.run_count());
            let text = legend::points(rows, runs, &self.replicates, &self.meshes, MEDIANS);
            eprintln!("{text}; --runs pairs single runs");
        }
        let shown = self.measures.iter().any(|measure| measure.errors.is_some());
        let meshes = if self.points.is_some() { self.meshes.as_slice() } else { &[] };
        for note in legend::mesh_errors(shown, self.table, meshes) {
            eprintln!("{note}");
        }
        for carried in &self.sets.carried {
            eprintln!("note: {carried} changes with {by}, so it is not matched");
        }
        if let (None, Some(note)) = (self.points, self.not_trusted()) {
            eprintln!("{note}");
        }
        let jobs = pairs_of_jobs(self.table, &self.pairs).len();
        if jobs < self.pairs.len() {
            eprintln!(
                "note: {} of points are {} of jobs; the summary counts each of these once",
                count(self.pairs.len(), "pair"),
                count(jobs, "pair")
            );
        }
        if !alone.is_empty() {
            eprintln!(
                "note: {} without a partner that has the same other parameters: {}",
                count(alone.len(), "row"),
                self.labels(alone)
            );
        }
    }

    /// A note with the number of paired rows of done jobs that cannot be trusted; `None` without any.
    fn not_trusted(&self) -> Option<String> {
        let marked = |row: &usize| {
            self.table.status(*row) == Some(Status::Done) && self.table.audit_mark(*row).is_some()
        };
        let rows = self.pairs.iter().flat_map(|pair| [pair.base, pair.other]);
        let rows: BTreeSet<usize> = rows.filter(marked).collect();
        (!rows.is_empty()).then(|| {
            format!(
                "note: {} with a passage, an intersection or numerically_damped: a ratio with one of them is not to be \
                 trusted; --where numerically_damped == false leaves those out",
                count(rows.len(), "paired row")
            )
        })
    }

    /// Parameters of some rows, of the first three at most.
    fn labels(&self, rows: &[usize]) -> String {
        const MAX_SHOWN: usize = 3;
        let label = |row: &usize| {
            let parameters = self.table.parameters();
            let texts: Vec<String> = parameters
                .map(|column| {
                    format!("{}={}", column.name, column.shown.quantity(&column.cells[*row]))
                })
                .collect();
            texts.join(", ")
        };
        let mut labels: Vec<String> = rows.iter().take(MAX_SHOWN).map(label).collect();
        if rows.len() > MAX_SHOWN {
            labels.push(format!("and {} more", rows.len() - MAX_SHOWN));
        }
        labels.join("; ")
    }
}
