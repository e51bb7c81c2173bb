//! The fields of frames: velocities, principal stresses, gaps. Frames of earlier versions have none.

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

/// Which fields the frames have: velocities, stresses, gaps.
fn present(frames: &Frames) -> [bool; 3] {
    frames.frames.first().map_or([false; 3], |frame| {
        [!frame.velocities.is_empty(), !frame.stresses.is_empty(), !frame.gaps.is_empty()]
    })
}

/// Whether a frame has the fields of all frames, in full.
pub(super) fn fit(frame: &Frame, frames: &Frames) -> bool {
    let (nodes, elements) = sizes(frames);
    let lengths = [frame.velocities.len(), frame.stresses.len(), frame.gaps.len()];
    let expected = [nodes, elements, nodes];
    let present = present(frames);
    (0..3).all(|k| lengths[k] == if present[k] { expected[k] } else { 0 })
}

/// Adds the fields to a content hash.
pub(super) fn hash(frames: &Frames, contents: &mut Contents) {
    let (nodes, elements) = sizes(frames);
    let count = frames.frames.len();
    let [has_velocities, has_stresses, has_gaps] = present(frames);
    let bytes = |value: f32| value.to_bits().to_le_bytes();
    if has_stresses {
        for (which, name) in STRESSES.iter().enumerate() {
            let name = format!("VTKHDF/CellData/{name}");
            contents.add(&name, count * elements, stresses(frames, which).map(bytes));
        }
    }
    if has_velocities {
        let name = "VTKHDF/PointData/velocity";
        contents.add(name, 3 * count * nodes, velocities(frames).map(bytes));
    }
    if has_gaps {
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
    let [has_velocities, has_stresses, has_gaps] = present(frames);
    if has_stresses {
        for (which, name) in STRESSES.iter().enumerate() {
            let values: Vec<f32> = stresses(frames, which).collect();
            array(cells, name, values.len(), Some(&[elements]), &values)?;
            array(cell_offsets, name, count, None, &every(elements))?;
        }
    }
    if !has_velocities && !has_gaps {
        return Ok(());
    }
    let points = create_group(group, "PointData")?;
    let offsets = create_group(steps, "PointDataOffsets")?;
    if has_velocities {
        let values: Vec<f32> = velocities(frames).collect();
        array(&points, "velocity", (count * nodes, 3), Some(&[nodes, 3]), &values)?;
        array(&offsets, "velocity", count, None, &every(nodes))?;
    }
    if has_gaps {
        let values: Vec<f32> = gaps(frames).collect();
        array(&points, "gap", values.len(), Some(&[nodes]), &values)?;
        array(&offsets, "gap", count, None, &every(nodes))?;
    }
    Ok(())
}

/// The fields of a file; `None` for one that it does not have.
#[derive(Debug, Clone)]
pub(super) struct StoredFields {
    velocities: Option<Dataset>,
    stresses: Option<[Dataset; 2]>,
    gaps: Option<Dataset>,
}

/// Velocities, principal stresses and gaps of a frame; empty for a field that the file does not have.
type FrameFields = (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<f32>);

impl StoredFields {
    /// Opens the fields of the group VTKHDF; `points` and `cells` are the rows of all frames.
    pub(super) fn open(group: &Group, points: usize, cells: usize) -> hdf5::Result<Self> {
        let optional = |name: &str, shape: &[usize]| -> hdf5::Result<Option<Dataset>> {
            let (parent, _) = name.split_once('/').unwrap_or_default();
            if !group.link_exists(parent) || !group.link_exists(name) {
                return Ok(None);
            }
            let dataset = group.dataset(name)?;
            let fits = dataset.shape() == shape;
            fits.then_some(Some(dataset)).ok_or_else(|| format!("{name} has another size").into())
        };
        let [first, second] = STRESSES.map(|name| optional(&format!("CellData/{name}"), &[cells]));
        Ok(Self {
            velocities: optional("PointData/velocity", &[points, 3])?,
            stresses: first?.zip(second?).map(|(first, second)| [first, second]),
            gaps: optional("PointData/gap", &[points])?,
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
        let velocities = match &self.velocities {
            Some(dataset) => {
                let values = dataset.read_slice_2d::<f32, _>((of_nodes.clone(), ..))?;
                values.as_slice().unwrap_or_default().as_chunks::<3>().0.to_vec()
            }
            None => Vec::new(),
        };
        let stresses = match &self.stresses {
            Some([first, second]) => {
                let pairs = column(first, &of_elements)?.into_iter();
                pairs.zip(column(second, &of_elements)?).map(|(a, b)| [a, b]).collect()
            }
            None => Vec::new(),
        };
        let gaps = match &self.gaps {
            Some(dataset) => column(dataset, &of_nodes)?,
            None => Vec::new(),
        };
        Ok((velocities, stresses, gaps))
    }
}
