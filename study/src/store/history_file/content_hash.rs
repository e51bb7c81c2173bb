//! Content hash: of the values that a run stored.

use billow_solver::output::frames::Frames;
use billow_solver::output::history::{History, Track};
use billow_solver::output::outcome::Deployment;

use super::sha256::Contents;
use super::vtkhdf;
use crate::job::row::hashed_column_name;

/// SHA-256 of the names, lengths and values of all that a run stored, in lower-case hexadecimal
/// digits. Equal results have equal hashes, whatever program or machine stored them. A renamed column
/// enters with its first name.
pub fn content_hash(deployment: &Deployment) -> String {
    hash_of(&deployment.history, &deployment.tracks, deployment.frames.as_ref())
}

/// The same hash of a history, its tracks and its frames.
pub fn hash_of(history: &History, tracks: &[Track], frames: Option<&Frames>) -> String {
    let mut contents = Contents::new();
    let columns = history.iter().map(|(column, values)| (column.name, values));
    let tracks = tracks.iter().map(|track| (track.name.as_str(), track.values.as_slice()));
    for (name, values) in columns.chain(tracks) {
        let bytes = values.iter().map(|value| value.to_bits().to_le_bytes());
        contents.add(hashed_column_name(name), values.len(), bytes);
    }
    if let Some(frames) = frames {
        vtkhdf::hash(frames, &mut contents);
    }
    contents.hash()
}
