//! Values extrapolated from two or three meshes, for studies with `solver.meshes`.
//!
//! ```text
//! m = m₂ + w (m₂ − m₁)      the two finest meshes, w from the table of mesh errors
//! error: that of the table for these meshes; of three meshes at least |m − m'|, m' from the two coarsest
//! ```
//! The row of a run on the finest mesh has them, if the runs on the other meshes that are equal in all else are
//! done and trusted.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use billow_solver::scene::Scene;

use super::same_job::point_rows;
use super::{Column, Table};
use crate::accuracy::{Features, MeshErrors, Method, PROMISED, Promised};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::{CellType, ColumnId, SAME_JOB_AS};

/// The parameter whose values are the meshes.
pub const MESH: &str = "subdivisions";
/// End of the name of an extrapolated value, and of its error.
pub const EXTRAPOLATED: &str = "_extrapolated";
const ERROR: &str = "_extrapolated_error";

/// Name of the column with the extrapolated values of a measure, and of that with their errors.
pub fn names(measure: &str) -> [String; 2] {
    [format!("{measure}{EXTRAPOLATED}"), format!("{measure}{ERROR}")]
}

/// Whether a column holds extrapolated values or their errors.
pub fn is_extrapolated(name: &str) -> bool {
    let measure = name.strip_suffix(EXTRAPOLATED).or(name.strip_suffix(ERROR));
    measure.is_some_and(|measure| PROMISED.iter().any(|known| known.measure.name() == measure))
}

impl Table {
    /// The table with the values extrapolated from these meshes, coarsest first, and their errors. `points` are
    /// those of its rows.
    #[must_use]
    pub fn with_extrapolated(mut self, points: &[Point], meshes: &[u32]) -> Self {
        let Some(finest) = meshes.last().filter(|_| meshes.len() > 1) else { return self };
        let points = point_rows(points);
        let on_mesh = self.rows_by_mesh();
        let mut new = Vec::new();
        for promised in &PROMISED {
            let value = |row: usize| {
                let scene = &points[row].point.job.scene;
                if scene.design.subdivisions != *finest {
                    return None;
                }
                let rows = on_mesh.get(&self.other_parameters(row))?;
                let values = meshes.iter().map(|n| self.extrapolable(*rows.get(n)?, promised));
                let values: Vec<f64> = values.collect::<Option<_>>()?;
                let features = self.features(row, scene)?;
                Some(extrapolated(promised, scene, &features, meshes, &values))
            };
            let cells: Vec<Option<(f64, Option<f64>)>> = (0..self.rows()).map(value).collect();
            let unit = promised.measure.column().unit;
            let column = |name: String, meaning: String, cells: Vec<Option<f64>>| Column {
                name,
                cell_type: CellType::Number,
                unit: unit.to_owned(),
                shown: DisplayUnit::si(unit),
                meaning,
                cells: cells
                    .into_iter()
                    .map(|cell| cell.map_or(Value::Null, Value::Number))
                    .collect(),
            };
            let [value, error] = names(promised.measure.name());
            let measure = promised.measure.name();
            let values = cells.iter().map(|cell| cell.map(|(value, _)| value)).collect();
            let meaning = format!("{measure}, extrapolated from the meshes of the study");
            new.push(column(value, meaning, values));
            let errors = cells.iter().map(|cell| cell.and_then(|(_, error)| error)).collect();
            let meaning =
                format!("mesh error of the extrapolated {measure}: 9 of 10 runs are nearer");
            new.push(column(error, meaning, errors));
        }
        let last = self.columns.iter().position(|column| column.name == SAME_JOB_AS);
        let last = last.unwrap_or(self.columns.len());
        self.columns.splice(last..last, new);
        self
    }

    /// Whether it has extrapolated values.
    pub fn has_extrapolated(&self) -> bool {
        self.columns.iter().any(|column| is_extrapolated(&column.name))
    }

    /// The rows by their parameters without the mesh, and by the subdivisions of their mesh.
    fn rows_by_mesh(&self) -> BTreeMap<Vec<String>, BTreeMap<u32, usize>> {
        let mut rows: BTreeMap<Vec<String>, BTreeMap<u32, usize>> = BTreeMap::new();
        let Some(mesh) = self.parameters().find(|column| column.name == MESH) else { return rows };
        for row in 0..self.rows() {
            if let Value::Integer(n) = mesh.cells[row]
                && let Ok(n) = u32::try_from(n)
            {
                rows.entry(self.other_parameters(row)).or_default().insert(n, row);
            }
        }
        rows
    }

    /// The parameters of a row without the mesh.
    fn other_parameters(&self, row: usize) -> Vec<String> {
        let others = self.parameters().filter(|column| column.name != MESH);
        others.map(|column| column.cells[row].to_string()).collect()
    }

    /// A measure of a trusted run; the state at the end only where the capsule is deployed.
    fn extrapolable(&self, row: usize, promised: &Promised) -> Option<f64> {
        let deployed = self.verdict(row).is_none_or(|verdict| verdict == Verdict::Deployed);
        match self.value(promised.measure, row) {
            Some(Value::Number(value))
                if self.is_trusted(row) && (deployed || !promised.is_at_end()) =>
            {
                Some(*value)
            }
            _ => None,
        }
    }

    fn features(&self, row: usize, scene: &Scene) -> Option<Features> {
        let number = |column| match self.value(column, row) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        Some(Features::of(scene, number(ColumnId::TopRadius)?, number(ColumnId::Height)?))
    }
}

/// The extrapolated value of a measure on two or three meshes, and its error if it is known.
fn extrapolated(
    promised: &Promised,
    scene: &Scene,
    features: &Features,
    meshes: &[u32],
    values: &[f64],
) -> (f64, Option<f64>) {
    let table = MeshErrors::shipped();
    let method = |index: usize| Method {
        model: scene.solver.model,
        meshes: meshes[index..index + 2].to_vec(),
    };
    let of_pair = |index: usize| {
        let weight = table.entry(&method(index), promised.measure.name());
        let weight = weight.map_or(0.0, |entry| entry.weight);
        values[index + 1] + weight * (values[index + 1] - values[index])
    };
    let last = meshes.len() - 2;
    let value = of_pair(last);
    let covered = table.gap(scene, features).is_none();
    let known = covered.then(|| table.error(&method(last), features, promised).ok()).flatten();
    let known = known.map(|error| error * value.abs());
    let observed = (last > 0).then(|| (value - of_pair(last - 1)).abs());
    let error = match (known, observed) {
        (Some(known), Some(observed)) => Some(known.max(observed)),
        (known, observed) => known.or(observed),
    };
    (value, error)
}
