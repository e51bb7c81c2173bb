//! What the cells of a printed table say: medians over replicates, values extrapolated from several meshes or
//! corrected to a finer one, and mesh errors.

use std::fmt::Write as _;

use crate::accuracy::row::{OF_CAPSULES, OF_FILM};
use crate::accuracy::{MeshErrors, NO_ERROR_REASON, is_of_pilots, is_unknown};
use crate::analysis::replicates::is_mesh;
use crate::input::value::Value;
use crate::print::count;
use crate::store::table::Table;
use crate::store::table::extrapolated::INDEX_FACTORS;
use crate::study::{Meshes, meshes_text};

/// What a row of points holds: runs that differ in `replicates`, on the meshes of the study (coarsest first; none where
/// values are not extrapolated). `of_each` says what a cell has.
pub fn points(
    points: usize,
    runs: usize,
    replicates: &[String],
    meshes: &Meshes,
    of_each: &str,
) -> String {
    let names: Vec<&str> =
        replicates.iter().map(String::as_str).filter(|name| !is_mesh(name, meshes)).collect();
    let mut text = format!("{}, {}", count(points, "point"), count(runs, "run"));
    let on_all = if meshes.of_pilots { &[][..] } else { &meshes.list };
    let repeats = !names.is_empty() && runs > points * on_all.len().max(1);
    // Pilots are runs too, whatever differs.
    if repeats && !meshes.of_pilots {
        let _ = write!(text, " that differ in {}: {of_each}", names.join(", "));
    }
    if meshes.of_pilots {
        let (all, finest) = (meshes_text(&meshes.list), meshes.list.last().unwrap_or(&1));
        let values = if meshes.of_file {
            format!("the values of n {finest}, with an error from n {all}")
        } else {
            format!("values extrapolated from n {all}")
        };
        let _ = write!(text, "; pilots have {values}, once these have run");
    }
    if let Some((finest, coarser)) = on_all.split_last() {
        let [others @ .., next] = coarser else { return text };
        if meshes.of_file {
            let all = meshes_text(&meshes.list);
            let _ = write!(text, "; values are those of n {finest}, with an error from n {all}");
            return text;
        }
        let _ = write!(
            text,
            "; the measures with a mesh error and the times since the release are extrapolated from n {next} and {finest} (that of \
             n {finest} where n {next} has none), all else is that of n {finest}"
        );
        for coarsest in others {
            let _ = write!(text, "; n {coarsest} shows how far the extrapolation changes");
        }
    }
    text
}

/// What a study gives to run each point on three meshes; `from_mesh`: of film from a mesh.
pub fn three_meshes(from_mesh: bool) -> &'static str {
    if from_mesh {
        "\"solver\": {\"meshes\": [1, 2, 3]}"
    } else {
        "\"solver\": {\"meshes\": [4, 6, 8]}"
    }
}

/// The uncertainty that a table shows.
pub const UNCERTAINTY: &str = "mesh error and what is assumed; limits count both; parts: <measure>_error_below, \
     _error_above, _assumed_below, _assumed_above";
/// The uncertainty that a comparison shows.
pub const MESH_ERROR: &str =
    "mesh error alone, since what is assumed moves both values of a pair alike";

/// What the uncertainties that are `shown` are, and where they come from outside the table of mesh errors: of values that
/// are extrapolated from several meshes.
pub fn mesh_errors(shown: Option<&str>, table: &Table, meshes: &Meshes) -> Vec<String> {
    let mut notes = Vec::new();
    let reasons = || table.column(NO_ERROR_REASON).into_iter().flat_map(|one| one.cells.iter());
    if let Some(shown) = shown.filter(|_| reasons().any(|reason| *reason == Value::Null)) {
        let finest = MeshErrors::shipped().finest;
        notes.push(format!(
            "− and +, or ±: how far below and above it the value at {finest} subdivisions may be, in 19 of 20 runs: {shown}"
        ));
    }
    let texts = reasons().filter_map(|cell| match cell {
        Value::Text(text) => Some(text.as_str()),
        _ => None,
    });
    let (known, gaps): (Vec<&str>, Vec<&str>) = texts.partition(|text| !is_unknown(text));
    if shown.is_some() && known.into_iter().any(is_of_pilots) {
        notes.push(
            "− and +, where the table does not reach: the largest error of the pilots (no_error_reason)"
                .to_owned(),
        );
    }
    if shown.is_some() && meshes.of_file {
        notes.push(
            "what is assumed (film loss, heat transfer) changes film from a mesh as it does a folded capsule: measured on these"
                .to_owned(),
        );
    }
    let Some(gap) = gaps.first() else { return notes };
    let on_all = if meshes.of_pilots { 0 } else { meshes.list.len() };
    let from_mesh = *gap == OF_CAPSULES;
    let three = three_meshes(from_mesh);
    notes.push(match on_all {
        2.. if from_mesh => format!(
            "− and + are {} times the largest change from mesh to mesh, taken to the limit as 1/n (grid convergence index)",
            INDEX_FACTORS[usize::from(on_all > 2)]
        ),
        0 => {
            // That of another model says what to do.
            let remedy = if gap.starts_with(OF_FILM) { String::new() } else { format!("; {three} gives one") };
            format!("rows without − and + have no known error (no_error_reason): {gap}{remedy}")
        }
        2 => format!("rows that the table does not cover (no_error_reason) have no error; {three} gives one"),
        _ => "rows that the table does not cover (no_error_reason): − and + are 3 times the change of the extrapolated value \
              from the two coarsest meshes to the two finest, or the error in the middle of the table where that is larger"
            .to_owned(),
    });
    notes
}
