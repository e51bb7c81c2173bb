//! From what an index was made.

use billow_solver::platform::seal::hexadecimal;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::platform::files::Stamp;
use crate::platform::provenance::{COMMIT, PHYSICS_VERSION, PROGRAM_VERSION};
use crate::store::journal;
use crate::store::results::Results;

/// The study, the program and the files from which an index was made. When each of them is as it was, the index says
/// what reading them again would say.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Key {
    /// SHA-256 of the text of study.json.
    study: String,
    program_version: String,
    commit: String,
    physics_version: u32,
    /// Name, size and time of each journal, in the order of the names.
    journals: Vec<(String, Stamp)>,
    /// Size and time of the table.
    table: Stamp,
}

impl Key {
    /// That of a folder as it is now; `None` where one of the files is missing or cannot be read.
    pub fn of(results: &Results<'_>) -> Option<Self> {
        let files = results.files();
        let study = files.read(&results.study_path()).ok()?;
        let paths = journal::paths(files, &results.journal_path()).ok()?;
        let journals = paths.iter().map(|path| {
            let name = path.file_name()?.to_str()?.to_owned();
            Some((name, files.stamp(path).ok()?))
        });
        Some(Self {
            study: text_hash(&study),
            program_version: PROGRAM_VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            physics_version: PHYSICS_VERSION,
            journals: journals.collect::<Option<_>>()?,
            table: files.stamp(&results.table_path()).ok()?,
        })
    }

    /// Whether this is the text of its study.json.
    pub fn is_study(&self, text: &str) -> bool {
        self.study == text_hash(text.as_bytes())
    }

    /// Name of the journal at this position.
    pub fn journal(&self, position: usize) -> Option<&str> {
        Some(self.journals.get(position)?.0.as_str())
    }
}

/// SHA-256 of a text, in lower-case hexadecimal digits.
fn text_hash(text: &[u8]) -> String {
    hexadecimal(&Sha256::digest(text))
}
