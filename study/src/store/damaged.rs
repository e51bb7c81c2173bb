//! The folder `damaged` of a results folder: files that were damaged, as they were found.

use std::io;
use std::path::{Path, PathBuf};

use crate::platform::error::Result;
use crate::platform::files::{Files, disk_error};

/// Stores the bytes of a damaged file under its name and a number that is not used yet. Returns the path.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`].
pub fn keep(files: &dyn Files, folder: &Path, path: &Path, bytes: &[u8]) -> Result<PathBuf> {
    let at_folder = |error: io::Error| disk_error(folder, &error);
    files.create_folder(folder).map_err(at_folder)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut number = 0_u64;
    loop {
        let kept = folder.join(format!("{name}.{number}"));
        match files.write_new(&kept, bytes) {
            Ok(()) => {
                files.sync_folder(folder).map_err(at_folder)?;
                return Ok(kept);
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(disk_error(&kept, &error)),
        }
    }
}
