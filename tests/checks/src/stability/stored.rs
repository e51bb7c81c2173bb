//! Finished cells on disk, so that an interrupted map continues.
//!
//! ```text
//! DIR/cells.json        {"checksum", "format", "version": [format, scenes, physics], "cells": […]}
//! DIR/stability.json    the map file that was run last
//! ```
//!
//! `checksum` is that of [`billow_solver::platform::seal`]. The file only saves time: where it is missing, damaged or
//! of another version, its cells run again.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use billow_solver::PHYSICS_VERSION;
use billow_solver::platform::seal;
use billow_study::platform::error::Result;
use billow_study::platform::files::{self, Disk, Files, disk_error};
use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::scenes;

/// Name of the file.
const FILE: &str = "cells.json";
/// Name of the format.
const FORMAT: &str = "billow-stability-cells";
/// Versions of format, scenes and physics.
const VERSION: [u32; 3] = [2, scenes::VERSION, PHYSICS_VERSION];
/// Name of the copy of the map file.
pub const MAP_FILE: &str = "stability.json";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CellsFile {
    format: String,
    version: [u32; 3],
    cells: Vec<Cell>,
}

/// Finished cells by their key.
pub type Cells = BTreeMap<String, Cell>;

/// The cells of a text; `None` for a text that this version did not write.
fn decode(bytes: &[u8]) -> Option<Cells> {
    let object = seal::open(std::str::from_utf8(bytes).ok()?).ok()?;
    let file: CellsFile = serde_json::from_str(&object).ok()?;
    (file.format == FORMAT && file.version == VERSION)
        .then(|| file.cells.into_iter().map(|cell| (cell.key.clone(), cell)).collect())
}

/// The finished cells of a folder, and whether a file was there that cannot be used.
pub fn read(folder: &Path) -> (Cells, bool) {
    match Disk.read(&folder.join(FILE)) {
        Ok(bytes) => decode(&bytes).map_or((Cells::new(), true), |cells| (cells, false)),
        Err(_) => (Cells::new(), false),
    }
}

/// Stores the finished cells.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, cells: &Cells) -> Result<()> {
    let path = folder.join(FILE);
    let cells = cells.values().cloned().collect();
    let file = CellsFile { format: FORMAT.to_owned(), version: VERSION, cells };
    let write = || -> io::Result<()> {
        let object = serde_json::to_string(&file).map_err(io::Error::other)?;
        files::write_atomic(&Disk, &path, seal::seal(&(object + "\n")).as_bytes())
    };
    write().map_err(|error| disk_error(&path, &error))
}
