//! The folder `damaged` of a results folder: files that were damaged, as they were found.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use crate::platform::error::{Error, Result};
use crate::platform::files::{Files, disk_error};

/// Stores the bytes of a damaged file under its name and a number that is not used yet.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`].
pub fn keep(files: &dyn Files, folder: &Path, path: &Path, bytes: &[u8]) -> Result<()> {
    let kept = free_path(files, folder, path)?;
    files.write_new(&kept, bytes).map_err(|error| disk_error(&kept, &error))?;
    files.sync_folder(folder).map_err(|error| disk_error(folder, &error))
}

/// A path in the folder that is not used yet: the name of `path` and a number. Creates the folder.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`].
pub fn free_path(files: &dyn Files, folder: &Path, path: &Path) -> Result<PathBuf> {
    let at_folder = |error: io::Error| disk_error(folder, &error);
    if folder.exists() && !folder.is_dir() {
        let problem =
            "a file where the folder of damaged files must be\n  next: move it away".to_owned();
        return Err(Error::Disk { path: folder.to_owned(), problem });
    }
    files.create_folder(folder).map_err(at_folder)?;
    let used: BTreeSet<PathBuf> = files.list(folder).map_err(at_folder)?.into_iter().collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let paths = (0_u64..).map(|number| folder.join(format!("{name}.{number}")));
    let mut free = paths.filter(|path| !used.contains(path));
    Ok(free.next().unwrap_or_else(|| unreachable!("there are more numbers than files")))
}
