//! Whole files: written completely or not at all.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Files, disk_error};
use crate::platform::error::Result;

/// End of the name of a temporary file.
const TEMPORARY: &str = ".tmp";

/// Whether a path has the name of a temporary file of this program.
pub fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with('.') && name.ends_with(TEMPORARY)
}

/// Writes a whole file, or keeps the old one: temporary name in the same folder, sync, rename, sync of
/// the folder.
///
/// # Errors
/// The error of the system. The temporary file is then removed if possible.
pub fn write_atomic(files: &dyn Files, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let temporary = loop {
        let temporary = temporary_path(path);
        match files.write_new(&temporary, bytes) {
            Ok(()) => break temporary,
            // A dead process with the same number left it.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => {
                // The error of the write is reported, not an error of this removal.
                let _ = files.remove(&temporary);
                return Err(error);
            }
        }
    };
    publish(files, &temporary, path)
}

/// A name for a temporary file of this process beside a path; each call returns another one.
fn temporary_path(path: &Path) -> PathBuf {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    path.with_file_name(format!(".{name}.{}-{number}{TEMPORARY}", std::process::id()))
}

/// Gives a synced temporary file its name.
fn publish(files: &dyn Files, temporary: &Path, path: &Path) -> io::Result<()> {
    if let Err(error) = files.rename(temporary, path) {
        let _ = files.remove(temporary);
        return Err(error);
    }
    // The parent of a bare name is the empty path, which cannot be opened.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    files.sync_folder(folder.unwrap_or(Path::new(".")))
}

/// Writes a whole file that the user named and that does not fit in memory: `build` writes it under a
/// temporary name, which then is synced and renamed. On an error the old file stays.
///
/// # Errors
/// The error of `build`; [`crate::platform::error::Error::Disk`].
pub fn build_output<T>(
    files: &dyn Files,
    path: &Path,
    build: &mut dyn FnMut(&Path) -> Result<T>,
) -> Result<T> {
    remove_stale_files_of(files, path);
    let mut temporary = temporary_path(path);
    // A dead process with the same number left it.
    while temporary.exists() {
        temporary = temporary_path(path);
    }
    let built = build(&temporary).and_then(|built| {
        let sync = || File::open(&temporary)?.sync_all();
        sync().map_err(|error| disk_error(path, &error))?;
        Ok(built)
    });
    match built {
        Ok(built) => {
            publish(files, &temporary, path).map_err(|error| disk_error(path, &error))?;
            Ok(built)
        }
        Err(error) => {
            // The error of the build is reported, not an error of this removal.
            let _ = files.remove(&temporary);
            Err(error)
        }
    }
}

/// Writes a whole file that the user named, as [`write_atomic`]. Temporary files of this name that dead
/// processes left are removed first.
///
/// # Errors
/// As [`write_atomic`].
pub fn write_output(files: &dyn Files, path: &Path, bytes: &[u8]) -> io::Result<()> {
    remove_stale_files_of(files, path);
    write_atomic(files, path, bytes)
}

/// Removes the temporary files of this name that dead processes left. What cannot be removed is no
/// obstacle: the new temporary file has another name.
fn remove_stale_files_of(files: &dyn Files, path: &Path) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let begin = format!(".{name}.");
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    // A folder that cannot be listed may still be written to.
    let mut stale = files.list(folder.unwrap_or(Path::new("."))).unwrap_or_default();
    stale.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(&begin) && is_stale(path)
    });
    for path in stale {
        let _ = files.remove(&path);
    }
}

/// Whether a temporary file belongs to a process that does not run: `.NAME.PROCESS-NUMBER.tmp`.
fn is_stale(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let middle = name.strip_suffix(TEMPORARY).and_then(|name| name.rsplit('.').next());
    let process = middle.and_then(|text| text.split_once('-')?.0.parse::<u32>().ok());
    is_temporary(path) && process.is_some_and(|id| !Path::new(&format!("/proc/{id}")).exists())
}

