//! Reads a history file.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::PoisonError;

use billow_solver::output::events::Event;
use billow_solver::output::history::{COLUMNS, History, RING_COLUMNS};
use hdf5::File;

use super::{HDF5_LOCK, damaged, events, open, read_text};
use crate::job::{JobId, Status};
use crate::platform::error::Result;

/// The contents of a history file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredHistory {
    /// Its job.
    pub job: JobId,
    /// The scene that was run, as JSON.
    pub scene: String,
    /// How the run ended.
    pub status: Status,
    /// Content hash, as stored.
    pub content_hash: String,
    /// Decisions of the step controller, in order of time.
    pub events: Vec<Event>,
    /// The columns that every history has.
    pub history: History,
    /// The other columns, by name.
    pub tracks: BTreeMap<String, Vec<f64>>,
    /// Unit and meaning of the other columns, by name.
    pub labels: BTreeMap<String, (String, String)>,
}

impl StoredHistory {
    /// Leaves out the columns that are not named, and frees their memory. Labels stay.
    pub fn keep(&mut self, names: &[&str]) {
        self.history.keep(names);
        self.tracks.retain(|name, _| names.contains(&name.as_str()));
    }
}

/// Reads a history file.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`] for a file that is missing, damaged, incomplete, of
/// another format or version.
pub fn read(path: &Path) -> Result<StoredHistory> {
    let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let file = open(path)?;
    let damaged = |error| damaged(path, &error);
    let job = read_text(&file, "job").map_err(damaged)?;
    let status = read_text(&file, "status").map_err(damaged)?;
    let (tracks, labels) = read_tracks(&file).map_err(damaged)?;
    Ok(StoredHistory {
        job: JobId::from_digits(&job).ok_or_else(|| damaged("no job id".into()))?,
        scene: read_text(&file, "scene").map_err(damaged)?,
        status: Status::from_name(&status)
            .ok_or_else(|| damaged(format!("unknown status {status:?}").into()))?,
        content_hash: read_text(&file, "content_hash").map_err(damaged)?,
        events: events::read(&file).map_err(damaged)?,
        history: read_history(&file).map_err(damaged)?,
        tracks,
        labels,
    })
}

fn read_history(file: &File) -> hdf5::Result<History> {
    let group = file.group("history")?;
    let mut columns = Vec::with_capacity(COLUMNS.len());
    let rings = RING_COLUMNS.iter().any(|name| group.link_exists(name));
    let empty = if rings { History::new() } else { History::new().without_rings() };
    for column in COLUMNS {
        if empty.has(column.name) {
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
    let mut tracks = BTreeMap::new();
    let mut labels = BTreeMap::new();
    for name in group.member_names()? {
        if COLUMNS.iter().any(|column| column.name == name) {
            continue;
        }
        let dataset = group.dataset(&name)?;
        let label = (read_text(&dataset, "units")?, read_text(&dataset, "long_name")?);
        tracks.insert(name.clone(), dataset.read_raw::<f64>()?);
        labels.insert(name, label);
    }
    Ok((tracks, labels))
}
