//! Shapes of the film in a history file, in the format that the reader of VTK and `ParaView` plays:
//! VTKHDF 2.0, one unstructured grid with changing positions and constant elements.
//!
//! ```text
//! /VTKHDF    attributes Version [2, 0], Type "UnstructuredGrid"
//!   NumberOfPoints, NumberOfCells, NumberOfConnectivityIds   [1]: one part
//!   Connectivity [3 elements]    Offsets [elements + 1]    Types [elements]: 5, a triangle
//!   Points [frames · nodes, 3]: f32, m; frame k from row k · nodes; one chunk per frame
//!   CellData/storey [elements]: u32, 0 the bottom cap, 1 … M, M + 1 the top cap
//!   CellData/regime [frames · elements]: u8, 0 slack, 1 wrinkled, 2 taut; frame k from k · elements
//!   CellData/principal_stress_1, …_2 [frames · elements]: f32, Pa, the larger first
//!   PointData/velocity [frames · nodes, 3]: f32, m/s
//!   PointData/gap [frames · nodes]: f32, m, at most the contact distance; with contact only
//!   Steps      attribute NSteps; Values [frames]: s
//!     PartOffsets, CellOffsets, ConnectivityIdOffsets 0; NumberOfParts 1; PointOffsets k · nodes
//!     CellDataOffsets/storey 0; the other CellDataOffsets k · elements; PointDataOffsets k · nodes
//! ```
//!
//! `CellOffsets` and `ConnectivityIdOffsets` have a second axis of length one: an unstructured grid has
//! one kind of topology. Source: "VTKHDF format specification" in the documentation of VTK.

use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use billow_solver::mechanics::material::Regime;
use billow_solver::output::frames::{Frame, Frames};
use hdf5::file::LinkCreationOrder;
use hdf5::types::FixedAscii;
use hdf5::{Dataset, Extents, File, Group, H5Type};

use self::fields::StoredFields;
use super::sha256::Contents;
use super::{DEFLATE_LEVEL, HDF5_LOCK, damaged, number_attribute};
use crate::platform::error::Result;

mod fields;

/// Name of the group.
const GROUP: &str = "VTKHDF";
/// Name of the grid type in VTK. Its readers need text of exactly this length.
const GRID: &str = "UnstructuredGrid";
/// Number of the cell type triangle in VTK.
const TRIANGLE: u8 = 5;
/// Regimes in the order of their stored codes.
const REGIMES: [Regime; 3] = [Regime::Slack, Regime::Wrinkled, Regime::Taut];

fn code(regime: Regime) -> u8 {
    match regime {
        Regime::Slack => 0,
        Regime::Wrinkled => 1,
        Regime::Taut => 2,
    }
}

fn connectivity(frames: &Frames) -> impl Iterator<Item = i64> {
    frames.triangles.as_flattened().iter().map(|node| i64::from(*node))
}

fn coordinates(frames: &Frames) -> impl Iterator<Item = f32> {
    frames.frames.iter().flat_map(|frame| frame.positions.as_flattened()).copied()
}

fn regimes(frames: &Frames) -> impl Iterator<Item = u8> {
    frames.frames.iter().flat_map(|frame| &frame.regimes).map(|regime| code(*regime))
}

/// Adds all values except the layout to a content hash, with the names of their datasets.
pub(super) fn hash(frames: &Frames, contents: &mut Contents) {
    let (count, elements) = (frames.frames.len(), frames.triangles.len());
    let nodes = frames.frames.first().map_or(0, |frame| frame.positions.len());
    let ids = connectivity(frames).map(i64::to_le_bytes);
    contents.add("VTKHDF/Connectivity", 3 * elements, ids);
    let storeys = frames.storeys.iter().map(|storey| storey.to_le_bytes());
    contents.add("VTKHDF/CellData/storey", frames.storeys.len(), storeys);
    let times = frames.frames.iter().map(|frame| frame.time.to_bits().to_le_bytes());
    contents.add("VTKHDF/Steps/Values", count, times);
    let points = coordinates(frames).map(|coordinate| coordinate.to_bits().to_le_bytes());
    contents.add("VTKHDF/Points", 3 * count * nodes, points);
    contents.add("VTKHDF/CellData/regime", count * elements, regimes(frames).map(|code| [code]));
    fields::hash(frames, contents);
}

