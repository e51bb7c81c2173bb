//! Removes lines that are not valid from journals.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use super::{Fault, line, scan};
use crate::platform::error::Result;
use crate::platform::files::{Files, disk_error, write_atomic};
use crate::store::damaged;

/// Writes every journal with a fault again, with its valid lines only. The file as it was is kept in the
/// folder `damaged`, unless only its last line was torn. Only for the process that holds the lock of the
/// results. Returns the journals that were written.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`]; each journal is then either as before or mended.
pub fn mend(files: &dyn Files, faults: &[Fault], damaged_folder: &Path) -> Result<Vec<PathBuf>> {
    let paths: BTreeSet<&PathBuf> = faults.iter().map(|fault| &fault.path).collect();
    let mut mended = Vec::with_capacity(paths.len());
    for path in paths {
        let at = |error: io::Error| disk_error(path, &error);
        let bytes = files.read(path).map_err(at)?;
        let lines = scan(path, 0, &bytes)?;
        let mut valid = Vec::with_capacity(bytes.len());
        if lines.first().is_none_or(|header| header.entry.is_err()) {
            let header = line::header_text().map_err(|error| at(io::Error::other(error)))?;
            valid.extend(header.into_bytes());
            valid.push(b'\n');
        }
        for line in lines.iter().filter(|line| line.entry.is_ok()) {
            valid.extend_from_slice(line.bytes);
        }
        if faults.iter().any(|fault| fault.path == *path && !fault.torn) {
            damaged::keep(files, damaged_folder, path, &bytes)?;
        }
        write_atomic(files, path, &valid).map_err(at)?;
        mended.push(path.clone());
    }
    Ok(mended)
}
