//! SHA-256 of bytes.

use billow_solver::platform::seal::hexadecimal;
use sha2::{Digest, Sha256};

/// The hash of bytes, in lower-case hexadecimal digits.
pub fn bytes_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}
