//! Picture files that commands write, and the options that these commands share.

use std::path::Path;

use crate::input::units::{self, Dimension};
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Disk, disk_error};
use crate::render::png;

/// Format of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Picture {
    /// SVG.
    Svg,
    /// PNG.
    Png,
}

impl Picture {
    /// Every format.
    pub const ALL: [Self; 2] = [Self::Svg, Self::Png];

    /// The format that a file name extension gives.
    ///
    /// # Errors
    /// [`Error::Input`] for another extension, or none.
    pub fn of(path: &Path) -> Result<Self> {
        let extension =
            path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(refused(
                "--out",
                &path.display().to_string(),
                "not a picture format",
                "a file name that ends in .svg or .png",
            )),
        }
    }

    /// File name extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// Writes a picture in the format of its file name. The file is complete or not written at all.
///
/// # Errors
/// A file name without a known format, a picture that is too large, a file that cannot be written.
pub fn write(path: &Path, svg: &str) -> Result<()> {
    let bytes = match Picture::of(path)? {
        Picture::Svg => svg.as_bytes().to_vec(),
        Picture::Png => png::encode(svg, png::PRINT_RESOLUTION)
            .map_err(|problem| Error::Disk { path: path.to_owned(), problem })?,
    };
    files::write_output(&Disk, path, &bytes).map_err(|error| disk_error(path, &error))
}

/// A time on the command line, s: a number, or a number with a unit.
///
/// # Errors
/// [`Error::Input`].
pub fn seconds(option: &str, text: &str) -> Result<f64> {
    if let Ok(seconds) = text.trim().parse::<f64>()
        && seconds.is_finite()
    {
        return Ok(seconds);
    }
    units::parse(text, Dimension::Time)
        .map_err(|error| refused(option, text, &error.problem, &error.allowed))
}

/// The error of an invalid option value.
pub fn refused(option: &str, value: &str, problem: &str, allowed: &str) -> Error {
    Error::invalid_option(option, value, problem, allowed, "")
}
