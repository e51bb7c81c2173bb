//! The stored runs of `studies/held-back.json`, by scene.
//!
//! They are stored, since they take hours: the rows of `billow table results/held-back --json --si --where
//! "status == 'done'" --columns job,status,verdict,top_radius,height,…` (the promised measures last), rounded to six
//! digits.

use std::collections::BTreeMap;

use billow_study::accuracy::Features;
use billow_study::job::Status;
use billow_study::job::row::{Cells, ColumnId};
use billow_study::platform::error::Result;
use billow_study::study::plan::next_jobs;
use billow_study::study::{MAX_POINTS, Study};

use super::runs::{MeshRun, SceneRuns, key};

const STUDY: &str = include_str!("../../../../studies/held-back.json");
const ROWS: &str = include_str!("../../../reference/held_back.json");
/// Scenes of a lot.
const LOT: usize = 20;
/// Subdivisions of the finest mesh.
pub(super) const FINEST: u32 = 24;

/// The runs of each scene that has one on n 24, with the number of its lot, from 1.
pub(super) fn lots() -> Result<Vec<(usize, SceneRuns)>> {
    let rows: Vec<BTreeMap<String, serde_json::Value>> =
        serde_json::from_str(ROWS).unwrap_or_else(|error| unreachable!("held_back.json: {error}"));
    let of_job = |row: &BTreeMap<String, serde_json::Value>| row["job"].as_str().map(str::to_owned);
    let mut rows: BTreeMap<String, _> =
        rows.into_iter().filter_map(|row| Some((of_job(&row)?, row))).collect();
    let study = Study::from_text(STUDY, "studies/held-back.json", "held-back", &[], MAX_POINTS)?;
    let points = next_jobs(&study, &[]).map(|generation| generation.points).unwrap_or_default();
    // Scenes in the order in which they were drawn.
    let mut scenes: Vec<(String, SceneRuns)> = Vec::new();
    for point in &*points {
        let scene = &point.job.scene;
        let key = key(scene);
        let index = scenes.iter().position(|(known, _)| *known == key).unwrap_or(scenes.len());
        if index == scenes.len() {
            scenes.push((key, SceneRuns { runs: Vec::new(), label: String::new() }));
        }
        let Some(row) = rows.remove(&point.job.id.to_string()) else { continue };
        let cells = cells(&row);
        let [top_radius, height] =
            [ColumnId::TopRadius, ColumnId::Height].map(|id| cells.number(id).unwrap_or(0.0));
        let Some(features) = Features::of(scene, top_radius, height) else { continue };
        scenes[index].1.runs.push(MeshRun { scene: (**scene).clone(), features, cells });
    }
    assert!(rows.is_empty(), "run studies/held-back.json again and store its table");
    let finest = |scene: &SceneRuns| scene.runs.iter().any(|run| run.mesh().1 == FINEST);
    let lots = scenes.into_iter().enumerate().map(|(index, (_, scene))| (index / LOT + 1, scene));
    Ok(lots.filter(|(_, scene)| finest(scene)).collect())
}

/// The cells of a stored row.
fn cells(row: &BTreeMap<String, serde_json::Value>) -> Cells {
    let mut cells = Cells::new(Status::Done);
    for (name, value) in row {
        match (ColumnId::from_name(name), value) {
            (Some(ColumnId::Status) | None, _) => {}
            (Some(column), serde_json::Value::Number(number)) => {
                cells.set(column, number.as_f64().unwrap_or(f64::NAN));
            }
            (Some(column), serde_json::Value::String(word)) => cells.set(column, word.as_str()),
            (Some(_), _) => {}
        }
    }
    cells
}
