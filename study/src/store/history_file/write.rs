//! Writes a history file.

use std::sync::PoisonError;

use billow_solver::output::history::{COLUMNS, History, Track};
use billow_solver::output::outcome::{Deployment, Stop};
use hdf5::dataset::DatasetCreate;
use hdf5::file::LinkCreationOrder;
use hdf5::{File, Group};

use super::{
    DEFLATE_LEVEL, FORMAT, HDF5_LOCK, MAX_CHUNK_SAMPLES, MIN_CHUNKED_SAMPLES, VERSION, events,
    number_attribute, raw, vtkhdf,
};
use crate::job::{Job, JobId, Status};
use crate::platform::provenance;

/// The bytes of a job's history file.
///
/// # Errors
/// The message of HDF5.
pub fn encode(
    job: &Job,
    deployment: &Deployment,
    hash: &str,
) -> std::result::Result<Vec<u8>, String> {
    let scene = serde_json::to_string(&*job.scene).map_err(|error| error.to_string())?;
    encode_scene(&job.id, &scene, deployment, hash)
}

/// The bytes of the history file of any scene, given as JSON.
///
/// # Errors
/// The message of HDF5.
pub fn encode_scene(
    id: &JobId,
    scene: &str,
    deployment: &Deployment,
    hash: &str,
) -> std::result::Result<Vec<u8>, String> {
    let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    build(id, scene, deployment, hash).map_err(|error| error.to_string())
}

fn build(id: &JobId, scene: &str, deployment: &Deployment, hash: &str) -> hdf5::Result<Vec<u8>> {
    let ordered = LinkCreationOrder::Indexed;
    // The oldest superblock: for a newer one, HDF5 1.10 returns an image with a wrong checksum.
    let file = File::with_options()
        .with_fapl(|access| access.core_options(64 * 1024, false))
        .with_fcpl(|creation| creation.obj_track_times(false).link_creation_order(ordered))
        .create(id.as_str())?;
    let (status, failure) = match &deployment.stop {
        Stop::Done => (Status::Done, None),
        Stop::Cancelled => (Status::Cancelled, None),
        Stop::Failed(failure) => (Status::Failed(failure.kind), Some(failure)),
    };
    let writer = raw::Writer::new()?;
    writer.text(&file, "format", FORMAT)?;
    number_attribute(&file, "version", VERSION)?;
    writer.text(&file, "program_version", provenance::PROGRAM_VERSION)?;
    writer.text(&file, "commit", provenance::COMMIT)?;
    number_attribute(&file, "physics_version", provenance::PHYSICS_VERSION)?;
    writer.text(&file, "job", id.as_str())?;
    writer.text(&file, "scene", scene)?;
    writer.text(&file, "status", status.name())?;
    if let Some(failure) = failure {
        number_attribute(&file, "stop_time", failure.time)?;
        writer.text(&file, "stop_location", failure.place.as_str())?;
    }
    writer.text(&file, "content_hash", hash)?;
    let group = file
        .create_group_builder()
        .with_gcpl(|creation| creation.link_creation_order(ordered))
        .create("history")?;
    write_history(&writer, &group, &deployment.history, &deployment.tracks)?;
    events::write(&writer, &file, &deployment.events)?;
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
    if samples >= MIN_CHUNKED_SAMPLES {
        create.chunk(samples.min(MAX_CHUNK_SAMPLES)).shuffle().deflate(DEFLATE_LEVEL);
    }
    let columns = raw::Columns::new(samples, create.finish()?)?;
    let mut datasets = Vec::with_capacity(COLUMNS.len() + tracks.len());
    let series =
        history.iter().map(|(column, values)| (column.name, column.unit, column.meaning, values));
    let tracks = tracks
        .iter()
        .map(|track| (track.name.as_str(), track.unit, track.meaning, track.values.as_slice()));
    for (name, unit, meaning, values) in series.chain(tracks) {
        let dataset = columns.write(group, name, values)?;
        writer.text(&dataset, "units", unit)?;
        writer.text(&dataset, "long_name", meaning)?;
        datasets.push((name, dataset));
    }
    let Some(((name, time), others)) = datasets.split_first() else { return Ok(()) };
    let others = others.iter().map(|(name, dataset)| raw::Scaled { name, dataset, along: &[0] });
    writer.attach(group, &[(name, time)], &others.collect::<Vec<_>>())
}
