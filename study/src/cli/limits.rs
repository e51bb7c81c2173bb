//! What the limits of a study say of one job: for each limit its value, its condition, and its margin.
//!
//! In a study with several meshes the table judges the value extrapolated from them; here it is that of the run.

use serde_json::json;

use crate::input::value::{Value, brief_number, json_value};
use crate::job::result_limit::{Condition, Judged, ResultLimit, Safety};
use crate::job::row::Cells;
use crate::store::stored::Stored;

/// One limit and the value of a job.
struct JudgedLimit<'a> {
    limit: &'a ResultLimit,
    value: &'a Value,
    /// `None` for a job that is not done, and where its measure has no value.
    judged: Option<Judged>,
}

fn judged<'a>(stored: &'a Stored<'_>, cells: &'a Cells) -> Vec<JudgedLimit<'a>> {
    let of = |limit: &'a ResultLimit| {
        let value = cells.get(limit.measure);
        JudgedLimit { limit, value, judged: limit.judge(cells.status(), value) }
    };
    stored.study.result_limits().iter().map(of).collect()
}

fn safety(stored: &Stored<'_>, cells: &Cells) -> Option<Safety> {
    Safety::of(stored.study.result_limits(), cells.status(), |column| cells.get(column))
}

/// The lines of `billow job`: whether the job is safe, and each limit; none for a study without limits, or a job that is not done.
pub(super) fn lines(stored: &Stored<'_>, cells: &Cells) -> Vec<(&'static str, String)> {
    let all = judged(stored, cells);
    if all.iter().all(|one| one.judged.is_none()) {
        return Vec::new();
    }
    let answer = match safety(stored, cells) {
        None => "not known: a measure with a limit has no value",
        Some(Safety { safe: true, .. }) => "yes: every limit is met",
        Some(_) => "no",
    };
    let mut lines = vec![("safe", answer.to_owned())];
    lines.extend(all.iter().map(|one| ("limit", text(stored, one))));
    lines
}

/// A limit in words.
fn text(stored: &Stored<'_>, one: &JudgedLimit<'_>) -> String {
    let column = one.limit.measure.column();
    let shown = match one.value {
        Value::Null => "without a value".to_owned(),
        Value::Number(number) => stored.units.of(column.name, column.unit).brief(*number),
        other => other.to_string(),
    };
    let (name, condition) = (column.name, &one.limit.text);
    match one.judged {
        None => format!("{name} {shown}, asked {condition}: not known"),
        Some(Judged { met, margin }) => {
            let met = if met { "met" } else { "not met" };
            let margin = match one.limit.condition {
                Condition::Bound { .. } => format!(", margin {}", brief_number(margin)),
                Condition::Is(_) => String::new(),
            };
            format!("{name} {shown}, asked {condition}: {met}{margin}")
        }
    }
}

/// The keys of `billow job` as JSON: `safe` (null where it is not known), and `limits`.
pub(super) fn keys(stored: &Stored<'_>, cells: &Cells) -> [(&'static str, serde_json::Value); 2] {
    let limit = |one: &JudgedLimit<'_>| {
        json!({
            "measure": one.limit.measure.name(),
            "value": json_value(one.value),
            "condition": one.limit.text,
            "met": one.judged.map(|judged| judged.met),
            "margin": one.judged.map(|judged| judged.margin),
        })
    };
    let limits: Vec<_> = judged(stored, cells).iter().map(limit).collect();
    [("safe", safety(stored, cells).map(|known| known.safe).into()), ("limits", limits.into())]
}
