//! `billow-checks converge`: to what each measure tends as the mesh is refined, and the table of mesh errors.

use std::io::Write;
use std::path::{Path, PathBuf};

use billow_study::accuracy::{MeshErrors, PROMISED};
use billow_study::cli::options::ResultsOption;
use billow_study::cli::results::{self, StudyArgs};
use billow_study::input::value::Value;
use billow_study::job::row::ColumnId;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, disk_error, write_output};
use billow_study::print::print_rows;

use super::calibrate::calibrate;
use super::fit::{fit, levels};
use super::runs::{SceneRuns, by_scene};
use crate::output::Options;

/// Arguments of `billow-checks converge`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study files, or folders of their results.
    #[arg(required = true, value_name = "STUDY")]
    studies: Vec<PathBuf>,
    /// Write the table of mesh errors to this file, JSON.
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Subdivisions of the mesh with which that table compares the others.
    #[arg(long, value_name = "N", default_value_t = 24, requires = "table")]
    reference: u32,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks converge`: one row per scene and measure.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let mut all = Vec::new();
    for study in &args.studies {
        let given = StudyArgs { study: Some(study.clone()), results: ResultsOption::default() };
        all.push(results::read(&results::folder(&given)?)?);
    }
    let mut names: Vec<String> = Vec::new();
    for stored in &all {
        // Runs of one study may lie in several folders.
        if !names.contains(&stored.study.name) {
            names.push(stored.study.name.clone());
        }
    }
    let scenes = by_scene(&all);
    let rows: Vec<Vec<Value>> = scenes.iter().flat_map(rows).collect();
    if rows.is_empty() {
        let allowed =
            "results with film on at least four meshes (design.subdivisions), all else equal";
        let value = names.join(", ");
        return Err(Error::invalid_option("study", &value, "has no series of meshes", allowed, ""));
    }
    print_rows(&COLUMNS, &rows, args.options.format(), out)?;
    let Some(path) = &args.table else { return Ok(()) };
    let Some(table) = calibrate(&scenes, names, args.reference) else {
        let allowed = "the subdivisions of a mesh that a run of these results has";
        let value = args.reference.to_string();
        let problem = "no scene has this mesh";
        return Err(Error::invalid_option("--reference", &value, problem, allowed, ""));
    };
    write_table(&table, path, &args.options)
}

/// Writes the table of mesh errors to a file.
pub(super) fn write_table(table: &MeshErrors, path: &Path, options: &Options) -> Result<()> {
    let text = serde_json::to_value(table).map(|table| lines(&table, LINE_DEPTH) + "\n");
    let text = text.unwrap_or_default();
    write_output(&Disk, path, text.as_bytes()).map_err(|error| disk_error(path, &error))?;
    let errors = || table.errors.values().flatten();
    let scenes = errors().map(|entry| entry.scenes).max().unwrap_or(0);
    let (path, count) = (path.display(), errors().count());
    options.note(&format!("{path}: {count} errors, of up to {scenes} scenes"));
    Ok(())
}

/// A value as JSON text, with a line for each value down to a depth, and one for what lies below.
fn lines(value: &serde_json::Value, depth: usize) -> String {
    let inner: Vec<String> = match value {
        serde_json::Value::Object(object) if depth > 0 => object
            .iter()
            .map(|(key, value)| format!("{key:?}: {}", lines(value, depth - 1)))
            .collect(),
        serde_json::Value::Array(array) if depth > 0 => {
            array.iter().map(|value| lines(value, depth - 1)).collect()
        }
        _ => return value.to_string(),
    };
    let [open, close] = if value.is_object() { ['{', '}'] } else { ['[', ']'] };
    format!("{open}\n{}\n{close}", inner.join(",\n"))
}

/// Depth of the table at which an error is one line.
const LINE_DEPTH: usize = 3;

const COLUMNS: [&str; 9] =
    ["scene", "measure", "unit", "meshes", "finest", "limit", "change", "uncertainty", "order"];

/// The rows of a scene: one per measure that has values on at least four meshes.
fn rows(scene: &SceneRuns) -> Vec<Vec<Value>> {
    let measures = PROMISED.iter().map(|promised| promised.measure);
    let row = |measure: ColumnId| {
        let levels = levels(scene, measure);
        let fit = fit(&levels)?;
        let (first, last) = (levels.first()?, levels.last()?);
        // A fitted number that is no limit must not be read as one.
        let has_limit = fit.has_limit(&levels);
        let known = |value: f64| Value::from(has_limit.then_some(value));
        let relative = |value: f64| match last.value {
            0.0 => Value::Null,
            finest => known(value / finest),
        };
        Some(vec![
            scene.label.as_str().into(),
            measure.name().into(),
            measure.column().unit.into(),
            format!("{} to {}", first.subdivisions, last.subdivisions).into(),
            last.value.into(),
            known(fit.limit),
            relative(fit.limit - last.value),
            relative(fit.uncertainty),
            fit.order.into(),
        ])
    };
    measures.filter_map(row).collect()
}
