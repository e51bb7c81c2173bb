//! Mesh errors of rows that the table of mesh errors does not cover, from the pilots of their study.
//!
//! ```text
//! error/|m_n| = max over the pilots of (|m_n − m| + e)/|m_n|
//! ```
//! Here `m_n` is a pilot's value on the mesh of the study, m its value extrapolated from three meshes, e the error of m.

use billow_solver::scene::ModelKind;

use super::extrapolated::{SINCE_RELEASE, names};
use super::same_job::point_rows;
use super::{Column, ColumnCells, Table};
use crate::accuracy::{NO_ERROR_REASON, PROMISED, Promised, is_unknown, of_pilots};
use crate::input::value::Value;
use crate::job::point::Point;

impl Table {
    /// The table with the mesh errors of the pilots in the rows of film that have none. `points` are those of its rows;
    /// it has the values extrapolated from these meshes.
    pub(super) fn with_pilots(mut self, points: &[Point], meshes: &[u32]) -> Self {
        let is_film: Vec<bool> = point_rows(points)
            .iter()
            .map(|row| row.point.job.scene.solver.model == ModelKind::Film)
            .collect();
        let pilots: Vec<[usize; 2]> = self.pilots(meshes);
        let reasons = self.reasons();
        let is_open =
            |row: &usize| is_film[*row] && reasons[*row].as_deref().is_some_and(is_unknown);
        let open: Vec<usize> = (0..self.rows()).filter(is_open).collect();
        for promised in &PROMISED {
            let largest = pilots.iter().filter_map(|pilot| self.of_pilot(promised, *pilot));
            let Some(largest) = largest.reduce(f64::max) else { continue };
            let since = SINCE_RELEASE.iter().filter(|(_, measure)| *measure == promised.measure);
            let measures = since.map(|(since, _)| *since).chain([promised.measure]);
            let extrapolated: Vec<[String; 2]> = measures.map(|one| names(one.name())).collect();
            for row in &open {
                let Some(value) = self.extrapolable(*row, promised) else { continue };
                let error = largest * value.abs();
                self.fill(promised.error_column, *row, error);
                for [value, of_value] in &extrapolated {
                    if self.column(value).is_some_and(|values| values.cells[*row] != Value::Null) {
                        self.fill(of_value, *row, error);
                    }
                }
            }
        }
        let verdicts = |[first, finest]: &[usize; 2]| self.verdict(*first) == self.verdict(*finest);
        let agree = pilots.iter().all(verdicts);
        if let Some(column) = self.cells_mut(NO_ERROR_REASON).filter(|_| !pilots.is_empty()) {
            for row in open {
                let Some(gap) = &reasons[row] else { continue };
                column[row] = Value::Text(of_pilots(gap, meshes, agree));
            }
        }
        self
    }

    /// The rows of each pilot on the mesh of the study and on the finest.
    fn pilots(&self, meshes: &[u32]) -> Vec<[usize; 2]> {
        let by_mesh = self.rows_by_mesh();
        let on_all = by_mesh.values().filter(|rows| meshes.iter().all(|n| rows.contains_key(n)));
        let trusted = |row: &usize| self.is_trusted(*row);
        // The first row of a point is that of the study itself.
        let rows = on_all.filter_map(|rows| {
            let first = rows.values().min()?;
            let finest = rows.get(meshes.last()?)?;
            rows.values().all(trusted).then_some([*first, *finest])
        });
        rows.collect()
    }

    /// Error of a measure of a pilot on the mesh of the study, over its value.
    fn of_pilot(&self, promised: &Promised, [first, finest]: [usize; 2]) -> Option<f64> {
        let number = |name: &str| match self.column(name)?.cells[finest] {
            Value::Number(number) => Some(number),
            _ => None,
        };
        let [value, error] = names(promised.measure.name());
        let first = self.extrapolable(first, promised).filter(|value| *value != 0.0)?;
        Some(((first - number(&value)?).abs() + number(&error)?) / first.abs())
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
