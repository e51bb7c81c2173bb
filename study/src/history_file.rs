//! The only door to HDF5: one file a job.
//!
//! ```text
//! /            format, version, program_version, commit, physics_version, job, scene, status,
//!              stop_time, stop_place, content_hash, complete (written last)
//! /history/    time (a dimension scale), z_centre, … : f64, one value a sample,
//!              each with units and long_name
//! ```
//!
//! The file is built in memory and written in one go, so no reader ever sees a half. It holds no
//! time of day: the same job run by the same program gives the same bytes. `xarray.open_dataset(path,
//! engine="h5netcdf", group="history")` shows the columns over `time`.

use std::path::Path;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use billow_solver::deployment::{Deployment, Stop};
use billow_solver::history::{COLUMNS, History};
use hdf5::file::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use hdf5::{File, Group, Location};
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::job::{Job, JobId};
use crate::{provenance, row};

mod scale;

/// Name of the format, in the attribute `format`.
const FORMAT: &str = "billow-history";
/// Version of the format this program writes, and the newest it reads.
const VERSION: u32 = 1;
/// Samples from which a column is stored in compressed chunks; below, the chunk index would cost
/// more than it saves.
const CHUNKED_FROM: usize = 512;
/// Samples a chunk, at most.
const CHUNK: usize = 16_384;
/// Deflate level: 1 is within a few per cent of 9 on shuffled time series, at a fraction of the time.
const DEFLATE: u8 = 1;

/// HDF5 keeps global state; one thread at a time is in here.
static DOOR: Mutex<()> = Mutex::new(());

/// SHA-256 of the names, shapes and values of a history, in lower-case hexadecimal digits: the same
/// for the same results, whatever program or machine stored them.
pub fn content_hash(history: &History) -> String {
    let mut hash = Sha256::new();
    for (column, values) in history.iter() {
        hash.update((column.name.len() as u64).to_le_bytes());
        hash.update(column.name.as_bytes());
        hash.update((values.len() as u64).to_le_bytes());
        for value in values {
            hash.update(value.to_bits().to_le_bytes());
        }
    }
    hexadecimal(&hash.finalize())
}

/// SHA-256 of bytes, in lower-case hexadecimal digits.
pub fn bytes_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The bytes of a job's history file.
///
/// # Errors
/// What HDF5 says, in words.
pub fn encode(
    job: &Job,
    deployment: &Deployment,
    hash: &str,
) -> std::result::Result<Vec<u8>, String> {
    let scene = serde_json::to_string(&job.scene).map_err(|error| error.to_string())?;
    let _door = DOOR.lock().unwrap_or_else(PoisonError::into_inner);
    build(job, &scene, deployment, hash).map_err(|error| error.to_string())
}

fn build(job: &Job, scene: &str, deployment: &Deployment, hash: &str) -> hdf5::Result<Vec<u8>> {
    let ordered = LinkCreationOrder::Indexed;
    // The oldest superblock: HDF5 1.10 gives the image of a newer one with a wrong checksum.
    let file = File::with_options()
        .with_fapl(|access| access.core_options(64 * 1024, false))
        .with_fcpl(|creation| creation.obj_track_times(false).link_creation_order(ordered))
        .create(job.id.as_str())?;
    let (status, stop_time, stop_place) = match &deployment.stop {
        Stop::Done => (row::DONE, None, None),
        Stop::Cancelled => ("cancelled", None, None),
        Stop::Failed(failure) => {
            (failure.kind.name(), Some(failure.time), Some(failure.place.as_str()))
        }
    };
    text_attribute(&file, "format", FORMAT)?;
    number_attribute(&file, "version", VERSION)?;
    text_attribute(&file, "program_version", provenance::PROGRAM_VERSION)?;
    text_attribute(&file, "commit", provenance::COMMIT)?;
    number_attribute(&file, "physics_version", provenance::PHYSICS_VERSION)?;
    text_attribute(&file, "job", job.id.as_str())?;
    text_attribute(&file, "scene", scene)?;
    text_attribute(&file, "status", status)?;
    if let Some(time) = stop_time {
        number_attribute(&file, "stop_time", time)?;
    }
    if let Some(place) = stop_place {
        text_attribute(&file, "stop_place", place)?;
    }
    text_attribute(&file, "content_hash", hash)?;
    let group = file
        .create_group_builder()
        .with_gcpl(|creation| creation.link_creation_order(ordered))
        .create("history")?;
    write_history(&group, &deployment.history)?;
    number_attribute(&file, "complete", 1_u8)?;
    scale::image(&file)
}

