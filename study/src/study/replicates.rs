//! The section `replicates` of a study: parameters whose values repeat a point.
//!
//! A replicate is an axis that varies fastest. Its runs are rows of the table; tables, comparisons and
//! charts show their median, range and proportions.

use super::REPLICATES;
use super::grid::{Axis, AxisKind, Context, Grid};
use crate::input::json::Json;
use crate::input::keys::{KEYS, position};
use crate::platform::error::InputError;

/// The key of which a number of values is enough.
const SEED: usize = position(KEYS, "seed");
/// The section, for errors.
const EXAMPLE: &str = "keys and their values, as in {\"seed\": 5} or {\"seed\": [1, 2, 3]}";
/// What the values of a key must look like, for errors.
const ALLOWED: &str =
    "a list of values, as in [1, 2, 3], or a range; for seed also their number, as in 5";

impl Grid {
    /// Reads the replicates, as axes after all others.
    pub(super) fn read_replicates(
        &mut self,
        json: Option<&Json>,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        let source = context.source;
        let Json::Object(members) = json else {
            let problem = format!("is {}, not an object of keys", json.kind());
            let mut error = source.error(REPLICATES, json, problem, EXAMPLE);
            if let Json::Integer(_) | Json::List(_) = json {
                error.hint = format!("\"{REPLICATES}\": {{\"seed\": {json}}}");
            }
            return Err(error);
        };
        for (name, value) in members {
            let path = format!("{REPLICATES}.{name}");
            let column = self.column(name, &path, value, context)?;
            let values = match value {
                Json::Integer(count) if self.columns[column].index == SEED => {
                    &seeds(*count, &path, value, context)?
                }
                Json::List(_) | Json::Object(_) => value,
                other => {
                    let problem = format!("is {}, not replicates", other.kind());
                    return Err(source.error(&path, other, problem, ALLOWED));
                }
            };
            self.read_axis(column, values, &path, AxisKind::Replicates, context)?;
            let rows = self.axes.last().map_or(&[][..], |axis| &axis.rows);
            let twice = (1..rows.len()).find(|index| rows[..*index].contains(&rows[*index]));
            if let Some(index) = twice {
                let problem = format!("has the value {} twice", rows[index][0].short());
                return Err(source.error(&path, value, problem, "each value once"));
            }
        }
        Ok(())
    }

    /// The axes whose values repeat a point: replicates and meshes.
    pub(super) fn replicates(&self) -> impl Iterator<Item = &Axis> {
        self.axes.iter().filter(|axis| axis.kind.repeats())
    }

    /// Number of runs of each point.
    pub(super) fn replicate_count(&self) -> usize {
        self.replicates().map(|axis| axis.rows.len()).product()
    }

    /// Whether a column is that of a replicate.
    pub(super) fn is_replicate(&self, column: usize) -> bool {
        self.replicates().any(|axis| axis.columns.contains(&column))
    }
}

/// The seeds 1 to a number. Seed 0 has no imperfection.
fn seeds(count: i64, path: &str, json: &Json, context: Context<'_>) -> Result<Json, InputError> {
    let Context { source, max_points, .. } = context;
    let fits = usize::try_from(count).is_ok_and(|count| (1..=max_points).contains(&count));
    if !fits {
        let problem = "is not a number of seeds";
        let allowed = format!("1 to {max_points}, or {ALLOWED}");
        return Err(source.error(path, json, problem, allowed));
    }
    Ok(Json::List((1..=count).map(Json::Integer).collect()))
}
