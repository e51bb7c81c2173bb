//! Stored results with their study and their table: what commands read that compare points.

use super::options::UnitsOption;
use super::target::{StudyArgs, folder};
use super::{changes, stored};
use crate::input::units::DisplayUnits;
use crate::platform::error::Result;
use crate::store::stored::Stored;
use crate::store::table::Table;

/// Reads stored results with their study, for commands that need both. Returns them, their table in the units to
/// show, and these units. Judges by the limits of a given study file, and says on stderr what
/// [`super::changes::asked`] says.
///
/// # Errors
/// As [`super::target::open`].
pub fn open_stored(
    given: &StudyArgs,
    set: &[String],
    units: &UnitsOption,
) -> Result<(Stored<'static>, Table, DisplayUnits)> {
    let mut stored = stored::read(&folder(given, set)?)?;
    let asked = changes::asked(&stored.results, given.study.as_deref(), set)?;
    if let Some(asked) = asked.filter(|asked| asked.other_limits) {
        stored = stored.asked(asked.study);
    }
    let table = stored.table();
    let units = units.of_table(&table, stored.study.display_units())?;
    let table = table.shown_in(&units);
    Ok((stored, table, units))
}
