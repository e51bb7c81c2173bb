//! The section `replicates` of a study: parameters whose values repeat a point.
//!
//! A replicate is an axis that varies fastest. Its runs are rows of the table; tables, comparisons and
//! charts show their median, range and proportions.

use super::base::Base;
use super::grid::{Axis, AxisKind, Grid};
use super::plan_size::PlanSize;
use crate::input::keys::{KEYS, STUDY, position};
use crate::input::settings::object;
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;

use super::target::Target;

/// The key of which a number of values is enough.
const SEED: usize = position(KEYS, "seed");
/// What the section must look like, for errors.
const ALLOWED: &str =
    "a list of values, as in [1, 2, 3], or a range; for seed also their number, as in 5";

impl Grid {
    /// Reads the replicates, as axes after all others.
    ///
    /// # Errors
    /// A name that is not a key, a value that the key does not allow, a key that the grid varies.
    pub(super) fn read_replicates(
        &mut self,
        json: Option<&Json>,
        base: &Base,
        source: &Source,
        size: PlanSize,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        for (name, value) in object(json, &STUDY, "replicates", source)? {
            let path = format!("replicates.{name}");
            let column = self.column(name, &path, value, base, source)?;
            let values = match value {
                Json::Integer(count) if self.columns[column].target == Target::Key(SEED) => {
                    &seeds(*count, &path, value, source, size)?
                }
                Json::List(_) | Json::Object(_) => value,
                other => {
                    let problem = format!("is {}, not replicates", other.kind());
                    return Err(source.error(&path, &other.brief(), problem, ALLOWED));
                }
            };
            let values = self.values(column, values, &path, base, source, size)?;
            let twice = (1..values.len()).find(|index| values[..*index].contains(&values[*index]));
            if let Some(index) = twice {
                let problem = format!("has the value {} twice", values[index].short());
                return Err(source.error(&path, &value.brief(), problem, "each value once"));
            }
            let rows = values.into_iter().map(|value| vec![value]).collect();
            self.axes.push(Axis { columns: vec![column], rows, kind: AxisKind::Replicates });
        }
        Ok(())
    }

    /// The axes of replicates.
    pub(super) fn replicates(&self) -> impl Iterator<Item = &Axis> {
        self.axes.iter().filter(|axis| axis.kind == AxisKind::Replicates)
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
fn seeds(
    count: i64,
    path: &str,
    json: &Json,
    source: &Source,
    size: PlanSize,
) -> Result<Json, InputError> {
    let fits = usize::try_from(count).is_ok_and(|count| (1..=size.points).contains(&count));
    if !fits {
        let problem = "is not a number of seeds";
        let allowed = format!("1 to {}, or {ALLOWED}", size.points);
        return Err(source.error(path, &json.brief(), problem, allowed));
    }
    Ok(Json::List((1..=count).map(Json::Integer).collect()))
}
