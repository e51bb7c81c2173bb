//! Values extrapolated from two or three meshes, for studies with `solver.meshes`.
//!
//! ```text
//! m = m₂ + w (m₂ − m₁)      the two finest meshes, w from the table of mesh errors
//! error = max(e, |m − m'|)    below and above m;  e: that of the table for these meshes;  m': from the two coarsest of three
//! outside the table, or without runs of such scenes on the two finest, of three meshes only:
//! error = max(e₀, 3 |m − m'|)   e₀: e of the table's base scene
//! film from a mesh, of which the table knows nothing (grid convergence index, errors go as 1/n):
//! m = m_f,  error = s max |m_j − m_i|/(1/i − 1/j)/f    pairs of meshes i < j, the finest f;  s = 1.25 with three, 3 with two
//! ```
//! P. J. Roache, "Perspective: a method for uniform reporting of grid refinement studies", J. Fluids Eng. 116 (1994).
//! [Record 24](../../../../docs/decisions/0024-mesh-errors.md) has the reasons for the factor.
//!
//! The row of a run on the finest mesh has them, if the runs on the next mesh that are equal in all else are done and
//! trusted; otherwise it has the value of the finest mesh with its own error.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use billow_solver::scene::Scene;

use super::same_job::point_rows;
use super::{Column, Table};
use crate::accuracy::promised::promise;
use crate::accuracy::row::of_meshes;
use crate::accuracy::{Features, MeshErrors, Method, NO_ERROR_REASON, PROMISED, Promised};
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::{CellType, ColumnId, SAME_JOB_AS};
use crate::store::journal::Record;
use crate::study::Study;

/// End of the name of an extrapolated value.
pub const EXTRAPOLATED: &str = "_extrapolated";
/// Ends of the names of its error, below and above it.
pub const EXTRAPOLATED_ERRORS: [&str; 2] =
    ["_extrapolated_error_below", "_extrapolated_error_above"];
/// Meaning of its error, one line.
pub const EXTRAPOLATED_ERROR_MEANING: &str = "mesh error of the extrapolated value: how far below or above it, as its name says, the value on the finest mesh of the table (n 24) may be, kept by 19 of 20 runs; outside the table of mesh errors it follows from three meshes and is null with two";

/// Name of the column with the extrapolated values of a measure, and of those with their errors below and above.
pub fn names(measure: &str) -> [String; 3] {
    let [below, above] = EXTRAPOLATED_ERRORS;
    [EXTRAPOLATED, below, above].map(|end| format!("{measure}{end}"))
}

/// Whether a column holds extrapolated values or their errors.
pub fn is_extrapolated(name: &str) -> bool {
    let [below, above] = EXTRAPOLATED_ERRORS;
    let measure = [EXTRAPOLATED, below, above].iter().find_map(|end| name.strip_suffix(end));
    measure.is_some_and(|measure| promise(measure).is_some())
}

/// Error outside the table over the difference of the two extrapolated values, at least.
const ERROR_PER_DIFFERENCE: f64 = 3.0;

/// An extrapolated value of a row, and its error below and above it if it is known.
pub(super) type Extrapolated = Option<(f64, Option<[f64; 2]>)>;

/// Times since the release, each with the position of its time among the promised measures.
pub(super) const SINCE_RELEASE: [(ColumnId, ColumnId); 2] = [
    (ColumnId::T50ZRimSinceRelease, ColumnId::T50ZRim),
    (ColumnId::T90ZRimSinceRelease, ColumnId::T90ZRim),
];

impl Table {
    /// The table of a study with these points planned so far, one row per point, with values extrapolated from several
    /// meshes where it has them.
    pub fn of_study(study: &Study, points: &[Point], records: &BTreeMap<JobId, Record>) -> Self {
        let unit = |name: &str| study.unit(name).to_owned();
        let table = Self::build(points, records, &unit, study.assumed());
        let meshes = study.meshes();
        let of_study = study.mesh_of_pilots();
        let mut table = table.with_extrapolated(points, &meshes.list, of_study);
        if meshes.of_file && !meshes.of_pilots {
            table.say_meshes(&meshes.list);
        }
        if let Some(mesh) = of_study {
            table = table.with_pilots(points, &meshes.list, mesh);
        }
        table.judged(study.result_limits())
    }