/// Writes the group.
pub(super) fn write(file: &File, frames: &Frames) -> hdf5::Result<()> {
    let (count, elements) = (frames.frames.len(), frames.triangles.len());
    let nodes = frames.frames.first().map_or(0, |frame| frame.positions.len());
    let fits = |frame: &Frame| {
        frame.positions.len() == nodes
            && frame.regimes.len() == elements
            && fields::fit(frame, frames)
    };
    if frames.storeys.len() != elements || !frames.frames.iter().all(fits) {
        return Err("frames of different sizes".into());
    }
    let integer = |number: usize| i64::try_from(number).unwrap_or(i64::MAX);
    let group = create_group(file, GROUP)?;
    let version = group.new_attr::<i64>().shape(2).create("Version")?;
    version.write_raw(&[2_i64, 0])?;
    let kind = FixedAscii::<{ GRID.len() }>::from_ascii(GRID).map_err(|error| error.to_string())?;
    group.new_attr::<FixedAscii<{ GRID.len() }>>().create("Type")?.write_scalar(&kind)?;

    array(&group, "NumberOfPoints", 1, None, &[integer(nodes)])?;
    array(&group, "NumberOfCells", 1, None, &[integer(elements)])?;
    array(&group, "NumberOfConnectivityIds", 1, None, &[integer(3 * elements)])?;
    let ids: Vec<i64> = connectivity(frames).collect();
    array(&group, "Connectivity", ids.len(), Some(&[ids.len()]), &ids)?;
    let offsets: Vec<i64> = (0..=elements).map(|element| integer(3 * element)).collect();
    array(&group, "Offsets", offsets.len(), Some(&[offsets.len()]), &offsets)?;
    array(&group, "Types", elements, Some(&[elements]), &vec![TRIANGLE; elements])?;
    let points: Vec<f32> = coordinates(frames).collect();
    array(&group, "Points", (count * nodes, 3), Some(&[nodes, 3]), &points)?;

    let cells = create_group(&group, "CellData")?;
    array(&cells, "storey", elements, Some(&[elements]), &frames.storeys)?;
    let regimes: Vec<u8> = regimes(frames).collect();
    array(&cells, "regime", regimes.len(), Some(&[elements]), &regimes)?;

    let steps = create_group(&group, "Steps")?;
    number_attribute(&steps, "NSteps", integer(count))?;
    let times: Vec<f64> = frames.frames.iter().map(|frame| frame.time).collect();
    array(&steps, "Values", count, None, &times)?;
    let (zeros, ones) = (vec![0_i64; count], vec![1_i64; count]);
    let every = |size: usize| (0..count).map(|step| integer(step * size)).collect::<Vec<i64>>();
    array(&steps, "NumberOfParts", count, None, &ones)?;
    array(&steps, "PartOffsets", count, None, &zeros)?;
    array(&steps, "PointOffsets", count, None, &every(nodes))?;
    array(&steps, "CellOffsets", (count, 1), None, &zeros)?;
    array(&steps, "ConnectivityIdOffsets", (count, 1), None, &zeros)?;
    let offsets = create_group(&steps, "CellDataOffsets")?;
    array(&offsets, "storey", count, None, &zeros)?;
    array(&offsets, "regime", count, None, &every(elements))?;

    fields::write(frames, &group, [&cells, &steps, &offsets])
}

fn create_group(parent: &Group, name: &str) -> hdf5::Result<Group> {
    let ordered = LinkCreationOrder::Indexed;
    parent.create_group_builder().with_gcpl(|list| list.link_creation_order(ordered)).create(name)
}

/// Creates and writes an array. An array in chunks is shuffled and deflated.
fn array<T: H5Type>(
    group: &Group,
    name: &str,
    shape: impl Into<Extents>,
    chunk: Option<&[usize]>,
    values: &[T],
) -> hdf5::Result<()> {
    let empty = group.new_dataset::<T>().shape(shape);
    let builder = match chunk {
        Some(chunk) => empty.chunk(chunk.to_vec()).shuffle().deflate(DEFLATE_LEVEL),
        None => empty,
    };
    builder.obj_track_times(false).create(name)?.write_raw(values)
}

