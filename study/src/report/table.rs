//! The summary table of a report: its columns in the units of the study, with their uncertainties.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};

use super::packed;
use crate::analysis::compare::canonical;
use crate::analysis::replicates::Condensed;
use crate::chart::series_of;
use crate::input::value::Value;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::{ColumnId, DerivedColumn};
use crate::print::is_part;
use crate::store::table::{Column, ColumnCells, Table, row_column_name};

/// Digits of a job id. Chosen: unique among a million jobs but for one in a hundred million studies.
const ID_DIGITS: usize = 12;
/// Cells above which columns of one value stay away.
const MAX_CELLS: usize = 4_000_000;
/// Measures shown at first beside those of the limits.
const MAIN: [ColumnId; 6] = [
    ColumnId::TDeployed,
    ColumnId::T90ZRimSinceRelease,
    ColumnId::PeakSpeed,
    ColumnId::PeakKineticEnergy,
    ColumnId::PeakPressure,
    ColumnId::FinalHeight,
];
/// Measures whose limits do not hold for every sample of a history: a mean over 5 ms, and a least value after a peak.
const NOT_OF_SAMPLES: [ColumnId; 2] = [ColumnId::PeakSpeed, ColumnId::LowestZRim];
/// How a run ended.
const OUTCOMES: [ColumnId; 2] = [ColumnId::Status, ColumnId::Verdict];

/// The columns of a table.
pub fn columns(table: &Table, limits: &[ResultLimit]) -> Vec<Json> {
    let parameters: Vec<&str> = table.parameters().map(|column| column.name.as_str()).collect();
    let has_value = |column: &&Column| column.cells.iter().any(|cell| *cell != Value::Null);
    let all: Vec<&Column> =
        table.columns.iter().filter(|column| !is_part(table, column)).filter(has_value).collect();
    let too_many = all.len() * table.rows() > MAX_CELLS;
    let all = all.into_iter().filter(|column| !too_many || varies(column));
    all.map(|column| {
        let is_parameter = parameters.contains(&column.name.as_str());
        let id = ColumnId::from_name(row_column_name(&column.name));
        let is_outcome = id.is_some_and(|id| OUTCOMES.contains(&id))
            || column.name == DerivedColumn::Safety.name();
        let is_limited = limits.iter().any(|limit| Some(limit.measure) == id);
        let shown = is_outcome || is_limited || id.is_some_and(|id| MAIN.contains(&id));
        let mut json = json!({
            "name": column.name,
            "unit": if column.shown.symbol() == "1" { "" } else { column.shown.symbol() },
            "meaning": column.meaning,
            "role": match (is_parameter, is_outcome) {
                (true, _) => "parameter",
                (_, true) => "outcome",
                _ => "measure",
            },
            "shown": if is_parameter { varies(column) } else { shown && varies(column) || is_outcome },
            "varies": varies(column),
        });
        let cells = if is_number(column) { numbers(table, column, id) } else { words(column) };
        if let (Json::Object(json), Json::Object(cells)) = (&mut json, cells) {
            json.extend(cells);
        }
        json
    })
    .collect()
}

/// Whether a column has two different cells.
fn varies(column: &Column) -> bool {
    let mut cells = column.cells.iter().map(canonical);
    let is_same = matches!(column.cells, ColumnCells::Same(..));
    !is_same && cells.next().is_some_and(|first| cells.any(|cell| cell != first))
}

fn is_number(column: &Column) -> bool {
    column
        .cells
        .iter()
        .all(|cell| matches!(cell, Value::Null | Value::Integer(_) | Value::Number(_)))
}

/// A cell in the unit that is shown.
fn number(column: &Column, cell: &Value) -> Option<f64> {
    match cell {
        #[expect(clippy::cast_precision_loss, reason = "seven digits are shown")]
        Value::Integer(integer) => Some(*integer as f64),
        Value::Number(si) => Some(column.shown.number(*si)),
        _ => None,
    }
}

fn numbers(table: &Table, column: &Column, id: Option<ColumnId>) -> Json {
    let mut json = json!({
        "numbers": packed::singles(column.cells.iter().map(|cell| number(column, cell))),
    });
    let errors: Vec<Option<[f64; 2]>> = match id {
        Some(id) => (0..table.rows()).map(|row| table.uncertainty(id, row)).collect(),
        None => Vec::new(),
    };
    if errors.iter().any(Option::is_some) {
        let unit = column.shown.of_difference();
        for (name, side) in [("below", 0), ("above", 1)] {
            let side = errors.iter().map(|error| error.map(|error| unit.number(error[side])));
            json[name] = packed::singles(side).into();
        }
    }
    json
}

fn words(column: &Column) -> Json {
    let mut known: BTreeMap<String, u32> = BTreeMap::new();
    let mut words = Vec::new();
    let codes: Vec<u32> = column
        .cells
        .iter()
        .map(|cell| {
            let text = match cell {
                Value::Null => String::new(),
                cell if column.name == "job" => cell.to_string().chars().take(ID_DIGITS).collect(),
                Value::Number(_) => column.shown.text(cell),
                cell => cell.to_string(),
            };
            let new = u32::try_from(known.len()).unwrap_or(u32::MAX);
            *known.entry(text.clone()).or_insert_with(|| {
                words.push(text);
                new
            })
        })
        .collect();
    json!({"words": words, "codes": packed::indices(codes.into_iter())})
}

/// The point of each row, where runs repeat points, and whether its measures count for the point.
pub fn points(table: &Table, replicates: &[String]) -> Option<[String; 2]> {
    if replicates.is_empty() {
        return None;
    }
    let mut counted = vec![0_u32; table.rows()];
    let rows: Vec<usize> = (0..table.rows()).collect();
    let mut points = vec![0_u32; rows.len()];
    let runs = Condensed::of(table, &rows, replicates).runs;
    for (point, runs) in (0_u32..).zip(&runs) {
        for row in &runs.rows {
            points[*row] = point;
        }
        for row in &runs.measured {
            counted[*row] = 1;
        }
    }
    Some([points, counted].map(|values| packed::indices(values.into_iter())))
}

/// The limits of a study, bounds in SI.
pub fn limits(limits: &[ResultLimit]) -> Vec<Json> {
    let json = |limit: &ResultLimit| {
        let name = limit.measure.name();
        let bound = match &limit.condition {
            Condition::Bound { bound, .. } => Some(*bound),
            Condition::Is(_) => None,
        };
        let of_samples = !NOT_OF_SAMPLES.contains(&limit.measure);
        let (column, signs) = series_of(limit.measure).filter(|_| of_samples).unzip();
        json!({
            "measure": name, "text": limit.to_string(), "bound": bound, "column": column, "signs": signs,
        })
    };
    limits.iter().map(json).collect()
}
