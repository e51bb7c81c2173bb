//! Static equilibria of a design ([`crate::job::references`]) on disk.
//!
//! ```text
//! results/<study>/references/<id>.json     {"checksum", "format", "version", "physics_version", "id",
//!                                           "states": [[level, p, V, z_rim], …]}
//! ```
//!
//! `checksum` is that of [`billow_solver::platform::seal`]. A stored file only saves time: if it is missing,
//! damaged or of another version, its states are computed again when a run needs them, with the same bits.

use std::io;
use std::path::PathBuf;

use billow_solver::PHYSICS_VERSION;
use billow_solver::models::film::LadderState;
use billow_solver::output::measures::StaticShape;
use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use crate::job::JobId;
use crate::platform::error;
use crate::platform::files::{self, disk_error};
use crate::store::results::Results;

/// Name of the format.
const FORMAT: &str = "billow-reference";
/// Version of the format that this program writes and reads. Version 1 had no levels, version 2 no
/// checksum of the whole file.
const VERSION: u32 = 3;

/// A state on disk: level, overpressure, Pa, volume, m³, mean height of the top ring, m.
type StoredState = (i32, f64, f64, f64);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: String,
    version: u32,
    physics_version: u32,
    id: String,
    /// Level ascending.
    states: Vec<StoredState>,
}

/// The members that every version of the format has.
#[derive(Deserialize)]
struct Head {
    version: u32,
    physics_version: u32,
}

/// Why a file is no reference of this program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unread {
    /// Of another version of the format or of the physics.
    OtherVersion,
    /// Not what was written.
    Damaged(String),
}

fn encode(id: &JobId, states: &[LadderState]) -> io::Result<String> {
    let stored = |state: &LadderState| {
        let StaticShape { overpressure, volume, height } = state.shape;
        (state.level, overpressure, volume, height)
    };
    let stored = Stored {
        format: FORMAT.to_owned(),
        version: VERSION,
        physics_version: PHYSICS_VERSION,
        id: id.as_str().to_owned(),
        states: states.iter().map(stored).collect(),
    };
    let object = serde_json::to_string(&stored).map_err(io::Error::other)?;
    Ok(seal::seal(&(object + "\n")))
}

fn read(id: &JobId, bytes: &[u8]) -> Result<Vec<LadderState>, Unread> {
    let damaged = |error: &dyn std::fmt::Display| Unread::Damaged(error.to_string());
    let text = std::str::from_utf8(bytes).map_err(|error| damaged(&error))?;
    let object = seal::open(text).map_err(|error| damaged(&error))?;
    let head: Head = serde_json::from_str(&object).map_err(|error| damaged(&error))?;
    if (head.version, head.physics_version) != (VERSION, PHYSICS_VERSION) {
        return Err(Unread::OtherVersion);
    }
    let stored: Stored = serde_json::from_str(&object).map_err(|error| damaged(&error))?;
    if stored.format != FORMAT || stored.id != id.as_str() {
        return Err(Unread::Damaged(format!("it belongs to {}", stored.id)));
    }
    let state = |(level, overpressure, volume, height): StoredState| LadderState {
        level,
        shape: StaticShape { overpressure, volume, height },
    };
    Ok(stored.states.into_iter().map(state).collect())
}

/// The references in a folder.
#[derive(Debug, Default)]
pub struct References {
    /// States by the id of their design.
    pub states: Vec<(JobId, Vec<LadderState>)>,
    /// Files that cannot be used, and why.
    pub unread: Vec<(PathBuf, Unread)>,
}

impl Results<'_> {
    /// The references that earlier runs stored.
    pub fn references(&self) -> References {
        let mut references = References::default();
        for path in self.files().list(&self.references_path()).unwrap_or_default() {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // A temporary file is no reference yet.
            if files::is_temporary(&path) {
                continue;
            }
            let read = || -> std::result::Result<_, Unread> {
                let damaged = |problem: String| Unread::Damaged(problem);
                let id = name.strip_suffix(".json").and_then(JobId::from_digits);
                let id =
                    id.ok_or_else(|| damaged("its name is not that of a design".to_owned()))?;
                let bytes = self.files().read(&path).map_err(|error| damaged(error.to_string()))?;
                let states = read(&id, &bytes)?;
                Ok((id, states))
            };
            match read() {
                Ok(found) => references.states.push(found),
                Err(problem) => references.unread.push((path, problem)),
            }
        }
        references
    }

    /// Moves damaged references into the folder `damaged`. Only for the process that holds the lock.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn set_aside_references(&self) -> error::Result<()> {
        for (path, problem) in self.references().unread {
            if matches!(problem, Unread::Damaged(_)) {
                self.set_aside(&path)?;
            }
        }
        Ok(())
    }

    /// Stores the states of a design.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn write_reference(&self, id: &JobId, states: &[LadderState]) -> error::Result<()> {
        let folder = self.references_path();
        let path = folder.join(format!("{id}.json"));
        let write = || -> io::Result<()> {
            self.files().create_folder(&folder)?;
            files::write_atomic(self.files(), &path, encode(id, states)?.as_bytes())
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
        assert_eq!(read(&id, &bytes), Ok(reference.clone()));
        let other = JobId::from_digits(&"cd".repeat(16)).unwrap();
        assert!(matches!(read(&other, &bytes), Err(Unread::Damaged(_))), "of another design");
        let text = String::from_utf8(bytes.clone()).unwrap();
        for damaged in [&text[..text.len() / 2], &text.replace("0.9]", "0.91]")] {
            assert!(matches!(read(&id, damaged.as_bytes()), Err(Unread::Damaged(_))), "{damaged}");
        }
        let old =
            "{\"format\":\"billow-reference\",\"version\":2,\"physics_version\":6,\"states\":[]}";
        assert_eq!(read(&id, seal::seal(old).as_bytes()), Err(Unread::OtherVersion));
        assert!(results.references().unread.is_empty());
        let damaged = path.with_file_name(format!("{other}.json"));
        files::write_atomic(&Disk, &damaged, &bytes).unwrap();
        assert_eq!(results.references().unread[0].0, damaged);
        // A disk that fails at any operation leaves the old file or the new one.
        let before = read(&id, &results.files().read(&path).unwrap());
        for nth in 1..=4 {
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            let other = vec![state(64, 1.0, 0.5, 0.9)];
            let written = Results::new(&failing, folder.path()).write_reference(&id, &other);
            let found = read(&id, &results.files().read(&path).unwrap());
            assert_eq!(written.is_err(), nth < 4, "operation {nth}");
            assert!(found == before || found == Ok(other), "operation {nth}");
            results.write_reference(&id, &reference).unwrap();
        }
        assert_eq!(results.references().states, [(id, reference)]);
    }
}