    /// Says in the rows of film from a mesh that ran on all of these meshes where their error comes from.
    fn say_meshes(&mut self, meshes: &[u32]) {
        let mut reasons = Vec::new();
        for rows in self.rows_by_mesh().values() {
            let all: Option<Vec<usize>> = meshes.iter().map(|n| rows.get(n).copied()).collect();
            let Some(all) = all.filter(|all| all.len() > 1) else { continue };
            if all.iter().all(|row| self.is_trusted(*row)) {
                let first = self.verdict(all[0]);
                let agree = first.is_some() && all.iter().all(|row| self.verdict(*row) == first);
                reasons.extend(all.into_iter().map(|row| (row, of_meshes(meshes, agree))));
            }
        }
        let column = self.columns.iter_mut().find(|column| column.name == NO_ERROR_REASON);
        if let Some(column) = column {
            for (row, reason) in reasons {
                column.cells[row] = Value::Text(reason);
            }
        }
    }

    /// The table with the values extrapolated from these meshes, coarsest first, and their errors. `points` are those of
    /// its rows. `of_study` is the mesh of a study with pilots: its rows keep their values, and a row on the finest mesh
    /// has one only with runs on all.
    #[must_use]
    pub fn with_extrapolated(
        mut self,
        points: &[Point],
        meshes: &[u32],
        of_study: Option<u32>,
    ) -> Self {
        let Some(finest) = meshes.last().filter(|_| meshes.len() > 1) else { return self };
        let points = point_rows(points);
        let on_mesh = self.rows_by_mesh();
        let of_measure = |promised: &Promised| {
            let value = |row: usize| {
                let scene = &points[row].point.job.scene;
                let n = scene.design.subdivisions();
                let alone = || {
                    let keeps = of_study.is_none_or(|mesh| mesh == n);
                    keeps.then(|| self.of_one_mesh(row, promised)).flatten()
                };
                if n != *finest {
                    return of_study.and_then(|_| alone());
                }
                let rows = on_mesh.get(&self.other_parameters(row))?;
                let value = |n: &u32| self.extrapolable(*rows.get(n)?, promised);
                // Without a value on the coarsest of three meshes the two others still give one.
                let least = if of_study.is_some() { meshes.len() } else { 2 };
                let used = [meshes, &meshes[meshes.len() - least..]];
                let used = used.into_iter().find_map(|meshes| {
                    let values: Option<Vec<f64>> = meshes.iter().map(value).collect();
                    Some((meshes, values?))
                });
                let Some((meshes, values)) = used else { return alone() };
                if scene.design.folded().is_err() {
                    return Some(by_convergence_index(meshes, &values));
                }
                let features = self.features(row, scene)?;
                Some(extrapolated(promised, scene, &features, meshes, &values))
            };
            (0..self.rows()).map(value).collect()
        };
        let values = PROMISED.each_ref().map(of_measure);
        let releases: Vec<f64> =
            points.iter().map(|row| row.point.job.scene.release_time).collect();
        self.add_extrapolated(&values, &releases);
        self
    }

    /// Adds the columns of extrapolated values and their errors, and of the times since the release that follow.
    /// `values` has one list per promised measure, `releases` the release time of each row, s.
    fn add_extrapolated(&mut self, values: &[Vec<Extrapolated>; PROMISED.len()], releases: &[f64]) {
        let mut new = Vec::new();
        let mut add = |measure: ColumnId, cells: &[Extrapolated]| {
            let unit = measure.column().unit;
            let column = |name: String, meaning: String, of: fn(Extrapolated) -> Option<f64>| {
                let cells = cells.iter().map(|cell| of(*cell).map_or(Value::Null, Value::Number));
                Column::new(name, (CellType::Number, unit), meaning, cells.collect())
            };
            let measure = measure.name();
            let [value, below, above] = names(measure);
            let value_of = |cell: Extrapolated| cell.map(|(value, _)| value);
            new.push(column(
                value,
                format!("{measure}, extrapolated from the meshes of the study; that of the finest where the next one has none"),
                value_of,
            ));
            let meaning = format!("{measure}: {EXTRAPOLATED_ERROR_MEANING}");
            new.push(column(below, meaning.clone(), |cell| Some(cell?.1?[0])));
            new.push(column(above, meaning, |cell| Some(cell?.1?[1])));
        };
        for (promised, cells) in PROMISED.iter().zip(values) {
            add(promised.measure, cells);
        }
        for (since, measure) in SINCE_RELEASE {
            let index = PROMISED.iter().position(|promised| promised.measure == measure);
            let Some(index) = index else { continue };
            let cells = values[index].iter().zip(releases);
            let cells: Vec<Extrapolated> = cells
                .map(|(cell, release)| cell.map(|(value, error)| (value - release, error)))
                .collect();
            add(since, &cells);
        }
        let last = self.columns.iter().position(|column| column.name == SAME_JOB_AS);
        let last = last.unwrap_or(self.columns.len());
        self.columns.splice(last..last, new);
    }

