//! The only door to HDF5: one file a job, or a scene that was solved by itself.
//!
//! ```text
//! /            format, version, program_version, commit, physics_version, job, scene, status,
//!              stop_time, stop_place, content_hash, complete (written last)
//! /history/    time (a dimension scale), z_centre, … : f64, one value a sample,
//!              each with units and long_name; of film without rings no z_centre, z_rim, vz; of a scene
//!              node_NAME_x, …, element_NAME_N1, … for what it follows; of film with contact
//!              interlayer_pressure, smallest_gap, …, plate_NAME_force
//! /VTKHDF/     shapes of the film, where the run kept any (vtkhdf)
//! ```
//!
//! A scene's `job` is the first half of its fingerprint.
//!
//! The file is built in memory and written in one go, so no reader ever sees a half. It holds no
//! time of day: the same job run by the same program gives the same bytes. `xarray.open_dataset(path,
//! engine="h5netcdf", group="history")` shows the columns over `time`.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use billow_solver::output::frames::Frames;
use billow_solver::output::history::{COLUMNS, History, RING_COLUMNS, Track};
use billow_solver::output::outcome::{Deployment, Stop};
use hdf5::dataset::DatasetCreate;
use hdf5::file::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use hdf5::{File, Group, Location};
use sha2::{Digest, Sha256};

use crate::job::row;
use crate::job::{Job, JobId};
use crate::platform::error::{Error, Result};
use crate::platform::provenance;

mod raw;
mod vtkhdf;

pub use vtkhdf::StoredFrames;

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

/// SHA-256 of the names, lengths and values of all a run stored, in lower-case hexadecimal digits:
/// the same for the same results, whatever program or machine stored them.
pub fn content_hash(deployment: &Deployment) -> String {
    hash_of(&deployment.history, &deployment.tracks, deployment.frames.as_ref())
}

/// The same of a history, what was followed beside it, and its frames.
pub fn hash_of(history: &History, tracks: &[Track], frames: Option<&Frames>) -> String {
    let mut contents = Contents(Sha256::new());
    let columns = history.iter().map(|(column, values)| (column.name, values));
    let tracks = tracks.iter().map(|track| (track.name.as_str(), track.values.as_slice()));
    for (name, values) in columns.chain(tracks) {
        contents.take(name, values.len(), values.iter().map(|value| value.to_bits().to_le_bytes()));
    }
    if let Some(frames) = frames {
        vtkhdf::hash(frames, &mut contents);
    }
    hexadecimal(&contents.0.finalize())
}

/// What a content hash is taken of: one array after the other.
struct Contents(Sha256);

