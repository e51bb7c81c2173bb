//! The fields of frames: velocities, principal stresses, and with contact gaps.

use std::ops::Range;

use billow_solver::output::frames::{Frame, Frames};
use hdf5::{Dataset, Group};

use super::super::sha256::Contents;
use super::{array, create_group};

/// Names of the datasets of the principal stresses.
const STRESSES: [&str; 2] = ["principal_stress_1", "principal_stress_2"];

fn velocities(frames: &Frames) -> impl Iterator<Item = f32> {
    frames.frames.iter().flat_map(|frame| frame.velocities.as_flattened()).copied()
}

fn stresses(frames: &Frames, which: usize) -> impl Iterator<Item = f32> {
    frames.frames.iter().flat_map(|frame| &frame.stresses).map(move |stress| stress[which])
}

fn gaps(frames: &Frames) -> impl Iterator<Item = f32> {
    frames.frames.iter().flat_map(|frame| &frame.gaps).copied()
}

/// Numbers of nodes and elements.
fn sizes(frames: &Frames) -> (usize, usize) {
    let nodes = frames.frames.first().map_or(0, |frame| frame.positions.len());
    (nodes, frames.triangles.len())
}

/// Whether the frames have gaps: film with contact.
fn has_gaps(frames: &Frames) -> bool {
    frames.frames.first().is_some_and(|frame| !frame.gaps.is_empty())
}

/// Whether a frame has the fields of all frames, in full.
pub(super) fn fit(frame: &Frame, frames: &Frames) -> bool {
    let (nodes, elements) = sizes(frames);
    let gaps = if has_gaps(frames) { nodes } else { 0 };
    [frame.velocities.len(), frame.stresses.len(), frame.gaps.len()] == [nodes, elements, gaps]
}

/// Adds the fields to a content hash.
pub(super) fn hash(frames: &Frames, contents: &mut Contents) {
    let (nodes, elements) = sizes(frames);
    let count = frames.frames.len();
    let bytes = |value: f32| value.to_bits().to_le_bytes();
    for (which, name) in STRESSES.iter().enumerate() {
        let name = format!("VTKHDF/CellData/{name}");
        contents.add(&name, count * elements, stresses(frames, which).map(bytes));
    }
    let name = "VTKHDF/PointData/velocity";
    contents.add(name, 3 * count * nodes, velocities(frames).map(bytes));
    if has_gaps(frames) {
        contents.add("VTKHDF/PointData/gap", count * nodes, gaps(frames).map(bytes));
    }
}

/// Writes the fields, given the groups VTKHDF, and `CellData`, `Steps` and `Steps/CellDataOffsets` in it.
pub(super) fn write(
    frames: &Frames,
    group: &Group,
    [cells, steps, cell_offsets]: [&Group; 3],
) -> hdf5::Result<()> {
    let (nodes, elements) = sizes(frames);
    let count = frames.frames.len();
    let integer = |number: usize| i64::try_from(number).unwrap_or(i64::MAX);
    let every = |size: usize| (0..count).map(|step| integer(step * size)).collect::<Vec<i64>>();
    for (which, name) in STRESSES.iter().enumerate() {
        let values: Vec<f32> = stresses(frames, which).collect();
        array(cells, name, values.len(), Some(&[elements]), &values)?;
        array(cell_offsets, name, count, None, &every(elements))?;
    }
    let points = create_group(group, "PointData")?;
    let offsets = create_group(steps, "PointDataOffsets")?;
    let values: Vec<f32> = velocities(frames).collect();
    array(&points, "velocity", (count * nodes, 3), Some(&[nodes, 3]), &values)?;
    array(&offsets, "velocity", count, None, &every(nodes))?;
    if has_gaps(frames) {
        let values: Vec<f32> = gaps(frames).collect();
        array(&points, "gap", values.len(), Some(&[nodes]), &values)?;
        array(&offsets, "gap", count, None, &every(nodes))?;
    }
    Ok(())
}

/// The fields of a file.
#[derive(Debug, Clone)]
pub(super) struct StoredFields {
    velocities: Dataset,
    stresses: [Dataset; 2],
    /// `None` without contact.
    gaps: Option<Dataset>,
}

/// Velocities, principal stresses and gaps of a frame; no gaps without contact.
type FrameFields = (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<f32>);

impl StoredFields {
    /// Opens the fields of the group VTKHDF; `points` and `cells` are the rows of all frames.
    pub(super) fn open(group: &Group, points: usize, cells: usize) -> hdf5::Result<Self> {
        let open = |name: &str, shape: &[usize]| -> hdf5::Result<Dataset> {
            let dataset = group.dataset(name)?;
            let fits = dataset.shape() == shape;
            fits.then_some(dataset).ok_or_else(|| format!("{name} has another size").into())
        };
        let [first, second] = STRESSES.map(|name| open(&format!("CellData/{name}"), &[cells]));
        let gap = "PointData/gap";
        Ok(Self {
            velocities: open("PointData/velocity", &[points, 3])?,
            stresses: [first?, second?],
            gaps: group.link_exists(gap).then(|| open(gap, &[points])).transpose()?,
        })
    }

    /// Reads the fields of a frame.
    pub(super) fn frame(
        &self,
        number: usize,
        nodes: usize,
        elements: usize,
    ) -> hdf5::Result<FrameFields> {
        let of_nodes = number * nodes..(number + 1) * nodes;
        let of_elements = number * elements..(number + 1) * elements;
        let column = |dataset: &Dataset, range: &Range<usize>| {
            dataset.read_slice_1d::<f32, _>(range.clone()).map(|values| values.to_vec())
        };
        let velocities = self.velocities.read_slice_2d::<f32, _>((of_nodes.clone(), ..))?;
        let velocities = velocities.as_slice().unwrap_or_default().as_chunks::<3>().0.to_vec();
        let [first, second] = &self.stresses;
        let pairs = column(first, &of_elements)?.into_iter();
        let stresses = pairs.zip(column(second, &of_elements)?).map(|(a, b)| [a, b]).collect();
        let gaps = match &self.gaps {
            Some(dataset) => column(dataset, &of_nodes)?,
            None => Vec::new(),
        };
        Ok((velocities, stresses, gaps))
    }
}