fn write_history(group: &Group, history: &History) -> hdf5::Result<()> {
    let mut datasets = Vec::with_capacity(COLUMNS.len());
    for (column, values) in history.iter() {
        let mut builder = group.new_dataset_builder().obj_track_times(false).no_chunk();
        if values.len() >= CHUNKED_FROM {
            builder = builder.chunk(values.len().min(CHUNK)).shuffle().deflate(DEFLATE);
        }
        let dataset = builder.with_data(values).create(column.name)?;
        text_attribute(&dataset, "units", column.unit)?;
        text_attribute(&dataset, "long_name", column.meaning)?;
        datasets.push(dataset);
    }
    if let Some((time, others)) = datasets.split_first() {
        scale::attach(group, time, COLUMNS[0].name, others)?;
    }
    Ok(())
}

fn text_attribute(location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    let text = VarLenUnicode::from_str(text).map_err(|error| error.to_string())?;
    location.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&text)
}

fn number_attribute<T: hdf5::H5Type>(
    location: &Location,
    name: &str,
    number: T,
) -> hdf5::Result<()> {
    location.new_attr::<T>().create(name)?.write_scalar(&number)
}

/// A history file, read back.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredHistory {
    /// Its job.
    pub job: JobId,
    /// The scene it was computed from, as JSON.
    pub scene: String,
    /// How the run ended.
    pub status: String,
    /// Hash of the history, as stored.
    pub content_hash: String,
    /// The series.
    pub history: History,
}

/// Reads a history file.
///
/// # Errors
/// [`Error::Disk`] for a file that is missing, damaged, foreign, incomplete or of a newer version.
pub fn read(path: &Path) -> Result<StoredHistory> {
    let broken = |problem: String| Error::Disk { path: path.to_owned(), problem };
    let _door = DOOR.lock().unwrap_or_else(PoisonError::into_inner);
    let file = File::open(path).map_err(|error| broken(format!("no HDF5 file: {error}")))?;
    let damaged = |error: hdf5::Error| {
        broken(format!(
            "damaged history file: {error}\n  next: `billow run` of its study runs the job again"
        ))
    };
    let format = read_text(&file, "format").unwrap_or_default();
    if format != FORMAT {
        return Err(broken("an HDF5 file, but no billow history".to_owned()));
    }
    let version: u32 = read_number(&file, "version").map_err(damaged)?;
    if version > VERSION {
        return Err(broken(format!(
            "history file of version {version}, this program reads up to {VERSION}\n  next: use \
             the newer billow that wrote it"
        )));
    }
    let complete: u8 = read_number(&file, "complete").map_err(damaged)?;
    if complete != 1 {
        return Err(damaged("not complete".into()));
    }
    let job = read_text(&file, "job").map_err(damaged)?;
    Ok(StoredHistory {
        job: JobId::from_digits(&job).ok_or_else(|| damaged("no job id".into()))?,
        scene: read_text(&file, "scene").map_err(damaged)?,
        status: read_text(&file, "status").map_err(damaged)?,
        content_hash: read_text(&file, "content_hash").map_err(damaged)?,
        history: read_history(&file).map_err(damaged)?,
    })
}

fn read_history(file: &File) -> hdf5::Result<History> {
    let group = file.group("history")?;
    let mut columns = Vec::with_capacity(COLUMNS.len());
    for column in COLUMNS {
        columns.push(group.dataset(column.name)?.read_raw::<f64>()?);
    }
    let samples = columns[0].len();
    if columns.iter().any(|column| column.len() != samples) {
        return Err("columns of different lengths".into());
    }
    let mut history = History::new();
    for sample in 0..samples {
        let mut values = [0.0; COLUMNS.len()];
        for (value, column) in values.iter_mut().zip(&columns) {
            *value = column[sample];
        }
        history.push(&values);
    }
    Ok(history)
}

fn read_text(location: &Location, name: &str) -> hdf5::Result<String> {
    Ok(location.attr(name)?.read_scalar::<VarLenUnicode>()?.to_string())
}

fn read_number<T: hdf5::H5Type>(location: &Location, name: &str) -> hdf5::Result<T> {
    location.attr(name)?.read_scalar::<T>()
}

#[cfg(test)]
mod tests;
