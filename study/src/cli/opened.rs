//! Stored results with their study and their table: what commands read that compare points.

use super::options::UnitsOption;
use super::target::{StudyArgs, folder};
use super::{changes, stored, study_keys};
use crate::input::units::DisplayUnits;
use crate::platform::error::Result;
use crate::store::stored::Stored;
use crate::store::table::Table;

/// Reads stored results with their study, for commands that need both. Returns them, their table in the units to
/// show with a column for every key that `condition` names, and these units. Judges by the limits of a given study
/// file, and says on stderr what [`super::changes::other_limits`] says.
///
/// # Errors
/// As [`super::target::open`].
pub fn open_stored(
    given: &StudyArgs,
    set: &[String],
    units: &UnitsOption,
    condition: Option<&str>,
) -> Result<(Stored<'static>, Table, DisplayUnits)> {
    let mut stored = stored::read(&folder(given, set)?)?;
    let file = given.study.as_deref();
    if let Some(study) = changes::other_limits(&stored.results, &stored.study, file, set)? {
        stored = stored.asked(study);
    }
    let table = stored.table();
    let units = units.of_table(&table, stored.study.display_units())?;
    let mut table = table.shown_in(&units);
    study_keys::add(&stored.study, &mut table, &units, &study_keys::names_in(condition));
    Ok((stored, table, units))
}
