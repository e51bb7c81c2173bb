//! Writes the HDF5 file of a cube: scales, coordinates, variables, attributes.
//!
//! Arrays of numbers are stored in compressed chunks. A chunk holds neighbouring points and, of each of them,
//! all times (up to [`MAX_CHUNK_SAMPLES`] values), so that a job is written once and read at once. A chunk
//! without a job takes no space.

use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use hdf5::file::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};

use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::platform::provenance;
use crate::store::history_file::raw::{self, Scaled};
use crate::store::history_file::{DEFLATE_LEVEL, HDF5_LOCK, MAX_CHUNK_SAMPLES, number_attribute};
use crate::store::stored::Stored;
use crate::store::table::Column;

/// Name of the format, in the attribute `format`.
const FORMAT: &str = "billow-cube";
/// Version of the format.
const VERSION: u32 = 1;

/// Name, unit and meaning of a variable over time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// SI unit; "1" for a pure number.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
}

/// A cube that is being written.
pub struct CubeFile {
    file: File,
    writer: raw::Writer,
    /// The path in errors.
    path: PathBuf,
    points: usize,
    times: usize,
    /// The scales of points and time.
    scales: Vec<Dataset>,
    /// Variables over points and time.
    over_time: Vec<(String, Dataset)>,
    /// Coordinates, and variables over points.
    over_points: Vec<(String, Dataset)>,
    coordinates: Vec<String>,
}

impl CubeFile {
    /// Creates the file at `temporary`, with its scales; errors name `path`.
    ///
    /// # Errors
    /// [`Error::Disk`], as of every method here.
    pub fn create(temporary: &Path, path: &Path, points: usize, times: &[f64]) -> Result<Self> {
        let create = || -> hdf5::Result<Self> {
            let file = File::with_options()
                .with_fcpl(|creation| {
                    creation.obj_track_times(false).link_creation_order(LinkCreationOrder::Indexed)
                })
                .create(temporary)?;
            let mut cube = Self {
                file,
                writer: raw::Writer::new()?,
                path: path.to_owned(),
                points,
                times: times.len(),
                scales: Vec::new(),
                over_time: Vec::new(),
                over_points: Vec::new(),
                coordinates: Vec::new(),
            };
            let rows: Vec<f64> = (0..points).map(|row| row as f64).collect();
            for (name, unit, meaning, values) in [
                ("point", "1", "row of the summary table", rows.as_slice()),
                ("time", "s", "time since the start of the run", times),
            ] {
                let scale = cube.numbers(name, &[values.len()])?;
                scale.write_raw(values)?;
                cube.label(&scale, unit, meaning)?;
                cube.scales.push(scale);
            }
            Ok(cube)
        };
        locked(path, create)
    }

    /// Writes what it is and where it comes from.
    pub fn describe(&self, stored: &Stored<'_>, study: &str) -> Result<()> {
        locked(&self.path, || {
            let Self { writer, file, .. } = self;
            writer.text(file, "format", FORMAT)?;
            number_attribute(file, "version", VERSION)?;
            writer.text(file, "program_version", provenance::PROGRAM_VERSION)?;
            writer.text(file, "commit", provenance::COMMIT)?;
            number_attribute(file, "physics_version", provenance::PHYSICS_VERSION)?;
            writer.text(file, "study_name", &stored.study.name)?;
            writer.text(file, "question", &stored.study.question)?;
            writer.text(file, "study", study)
        })
    }

    /// Writes a coordinate of the points.
    pub fn coordinate(&mut self, name: &str, column: &Column) -> Result<()> {
        let dataset = self.column(name, column)?;
        self.coordinates.push(name.to_owned());
        self.over_points.push((name.to_owned(), dataset));
        Ok(())
    }

    /// Writes a variable over the points.
    pub fn over_points(&mut self, name: &str, column: &Column) -> Result<()> {
        let dataset = self.column(name, column)?;
        locked(&self.path, || self.name_coordinates(&dataset))?;
        self.over_points.push((name.to_owned(), dataset));
        Ok(())
    }

    /// Adds a variable over points and time. Its values are NaN until they are written.
    pub fn over_time(&mut self, name: &str, variable: &Variable) -> Result<()> {
        let dataset = locked(&self.path, || {
            let dataset = self.numbers(name, &[self.points, self.times])?;
            self.label(&dataset, &variable.unit, &variable.meaning)?;
            self.name_coordinates(&dataset)?;
            Ok(dataset)
        })?;
        self.over_time.push((name.to_owned(), dataset));
        Ok(())
    }

