//! Everything stored of a job: one row per quantity, with group, name, value, unit and meaning.

use billow_solver::output::events::Event;

use super::Inspected;
use crate::accuracy::{NO_ERROR_REASON, is_error_column};
use crate::cli::limits;
use crate::input::keys::{self, KEYS};
use crate::input::value::Value;
use crate::job::row::{Cells, ColumnGroup};
use crate::platform::error::{Error, Result};
use crate::scene::summary;
use crate::store::history_file::{self, StoredHistory};

impl Inspected {
    pub(super) fn history(&self) -> Result<StoredHistory> {
        history_file::read(&self.stored.history_path(&self.id)?)
    }

    /// The scene of the job: the stored one if the job has run, else the one that will run.
    pub(super) fn scene(&self) -> Result<serde_json::Value> {
        let Self { stored, id, .. } = self;
        let is_stored = stored.record(id).is_some_and(|record| record.file_hash.is_some());
        let scene = match stored.point(id) {
            Some(point) if !is_stored && point.job.id == *id => {
                serde_json::to_value(&*point.job.scene)
            }
            _ => serde_json::from_str(&self.history()?.scene),
        };
        scene.map_err(|error| Error::Disk {
            path: stored.results.job_path(id),
            problem: format!("its scene is not valid JSON: {error}"),
        })
    }
}

/// The rows; the values in the units of a reader if asked for, in SI otherwise.
pub(super) fn rows(job: &Inspected, in_units: bool) -> Vec<Vec<Value>> {
    let Inspected { stored, id, cells } = job;
    let mut rows = vec![row("job", "job", Value::Text(id.to_string()), "", "")];
    for (name, value) in stored.point(id).iter().flat_map(|point| &point.job.parameters) {
        let meaning = keys::find(name).map_or("", |index| KEYS[index].doc);
        rows.push(row("parameters", name, value.clone(), stored.study.unit(name), meaning));
    }
    for group in ColumnGroup::ALL {
        rows.extend(columns(cells, group));
        if group == ColumnGroup::Outcome {
            rows.extend(limits::rows(stored, cells));
        }
    }
    let suggested = job.suggestions().into_iter();
    rows.extend(suggested.map(|text| row("suggestions", "try", Value::Text(text), "", "")));
    rows.extend(mesh_errors(job));
    let events = job.history().map(|history| history.events).unwrap_or_default();
    let event = |event: &Event| {
        let time = Value::Number(event.time);
        row("events", event.kind.name(), time, "s", event.kind.meaning())
    };
    rows.extend(events.iter().map(event));
    // The row is shown even if its file cannot be read: the error is then one of the rows.
    match job.scene() {
        Ok(scene) => rows.extend(summary::rows(&scene).into_iter().map(|mut pair| {
            let value = pair.pop().unwrap_or(Value::Null);
            let name = current_path(&pair[0].to_string());
            let key = KEYS.iter().find(|key| key.path == name);
            row("scene", &name, value, unit(&name), key.map_or("", |key| key.doc))
        })),
        Err(error) => rows.push(row("scene", "error", Value::Text(error.to_string()), "", "")),
    }
    if in_units {
        for row in &mut rows {
            show_in_units(row, job);
        }
    }
    rows
}

fn row(group: &str, name: &str, value: Value, unit: &str, meaning: &str) -> Vec<Value> {
    let text = |text: &str| Value::Text(text.to_owned());
    vec![text(group), text(name), value, text(unit), text(meaning)]
}

/// The columns of a group that have a value.
fn columns(cells: &Cells, group: ColumnGroup) -> impl Iterator<Item = Vec<Value>> {
    let filled = cells.iter().filter(|(_, value)| **value != Value::Null);
    filled.filter(move |(column, _)| column.group == group).map(move |(column, value)| {
        let noisy = if column.id.is_noisy() { "noisy: " } else { "" };
        let meaning = format!("{noisy}{}", column.meaning);
        row(group.name(), column.name, value.clone(), column.unit, &meaning)
    })
}

/// The mesh errors of a job's row, or why it has none.
fn mesh_errors(job: &Inspected) -> Vec<Vec<Value>> {
    let Some(table) = job.stored.table_of(&job.id) else { return Vec::new() };
    let columns = table.columns.iter().filter(|column| {
        let is_shown = is_error_column(&column.name) || column.name == NO_ERROR_REASON;
        is_shown && column.cells[0] != Value::Null
    });
    let group = ColumnGroup::Measures.name();
    columns
        .map(|column| {
            row(group, &column.name, column.cells[0].clone(), &column.unit, &column.meaning)
        })
        .collect()
}

/// Shows the value of a row in the unit that a reader asks for. A scene names its keys by their paths.
fn show_in_units(row: &mut [Value], job: &Inspected) {
    let (name, si) = (row[1].to_string(), row[3].to_string());
    let name = keys::index(&name).map_or(&*name, |index| keys::short_name(index));
    let unit = job.stored.units.of(name, &si);
    if unit.is_chosen() && !unit.symbol().is_empty() {
        row[2] = unit.value(&row[2]);
        row[3] = Value::Text(unit.symbol().to_owned());
    }
}

/// Keys that a stored scene gives another name than a study file: stored name, name of the key. The stored
/// names stay, because job ids are hashes of them.
const STORED_NAMES: [(&str, &str); 3] = [
    ("viscosity", "numerical_damping"),
    ("close_margin", "near_threshold_margin"),
    ("rate", "mass_flow_rate"),
];

/// The path of a value in a stored scene as a file has it: with the name of its key, and the number of a
/// list item in brackets.
fn current_path(stored: &str) -> String {
    let mut path = String::with_capacity(stored.len());
    for part in stored.split('.') {
        let name = STORED_NAMES.iter().find(|(stored, _)| *stored == part);
        let part = name.map_or(part, |(_, name)| name);
        let separator = if path.is_empty() { "" } else { "." };
        if !path.is_empty() && part.parse::<usize>().is_ok() {
            path.extend(["[", part, "]"]);
        } else {
            path.extend([separator, part]);
        }
    }
    path
}

/// SI unit of a number in a scene, given its dotted key; empty without a unit.
fn unit(key_path: &str) -> &'static str {
    let key = KEYS.iter().find(|key| key.path == key_path);
    match key.map(|key| key.kind) {
        Some(keys::KeyKind::Quantity(quantity)) => quantity.dimension.si(),
        _ => match key_path.rsplit('.').next().unwrap_or(key_path) {
            "from" | "to" | "release_time" | "end_time" | "sample_interval" => "s",
            "rate" | "mass_flow_rate" => "kg/s",
            "initial_mass" => "kg",
            "temperature" => "K",
            "gas_constant" | "cp" => "J/(kg K)",
            "gravity" => "m/s2",
            "coefficient" => "W/(m2 K)",
            _ => "",
        },
    }
}
