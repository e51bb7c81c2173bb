//! Mesh errors of rows that the table of mesh errors does not cover, from the pilots of their study.
//!
//! ```text
//! error below a value, over it = max over the pilots of (m_n − m + e_below)/|m_n|, from 0 to 1
//! above it                     = max over the pilots of (m − m_n + e_above)/|m_n|, from 0
//! ```
//! Here `m_n` is a pilot's value on the mesh of the study, m its value extrapolated from three meshes, e the error of m.

use std::collections::BTreeMap;

use billow_solver::scene::ModelKind;

use super::extrapolated::{SINCE_RELEASE, names};
use super::same_job::point_rows;
use super::{Column, ColumnCells, Table};
use crate::accuracy::{NO_ERROR_REASON, PROMISED, Promised, is_unknown, of_pilots};
use crate::input::value::Value;
use crate::job::point::Point;

impl Table {
    /// The table with the mesh errors of the pilots in the rows of film that have none. `points` are those of its rows;
    /// it has the values extrapolated from these meshes, of which `mesh` is that of the study. A measure without an error
    /// at one of the pilots, as one whose run failed or is pending, has none in the other rows.
    pub(super) fn with_pilots(mut self, points: &[Point], meshes: &[u32], mesh: u32) -> Self {
        let is_film: Vec<bool> = point_rows(points)
            .iter()
            .map(|row| row.point.job.scene.solver.model == ModelKind::Film)
            .collect();
        let by_mesh = self.rows_by_mesh();
        let pilots: Vec<&BTreeMap<u32, usize>> =
            by_mesh.values().filter(|rows| rows.len() > 1).collect();
        let reasons = self.reasons();
        let is_open =
            |row: &usize| is_film[*row] && reasons[*row].as_deref().is_some_and(is_unknown);
        let open: Vec<usize> = (0..self.rows()).filter(is_open).collect();
        let mut filled = false;
        for promised in &PROMISED {
            let all: Option<Vec<[f64; 2]>> =
                pilots.iter().map(|rows| self.of_pilot(promised, rows, meshes, mesh)).collect();
            let larger = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
            let largest = all.and_then(|errors| errors.into_iter().reduce(larger));
            let Some(largest) = largest else { continue };
            filled = true;
            let since = SINCE_RELEASE.iter().filter(|(_, measure)| *measure == promised.measure);
            let measures = since.map(|(since, _)| *since).chain([promised.measure]);
            let extrapolated: Vec<[String; 3]> = measures.map(|one| names(one.name())).collect();
            for row in &open {
                let Some(value) = self.extrapolable(*row, promised) else { continue };
                let sides = largest.map(|side| side * value.abs());
                for (name, side) in promised.error_columns.into_iter().zip(sides) {
                    self.fill(name, *row, side);
                }
                for [value, below, above] in &extrapolated {
                    if self.column(value).is_some_and(|values| values.cells[*row] != Value::Null) {
                        self.fill(below, *row, sides[0]);
                        self.fill(above, *row, sides[1]);
                    }
                }
            }
        }
        // The verdict is certain where no pilot changes it.
        let agrees = |rows: &&BTreeMap<u32, usize>| {
            let verdicts: Vec<_> = rows.values().map(|row| self.verdict(*row)).collect();
            verdicts.iter().all(|verdict| verdict.is_some() && *verdict == verdicts[0])
        };
        let agree = pilots.iter().all(agrees);
        if let Some(column) = self.cells_mut(NO_ERROR_REASON).filter(|_| filled) {
            for row in open {
                let Some(gap) = &reasons[row] else { continue };
                column[row] = Value::Text(of_pilots(gap, meshes, agree));
            }
        }
        self
    }

    /// Error of a measure of a pilot on the mesh of the study, below and above its value, over it; 0 where the run has no
    /// value on any mesh, `None` where it is not known.
    fn of_pilot(
        &self,
        promised: &Promised,
        rows: &BTreeMap<u32, usize>,
        meshes: &[u32],
        mesh: u32,
    ) -> Option<[f64; 2]> {
        let on = |n: &u32| rows.get(n).copied();
        let all: Vec<usize> = meshes.iter().map(on).collect::<Option<_>>()?;
        if !all.iter().all(|row| self.is_trusted(*row)) {
            return None;
        }
        if all.iter().all(|row| self.extrapolable(*row, promised).is_none()) {
            return Some([0.0; 2]);
        }
        let of_study = self.extrapolable(on(&mesh)?, promised).filter(|value| *value != 0.0)?;
        let finest = *all.last()?;
        let number = |name: &str| match self.column(name)?.cells[finest] {
            Value::Number(number) => Some(number),
            _ => None,
        };
        let [value, below, above] = names(promised.measure.name());
        let above_it = number(&value)? - of_study;
        let sides = [number(&below)? - above_it, number(&above)? + above_it];
        // No measure is below 0.
        let [below, above] = sides.map(|side| (side / of_study.abs()).max(0.0));
        Some([below.min(1.0), above])
    }

    /// Why each row has no mesh error.
    fn reasons(&self) -> Vec<Option<String>> {
        let reason = |cell: &Value| match cell {
            Value::Text(reason) => Some(reason.clone()),
            _ => None,
        };
        self.column(NO_ERROR_REASON).map_or_else(
            || vec![None; self.rows()],
            |column| column.cells.iter().map(reason).collect(),
        )
    }

    /// Writes a number into a cell that has none.
    fn fill(&mut self, name: &str, row: usize, number: f64) {
        if let Some(cells) = self.cells_mut(name)
            && cells[row] == Value::Null
        {
            cells[row] = Value::Number(number);
        }
    }

    fn cells_mut(&mut self, name: &str) -> Option<&mut ColumnCells> {
        let column: &mut Column = self.columns.iter_mut().find(|column| column.name == name)?;
        Some(&mut column.cells)
    }
}
