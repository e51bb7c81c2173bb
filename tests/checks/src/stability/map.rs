//! Runs the cells of maps, in parallel, searches the borders, and keeps finished cells, so that an interrupted map
//! continues.
//!
//! ```text
//! border: done at a, failing at b  →  the same at half the way, until |b − a| ≤ within · max(|a|, |b|, s)
//!         half the way: √(ab) if both are above 0, (a + b)/2 otherwise
//!         s: smallest value above 0 of the axis; without it a search from 0 never ends
//!
//! DIR/cells.json: {"checksum", "format", "version": [format, scenes, physics], "cells": {…}}
//! ```
//!
//! Every trial is a cell. `checksum` is that of [`billow_solver::platform::seal`]. The file only saves time: where it is
//! missing, damaged or of another version, its cells run again.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Mutex;

use billow_solver::PHYSICS_VERSION;
use billow_solver::platform::seal;
use billow_solver::scene::IntegratorKind;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{self, Disk, Files, disk_error};
use billow_study::platform::stop::Stop;
use rayon::prelude::{IntoParallelIterator as _, ParallelIterator as _};
use serde::{Deserialize, Serialize};

use super::cell::{self, Cell, Question};
use super::file::{Map, meets};
use super::{Method, scenes};
use crate::cases::Rig;

/// A place where the outcome changes along the axis of the search.
pub(super) struct Border {
    pub(super) method: Method,
    /// Value of the other axis; `None` without one.
    pub(super) at: Option<f64>,
    /// The value between both outcomes; `None` where the cells of the axis all have one outcome.
    pub(super) value: Option<f64>,
    /// Status on the side of the failure; empty without a border.
    pub(super) status: String,
    /// The border over the limit of theory; `None` where no theory is known.
    pub(super) of_theory: Option<f64>,
    /// Whether it must agree with the theory and does not.
    pub(super) is_wrong: bool,
}

/// A cell of a map with its place.
pub(super) struct Placed {
    pub(super) method: Method,
    /// Values of the axes.
    pub(super) at: Vec<f64>,
    /// What was found.
    pub(super) cell: Cell,
    /// What is expected.
    pub(super) expected: Vec<String>,
}

impl Placed {
    pub(super) fn is_wrong(&self) -> bool {
        !meets(&self.expected, &self.cell)
    }
}

/// A map that has run.
pub(super) struct FinishedMap<'a> {
    pub(super) map: &'a Map,
    /// Method by method.
    pub(super) cells: Vec<Placed>,
    pub(super) borders: Vec<Border>,
}

/// The file of finished cells by their key.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CellsFile {
    format: String,
    version: [u32; 3],
    cells: BTreeMap<String, Cell>,
}

/// Name of the format, and versions of format, scenes and physics.
const FORMAT: &str = "billow-stability-cells";
const VERSION: [u32; 3] = [3, scenes::VERSION, PHYSICS_VERSION];

/// Finished cells, and how the others run.
pub(super) struct Cells<'a> {
    rig: Rig,
    path: PathBuf,
    stop: &'a Stop,
    file: Mutex<CellsFile>,
}

impl<'a> Cells<'a> {
    /// The finished cells of a file, and whether it is there and cannot be used.
    pub(super) fn open(rig: Rig, path: PathBuf, stop: &'a Stop) -> (Self, bool) {
        let bytes = Disk.read(&path);
        let read = |bytes: &Vec<u8>| {
            let object = seal::open(std::str::from_utf8(bytes).ok()?).ok()?;
            let file: CellsFile = serde_json::from_str(&object).ok()?;
            (file.format == FORMAT && file.version == VERSION).then_some(file)
        };
        let found = bytes.as_ref().ok().and_then(read);
        let damaged = bytes.is_ok() && found.is_none();
        let empty =
            || CellsFile { format: FORMAT.to_owned(), version: VERSION, ..CellsFile::default() };
        (Self { rig, path, stop, file: Mutex::new(found.unwrap_or_else(empty)) }, damaged)
    }

    /// Number of finished cells.
    pub(super) fn len(&self) -> usize {
        self.file.lock().expect("no thread panicked").cells.len()
    }

