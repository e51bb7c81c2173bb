//! Changes of bytes, for any file.

use crate::harness::random::Random;

/// Changes of one file, at most.
const MAX_CHANGES: usize = 4;
/// Longest part that is removed, doubled or moved.
const MAX_PART: usize = 200;
/// Texts that are put in.
const TEXTS: [&[u8]; 12] =
    [b"\0", b"\xff", b"\xc3", b"\n", b"\r\n", b"{", b"}", b"]", b"\"", b"\\", b"1e999", b"-0"];
/// The bytes with a few changes.
pub fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(MAX_CHANGES) {
        change(&mut bytes, random);
    }
    bytes
}

/// Makes one change.
pub fn change(bytes: &mut Vec<u8>, random: &mut Random) {
    if bytes.is_empty() {
        return bytes.push(b'{');
    }
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(MAX_PART)).min(bytes.len());
    match random.below(7) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes.truncate(at),
        2 => drop(bytes.drain(at..end)),
        3 => {
            let part = bytes[at..end].to_vec();
            let place = random.below(bytes.len());
            bytes.splice(place..place, part);
        }
        4 => bytes[at..end].reverse(),
        5 => digit(bytes, at, random),
        _ => {
            let text = *random.pick(&TEXTS);
            bytes.splice(at..at, text.iter().copied());
        }
    }
}

/// Changes the first digit after a place.
pub fn digit(bytes: &mut [u8], at: usize, random: &mut Random) {
    if let Some(digit) = bytes[at..].iter_mut().find(|byte| byte.is_ascii_digit()) {
        let change = u8::try_from(1 + random.below(9)).unwrap_or(1);
        *digit = b'0' + (*digit - b'0' + change) % 10;
    }
}
