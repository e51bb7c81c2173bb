//! What the search of an optimum has proposed, so that a command that reads its results need not search again.
//!
//! ```text
//! results/<study>/proposed.json   {"checksum": "…", "program": "…", "proposed": {"<hash of the points before>": [[…], …]}}
//! ```
//! Nothing depends on it: where it is missing, damaged or of another program, the same points are found again, in seconds.

use std::path::PathBuf;

use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use super::Results;
use crate::platform::files::write_if_changed;
use crate::platform::provenance::{COMMIT, PROGRAM_VERSION};
use crate::study::Proposed;

#[derive(Serialize, Deserialize)]
struct Search {
    program: String,
    proposed: Proposed,
}

/// The program that proposes: another one may propose other points.
fn program() -> String {
    format!("{PROGRAM_VERSION} {COMMIT}")
}

impl Results<'_> {
    fn proposed_path(&self) -> PathBuf {
        self.root.join(super::PROPOSED)
    }

    /// Makes known what was proposed for these results.
    pub(super) fn recall_proposed(&self) {
        let Ok(bytes) = self.files.read(&self.proposed_path()) else { return };
        let text = String::from_utf8(bytes).ok().and_then(|text| seal::open(&text).ok());
        let search: Option<Search> = text.and_then(|text| serde_json::from_str(&text).ok());
        if let Some(search) = search.filter(|search| search.program == program()) {
            Proposed::recall(search.proposed);
        }
    }

    /// Keeps what was proposed in this process. A disk on which it cannot be written has no room for results either.
    pub fn keep_proposed(&self) {
        let proposed = Proposed::so_far();
        if proposed.is_empty() {
            return;
        }
        let search = Search { program: program(), proposed };
        if let Ok(text) = serde_json::to_string(&search) {
            let _ =
                write_if_changed(self.files, &self.proposed_path(), seal::seal(&text).as_bytes());
        }
    }
}