/// Removes the temporary files that dead processes left in a folder to which other processes may write.
/// Returns their paths.
///
/// # Errors
/// The error of the system.
pub fn remove_stale_files(files: &dyn Files, folder: &Path) -> io::Result<Vec<PathBuf>> {
    remove_where(files, folder, is_stale)
}

/// Writes a whole file unless it holds these bytes already. Returns whether it wrote.
///
/// # Errors
/// As [`write_atomic`], and for an existing file that cannot be read.
pub fn write_if_changed(files: &dyn Files, path: &Path, bytes: &[u8]) -> io::Result<bool> {
    match files.read(path) {
        Ok(stored) if stored == bytes => return Ok(false),
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    write_atomic(files, path, bytes).map(|()| true)
}

/// Removes the temporary files that killed processes left in a folder. Only for a folder to which no
/// other process writes. Returns their paths.
///
/// # Errors
/// The error of the system.
pub fn remove_temporary_files(files: &dyn Files, folder: &Path) -> io::Result<Vec<PathBuf>> {
    remove_where(files, folder, is_temporary)
}

/// Removes the files of a folder for which `is_old` holds. Returns their paths.
fn remove_where(
    files: &dyn Files,
    folder: &Path,
    is_old: fn(&Path) -> bool,
) -> io::Result<Vec<PathBuf>> {
    let mut paths = files.list(folder)?;
    paths.retain(|path| is_old(path));
    for path in &paths {
        files.remove(path)?;
    }
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::Disk;
    use super::super::failing::FailingFiles;
    use super::*;

    #[test]
    fn a_failed_atomic_write_leaves_the_old_or_the_new_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_atomic(&Disk, &path, b"old").unwrap();
        for nth in 1..=3 {
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            write_atomic(&failing, &path, b"new, and longer").unwrap_err();
            let found = fs::read(&path).unwrap();
            // A failed sync of the folder comes after the rename.
            let expected: &[u8] = if nth == 3 { b"new, and longer" } else { b"old" };
            assert_eq!(found, expected, "operation {nth}");
            write_atomic(&Disk, &path, b"old").unwrap();
            remove_temporary_files(&Disk, folder.path()).unwrap();
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        let enough = FailingFiles::new(4, io::ErrorKind::StorageFull);
        write_atomic(&enough, &path, b"new").unwrap();
        assert_eq!(enough.operations(), 3);
    }

    #[test]
    fn temporary_files_of_dead_processes_are_no_obstacle_and_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.json");
        let this = std::process::id();
        // A dead process had the number of this one.
        for number in 0..200 {
            fs::write(folder.path().join(format!(".state.json.{this}-{number}.tmp")), "x").unwrap();
        }
        let dead = folder.path().join(".state.json.4194999-0.tmp");
        let other = folder.path().join(".other.json.4194999-0.tmp");
        fs::write(&dead, "x").and_then(|()| fs::write(&other, "x")).unwrap();
        write_output(&Disk, &path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(!dead.exists() && other.exists());
        assert_eq!(remove_stale_files(&Disk, folder.path()).unwrap(), [other]);
    }

    #[test]
    fn a_file_that_is_built_replaces_the_old_one_only_when_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cube.nc");
        fs::write(&path, "old").unwrap();
        let failed: Result<()> = build_output(&Disk, &path, &mut |temporary| {
            fs::write(temporary, "half").unwrap();
            Err(disk_error(temporary, &io::Error::from(io::ErrorKind::StorageFull)))
        });
        failed.unwrap_err();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        build_output(&Disk, &path, &mut |temporary| {
            fs::write(temporary, "new").unwrap();
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_equal_file_is_not_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert!(write_if_changed(&Disk, &path, b"1").unwrap());
        assert!(!write_if_changed(&Disk, &path, b"1").unwrap());
        assert!(write_if_changed(&Disk, &path, b"2").unwrap());
    }
}
