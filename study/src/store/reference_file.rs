//! Static equilibria of a design ([`crate::job::references`]) on disk.
//!
//! ```text
//! results/<study>/references/<id>.json     {"format", "version", "physics_version", "sha256",
//!                                           "states": [[level, p, V, z_rim], …]}
//! ```
//!
//! `sha256` is that of the JSON text of `states`. A stored file only saves time: if it is missing, damaged
//! or of another version, its states are computed again when a run needs them, with the same bits.

use std::io;
use std::path::PathBuf;

use billow_solver::PHYSICS_VERSION;
use billow_solver::models::film::LadderState;
use billow_solver::output::measures::StaticShape;
use serde::{Deserialize, Serialize};

use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::{self, disk_error};
use crate::store::history_file;
use crate::store::results::Results;

/// Name of the format.
const FORMAT: &str = "billow-reference";
/// Version of the format that this program writes and reads. Version 1 had no levels.
const VERSION: u32 = 2;

/// A state on disk: level, overpressure, Pa, volume, m³, mean height of the top ring, m.
type StoredState = (i32, f64, f64, f64);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: String,
    version: u32,
    physics_version: u32,
    sha256: String,
    /// Level ascending.
    states: Vec<StoredState>,
}

fn hash(states: &[StoredState]) -> io::Result<String> {
    Ok(history_file::bytes_hash(&serde_json::to_vec(states).map_err(io::Error::other)?))
}

fn encode(states: &[LadderState]) -> io::Result<Vec<u8>> {
    let stored = |state: &LadderState| {
        let StaticShape { overpressure, volume, height } = state.shape;
        (state.level, overpressure, volume, height)
    };
    let states: Vec<StoredState> = states.iter().map(stored).collect();
    let stored = Stored {
        format: FORMAT.to_owned(),
        version: VERSION,
        physics_version: PHYSICS_VERSION,
        sha256: hash(&states)?,
        states,
    };
    let mut bytes = serde_json::to_vec(&stored).map_err(io::Error::other)?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn read(bytes: &[u8]) -> Option<Vec<LadderState>> {
    let stored: Stored = serde_json::from_slice(bytes).ok()?;
    let current = stored.format == FORMAT
        && stored.version == VERSION
        && stored.physics_version == PHYSICS_VERSION;
    let state = |(level, overpressure, volume, height): StoredState| LadderState {
        level,
        shape: StaticShape { overpressure, volume, height },
    };
    (current && hash(&stored.states).ok()? == stored.sha256)
        .then(|| stored.states.into_iter().map(state).collect())
}

impl Results<'_> {
    /// States that earlier runs stored, by design. Files that cannot be read are ignored.
    pub fn references(&self) -> Vec<(JobId, Vec<LadderState>)> {
        let paths = self.files().list(&self.references_path()).unwrap_or_default();
        let known = |path: PathBuf| {
            let id = JobId::from_digits(&path.file_stem()?.to_string_lossy())?;
            Some((id, read(&self.files().read(&path).ok()?)?))
        };
        paths.into_iter().filter_map(known).collect()
    }

    /// Files in the folder of references that this program cannot read as references.
    pub fn unread_references(&self) -> Vec<PathBuf> {
        let paths = self.files().list(&self.references_path()).unwrap_or_default();
        let reference =
            |path: &PathBuf| self.files().read(path).ok().and_then(|bytes| read(&bytes));
        paths.into_iter().filter(|path| reference(path).is_none()).collect()
    }

    /// Stores the states of a design.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn write_reference(&self, id: &JobId, states: &[LadderState]) -> Result<()> {
        let folder = self.references_path();
        let path = folder.join(format!("{id}.json"));
        let write = || -> io::Result<()> {
            self.files().create_folder(&folder)?;
            files::write_atomic(self.files(), &path, &encode(states)?)
        };
        write().map_err(|error| disk_error(&path, &error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::files::Disk;
    use crate::platform::files::failing::FailingFiles;

    #[test]
    fn a_stored_reference_is_read_and_a_damaged_one_is_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
        let state = |level: i32, overpressure, volume, height| LadderState {
            level,
            shape: StaticShape { overpressure, volume, height },
        };
        let reference = vec![state(-64, 1.0, 0.1 + 0.2, 0.9), state(0, 4.0, 0.4, 1.0)];
        results.write_reference(&id, &reference).unwrap();
        let path = results.references_path().join(format!("{id}.json"));
        let bytes = results.files().read(&path).unwrap();
        assert_eq!(read(&bytes), Some(reference.clone()));
        assert_eq!(read(&bytes[..bytes.len() / 2]), None);
        let other = String::from_utf8(bytes).unwrap().replace("0.9]", "0.91]");
        assert_eq!(read(other.as_bytes()), None, "a changed number");
        let other = other.replace("0.91]", "0.9]").replace("\"version\":2", "\"version\":1");
        assert_eq!(read(other.as_bytes()), None, "another version");
        assert!(results.unread_references().is_empty());
        let damaged = path.with_file_name(format!("{}.json", "cd".repeat(16)));
        files::write_atomic(&Disk, &damaged, other.as_bytes()).unwrap();
        assert_eq!(results.unread_references(), [damaged]);
        // A disk that fails at any operation leaves the old file or the new one.
        let before = read(&results.files().read(&path).unwrap());
        for nth in 1..=4 {
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            let other = vec![state(64, 1.0, 0.5, 0.9)];
            let written = Results::new(&failing, folder.path()).write_reference(&id, &other);
            let found = read(&results.files().read(&path).unwrap());
            assert_eq!(written.is_err(), nth < 4, "operation {nth}");
            assert!(found == before || found == Some(other), "operation {nth}");
            results.write_reference(&id, &reference).unwrap();
        }
        assert_eq!(results.references(), [(id, reference)]);
    }
}
