//! Columns of the mesh error: how far each promised measure of a row is from its value on fine meshes.
//!
//! Rows of the model film have them. The error of a model without mesh is of another kind: it would make most
//! comparisons of its rows ties, though its errors are alike from design to design. `billow advise` names it.

use billow_solver::output::measures::Verdict;
use billow_solver::scene::ModelKind;

use super::Column;
use super::same_job::PointRow;
use crate::accuracy::{
    Features, MeshErrors, Method, NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED,
};
use crate::input::units::DisplayUnit;
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
                Ok(error) => Some(error * value.abs()),
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
        "the error columns are those of film; billow advise STUDY gives the errors of {}",
        method.name()
    )
}

/// Why the state at the end of some runs has no error.
const NOT_DEPLOYED: &str = "not deployed: final_z_rim and final_volume have a mesh error only where the capsule is deployed";

/// The columns of these rows.
pub(super) fn columns(points: &[PointRow<'_>], rows: &[Cells]) -> Vec<Column> {
    let all: Vec<RowErrors> =
        points.iter().zip(rows).map(|(point, cells)| RowErrors::of(point, cells)).collect();
    let number = |value: Option<f64>| value.map_or(Value::Null, Value::Number);
    let mut columns: Vec<Column> = PROMISED
        .iter()
        .enumerate()
        .map(|(index, promised)| {
            let unit = promised.measure.column().unit;
            Column {
                name: promised.error_column.to_owned(),
                cell_type: CellType::Number,
                unit: unit.to_owned(),
                shown: DisplayUnit::si(unit),
                meaning: promised.meaning(),
                cells: all.iter().map(|row| number(row.errors[index])).collect(),
            }
        })
        .collect();
    columns.push(Column {
        name: NO_ERROR_REASON.to_owned(),
        cell_type: CellType::Text,
        unit: String::new(),
        shown: DisplayUnit::si(""),
        meaning: NO_ERROR_REASON_MEANING.to_owned(),
        cells: all.into_iter().map(|row| row.reason.map_or(Value::Null, Value::Text)).collect(),
    });
    columns
}
