//! Files where folders must be, and folders where files must be.

use std::path::PathBuf;

use crate::store::results::Results;

/// What is in the place of a file or folder of the results, with the problem.
pub(super) fn misplaced(results: &Results<'_>) -> Vec<(PathBuf, &'static str)> {
    let folders = [
        results.journal_path(),
        results.jobs_path(),
        results.charts_path(),
        results.checkpoints_path(),
        results.damaged_path(),
    ];
    let mut files = vec![
        results.study_path(),
        results.previous_path(),
        results.table_path(),
        results.attempts_path(),
        results.lock_path(),
    ];
    for folder in [results.journal_path(), results.checkpoints_path()] {
        files.extend(results.files().list(&folder).unwrap_or_default());
    }
    let folders = folders.into_iter().filter(|path| path.exists() && !path.is_dir());
    let files = files.into_iter().filter(|path| path.is_dir());
    folders
        .map(|path| (path, "a file where a folder must be"))
        .chain(files.map(|path| (path, "a folder where a file must be")))
        .collect()
}
