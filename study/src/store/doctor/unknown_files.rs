//! Finds files that no record names, temporary files of killed processes, and files of other programs.

use std::path::{Path, PathBuf};

use super::Health;
use crate::job::JobId;
use crate::platform::files::{self, disk_error};
use crate::store::journal;
use crate::store::results::{OTHER_NAMES, RESULT_NAMES, Results};

/// The problem of a file of another program.
const FOREIGN: &str = "not a file of billow";
/// The next step for it.
const FOREIGN_NEXT: &str = "nothing; billow ignores it";
/// The problem of a temporary file.
const INCOMPLETE: &str = "an incomplete temporary file";

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The next step for a temporary file.
fn incomplete_next(health: &Health) -> &'static str {
    if health.running {
        "nothing; a running command is writing it"
    } else {
        "nothing; the next `billow run` of its study removes it"
    }
}

/// Whether a job may have a history file: its record names one, or the job must run again.
pub(super) type IsKnown<'a> = dyn Fn(&JobId) -> bool + 'a;

/// Checks the files of a results folder. `paths` are the entries of the folder itself.
pub(super) fn check(
    results: &Results<'_>,
    is_known: &IsKnown<'_>,
    paths: &[PathBuf],
    health: &mut Health,
) {
    for path in paths {
        let name = name(path);
        if files::is_temporary(path) {
            health.note(path, INCOMPLETE, incomplete_next(health));
        } else if !RESULT_NAMES.contains(&name.as_str()) && !OTHER_NAMES.contains(&name.as_str()) {
            health.note(path, FOREIGN, FOREIGN_NEXT);
        }
    }
    let journals = results.files().list(&results.journal_path()).unwrap_or_default();
    for path in journals.iter().filter(|path| !journal::is_journal(path)) {
        health.note(path, FOREIGN, FOREIGN_NEXT);
    }
    let folders = match results.files().list(&results.jobs_path()) {
        Ok(folders) => folders,
        Err(error) => return health.error(results.root(), &disk_error(results.root(), &error)),
    };
    for folder in folders {
        check_job_folder(results, is_known, &folder, health);
    }
}

/// Checks one of the folders of histories.
fn check_job_folder(
    results: &Results<'_>,
    is_known: &IsKnown<'_>,
    folder: &Path,
    health: &mut Health,
) {
    let folder_name = name(folder);
    if folder_name.len() != 2 || !folder_name.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return health.note(folder, FOREIGN, FOREIGN_NEXT);
    }
    if !folder.is_dir() {
        let problem = "a file with the name of a folder of histories";
        return health.fault(folder, problem, "move the file away");
    }
    let paths = match results.files().list(folder) {
        Ok(paths) => paths,
        Err(error) => return health.error(folder, &disk_error(folder, &error)),
    };
    for path in paths {
        let id = name(&path).strip_suffix(".h5").and_then(JobId::from_digits);
        match id.filter(|id| results.job_path(id) == path) {
            _ if files::is_temporary(&path) => {
                health.note(&path, INCOMPLETE, incomplete_next(health));
            }
            None => health.note(&path, FOREIGN, FOREIGN_NEXT),
            Some(id) if is_known(&id) => {}
            Some(_) if health.running => {}
            Some(_) => health.note(
                &path,
                "a history without a record",
                "nothing: a run of its job replaces it; delete it if the job is not needed",
            ),
        }
    }
}
