//! The table of a study: one row per point. In a study with `"model": "auto"` a row shows one run of its point; its
//! promised measures are corrected to the reference mesh, all else is as the run gave it.
//!
//! ```text
//! m = m_n F(x)                     F: correction of the pilots, [`crate::study::auto`]
//! error = m (ε + ε_ref)            ε: error of the correction;  ε_ref: mesh error of the reference mesh
//! ```

use std::collections::BTreeMap;

use super::extrapolated::{Extrapolated, SINCE_RELEASE};
use super::same_job::point_rows;
use super::{Column, Table};
use crate::accuracy::{Features, MeshErrors, Method, PROMISED, Promised};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::{CellType, SAME_JOB_AS};
use crate::store::finished;
use crate::store::journal::Record;
use crate::study::auto::{Auto, Decision, Outcome};
use crate::study::finished::FinishedRow;
use crate::study::{Study, plan};
use billow_solver::scene::ModelKind;

/// Column with the mesh of the run of a row.
pub const RUN_MESH: &str = "run_subdivisions";
/// Its meaning, one line.
pub const RUN_MESH_MEANING: &str = "subdivisions of the mesh of the run that the row shows; its promised measures are corrected to the reference mesh, all else is as that run gave it";

impl Table {
    /// The table of a study with these points planned so far, one row per point.
    pub fn of_study(study: &Study, points: &[Point], records: &BTreeMap<JobId, Record>) -> Self {
        let finished = || finished::rows(points, records, study.result_limits());
        match study.auto().zip(study.auto().and_then(|_| plan::shown(study, &finished()))) {
            Some((auto, (shown, outcome))) => {
                let unit = |name: &str| study.unit(name).to_owned();
                let mut table = Self::build(&shown, records, &unit);
                table.add_corrected(study, auto, &outcome, &shown, records);
                table.judged(study.result_limits())
            }
            None => Self::of_runs(study, points, records),
        }
    }

    /// The table of these runs of a study, with values extrapolated from several meshes where it has them.
    pub fn of_runs(study: &Study, points: &[Point], records: &BTreeMap<JobId, Record>) -> Self {
        let unit = |name: &str| study.unit(name).to_owned();
        let table = Self::build(points, records, &unit);
        table.with_extrapolated(points, &study.meshes()).judged(study.result_limits())
    }

    /// Adds the corrected values, and the mesh of each run.
    fn add_corrected(
        &mut self,
        study: &Study,
        auto: &Auto,
        outcome: &Outcome,
        shown: &[Point],
        records: &BTreeMap<JobId, Record>,
    ) {
        let rows = point_rows(shown);
        let finished: Vec<Option<FinishedRow>> = rows
            .iter()
            .map(|row| finished::row(row.point, records, study.result_limits()))
            .collect();
        for (index, promised) in PROMISED.iter().enumerate() {
            let cells = rows.iter().zip(&finished).map(|(row, finished)| {
                let decision = outcome.decision.as_ref()?;
                let value = finished.as_ref()?.promised[index]?;
                corrected(auto, decision, row.point, index, value)
            });
            let cells: Vec<Extrapolated> = cells.collect();
            let how = format!("; corrected to n {} by the pilots of the study", auto.reference);
            let values = cells.iter().map(|cell| cell.map(|(value, _)| value));
            self.replace(promised.measure.name(), values, &how);
            self.replace(
                promised.error_column,
                cells.iter().map(|cell| cell.and_then(|(_, error)| error)),
                "",
            );
            for (since, _) in SINCE_RELEASE.iter().filter(|(_, time)| *time == promised.measure) {
                let release = |row: usize| rows[row].point.job.scene.release_time;
                let values = cells.iter().enumerate();
                let values = values.map(|(row, cell)| cell.map(|(value, _)| value - release(row)));
                self.replace(since.name(), values, &how);
            }
        }
        let meshes = rows.iter().map(|row| row.point.job.scene.design.subdivisions);
        let column = Column {
            name: RUN_MESH.to_owned(),
            cell_type: CellType::Integer,
            unit: "1".to_owned(),
            shown: DisplayUnit::si("1"),
            meaning: RUN_MESH_MEANING.to_owned(),
            cells: meshes.map(|n| Value::Integer(i64::from(n))).collect(),
        };
        let last = self.columns.iter().position(|column| column.name == SAME_JOB_AS);
        self.columns.insert(last.unwrap_or(self.columns.len()), column);
    }

    /// Replaces the cells of a column, and adds to its meaning.
    fn replace(&mut self, name: &str, cells: impl Iterator<Item = Option<f64>>, how: &str) {
        let column = self.columns.iter_mut().find(|column| column.name == name);
        if let Some(column) = column {
            column.cells = cells.map(|cell| cell.map_or(Value::Null, Value::Number)).collect();
            column.meaning.push_str(how);
        }
    }
}

/// A corrected value, and its error against the limit of fine meshes.
fn corrected(
    auto: &Auto,
    decision: &Decision,
    point: &Point,
    index: usize,
    value: f64,
) -> Extrapolated {
    let (value, error) = auto.corrected(decision, &point.job.scene, point.solved, index, value)?;
    let of_reference = error_of_reference(auto, point, &PROMISED[index]);
    Some((value, of_reference.map(|of_reference| value.abs() * (error + of_reference))))
}

/// Relative mesh error of the reference mesh, where it is known.
fn error_of_reference(auto: &Auto, point: &Point, promised: &Promised) -> Option<f64> {
    let scene = &point.job.scene;
    let solved = point.solved?;
    let features = Features::of(scene, solved.top_radius, solved.height);
    let table = MeshErrors::shipped();
    let method = Method { model: ModelKind::Film, meshes: vec![auto.reference] };
    let covered = table.gap(scene, &features).is_none();
    let error = covered.then(|| table.error(&method, &features, promised).ok()).flatten();
    error.map(|error| error.of_itself).filter(|error| error.is_finite())
}
