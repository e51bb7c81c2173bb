//! Reads a results folder for a command, and says on stderr what of it is damaged.

use std::path::Path;

use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::store::journal::Journal;
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Journal lines that are named, at most.
const MAX_SHOWN: usize = 3;

/// Reads a results folder.
///
/// # Errors
/// As [`Stored::read`].
pub fn read(root: &Path) -> Result<Stored<'static>> {
    let stored = Stored::read(Results::new(&Disk, root))?;
    note_faults(&stored.journal, root);
    Ok(stored)
}

/// Names the lines of the journal that are not valid. A torn last line is what a running or stopped process
/// leaves, and no damage.
pub fn note_faults(journal: &Journal, root: &Path) {
    let mut faults = journal.faults.iter().filter(|fault| !fault.torn);
    for fault in faults.by_ref().take(MAX_SHOWN) {
        eprintln!("billow: damaged: {fault}");
    }
    let more = faults.count();
    if more > 0 {
        eprintln!("billow: damaged: {more} more lines of the journal");
    }
    if journal.faults.iter().any(|fault| !fault.torn) {
        let root = root.display();
        eprintln!(
            "  next: run `billow run` of the study: it runs these jobs again; `billow doctor {root}`"
        );
    }
}
