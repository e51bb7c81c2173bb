//! Writes the HDF5 file of a cube: dimensions, coordinates, variables, attributes.
//!
//! Arrays of numbers are stored in compressed chunks. A chunk holds neighbouring points and, of each of them,
//! all times (up to [`MAX_CHUNK_SAMPLES`] values), so that a job is written once and read at once. A chunk
//! without a job takes no space.

use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use hdf5::file::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};

use super::layout::Coordinate;
use super::values::Values;
use super::{FORMAT, TIME, VERSION};
use crate::platform::error::{Error, Result};
use crate::platform::provenance;
use crate::store::history_file::raw::{self, Scaled};
use crate::store::history_file::{DEFLATE_LEVEL, HDF5_LOCK, MAX_CHUNK_SAMPLES, number_attribute};
use crate::store::stored::Stored;

/// Name, unit and meaning of a variable.
pub struct Variable<'a> {
    /// Name.
    pub name: &'a str,
    /// SI unit; "1" for a pure number, empty for a text.
    pub unit: &'a str,
    /// Meaning, one line.
    pub meaning: &'a str,
}

/// A dataset of the file.
struct Entry {
    name: String,
    dataset: Dataset,
    /// Number of the dimension of each of its axes.
    along: Vec<usize>,
}

/// A cube that is being written.
pub struct CubeFile {
    file: File,
    writer: raw::Writer,
    /// The path in errors.
    path: PathBuf,
    /// Name and length of each dimension; time, the last one, is added by [`Self::time`].
    dimensions: Vec<(String, usize)>,
    /// Names of the coordinates that are no scales, and their dimensions.
    others: Vec<(String, usize)>,
    scales: Vec<Entry>,
    variables: Vec<Entry>,
}

