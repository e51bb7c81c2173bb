//! What a reader of a comparison must know, on stderr.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::analysis::compare::{Comparison, ToleranceSource, pairs_of_jobs};
use crate::analysis::replicates::is_mesh;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::BetterSide;
use crate::print::count;
use crate::print::legend;
use crate::store::table::Table;
use crate::study::Meshes;

/// What a cell of a point holds.
const MEDIANS: &str = "median [least to largest]";

/// Prints, on stderr, which value is the base, which ratios are better, and what is not compared.
pub(super) fn print(
    comparison: &Comparison<'_>,
    base: &Value,
    alone: &[usize],
    replicates: &[String],
    meshes: &Meshes,
) {
    let by = &comparison.by.name;
    let base = comparison.by.shown.quantity(base);
    let mut text = format!("base: {by} = {base}; ratio: other / base");
    for (noun, side) in [("smaller", BetterSide::Smaller), ("larger", BetterSide::Larger)] {
        let measures = comparison.measures.iter().filter(|measure| measure.side() == side);
        let names: Vec<&str> = measures.map(|measure| measure.column.name.as_str()).collect();
        if !names.is_empty() {
            let _ = write!(text, "; better: {noun} {}", names.join(", "));
        }
    }
    eprintln!("{text}");
    let ties = comparison.measures.iter().map(|measure| {
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
        let limit = measure.tolerance.text();
        format!("{} within {limit} ({source})", measure.column.name)
    });
    let ranges = comparison.measures.iter().any(|measure| measure.ranges.is_some())
        && replicates.iter().any(|name| !is_mesh(name, meshes));
    let overlap = if ranges { "; or the ranges over the runs overlap" } else { "" };
    eprintln!("tie: {}{overlap}", ties.collect::<Vec<_>>().join(", "));
    if let Some(points) = comparison.points {
        let (rows, runs) =
            (comparison.table.rows(), points.runs.iter().map(|runs| runs.rows.len()).sum());
        let text = legend::points(rows, runs, replicates, meshes, MEDIANS);
        eprintln!("{text}; --runs pairs single runs");
    }
    let has_error = comparison.measures.iter().any(|measure| measure.errors.is_some());
    let shown = has_error.then_some(legend::MESH_ERROR);
    let of_runs = Meshes::default();
    let meshes = if comparison.points.is_some() { meshes } else { &of_runs };
    for note in legend::mesh_errors(shown, comparison.table, meshes) {
        eprintln!("{note}");
    }
    for carried in &comparison.sets.carried {
        eprintln!("note: {carried} changes with {by}, so it is not matched");
    }
    if let (None, Some(note)) = (comparison.points, not_trusted(comparison)) {
        eprintln!("{note}");
    }
    let jobs = pairs_of_jobs(comparison.table, &comparison.pairs).len();
    if jobs < comparison.pairs.len() {
        eprintln!(
            "note: {} of points are {} of jobs; the summary counts each of these once",
            count(comparison.pairs.len(), "pair"),
            count(jobs, "pair")
        );
    }
    if !alone.is_empty() {
        eprintln!(
            "note: {} without a partner that has the same other parameters: {}",
            count(alone.len(), "row"),
            labels(comparison.table, alone)
        );
    }
}

/// A note with the number of paired rows of done jobs that cannot be trusted; `None` without any.
fn not_trusted(comparison: &Comparison<'_>) -> Option<String> {
    let marked = |row: &usize| {
        comparison.table.status(*row) == Some(Status::Done)
            && comparison.table.audit_mark(*row).is_some()
    };
    let rows = comparison.pairs.iter().flat_map(|pair| [pair.base, pair.other]);
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
fn labels(table: &Table, rows: &[usize]) -> String {
    const MAX_SHOWN: usize = 3;
    let label = |row: &usize| {
        let parameters = table.parameters();
        let texts: Vec<String> = parameters
            .map(|column| format!("{}={}", column.name, column.shown.quantity(&column.cells[*row])))
            .collect();
        texts.join(", ")
    };
    let mut labels: Vec<String> = rows.iter().take(MAX_SHOWN).map(label).collect();
    if rows.len() > MAX_SHOWN {
        labels.push(format!("and {} more", rows.len() - MAX_SHOWN));
    }
    labels.join("; ")
}
