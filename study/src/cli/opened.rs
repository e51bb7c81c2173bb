//! Stored results with their study and their table: what commands read that compare points.

use super::options::UnitsOption;
use super::target::{StudyArgs, folder};
use super::{changes, stored, study_keys};
use crate::input::units::DisplayUnits;
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::store::index::Index;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Table, parquet};
use crate::study::Study;

/// Results with some columns of their table, and without points and records.
pub struct Opened {
    /// The results.
    pub stored: Stored<'static>,
    /// These columns.
    pub table: Table,
    /// Number of columns of the whole table.
    pub all_columns: usize,
}

/// The same as [`open_stored`] from the index of the results, with the columns alone of which `wanted` holds (given the name,
/// and all names), the job, the parameters and the `keys` of the study; `None` where the index cannot serve them, and for what is an error.
pub fn open_indexed(
    given: &StudyArgs,
    set: &[String],
    units: &UnitsOption,
    keys: &[String],
    wanted: &dyn Fn(&str, &[&str]) -> bool,
) -> Option<Opened> {
    let results = Results::new(&Disk, &folder(given, set).ok()?);
    let index = match given.study.as_deref().filter(|path| path.is_file()) {
        Some(file) => Index::of_study(&results, &Study::sketch(file, set).ok()??)?,
        None => Index::read(&results)?,
    };
    let bytes = results.files().read(&results.table_path()).ok()?;
    let (table, all_columns) = parquet::decode_columns(&bytes, wanted)?;
    let stored = index.is_current(&results).then(|| index.stored(&results, &[]))??;
    let units = units.of_table(&table, stored.study.display_units()).ok()?;
    let mut table = table.shown_in(&units);
    study_keys::add(&stored.study, &mut table, &units, keys);
    Some(Opened { stored, table, all_columns })
}

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