impl CubeFile {
    /// Creates the file at `temporary`; errors name `path`.
    ///
    /// # Errors
    /// [`Error::Disk`], as of every method here.
    pub fn create(temporary: &Path, path: &Path) -> Result<Self> {
        let create = || -> hdf5::Result<Self> {
            let file = File::with_options()
                .with_fcpl(|creation| {
                    creation.obj_track_times(false).link_creation_order(LinkCreationOrder::Indexed)
                })
                .create(temporary)?;
            Ok(Self {
                file,
                writer: raw::Writer::new()?,
                path: path.to_owned(),
                dimensions: Vec::new(),
                others: Vec::new(),
                scales: Vec::new(),
                variables: Vec::new(),
            })
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

    /// Adds a dimension of the grid; the last one is fastest.
    pub fn dimension(&mut self, name: &str, length: usize) {
        self.dimensions.push((name.to_owned(), length));
    }

    /// Writes a coordinate: the scale of its dimension, if it has the name of that.
    pub fn coordinate(&mut self, coordinate: &Coordinate) -> Result<()> {
        let Coordinate { name, unit, meaning, dimension, values } = coordinate;
        let variable = Variable { name, unit, meaning };
        let entry = self.array(&variable, &[*dimension], values)?;
        if self.dimensions[*dimension].0 == *name {
            self.scales.push(entry);
        } else {
            self.variables.push(entry);
            self.others.push((name.clone(), *dimension));
        }
        Ok(())
    }

    /// Adds the time axis after the coordinates, as the fastest dimension.
    pub fn time(&mut self, times: &[f64]) -> Result<()> {
        self.dimension(TIME, times.len());
        let variable =
            Variable { name: TIME, unit: "s", meaning: "time since the start of the run" };
        let along = [self.dimensions.len() - 1];
        let entry = self.array(&variable, &along, &Values::Numbers(times.to_vec()))?;
        self.scales.push(entry);
        Ok(())
    }

    /// Adds a variable over the grid and time. Its values are NaN until they are written. Returns its number.
    pub fn over_time(&mut self, variable: &Variable<'_>) -> Result<usize> {
        let along: Vec<usize> = (0..self.dimensions.len()).collect();
        let entry = locked(&self.path, || {
            let dataset = self.numbers(variable.name, &along)?;
            self.label(&dataset, variable, &along)?;
            Ok(Entry { name: variable.name.to_owned(), dataset, along })
        })?;
        self.variables.push(entry);
        Ok(self.variables.len() - 1)
    }

    /// Writes a variable over the grid.
    pub fn over_grid(&mut self, variable: &Variable<'_>, values: &Values) -> Result<()> {
        let along: Vec<usize> = (0..self.dimensions.len() - 1).collect();
        let entry = self.array(variable, &along, values)?;
        self.variables.push(entry);
        Ok(())
    }

    /// Writes the values over time at a position of the grid.
    pub fn write(&self, variable: usize, position: usize, values: &[f64]) -> Result<()> {
        let (grid, time) = self.dimensions.split_at(self.dimensions.len() - 1);
        let mut start = vec![0_u64; grid.len() + 1];
        let mut count = vec![1_u64; grid.len() + 1];
        let mut rest = position;
        for ((_, length), start) in grid.iter().zip(&mut start).rev() {
            *start = (rest % length) as u64;
            rest /= length;
        }
        count[grid.len()] = time[0].1 as u64;
        let dataset = &self.variables[variable].dataset;
        locked(&self.path, || raw::write_block(dataset, &start, &count, values))
    }

    /// Attaches the scales, and completes the file.
    pub fn finish(self) -> Result<()> {
        let Self { file, writer, path, scales, variables, .. } = self;
        locked(&path, || {
            let named: Vec<(&str, &Dataset)> =
                scales.iter().map(|scale| (scale.name.as_str(), &scale.dataset)).collect();
            // The scales are in the order of their coordinates: that of the dimensions.
            let scaled = variables.iter().map(|variable| Scaled {
                name: &variable.name,
                dataset: &variable.dataset,
                along: &variable.along,
            });
            let root = file.group("/")?;
            writer.attach(&root, &named, &scaled.collect::<Vec<_>>())?;
            number_attribute(&file, "complete", 1_u8)?;
            drop((scales, variables, root));
            file.close()
        })
    }

    /// Writes an array along these dimensions.
    fn array(&self, variable: &Variable<'_>, along: &[usize], values: &Values) -> Result<Entry> {
        locked(&self.path, || {
            let name = variable.name;
            let shape = self.shape(along);
            let plain = || self.file.new_dataset_builder().obj_track_times(false);
            let dataset = match values {
                Values::Numbers(values) => {
                    let dataset = self.numbers(name, along)?;
                    dataset.write_raw(values.as_slice())?;
                    dataset
                }
                Values::Integers(values) => {
                    let dataset = plain().empty::<i64>().shape(shape).create(name)?;
                    dataset.write_raw(values.as_slice())?;
                    dataset
                }
                Values::Texts(texts) => {
                    let dataset = plain().empty::<VarLenUnicode>().shape(shape).create(name)?;
                    let text = |text: &String| {
                        text.parse::<VarLenUnicode>()
                            .map_err(|error| format!("{name}: {error}").into())
                    };
                    let texts: hdf5::Result<Vec<_>> = texts.iter().map(text).collect();
                    dataset.write_raw(texts?.as_slice())?;
                    dataset
                }
            };
            self.label(&dataset, variable, along)?;
            Ok(Entry { name: name.to_owned(), dataset, along: along.to_vec() })
        })
    }

    /// Creates an array of numbers: NaN where nothing is written.
    fn numbers(&self, name: &str, along: &[usize]) -> hdf5::Result<Dataset> {
        let shape = self.shape(along);
        let builder = self.file.new_dataset_builder().obj_track_times(false);
        let builder = builder.chunk(chunk(&shape)).shuffle().deflate(DEFLATE_LEVEL);
        builder.fill_value(f64::NAN).empty::<f64>().shape(shape).create(name)
    }

    fn shape(&self, along: &[usize]) -> Vec<usize> {
        along.iter().map(|dimension| self.dimensions[*dimension].1).collect()
    }

    /// Writes unit and meaning, and the coordinates along its dimensions that are no scales.
    fn label(
        &self,
        dataset: &Dataset,
        variable: &Variable<'_>,
        along: &[usize],
    ) -> hdf5::Result<()> {
        self.writer.text(dataset, "units", variable.unit)?;
        self.writer.text(dataset, "long_name", variable.meaning)?;
        let others = self.others.iter().filter(|(_, dimension)| along.contains(dimension));
        let names: Vec<&str> = others.map(|(name, _)| name.as_str()).collect();
        // A coordinate, and the time axis, name no coordinates.
        let has_time = self.scales.last().is_some_and(|scale| scale.name == TIME);
        if names.is_empty() || !has_time {
            return Ok(());
        }
        self.writer.text(dataset, "coordinates", &names.join(" "))
    }
}

/// The chunk of an array: whole inner axes as far as [`MAX_CHUNK_SAMPLES`] values reach.
fn chunk(shape: &[usize]) -> Vec<usize> {
    let mut chunk = vec![1; shape.len()];
    let mut rest = MAX_CHUNK_SAMPLES;
    for (chunk, length) in chunk.iter_mut().zip(shape).rev() {
        *chunk = (*length).clamp(1, rest.max(1));
        rest = if *chunk == *length { rest / *chunk } else { 1 };
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_holds_whole_inner_axes() {
        assert_eq!(chunk(&[7, 20, 500]), [1, 20, 500]);
        assert_eq!(chunk(&[7, 100, 500]), [1, 32, 500]);
        assert_eq!(chunk(&[7, 3, 40_000]), [1, 1, MAX_CHUNK_SAMPLES]);
        assert_eq!(chunk(&[7, 3]), [7, 3]);
        assert_eq!(chunk(&[1000, 10, 4]), [409, 10, 4]);
    }
}
