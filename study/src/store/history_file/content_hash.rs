//! Content hash: of the values that a run stored.

use billow_solver::output::frames::Frames;
use billow_solver::output::history::{History, Track};
use billow_solver::output::outcome::Deployment;

use super::sha256::Contents;
use super::vtkhdf;

/// Columns that a hash names otherwise: name, name in the hash. The names changed once; the hashes of equal results did not.
const NAMES_IN_HASHES: [(&str, &str); 3] = [
    ("broad_phase_rebuilds", "contact_searches"),
    ("collision_impulses", "contact_impulses"),
    ("numerical_dissipation", "viscous_work"),
];

/// SHA-256 of the names, lengths and values of all that a run stored, in lower-case hexadecimal
/// digits. Equal results have equal hashes, whatever program or machine stored them.
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
        let other = NAMES_IN_HASHES.iter().find(|(current, _)| *current == name);
        contents.add(other.map_or(name, |(_, hashed)| hashed), values.len(), bytes);
    }
    if let Some(frames) = frames {
        vtkhdf::hash(frames, &mut contents);
    }
    contents.hash()
}
