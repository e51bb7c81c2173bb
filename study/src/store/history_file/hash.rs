//! Hashes: of the values that a run stored, and of the bytes of a file.

use billow_solver::output::frames::Frames;
use billow_solver::output::history::{History, Track};
use billow_solver::output::outcome::Deployment;
use sha2::{Digest, Sha256};

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
    let mut contents = Contents(Sha256::new());
    let columns = history.iter().map(|(column, values)| (column.name, values));
    let tracks = tracks.iter().map(|track| (track.name.as_str(), track.values.as_slice()));
    for (name, values) in columns.chain(tracks) {
        let bytes = values.iter().map(|value| value.to_bits().to_le_bytes());
        contents.add(hashed_column_name(name), values.len(), bytes);
    }
    if let Some(frames) = frames {
        vtkhdf::hash(frames, &mut contents);
    }
    hexadecimal(&contents.0.finalize())
}

/// The input of a content hash: one array after the other.
pub(super) struct Contents(Sha256);

impl Contents {
    /// Adds an array: its name, its length, its values in little-endian bytes.
    pub(super) fn add<const N: usize>(
        &mut self,
        name: &str,
        length: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        self.0.update((name.len() as u64).to_le_bytes());
        self.0.update(name.as_bytes());
        self.0.update((length as u64).to_le_bytes());
        for value in values {
            self.0.update(value);
        }
    }
}

/// SHA-256 of bytes, in lower-case hexadecimal digits.
pub fn bytes_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