/// Frames of a history file, read one at a time: all frames together may not fit into memory.
#[derive(Debug)]
pub struct StoredFrames {
    path: PathBuf,
    triangles: Vec<[u32; 3]>,
    storeys: Vec<u32>,
    times: Vec<f64>,
    nodes: usize,
    points: Dataset,
    regimes: Dataset,
    fields: StoredFields,
}

/// Opens the group and reads everything except the frames; `None` for a file without the group.
pub(super) fn read(file: &File, path: &Path) -> hdf5::Result<Option<StoredFrames>> {
    if !file.link_exists(GROUP) {
        return Ok(None);
    }
    let group = file.group(GROUP)?;
    let nodes = group.dataset("NumberOfPoints")?.read_raw::<i64>()?;
    let nodes = nodes.first().and_then(|nodes| u32::try_from(*nodes).ok());
    let nodes = nodes.ok_or("invalid number of nodes")?;
    let ids = group.dataset("Connectivity")?.read_raw::<i64>()?;
    let ids: Vec<u32> = ids
        .into_iter()
        .map(|id| u32::try_from(id).ok().filter(|id| *id < nodes))
        .collect::<Option<_>>()
        .ok_or("an element with an unknown node")?;
    let (triangles, rest) = ids.as_chunks::<3>();
    let storeys = group.dataset("CellData/storey")?.read_raw::<u32>()?;
    let times = group.dataset("Steps/Values")?.read_raw::<f64>()?;
    let (points, regimes) = (group.dataset("Points")?, group.dataset("CellData/regime")?);
    let (count, nodes) = (times.len(), nodes as usize);
    if !rest.is_empty() || triangles.is_empty() || storeys.len() != triangles.len() {
        return Err("different numbers of elements and storeys".into());
    }
    if count == 0
        || points.shape() != [count * nodes, 3]
        || regimes.shape() != [count * triangles.len()]
    {
        return Err("the size of the frames does not match the mesh".into());
    }
    if !times.iter().all(|time| time.is_finite()) || !times.is_sorted() {
        return Err("frames out of order".into());
    }
    let stored = StoredFrames {
        fields: StoredFields::open(&group, count * nodes, count * triangles.len())?,
        path: path.to_owned(),
        triangles: triangles.to_vec(),
        storeys,
        times,
        nodes,
        points,
        regimes,
    };
    Ok(Some(stored))
}

impl StoredFrames {
    /// Nodes of each element, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Storey of each element, as [`Frames::storeys`].
    pub fn storeys(&self) -> &[u32] {
        &self.storeys
    }

    /// Time of each frame, s, in order; at least one.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Reads one frame.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`] when this part of the file is damaged.
    pub fn frame(&self, number: usize) -> Result<Frame> {
        let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
        self.read(number).map_err(|error| damaged(&self.path, &error))
    }

    fn read(&self, number: usize) -> hdf5::Result<Frame> {
        let time = *self.times.get(number).ok_or("no such frame")?;
        let (nodes, elements) = (self.nodes, self.triangles.len());
        let rows = number * nodes..(number + 1) * nodes;
        let points = self.points.read_slice_2d::<f32, _>((rows, ..))?;
        let (points, _) = points.as_slice().unwrap_or_default().as_chunks::<3>();
        if points.len() != nodes || points.as_flattened().iter().any(|x| !x.is_finite()) {
            return Err(format!("frame {number} has non-finite positions").into());
        }
        let codes = number * elements..(number + 1) * elements;
        let codes = self.regimes.read_slice_1d::<u8, _>(codes)?;
        let regime = |code: &u8| REGIMES.get(usize::from(*code)).copied();
        let regimes: Option<Vec<Regime>> = codes.iter().map(regime).collect();
        let regimes = regimes.ok_or_else(|| format!("frame {number} has unknown regimes"))?;
        let (velocities, stresses, gaps) = self.fields.frame(number, nodes, elements)?;
        Ok(Frame { time, positions: points.to_vec(), regimes, velocities, stresses, gaps })
    }
}

#[cfg(test)]
mod tests;
