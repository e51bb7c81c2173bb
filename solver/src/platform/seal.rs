//! A checksum inside the text of a JSON object, so that every changed byte is found.
//!
//! ```text
//! {"checksum":"<64 hexadecimal digits>", other members …}
//! ```
//!
//! The checksum is the SHA-256 of the whole text with zeros in place of its 64 digits. It protects against
//! damaged disks and careless edits, not against forgery.

use core::fmt::Write as _;

use sha2::{Digest, Sha256};

/// Text before the digits. The checksum is the first member.
const BEFORE: &str = "{\"checksum\":\"";
/// Text after the digits.
const AFTER: &str = "\",";
/// Number of hexadecimal digits of a SHA-256.
const DIGITS: usize = 64;

/// Why a text is not what was sealed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SealError {
    /// The text has no checksum as its first member.
    #[error("it has no checksum")]
    Missing,
    /// The text is not the one of which the checksum was taken.
    #[error("it does not have the contents of its checksum: the file was changed or damaged")]
    Changed,
}

/// The text of a JSON object with its checksum as first member.
///
/// # Panics
/// If `object` does not begin with a brace.
pub fn seal(object: &str) -> String {
    let Some(members) = object.strip_prefix('{') else { panic!("no JSON object: {object:.20}") };
    let checksum = checksum(members);
    let mut text = String::with_capacity(BEFORE.len() + DIGITS + AFTER.len() + members.len());
    text.extend([BEFORE, &checksum, AFTER, members]);
    text
}

/// The text of the object that was sealed, without the checksum.
pub fn open(text: &str) -> Result<String, SealError> {
    let rest = text.strip_prefix(BEFORE).ok_or(SealError::Missing)?;
    // An index within a character gives no slice.
    let (Some(found), Some(rest)) = (rest.get(..DIGITS), rest.get(DIGITS..)) else {
        return Err(SealError::Changed);
    };
    let members = rest.strip_prefix(AFTER).ok_or(SealError::Changed)?;
    if found != checksum(members) {
        return Err(SealError::Changed);
    }
    let mut object = String::with_capacity(1 + members.len());
    object.extend(["{", members]);
    Ok(object)
}

/// The checksum of an object with these members.
fn checksum(members: &str) -> String {
    let mut hash = Sha256::new();
    for part in [BEFORE, &"0".repeat(DIGITS), AFTER, members] {
        hash.update(part.as_bytes());
    }
    hexadecimal(&hash.finalize())
}

/// Bytes as lower-case hexadecimal digits.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBJECT: &str = "{\"format\":\"x\",\"z\":0.30000000000000004}\n";

    #[test]
    fn a_sealed_text_is_json_and_opens_to_the_same_object() {
        let text = seal(OBJECT);
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["checksum"].as_str().unwrap().len(), DIGITS);
        assert_eq!(open(&text), Ok(OBJECT.to_owned()));
        assert_eq!(open(OBJECT), Err(SealError::Missing));
    }

    #[test]
    fn every_flipped_bit_and_every_other_length_is_found() {
        let bytes = seal(OBJECT).into_bytes();
        for index in 0..bytes.len() {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[index] ^= 1 << bit;
                assert!(!std::str::from_utf8(&changed).is_ok_and(|text| open(text).is_ok()));
            }
            assert!(open(std::str::from_utf8(&bytes[..index]).unwrap()).is_err());
        }
        let longer = format!("{} ", seal(OBJECT));
        assert_eq!(open(&longer), Err(SealError::Changed));
    }
}
