//! The text of a study or scene file: UTF-8, at most [`MAX_FILE_SIZE`].

use std::io::ErrorKind;
use std::path::Path;

use crate::platform::error::{Error, InputError, Result};
use crate::platform::files;

/// Largest study or scene file read, bytes (chosen: such a file is written by hand, and a grid of a
/// million points takes a few lines).
pub const MAX_FILE_SIZE: u64 = 16 << 20;

/// The text of a file; a byte order mark is no part of it.
///
/// # Errors
/// When the bytes are empty or not UTF-8.
pub fn text_of<'a>(bytes: &'a [u8], file: &str) -> std::result::Result<&'a str, InputError> {
    let refuse = |problem: String, hint: &str| InputError {
        file: file.to_owned(),
        key: String::new(),
        value: String::new(),
        problem,
        allowed: "JSON in UTF-8".to_owned(),
        hint: hint.to_owned(),
    };
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let byte = error.valid_up_to();
        let line = bytes[..byte].split(|byte| *byte == b'\n').count();
        let problem = format!("is not UTF-8 from byte {byte} on, in line {line}");
        refuse(problem, "name a study file or a scene file, saved as UTF-8")
    })?;
    if text.trim().is_empty() {
        let next = "start from a file in studies/ (or, for a scene, in scenes/)";
        return Err(refuse("is empty".to_owned(), next));
    }
    Ok(text)
}

/// The bytes of a study or scene file; `what` names the kind of file, `example` one that ships.
///
/// # Errors
/// [`Error::Disk`] when it cannot be read, or is larger than [`MAX_FILE_SIZE`].
pub fn read(path: &Path, what: &str, example: &str) -> Result<Vec<u8>> {
    let disk = |problem: String| Error::Disk { path: path.to_owned(), problem };
    let give = format!("give the path of a {what}, as {example}");
    let unreadable = |error: std::io::Error| {
        let near =
            || files::nearest_name(path).map(|near| format!("did you mean {near}? Otherwise "));
        let (problem, next) = match error.kind() {
            ErrorKind::IsADirectory => ("it is a folder".to_owned(), give.clone()),
            ErrorKind::NotFound => {
                (error.to_string(), format!("{}{give}", near().unwrap_or_default()))
            }
            _ => {
                let next = "make the file readable and run the same command again";
                (error.to_string(), next.to_owned())
            }
        };
        disk(format!("cannot read the {what}: {problem}\n  next: {next}"))
    };
    files::read_at_most(path, MAX_FILE_SIZE).map_err(unreadable)?.ok_or_else(|| {
        let limit = MAX_FILE_SIZE >> 20;
        disk(format!("is larger than {limit} MiB, the limit of a {what}\n  next: {give}"))
    })
}
