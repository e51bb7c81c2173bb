//! Finished cells on disk, so that an interrupted map continues.
//!
//! ```text
//! DIR/cells.json        {"checksum", "format", "version", "scenes", "physics_version", "cells": […]}
//! DIR/stability.json    the map file that was run last
//! ```
//!
//! `checksum` is that of [`billow_solver::platform::seal`]. The file only saves time: where it is missing, damaged or
//! of another version, its cells run again.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use billow_solver::PHYSICS_VERSION;
use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::scenes;
use billow_study::platform::error::Result;
use billow_study::platform::files::{self, Disk, Files, disk_error};

/// Name of the format.
const FORMAT: &str = "billow-stability-cells";
/// Version of the format.
const VERSION: u32 = 1;
/// Name of the copy of the map file.
pub const MAP_FILE: &str = "stability.json";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: String,
    version: u32,
    scenes: u32,
    physics_version: u32,
    cells: Vec<Cell>,
}

/// Finished cells by their key.
pub type Cells = BTreeMap<String, Cell>;

fn path(folder: &Path) -> PathBuf {
    folder.join("cells.json")
}

/// The cells of a text; `None` for a text that this version did not write.
fn decode(bytes: &[u8]) -> Option<Cells> {
    let object = seal::open(std::str::from_utf8(bytes).ok()?).ok()?;
    let stored: Stored = serde_json::from_str(&object).ok()?;
    let found = (stored.format.as_str(), stored.version, stored.scenes, stored.physics_version);
    (found == (FORMAT, VERSION, scenes::VERSION, PHYSICS_VERSION))
        .then(|| stored.cells.into_iter().map(|cell| (cell.key.clone(), cell)).collect())
}

/// The finished cells of a folder, and whether a file was there that cannot be used.
pub fn read(folder: &Path) -> (Cells, bool) {
    match Disk.read(&path(folder)) {
        Ok(bytes) => decode(&bytes).map_or((Cells::new(), true), |cells| (cells, false)),
        Err(_) => (Cells::new(), false),
    }
}

/// Stores the finished cells.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, cells: &Cells) -> Result<()> {
    let stored = Stored {
        format: FORMAT.to_owned(),
        version: VERSION,
        scenes: scenes::VERSION,
        physics_version: PHYSICS_VERSION,
        cells: cells.values().cloned().collect(),
    };
    let path = path(folder);
    let write = || -> io::Result<()> {
        let object = serde_json::to_string(&stored).map_err(io::Error::other)?;
        files::write_atomic(&Disk, &path, seal::seal(&(object + "\n")).as_bytes())
    };
    write().map_err(|error| disk_error(&path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use billow_study::platform::files::scratch::Scratch;

    #[test]
    fn cells_are_read_back_and_a_changed_byte_costs_them() {
        let scratch = Scratch::new("cells").unwrap();
        let cell = Cell {
            key: "sheet explicit step=1".to_owned(),
            status: "done".to_owned(),
            audit: String::new(),
            place: String::new(),
            time: 0.5,
            end_time: 0.5,
            steps: 7,
            residual: None,
            theory: Some(0.9),
        };
        let cells = Cells::from([(cell.key.clone(), cell)]);
        write(scratch.path(), &cells).unwrap();
        assert_eq!(read(scratch.path()), (cells, false));
        let text = String::from_utf8(Disk.read(&path(scratch.path())).unwrap()).unwrap();
        let changed = text.replace("\"steps\":7", "\"steps\":8");
        assert_ne!(text, changed);
        files::write_atomic(&Disk, &path(scratch.path()), changed.as_bytes()).unwrap();
        assert_eq!(read(scratch.path()), (Cells::new(), true));
    }
}
