//! SHA-256 of named arrays, in lower-case hexadecimal digits.

use billow_solver::platform::seal::hexadecimal;
use sha2::{Digest, Sha256};

/// The input of a content hash: one array after the other.
pub(super) struct Contents(Sha256);

impl Contents {
    /// Contents without an array.
    pub(super) fn new() -> Self {
        Self(Sha256::new())
    }

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

    /// The hash of all arrays.
    pub(super) fn hash(self) -> String {
        hexadecimal(&self.0.finalize())
    }
}
