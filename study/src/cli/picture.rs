//! Pictures as commands write them, and what their flags have in common.

use std::path::Path;

use crate::input::units::{self, Dimension};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{self, Disk, disk_error};
use crate::render::png;

/// Format of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Picture {
    /// Lines and areas.
    Svg,
    /// Pixels.
    Png,
}

impl Picture {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Svg, Self::Png];

    /// The format a file name asks for.
    ///
    /// # Errors
    /// [`Error::Input`] when it asks for none of them.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(refused(
                "--out",
                &path.display().to_string(),
                "not a format of pictures",
                "a name that ends in .svg or .png",
            )),
        }
    }

    /// How names of its files end.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// Writes a picture, whole or not at all, in the format its name asks for.
///
/// # Errors
/// A name without a format, a picture too large, a file that cannot be written.
pub fn write(path: &Path, svg: &str) -> Result<()> {
    let bytes = match Picture::of(path)? {
        Picture::Svg => svg.as_bytes().to_vec(),
        Picture::Png => png::encode(svg, png::PRINT)
            .map_err(|problem| Error::Disk { path: path.to_owned(), problem })?,
    };
    files::write_atomic(&Disk, path, &bytes).map_err(|error| disk_error(path, &error))
}

/// A time given on the command line, s: a number, or a number with a unit.
///
/// # Errors
/// [`Error::Input`].
pub fn seconds(flag: &str, text: &str) -> Result<f64> {
    if let Ok(seconds) = text.trim().parse::<f64>()
        && seconds.is_finite()
    {
        return Ok(seconds);
    }
    units::parse(text, Dimension::Time)
        .map_err(|error| refused(flag, text, &error.problem, &error.allowed))
}

/// A flag's value that is not as it must be.
pub fn refused(flag: &str, value: &str, problem: &str, allowed: &str) -> Error {
    Error::from(InputError {
        file: flag.to_owned(),
        key: String::new(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed: allowed.to_owned(),
        hint: String::new(),
    })
}