    /// Writes the values over time of a point; `variable` is the number of the variable over time.
    pub fn write(&self, variable: usize, point: usize, values: &[f64]) -> Result<()> {
        let (_, dataset) = &self.over_time[variable];
        let (start, count) = ([point as u64, 0], [1, self.times as u64]);
        locked(&self.path, || raw::write_block(dataset, &start, &count, values))
    }

    /// Attaches the scales, and completes the file.
    pub fn finish(self) -> Result<()> {
        let Self { file, writer, path, scales, over_time, over_points, .. } = self;
        locked(&path, || {
            let scaled: Vec<Scaled<'_>> = [(&over_points, &[0][..]), (&over_time, &[0, 1])]
                .into_iter()
                .flat_map(|(variables, along)| {
                    variables.iter().map(move |(name, dataset)| Scaled { name, dataset, along })
                })
                .collect();
            let root = file.group("/")?;
            writer.attach(&root, &[("point", &scales[0]), ("time", &scales[1])], &scaled)?;
            number_attribute(&file, "complete", 1_u8)?;
            drop((scales, over_time, over_points, root));
            file.close()
        })
    }

    /// Writes a column of the table.
    fn column(&self, name: &str, column: &Column) -> Result<Dataset> {
        let number = |cell: &Value| match cell {
            Value::Integer(value) => *value as f64,
            Value::Number(value) => *value,
            Value::Bool(value) => f64::from(u8::from(*value)),
            Value::Null | Value::Text(_) => f64::NAN,
        };
        let text = |cell: &Value| match cell {
            Value::Null => VarLenUnicode::default(),
            other => other.to_string().parse().unwrap_or_default(),
        };
        locked(&self.path, || {
            let dataset = if column.cell_type == CellType::Text {
                let texts: Vec<VarLenUnicode> = column.cells.iter().map(text).collect();
                let builder = self.file.new_dataset_builder().obj_track_times(false);
                let dataset = builder.empty::<VarLenUnicode>().shape(self.points).create(name)?;
                dataset.write_raw(&texts)?;
                dataset
            } else {
                let numbers: Vec<f64> = column.cells.iter().map(number).collect();
                let dataset = self.numbers(name, &[self.points])?;
                dataset.write_raw(&numbers)?;
                dataset
            };
            self.label(&dataset, &column.unit, &column.meaning)?;
            Ok(dataset)
        })
    }

    /// Creates an array of numbers: NaN where nothing is written.
    fn numbers(&self, name: &str, shape: &[usize]) -> hdf5::Result<Dataset> {
        let builder = self.file.new_dataset_builder().obj_track_times(false);
        let builder = builder.chunk(chunk(shape)).shuffle().deflate(DEFLATE_LEVEL);
        builder.fill_value(f64::NAN).empty::<f64>().shape(shape.to_vec()).create(name)
    }

    fn label(&self, dataset: &Dataset, unit: &str, meaning: &str) -> hdf5::Result<()> {
        self.writer.text(dataset, "units", &with_powers(unit))?;
        self.writer.text(dataset, "long_name", meaning)
    }

    fn name_coordinates(&self, dataset: &Dataset) -> hdf5::Result<()> {
        if self.coordinates.is_empty() {
            return Ok(());
        }
        self.writer.text(dataset, "coordinates", &self.coordinates.join(" "))
    }
}

/// The chunk of an array: whole inner axes as far as [`MAX_CHUNK_SAMPLES`] values reach.
fn chunk(shape: &[usize]) -> Vec<usize> {
    let mut rest = MAX_CHUNK_SAMPLES;
    let mut chunk: Vec<usize> = shape
        .iter()
        .rev()
        .map(|length| {
            let part = (*length).clamp(1, rest.max(1));
            rest = if part == *length { rest / part } else { 1 };
            part
        })
        .collect();
    chunk.reverse();
    chunk
}

/// Calls HDF5, one thread at a time.
fn locked<T>(path: &Path, call: impl FnOnce() -> hdf5::Result<T>) -> Result<T> {
    let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    call().map_err(|error| Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "HDF5 cannot write it: {error}\n  next: free some space, or choose another file"
        ),
    })
}

/// A unit with its powers written so that pint, udunits and the CF convention read them: `m^3` of `m3`.
fn with_powers(unit: &str) -> String {
    let mut text = String::new();
    for c in unit.chars() {
        if c.is_ascii_digit() && text.ends_with(|last: char| last.is_alphabetic()) {
            text.push('^');
        }
        text.push(c);
    }
    text
}
