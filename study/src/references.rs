//! Static states runs are judged against: looked for once a design, shared by all its jobs.
//!
//! ```text
//! results/<study>/references/<id>.json     {"format", "version", "physics_version", "states": [[p, V, z_rim], …]}
//! ```
//!
//! The id is that of the scene whose states they are ([`billow_solver::ladder::reference_scene`]): all
//! that does not matter to them left out. A stored state is a saving, never a truth: what is missing,
//! damaged or of another physics version is looked for again and gives the same bits.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use billow_solver::PHYSICS_VERSION;
use billow_solver::ladder;
use billow_solver::measures::Reference;
use billow_solver::scene::Scene;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::files::{self, disk_error};
use crate::job::JobId;
use crate::results::Results;

/// Name of the format.
const FORMAT: &str = "billow-reference";
/// Version of the format this program writes and reads.
const VERSION: u32 = 1;

/// A reference, or why there is none.
type Found = std::result::Result<Reference, String>;
/// Found once; whoever comes meanwhile waits.
type Slot = Arc<OnceLock<Found>>;

/// References by the scene they are of.
#[derive(Debug, Default)]
pub struct References {
    slots: Mutex<BTreeMap<JobId, Slot>>,
    fresh: Mutex<Vec<(JobId, Reference)>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: String,
    version: u32,
    physics_version: u32,
    /// Overpressure, Pa, volume, m³, mean height of the top ring, m; pressure rising.
    states: Vec<[f64; 3]>,
}

impl References {
    /// What a results folder holds of them; what cannot be read is not known.
    pub fn load(results: &Results<'_>) -> Self {
        let paths = results.files().list(&results.references_path()).unwrap_or_default();
        let known = paths.into_iter().filter_map(|path| {
            let id = JobId::from_digits(&path.file_stem()?.to_string_lossy())?;
            let reference = read(&results.files().read(&path).ok()?)?;
            Some((id, Arc::new(OnceLock::from(Ok(reference)))))
        });
        Self { slots: Mutex::new(known.collect()), fresh: Mutex::default() }
    }

    /// The reference of a scene; `None` where its model knows its own. The second value says why
    /// there is none where there should be one. `goes_on` is asked now and then; once it says no the
    /// whole run is ending, and none is looked for again.
    pub fn of(
        &self,
        scene: &Scene,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> (Option<Reference>, Option<String>) {
        let Some(of) = ladder::reference_scene(scene) else { return (None, None) };
        let id = JobId::of(&of);
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(slots.entry(id.clone()).or_default())
        };
        let found = slot.get_or_init(|| {
            let found = ladder::reference(&of, goes_on).map_err(|error| error.to_string());
            if let Ok(reference) = &found {
                let mut fresh = self.fresh.lock().unwrap_or_else(PoisonError::into_inner);
                fresh.push((id, reference.clone()));
            }
            found
        });
        match found {
            Ok(reference) => (Some(reference.clone()), None),
            Err(problem) => (None, Some(format!("no verdict: {problem}"))),
        }
    }

    /// What has been found since the last call.
    pub fn take_fresh(&self) -> Vec<(JobId, Reference)> {
        core::mem::take(&mut self.fresh.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

fn read(bytes: &[u8]) -> Option<Reference> {
    let stored: Stored = serde_json::from_slice(bytes).ok()?;
    let ours = stored.format == FORMAT
        && stored.version == VERSION
        && stored.physics_version == PHYSICS_VERSION;
    let rising = stored.states.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    let sound = rising && stored.states.first().is_some_and(|first| first[0] > 0.0);
    (ours && sound).then(|| Reference::new(stored.states))
}

impl Results<'_> {
    /// Files that should be references and are none this program reads.
    pub fn unread_references(&self) -> Vec<PathBuf> {
        let paths = self.files().list(&self.references_path()).unwrap_or_default();
        let sound = |path: &PathBuf| self.files().read(path).ok().and_then(|bytes| read(&bytes));
        paths.into_iter().filter(|path| sound(path).is_none()).collect()
    }

    /// Stores a reference.
    ///
    /// # Errors
    /// [`crate::error::Error::Disk`].
    pub fn write_reference(&self, id: &JobId, reference: &Reference) -> Result<()> {
        let folder = self.references_path();
        let path = folder.join(format!("{id}.json"));
        let stored = Stored {
            format: FORMAT.to_owned(),
            version: VERSION,
            physics_version: PHYSICS_VERSION,
            states: reference.states().to_vec(),
        };
        let written = || -> io::Result<()> {
            self.files().create_folder(&folder)?;
            let mut bytes = serde_json::to_vec(&stored).map_err(io::Error::other)?;
            bytes.push(b'\n');
            files::write_atomic(self.files(), &path, &bytes)
        };
        written().map_err(|error| disk_error(&path, &error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Disk;
    use crate::files::failing::FailingFiles;

    #[test]
    fn what_is_stored_is_read_and_what_is_damaged_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
        let reference = Reference::new(vec![[1.0, 0.1 + 0.2, 0.9], [10.0, 0.4, 1.0]]);
        results.write_reference(&id, &reference).unwrap();
        let path = results.references_path().join(format!("{id}.json"));
        let bytes = results.files().read(&path).unwrap();
        assert_eq!(read(&bytes), Some(reference.clone()));
        assert_eq!(read(&bytes[..bytes.len() / 2]), None);
        let other = String::from_utf8(bytes).unwrap().replace("\"version\":1", "\"version\":2");
        assert_eq!(read(other.as_bytes()), None);
        assert!(results.unread_references().is_empty());
        let damaged = path.with_file_name(format!("{}.json", "cd".repeat(16)));
        files::write_atomic(&Disk, &damaged, other.as_bytes()).unwrap();
        assert_eq!(results.unread_references(), [damaged]);
        // A disk that fails at any operation leaves the old file or the new one.
        let sound = read(&results.files().read(&path).unwrap());
        for nth in 1..=4 {
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            let other = Reference::new(vec![[1.0, 0.5, 0.9]]);
            let told = Results::new(&failing, folder.path()).write_reference(&id, &other);
            let found = read(&results.files().read(&path).unwrap());
            assert_eq!(told.is_err(), nth < 4, "operation {nth}");
            assert!(found == sound || found == Some(other), "operation {nth}");
            results.write_reference(&id, &reference).unwrap();
        }
        let loaded = References::load(&results);
        let slots = loaded.slots.lock().unwrap();
        assert_eq!(slots[&id].get(), Some(&Ok(reference)));
    }
}
