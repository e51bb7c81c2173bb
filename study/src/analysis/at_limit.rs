//! A limit of the study, and the value of one row that it judges, with what is known of its error.

use serde::{Serialize, Serializer};
use serde_json::json;

use crate::input::units::DisplayUnit;
use crate::input::value::{Value, json_value};
use crate::job::result_limit::{Judged, ResultLimit};
use crate::store::table::Table;

/// What a limit says of the value of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct AtLimit {
    /// The limit.
    pub limit: ResultLimit,
    /// The value, SI.
    pub value: Value,
    /// Its mesh error below and above it, SI, where it is known.
    pub mesh_error: Option<[f64; 2]>,
    /// Its change over the ranges of the assumed values, below and above it, SI, where it is known.
    pub assumed: Option<[f64; 2]>,
    /// Its uncertainty by both, below and above it, SI, where it is known.
    pub uncertainty: Option<[f64; 2]>,
    /// Whether it is met; `None` for a job that is not done, and where its measure has no value.
    pub judged: Option<Judged>,
    /// The unit in which the value is shown.
    pub shown: DisplayUnit,
}

impl AtLimit {
    /// What a limit says of a row.
    pub fn of(table: &Table, limit: &ResultLimit, row: usize) -> Self {
        let measure = limit.measure;
        let column = table.column(measure.name());
        let [mesh_error, assumed] = table.error_parts(measure, row);
        let si = || DisplayUnit::si(measure.column().unit);
        Self {
            limit: limit.clone(),
            value: table.estimate(measure, row).cloned().unwrap_or(Value::Null),
            mesh_error,
            assumed,
            uncertainty: table.uncertainty(measure, row),
            judged: table.judge(limit, row),
            shown: column.map_or_else(si, |column| column.shown.clone()),
        }
    }
}

impl Serialize for AtLimit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        json!({
            "measure": self.limit.measure.name(),
            "condition": self.limit.text,
            "value": json_value(&self.value),
            "mesh_error_below": self.mesh_error.map(|[below, _]| below),
            "mesh_error_above": self.mesh_error.map(|[_, above]| above),
            "assumed_below": self.assumed.map(|[below, _]| below),
            "assumed_above": self.assumed.map(|[_, above]| above),
            "margin": self.judged.map(|judged| judged.margin),
            "safety": self.judged.map(|judged| judged.safety().name()),
        })
        .serialize(serializer)
    }
}
