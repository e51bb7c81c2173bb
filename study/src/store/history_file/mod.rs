//! History files, HDF5: one per job, or per scene that is solved alone. Beside it only
//! [`crate::store::cube`] uses HDF5, through the calls of this module.
//!
//! ```text
//! /            format, version, program_version, commit, physics_version, job, scene, status,
//!              stop_time, stop_location, content_hash, complete (written last)
//! /history/    time (a dimension scale), z_centre, … : f64, one value per sample, each with units
//!              and long_name. Film without rings has height in place of
//!              z_centre, z_rim, vz. A scene adds
//!              node_NAME_x, …, element_NAME_N1, … for what it follows; film with contact adds
//!              interlayer_pressure, smallest_gap, …, plate_NAME_force
//! /events/     time, kind: decisions of the step controller, when there were any (events)
//! /VTKHDF/     shapes of the film, when the run stored any (vtkhdf)
//! ```
//!
//! The `job` of a scene that is solved alone is the first half of its fingerprint.
//!
//! The file is built in memory and written at once, so no reader ever sees an incomplete file. It
//! holds no time of day: the same job and program give the same bytes. The columns over `time` can be
//! read with `xarray.open_dataset(path, engine="h5netcdf", group="history")`.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use hdf5::types::VarLenUnicode;
use hdf5::{File, Location};

use crate::platform::error::{Error, Result};

mod content_hash;
mod events;
pub(in crate::store) mod raw;
mod read;
mod sha256;
mod vtkhdf;
mod write;

pub use content_hash::{content_hash, hash_of};
pub use read::{StoredHistory, read};
pub use vtkhdf::StoredFrames;
pub use write::{encode, encode_scene};

/// Name of the format, in the attribute `format`.
const FORMAT: &str = "billow-history";
/// Version of the format that this program writes and reads.
const VERSION: u32 = 2;
/// Number of samples from which a column is stored in compressed chunks. Chosen: below it, the index
/// of the chunks takes more space than the compression saves.
const MIN_CHUNKED_SAMPLES: usize = 512;
/// Number of samples in a chunk, at most. Chosen: 128 KiB of `f64`.
pub(in crate::store) const MAX_CHUNK_SAMPLES: usize = 16_384;
/// Deflate level. Chosen: on shuffled time series, level 1 is nearly as small as 9 and much faster.
pub(in crate::store) const DEFLATE_LEVEL: u8 = 1;

/// HDF5 has global state: one thread at a time uses it.
pub(in crate::store) static HDF5_LOCK: Mutex<()> = Mutex::new(());

/// Opens the frames of a history file, to be read one at a time; `None` for a file without frames.
///
/// # Errors
/// As [`read`].
pub fn read_frames(path: &Path) -> Result<Option<StoredFrames>> {
    let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let file = open(path)?;
    vtkhdf::read(&file, path).map_err(|error| damaged(path, &error))
}

/// Opens a history file that is complete and of a version that this program reads.
fn open(path: &Path) -> Result<File> {
    let broken = |problem: String| Error::Disk { path: path.to_owned(), problem };
    if !path.exists() {
        return Err(broken("no such file".to_owned()));
    }
    let file = File::open(path).map_err(|error| {
        broken(format!(
            "not an HDF5 file: {error}\n  next: if it is the damaged file of a job, run `billow run` \
             of its study: it writes the file again"
        ))
    })?;
    let damaged = |error| damaged(path, &error);
    let format = read_text(&file, "format").unwrap_or_default();
    if format != FORMAT {
        return Err(broken("an HDF5 file, but not a billow history".to_owned()));
    }
    let version: u32 = read_number(&file, "version").map_err(damaged)?;
    if version != VERSION {
        return Err(broken(format!(
            "history file of version {version}, this program reads version {VERSION}\n  next: use the \
             billow that wrote it"
        )));
    }
    let complete: u8 = read_number(&file, "complete").map_err(damaged)?;
    if complete != 1 {
        return Err(damaged("not complete".into()));
    }
    Ok(file)
}

fn damaged(path: &Path, error: &hdf5::Error) -> Error {
    Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "damaged history file: {error}\n  next: run `billow run` of its study: it runs the job \
             again"
        ),
    }
}

/// Writes a number as an attribute.
pub(in crate::store) fn number_attribute<T: hdf5::H5Type + Copy>(
    location: &Location,
    name: &str,
    number: T,
) -> hdf5::Result<()> {
    location.new_attr::<T>().create(name)?.write_scalar(&number)
}

fn read_text(location: &Location, name: &str) -> hdf5::Result<String> {
    Ok(location.attr(name)?.read_scalar::<VarLenUnicode>()?.to_string())
}

fn read_number<T: hdf5::H5Type>(location: &Location, name: &str) -> hdf5::Result<T> {
    location.attr(name)?.read_scalar::<T>()
}

#[cfg(test)]
mod tests;
