//! The text of a study or scene file: UTF-8, at most [`MAX_FILE_SIZE`].

use std::path::Path;

use crate::input::place;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files;

/// Largest study or scene file read, bytes (chosen: such a file is written by hand, and a grid of a
/// million points takes a few lines).
pub const MAX_FILE_SIZE: u64 = 16 << 20;

/// First bytes of files that are given by mistake, and what they are.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"\x89HDF", "an HDF5 file (as the histories of results are)"),
    (b"PAR1", "a Parquet file (as the table of results is)"),
    (b"\x89PNG", "a PNG picture"),
    (b"%PDF", "a PDF file"),
    (b"PK\x03\x04", "a ZIP archive (office documents are such)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x7fELF", "a program"),
];

/// Reads text from bytes.
///
/// # Errors
/// When the bytes are empty, not UTF-8, or start with a byte order mark.
pub fn text_of<'a>(bytes: &'a [u8], file: &str) -> std::result::Result<&'a str, InputError> {
    let refuse = |problem: String, hint: &str| InputError {
        file: file.to_owned(),
        key: String::new(),
        value: String::new(),
        problem,
        allowed: "JSON in UTF-8, without a byte order mark".to_owned(),
        hint: hint.to_owned(),
    };
    if bytes.starts_with(&[0xEF, 0xBB, 0xBF])
        || bytes.starts_with(&[0xFF, 0xFE])
        || bytes.starts_with(&[0xFE, 0xFF])
    {
        return Err(refuse(
            "starts with a byte order mark".to_owned(),
            "save it as plain UTF-8 (\"UTF-8 without BOM\")",
        ));
    }
    if let Some((_, kind)) = FOREIGN.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(refuse(format!("is {kind}, not JSON"), "name a study file or a scene file"));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let sound = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        let (line, column) = place::line_and_column(&sound, sound.len());
        refuse(
            format!(
                "is not UTF-8 from byte {} on, line {line} column {column}",
                error.valid_up_to()
            ),
            "save it as UTF-8",
        )
    })?;
    if text.contains('\0') {
        return Err(refuse("is not text: it has NUL bytes".to_owned(), "save it as UTF-8"));
    }
    if text.trim().is_empty() {
        return Err(refuse(
            "is empty".to_owned(),
            "start from a file in studies/ (or, for a scene, in scenes/)",
        ));
    }
    Ok(text)
}

/// The bytes of a study or scene file; `what` names the kind of file, `example` one that ships.
///
/// # Errors
/// [`Error::Disk`] when it cannot be read, or is larger than [`MAX_FILE_SIZE`].
pub fn read(path: &Path, what: &str, example: &str) -> Result<Vec<u8>> {
    let disk = |problem: String| Error::Disk { path: path.to_owned(), problem };
    let unreadable = |error: std::io::Error| {
        let next = match error.kind() {
            std::io::ErrorKind::NotFound | std::io::ErrorKind::IsADirectory => {
                let near = files::nearest_name(path)
                    .map_or_else(String::new, |near| format!("did you mean {near}? Otherwise "));
                format!("\n  next: {near}give the path of a {what}, as {example}")
            }
            _ => "\n  next: make the file readable and run the same command again".to_owned(),
        };
        let problem = match error.kind() {
            std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
            _ => error.to_string(),
        };
        disk(format!("cannot read the {what}: {problem}{next}"))
    };
    files::read_at_most(path, MAX_FILE_SIZE).map_err(unreadable)?.ok_or_else(|| {
        let limit = MAX_FILE_SIZE >> 20;
        let next = format!("give the path of a {what}, as {example}");
        disk(format!("is larger than {limit} MiB, the limit of a {what}\n  next: {next}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_not_text_are_refused() {
        for bytes in
            [&b""[..], b" \n", b"\xEF\xBB\xBF{}", b"\xFF\xFE{\0}\0", b"{\"a\": \"\xC3\x28\"}"]
        {
            assert!(text_of(bytes, "f").is_err(), "{bytes:?}");
        }
    }
}