impl Contents {
    /// An array: its name, its length, its values, little-endian.
    fn take<const N: usize>(
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
    encode_scene(&job.id, &scene, deployment, hash)
}

/// The bytes of the history file of a run of any scene, given as JSON.
///
/// # Errors
/// What HDF5 says, in words.
pub fn encode_scene(
    id: &JobId,
    scene: &str,
    deployment: &Deployment,
    hash: &str,
) -> std::result::Result<Vec<u8>, String> {
    let _door = DOOR.lock().unwrap_or_else(PoisonError::into_inner);
    build(id, scene, deployment, hash).map_err(|error| error.to_string())
}

fn build(id: &JobId, scene: &str, deployment: &Deployment, hash: &str) -> hdf5::Result<Vec<u8>> {
    let ordered = LinkCreationOrder::Indexed;
    // The oldest superblock: HDF5 1.10 gives the image of a newer one with a wrong checksum.
    let file = File::with_options()
        .with_fapl(|access| access.core_options(64 * 1024, false))
        .with_fcpl(|creation| creation.obj_track_times(false).link_creation_order(ordered))
        .create(id.as_str())?;
    let (status, stop_time, stop_place) = match &deployment.stop {
        Stop::Done => (row::DONE, None, None),
        Stop::Cancelled => ("cancelled", None, None),
        Stop::Failed(failure) => {
            (failure.kind.name(), Some(failure.time), Some(failure.place.as_str()))
        }
    };
    let writer = raw::Writer::new()?;
    writer.text(&file, "format", FORMAT)?;
    number_attribute(&file, "version", VERSION)?;
    writer.text(&file, "program_version", provenance::PROGRAM_VERSION)?;
    writer.text(&file, "commit", provenance::COMMIT)?;
    number_attribute(&file, "physics_version", provenance::PHYSICS_VERSION)?;
    writer.text(&file, "job", id.as_str())?;
    writer.text(&file, "scene", scene)?;
    writer.text(&file, "status", status)?;
    if let Some(time) = stop_time {
        number_attribute(&file, "stop_time", time)?;
    }
    if let Some(place) = stop_place {
        writer.text(&file, "stop_place", place)?;
    }
    writer.text(&file, "content_hash", hash)?;
    let group = file
        .create_group_builder()
        .with_gcpl(|creation| creation.link_creation_order(ordered))
        .create("history")?;
    write_history(&writer, &group, &deployment.history, &deployment.tracks)?;
    if let Some(frames) = &deployment.frames {
        vtkhdf::write(&file, frames)?;
    }
    number_attribute(&file, "complete", 1_u8)?;
    raw::image(&file)
}

fn write_history(
    writer: &raw::Writer,
    group: &Group,
    history: &History,
    tracks: &[Track],
) -> hdf5::Result<()> {
    let samples = history.len();
    let mut create = DatasetCreate::build();
    create.obj_track_times(false);
    if samples >= CHUNKED_FROM {
        create.chunk(samples.min(CHUNK)).shuffle().deflate(DEFLATE);
    }
    let columns = raw::Columns::new(samples, create.finish()?)?;
    let mut datasets = Vec::with_capacity(COLUMNS.len() + tracks.len());
    let own =
        history.iter().map(|(column, values)| (column.name, column.unit, column.meaning, values));
    let followed = tracks
        .iter()
        .map(|track| (track.name.as_str(), track.unit, track.meaning, track.values.as_slice()));
    for (name, unit, meaning, values) in own.chain(followed) {
        let dataset = columns.write(group, name, values)?;
        writer.text(&dataset, "units", unit)?;
        writer.text(&dataset, "long_name", meaning)?;
        datasets.push((name, dataset));
    }
    if let Some(((name, time), others)) = datasets.split_first() {
        writer.attach(group, (name, time), others)?;
    }
    Ok(())
}

fn number_attribute<T: hdf5::H5Type + Copy>(
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
    /// What was followed beside it, by name.
    pub tracks: BTreeMap<String, Vec<f64>>,
    /// Unit and meaning of what was followed, by name.
    pub labels: BTreeMap<String, (String, String)>,
}

/// Reads a history file.
///
/// # Errors
/// [`Error::Disk`] for a file that is missing, damaged, foreign, incomplete or of a newer version.
pub fn read(path: &Path) -> Result<StoredHistory> {
    let _door = DOOR.lock().unwrap_or_else(PoisonError::into_inner);
    let file = open(path)?;
    let damaged = |error| damaged(path, &error);
    let job = read_text(&file, "job").map_err(damaged)?;
    let (tracks, labels) = read_tracks(&file).map_err(damaged)?;
    Ok(StoredHistory {
        job: JobId::from_digits(&job).ok_or_else(|| damaged("no job id".into()))?,
        scene: read_text(&file, "scene").map_err(damaged)?,
        status: read_text(&file, "status").map_err(damaged)?,
        content_hash: read_text(&file, "content_hash").map_err(damaged)?,
        history: read_history(&file).map_err(damaged)?,
        tracks,
        labels,
    })
}

/// Opens the frames of a history file, to be read one at a time; `None` where it holds none.
///
/// # Errors
/// As [`read`].
pub fn read_frames(path: &Path) -> Result<Option<StoredFrames>> {
    let _door = DOOR.lock().unwrap_or_else(PoisonError::into_inner);
    let file = open(path)?;
    vtkhdf::read(&file, path).map_err(|error| damaged(path, &error))
}

/// Opens a history file that is whole, ours, and not too new.
fn open(path: &Path) -> Result<File> {
    let broken = |problem: String| Error::Disk { path: path.to_owned(), problem };
    if !path.exists() {
        return Err(broken("no such file".to_owned()));
    }
    let file = File::open(path).map_err(|error| {
        broken(format!(
            "no HDF5 file: {error}\n  next: a job's file that is damaged is written anew by `billow \
             run` of its study"
        ))
    })?;
    let damaged = |error| damaged(path, &error);
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
    Ok(file)
}

fn damaged(path: &Path, error: &hdf5::Error) -> Error {
    Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "damaged history file: {error}\n  next: `billow run` of its study runs the job again"
        ),
    }
}

fn read_history(file: &File) -> hdf5::Result<History> {
    let group = file.group("history")?;
    let mut columns = Vec::with_capacity(COLUMNS.len());
    let rings = RING_COLUMNS.iter().any(|name| group.link_exists(name));
    for column in COLUMNS {
        if rings || !RING_COLUMNS.contains(&column.name) {
            columns.push(group.dataset(column.name)?.read_raw::<f64>()?);
        } else {
            columns.push(vec![0.0; columns[0].len()]);
        }
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
    Ok(if rings { history } else { history.without_rings() })
}

/// Values by name, and unit and meaning by name.
type Tracks = (BTreeMap<String, Vec<f64>>, BTreeMap<String, (String, String)>);

fn read_tracks(file: &File) -> hdf5::Result<Tracks> {
    let group = file.group("history")?;
    let followed = |name: &String| COLUMNS.iter().all(|column| column.name != name);
    let mut tracks = BTreeMap::new();
    let mut labels = BTreeMap::new();
    for name in group.member_names()?.into_iter().filter(followed) {
        let dataset = group.dataset(&name)?;
        tracks.insert(name.clone(), dataset.read_raw::<f64>()?);
        labels.insert(name, (read_text(&dataset, "units")?, read_text(&dataset, "long_name")?));
    }
    Ok((tracks, labels))
}

fn read_text(location: &Location, name: &str) -> hdf5::Result<String> {
    Ok(location.attr(name)?.read_scalar::<VarLenUnicode>()?.to_string())
}

fn read_number<T: hdf5::H5Type>(location: &Location, name: &str) -> hdf5::Result<T> {
    location.attr(name)?.read_scalar::<T>()
}

#[cfg(test)]
mod tests;
