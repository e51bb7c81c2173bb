//! What the cells of a printed table say: medians over replicates, values extrapolated from several meshes or
//! corrected to a finer one, and mesh errors.

use std::fmt::Write as _;

use crate::accuracy::{NO_ERROR_REASON, PROMISED};
use crate::analysis::replicates::is_mesh;
use crate::input::value::Value;
use crate::print::count;
use crate::store::table::NOT_DEPLOYED;
use crate::store::table::Table;

/// What a row of points holds: runs that differ in `replicates`, on the meshes of the study (coarsest first; none where
/// values are not extrapolated). `of_each` says what a cell has.
pub fn points(
    points: usize,
    runs: usize,
    replicates: &[String],
    meshes: &[u32],
    of_each: &str,
) -> String {
    let names: Vec<&str> =
        replicates.iter().map(String::as_str).filter(|name| !is_mesh(name, meshes)).collect();
    let mut text = format!("{}, {}", count(points, "point"), count(runs, "run"));
    if !names.is_empty() && runs > points * meshes.len().max(1) {
        let _ = write!(text, " that differ in {}: {of_each}", names.join(", "));
    }
    if let Some((finest, coarser)) = meshes.split_last() {
        let [others @ .., next] = coarser else { return text };
        let _ = write!(
            text,
            "; {} are extrapolated from n {next} and {finest} (that of n {finest} where n {next} has none), all else is \
             that of n {finest}",
            estimated_names(),
        );
        for coarsest in others {
            let _ = write!(text, "; n {coarsest} shows how far the extrapolation changes");
        }
    }
    text
}

/// What the mesh errors that are `shown` are, and where they come from outside the table of mesh errors: of values that
/// are extrapolated from several meshes.
pub fn mesh_errors(shown: bool, table: &Table, meshes: &[u32]) -> Vec<String> {
    let mut notes = Vec::new();
    if shown {
        notes.push(format!(
            "±: mesh error, which 9 of 10 runs of the table of mesh errors keep: to the limit of fine meshes; of {} to \
             n 24 only",
            names(|has_limit| !has_limit)
        ));
    }
    let outside = || {
        let reasons = table.column(NO_ERROR_REASON);
        let is_gap = |cell: &Value| matches!(cell, Value::Text(text) if text != NOT_DEPLOYED);
        reasons.is_some_and(|reasons| reasons.cells.iter().any(is_gap))
    };
    if !meshes.is_empty() && outside() {
        notes.push(
            if meshes.len() > 2 {
                "rows that the table does not cover (no_error_reason): ± is 3 times the change of the extrapolated value \
                 from the two coarsest meshes to the two finest, or the error of the paper's capsule where that is larger"
            } else {
                "rows that the table does not cover (no_error_reason) have no ±: solver.meshes with three meshes gives one"
            }
            .to_owned(),
        );
    }
    notes
}

/// The measures that are extrapolated or corrected.
fn estimated_names() -> String {
    format!("{} and the times since the release", names(|_| true))
}

/// The promised measures with and without a limit of fine meshes, by their names.
fn names(of: fn(bool) -> bool) -> String {
    let chosen = PROMISED.iter().filter(|promised| of(promised.has_limit));
    chosen.map(|promised| promised.measure.name()).collect::<Vec<_>>().join(", ")
}
