//! Columns of the mesh error: how far each promised measure of a row is from its value on fine meshes.
//!
//! Rows of the model film have them. The error of a model without mesh is of another kind: it would make most
//! comparisons of its rows ties, though its errors are alike from design to design. `billow plan --accuracy` names it.

use std::borrow::Cow;

use billow_solver::output::measures::Verdict;
use billow_solver::scene::ModelKind;

use super::Column;
use super::same_job::PointRow;
use crate::accuracy::{
    Features, MeshErrors, Method, NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED,
};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{CellType, Cells, ColumnId};

/// The errors of one row, in the order of [`PROMISED`], and why some are not known.
struct RowErrors {
    errors: [Option<f64>; PROMISED.len()],
    reason: Option<String>,
}

impl RowErrors {
    /// Those of a row without a result.
    const NONE: Self = Self { errors: [None; PROMISED.len()], reason: None };

    fn of(row: &PointRow<'_>, cells: &Cells) -> Self {
        if cells.status() != Status::Done {
            return Self::NONE;
        }
        let scene = &row.point.job.scene;
        let [Some(top_radius), Some(height)] =
            [ColumnId::TopRadius, ColumnId::Height].map(|column| cells.number(column))
        else {
            return Self::NONE;
        };
        let table = MeshErrors::shipped();
        let features = Features::of(scene, top_radius, height);
        if let Some(gap) = table.gap(scene, &features) {
            return Self { reason: Some(gap), ..Self::NONE };
        }
        let method = Method::of(scene);
        if method.model != ModelKind::Film {
            let known = PROMISED.map(|promised| table.error(&method, &features, &promised));
            let reason = match known.iter().find_map(|error| error.as_ref().ok()) {
                Some(_) => of_another_model(&method),
                None => known.into_iter().find_map(Result::err).unwrap_or_default(),
            };
            return Self { reason: Some(reason), ..Self::NONE };
        }
        let mut reason = None;
        let deployed = cells.verdict() == Some(Verdict::Deployed) || cells.verdict().is_none();
        let errors = PROMISED.map(|promised| {
            let value = cells.number(promised.measure)?;
            if promised.is_at_end() && !deployed {
                reason = Some(NOT_DEPLOYED.to_owned());
                return None;
            }
            match table.error(&method, &features, &promised) {
                Ok(error) => Some(error.of_itself * value.abs()).filter(|error| error.is_finite()),
                Err(gap) => {
                    reason = Some(gap);
                    None
                }
            }
        });
        Self { errors, reason }
    }
}

/// Why rows of a model without mesh have no error, though the table knows it.
fn of_another_model(method: &Method) -> String {
    format!(
        "the error columns are those of film, not of {}; billow plan STUDY --accuracy names a method that keeps an error",
        method.name()
    )
}

/// Why the state at the end of some runs has no error.
pub const NOT_DEPLOYED: &str = "not deployed: final_z_rim and final_volume have a mesh error only where the capsule is deployed";

/// The columns of these rows.
pub(super) fn columns(points: &[PointRow<'_>], rows: &[Cow<'_, Cells>]) -> Vec<Column> {
    let all: Vec<RowErrors> =
        points.iter().zip(rows).map(|(point, cells)| RowErrors::of(point, cells)).collect();
    let number = |value: Option<f64>| value.map_or(Value::Null, Value::Number);
    let mut columns: Vec<Column> = PROMISED
        .iter()
        .enumerate()
        .map(|(index, promised)| {
            let kind = (CellType::Number, promised.measure.column().unit);
            let cells = all.iter().map(|row| number(row.errors[index])).collect();
            Column::new(promised.error_column, kind, promised.meaning(), cells)
        })
        .collect();
    let reasons = all.into_iter().map(|row| row.reason.map_or(Value::Null, Value::Text)).collect();
    let kind = (CellType::Text, "");
    columns.push(Column::new(NO_ERROR_REASON, kind, NO_ERROR_REASON_MEANING, reasons));
    columns
}

#[cfg(test)]
mod tests {

    use billow_solver::scene::{Scene, Stepping};

    use super::*;
    use crate::run::fixture;

    /// The errors of a row of the paper's capsule, computed by a model.
    fn of_row(model: ModelKind, stepping: Stepping) -> RowErrors {
        let mut point = fixture::points(1).remove(0);
        let scene: &mut Scene = std::sync::Arc::make_mut(&mut point.job.scene);
        *scene = MeshErrors::shipped().coverage.scene.clone();
        scene.design.panels = 6;
        scene.design.subdivisions = 4;
        scene.solver.model = model;
        scene.solver.stepping = stepping;
        let mut cells = Cells::new(Status::Done);
        cells.set(ColumnId::TopRadius, 0.365);
        cells.set(ColumnId::Height, 1.0);
        cells.set(ColumnId::T90ZRim, 0.2);
        cells.set(ColumnId::Verdict, "deployed");
        let parameters = point.job.parameters.clone();
        RowErrors::of(&PointRow { point: &point, parameters: &parameters }, &cells)
    }

    #[test]
    fn rows_of_film_have_errors_and_rows_of_another_model_say_where_theirs_are() {
        let film = of_row(ModelKind::Film, Stepping::Stable(0.45));
        assert!(film.errors[1].is_some_and(|error| error > 0.0 && error < 0.2));
        assert_eq!(film.reason, None);
        let said = |model: &str| {
            format!(
                "the error columns are those of film, not of {model}; billow plan STUDY --accuracy names a method that keeps an error"
            )
        };
        let piston = of_row(ModelKind::Piston, Stepping::Adaptive(1e-9));
        assert_eq!((piston.errors, piston.reason), (RowErrors::NONE.errors, Some(said("piston"))));
        let storeys = of_row(ModelKind::Storeys, Stepping::Stable(0.45));
        assert_eq!(storeys.errors, RowErrors::NONE.errors);
        assert_eq!(storeys.reason, Some(said("storeys")));
        // Where the table has no error of the model either, the reason is that.
        let outside = of_row(ModelKind::Storeys, Stepping::Stable(0.2));
        assert_eq!(outside.errors, RowErrors::NONE.errors);
        assert_eq!(
            outside.reason.as_deref(),
            Some("solver.cfl 0.2: the runs of the table have 0.45")
        );
    }
}
