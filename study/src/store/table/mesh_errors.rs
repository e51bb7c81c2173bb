//! Columns of the errors: how far each promised measure of a row is from its value on fine meshes, and how much it
//! changes over the ranges of the assumed values.
//!
//! Rows of the model film have them. The error of a model without mesh is of another kind: it would make most
//! comparisons of its rows ties, though its errors are alike from design to design. `billow plan --accuracy` names it.

use super::Column;
use super::same_job::PointRow;
use crate::accuracy::{
    AssumedRanges, NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED, RowErrors,
};
use crate::input::value::Value;
use crate::job::row::{CellType, Cells};

/// The columns of these rows.
pub(super) fn columns(
    points: &[PointRow<'_>],
    rows: &[Cells],
    ranges: &AssumedRanges,
) -> Vec<Column> {
    const NONE: &RowErrors = &RowErrors::NONE;
    let mut reasons = Vec::with_capacity(rows.len());
    let errors = |(point, cells): (&PointRow<'_>, &Cells)| {
        let mut row = RowErrors::of(&point.point.job.scene, cells, ranges);
        reasons.push(row.reason.take().map_or(Value::Null, Value::Text));
        // Most large studies use a model without mesh, whose rows have none: those take no memory.
        let has_any = row.errors.iter().chain(&row.assumed).any(Option::is_some);
        has_any.then(|| Box::new(row))
    };
    let all: Vec<Option<Box<RowErrors>>> = points.iter().zip(rows).map(errors).collect();
    let number = |value: Option<f64>| value.map_or(Value::Null, Value::Number);
    let mut columns = Vec::new();
    for (index, promised) in PROMISED.iter().enumerate() {
        let kind = (CellType::Number, promised.measure.column().unit);
        for (part, (name, meaning)) in promised.columns().into_iter().enumerate() {
            let cells = all.iter().map(|row| {
                let row = row.as_deref().unwrap_or(NONE);
                let [errors, assumed] = [row.errors[index], row.assumed[index]]
                    .map(|sides| sides.map_or([None; 2], |sides| sides.map(Some)));
                number([errors[0], errors[1], assumed[0], assumed[1]][part])
            });
            columns.push(Column::new(name, kind, meaning, cells.collect()));
        }
    }
    let kind = (CellType::Text, "");
    columns.push(Column::new(NO_ERROR_REASON, kind, NO_ERROR_REASON_MEANING, reasons));
    columns
}
