//! Sets damaged files of a results folder aside, in its folder `damaged`.

use std::path::Path;

use super::Results;
use crate::platform::error::Result;
use crate::platform::files::disk_error;
use crate::store::damaged;

impl Results<'_> {
    /// Moves a damaged file or folder into the folder `damaged`, if it exists. Only for the process that holds
    /// the lock.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn set_aside(&self, path: &Path) -> Result<()> {
        if path.symlink_metadata().is_err() {
            return Ok(());
        }
        let (files, folder) = (self.files(), self.damaged_path());
        let kept = damaged::free_path(files, &folder, path)?;
        files.rename(path, &kept).map_err(|error| disk_error(path, &error))?;
        files.sync_folder(&folder).map_err(|error| disk_error(&folder, &error))
    }
}