    /// The finished cell of a question, or a run of it.
    fn cell(&self, question: &Question) -> Result<Cell> {
        let key = question.key();
        if let Some(cell) = self.file.lock().expect("no thread panicked").cells.get(&key) {
            return Ok(cell.clone());
        }
        let stopped = || Error::Signal(self.stop.requested().unwrap_or_default());
        if self.stop.requested().is_some() {
            return Err(stopped());
        }
        let cell = cell::run(&self.rig, question, self.stop).ok_or_else(stopped)?;
        let mut file = self.file.lock().expect("no thread panicked");
        file.cells.insert(key, cell.clone());
        let object = serde_json::to_string(&*file).expect("numbers that are not finite are null");
        files::write_atomic(&Disk, &self.path, seal::seal(&(object + "\n")).as_bytes())
            .map_err(|error| disk_error(&self.path, &error))?;
        Ok(cell)
    }

    /// Runs what is missing of a map, in parallel: first its cells, then its borders.
    pub(super) fn run<'m>(&self, map: &'m Map) -> Result<FinishedMap<'m>> {
        let places = map.places();
        let all =
            map.methods.iter().flat_map(|method| places.iter().map(|at| (*method, at.clone())));
        let placed = |(method, at): (Method, Vec<f64>)| {
            let question = map.question(method, &at);
            let expected = map.expected(&question);
            Ok(Placed { method, at, cell: self.cell(&question)?, expected })
        };
        let cells = all.collect::<Vec<_>>().into_par_iter().map(placed).collect::<Result<_>>()?;
        let mut lines: Vec<(Method, Option<f64>)> = Vec::new();
        for method in map.methods.iter().filter(|_| map.search.is_some()) {
            match map.axes.get(1 - map.horizontal()) {
                Some((_, values)) => lines.extend(values.iter().map(|at| (*method, Some(*at)))),
                None => lines.push((*method, None)),
            }
        }
        let border = |(method, at)| self.border(map, method, at);
        let borders = lines.into_par_iter().map(border).collect::<Result<_>>()?;
        Ok(FinishedMap { map, cells, borders })
    }

    /// The first change of the outcome along the axis of the search, at a value of the other one.
    fn border(&self, map: &Map, method: Method, at: Option<f64>) -> Result<Border> {
        let axis = map.horizontal();
        let ask = |value: f64| {
            let mut place = vec![value];
            if let Some(other) = at {
                place.insert(1 - axis, other);
            }
            self.cell(&map.question(method, &place))
        };
        let bound = map.theory.filter(|_| method == Method::Film(IntegratorKind::Explicit));
        let (status, is_wrong) = (String::new(), bound.is_some());
        let none = Border { method, at, value: None, status, of_theory: None, is_wrong };
        let values = &map.axes[axis].1;
        let found: Result<Vec<Cell>> = values.iter().map(|value| ask(*value)).collect();
        let found = found?;
        let Some(first) = found.windows(2).position(|pair| pair[0].is_done() != pair[1].is_done())
        else {
            return Ok(none);
        };
        let done_below = found[first].is_done();
        let mut failing = found[first + usize::from(done_below)].clone();
        let (mut low, mut high) = (values[first], values[first + 1]);
        let positive = values.iter().copied().filter(|value| *value > 0.0);
        let smallest = positive.reduce(f64::min).unwrap_or(0.0);
        let within = map.search.as_ref().map_or(1.0, |search| search.within);
        while high - low > within * high.abs().max(low.abs()).max(smallest) {
            let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
            let trial = ask(middle)?;
            *(if trial.is_done() == done_below { &mut low } else { &mut high }) = middle;
            if !trial.is_done() {
                failing = trial;
            }
        }
        let value = 0.5 * (low + high);
        let of_step = map.axes[axis].0 == "step";
        let of_theory = failing.theory.filter(|_| of_step).map(|theory| value * theory);
        let close = |within| of_theory.is_some_and(|ratio| (ratio - 1.0).abs() <= within);
        let is_wrong = bound.is_some_and(|within| !close(within));
        Ok(Border { value: Some(value), status: failing.status, of_theory, is_wrong, ..none })
    }
}