    /// The value of a measure that a row stands for: the extrapolated one, if it has it.
    pub fn estimate(&self, measure: ColumnId, row: usize) -> Option<&Value> {
        let extrapolated = self.column(&names(measure.name())[0]).map(|column| &column.cells[row]);
        extrapolated.filter(|value| **value != Value::Null).or_else(|| self.value(measure, row))
    }

    /// Whether it has extrapolated values.
    pub fn has_extrapolated(&self) -> bool {
        self.columns.iter().any(|column| is_extrapolated(&column.name))
    }

    /// Whether a row has a value in a column of extrapolated ones.
    pub fn is_extrapolated_at(&self, row: usize) -> bool {
        let mut columns = self.columns.iter().filter(|column| is_extrapolated(&column.name));
        columns.any(|column| column.cells[row] != Value::Null)
    }

    /// The rows by their parameters without the mesh, and by the subdivisions of their mesh.
    pub(super) fn rows_by_mesh(&self) -> BTreeMap<Vec<String>, BTreeMap<u32, usize>> {
        let mut rows: BTreeMap<Vec<String>, BTreeMap<u32, usize>> = BTreeMap::new();
        let Some(mesh) = self.parameters().find(|column| column.name == MESH_PARAMETER) else {
            return rows;
        };
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
        let others = self.parameters().filter(|column| column.name != MESH_PARAMETER);
        others.map(|column| column.cells[row].to_string()).collect()
    }

    /// The value of a row on the finest mesh with its mesh error, where a coarser mesh has no value.
    fn of_one_mesh(&self, row: usize, promised: &Promised) -> Extrapolated {
        let Value::Number(value) = self.value(promised.measure, row)? else { return None };
        Some((*value, self.error_parts(promised.measure, row)[0]))
    }

    /// A measure of a trusted run; the state at the end only where the capsule is deployed.
    pub(super) fn extrapolable(&self, row: usize, promised: &Promised) -> Option<f64> {
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
        Features::of(scene, number(ColumnId::TopRadius)?, number(ColumnId::Height)?)
    }
}

/// Safety factors of the grid convergence index: with two meshes, and with more.
pub const INDEX_FACTORS: [f64; 2] = [3.0, 1.25];

/// The value on the finest of two or three meshes of film from a mesh, and its error by the grid convergence index.
fn by_convergence_index(meshes: &[u32], values: &[f64]) -> (f64, Option<[f64; 2]>) {
    let factor = INDEX_FACTORS[usize::from(meshes.len() > 2)];
    let finest = f64::from(meshes[meshes.len() - 1]);
    let slope = |(n, m): (&[u32], &[f64])| {
        let [coarse, fine] = [n[0], n[1]].map(|n| 1.0 / f64::from(n));
        (m[1] - m[0]).abs() / (coarse - fine)
    };
    let largest = meshes.windows(2).zip(values.windows(2)).map(slope).fold(0.0, f64::max);
    (values[values.len() - 1], Some([factor * largest / finest; 2]))
}

/// The extrapolated value of a measure on two or three meshes, and its error if it is known.
fn extrapolated(
    promised: &Promised,
    scene: &Scene,
    features: &Features,
    meshes: &[u32],
    values: &[f64],
) -> (f64, Option<[f64; 2]>) {
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
    let of_table = |features: &Features| {
        let error = table.error(&method(last), features, promised).ok();
        error.map(|error| error.of_itself.map(|side| side * value.abs()))
    };
    let observed = (last > 0).then(|| (value - of_pair(last - 1)).abs());
    let covered = table.gap(scene, features).is_none();
    let at_least = |sides: [f64; 2], least: f64| sides.map(|side| side.max(least));
    let error = match covered.then(|| of_table(features)).flatten() {
        Some(error) => Some(at_least(error, observed.unwrap_or(0.0))),
        None => of_table(&Features { values: table.coordinates.base })
            .zip(observed)
            .map(|(error, observed)| at_least(error, ERROR_PER_DIFFERENCE * observed)),
    };
    (value, error)
}
