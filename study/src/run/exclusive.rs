//! A results folder that this process has for itself: what dead processes left is cleared before anything is written.

use crate::input::json::Json;
use crate::platform::error::Result;
use crate::store::attempts;
use crate::store::journal::{Fault, Journal, Writer};
use crate::store::results::Results;

/// The repaired journal of a folder.
pub struct Exclusive<'a> {
    /// What it holds, without faults.
    pub journal: Journal,
    /// Appends to it.
    pub writer: Writer<'a>,
    /// The lines that were not valid; they are removed.
    pub faults: Vec<Fault>,
}

/// Clears a folder whose lock this process holds alone: temporary files and invalid journal
/// lines. Jobs that ran in a process that died are noted in the journal. With a study, its name and its
/// file, study.json and the journal are those of this study.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`], also for a folder of another study.
pub fn open<'a>(results: &Results<'a>, study: Option<(&str, &Json)>) -> Result<Exclusive<'a>> {
    results.remove_temporary_files()?;
    let mut journal = results.journal()?;
    let text = match study {
        Some((name, study)) => Some(results.write_study(name, study, &journal)?),
        None => None,
    };
    results.mend_journal(&journal)?;
    let faults = std::mem::take(&mut journal.faults);
    let mut writer = Writer::new(results.files(), results.journal_path());
    attempts::take_deaths(results, &mut journal, &mut writer)?;
    if let Some(text) = text
        && journal.study.as_deref() != Some(&text)
    {
        writer.study(&text)?;
        journal.study = Some(text);
    }
    Ok(Exclusive { journal, writer, faults })
}
