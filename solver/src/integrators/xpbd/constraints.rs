//! The constraints of the elements, eight at a time, and how far a force moves a node.
//!
//! ```text
//! order      colours of elements without a common node, eight elements of one colour a batch
//! mobility   W = P/m          P: projector onto the free directions of a node, prescribed ones excluded
//! ```
//!
//! Elements of a batch move no common node, so their projections are independent, and the order of all
//! projections is fixed.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Lanes, WIDTH};
use crate::system::FilmSystem;

/// How far a force moves each node: W, 1/kg.
#[derive(Debug, Clone)]
pub(super) struct Mobility {
    /// Diagonal of W along the axes.
    diagonal: Field,
    /// W of nodes that are held along other directions than the axes.
    oblique: BTreeMap<u32, Matrix3<f64>>,
}

impl Mobility {
    /// The mobility of the nodes of a system.
    pub fn new(system: &FilmSystem) -> Self {
        let nodes = system.model.nodes();
        let mut projectors: Vec<_> =
            (0..nodes).map(|node| system.supports.projector(node)).collect();
        for mover in &system.supports.movers {
            let free = Matrix3::identity() - mover.held;
            let nodes = mover.nodes.iter();
            for node in nodes {
                let projector = &mut projectors[*node as usize];
                *projector = free * *projector * free;
            }
        }
        let (mut diagonal, mut oblique) = (Field::zeros(nodes), BTreeMap::new());
        for (node, projector) in projectors.into_iter().enumerate() {
            let mobility = projector * system.model.inverse_mass[node];
            diagonal.set(node, mobility.diagonal());
            if mobility != Matrix3::from_diagonal(&mobility.diagonal()) {
                oblique.extend(u32::try_from(node).map(|node| (node, mobility)));
            }
        }
        Self { diagonal, oblique }
    }

    /// W f of a force (N) on a node, m/s².
    pub fn of(&self, node: usize, force: Vector3<f64>) -> Vector3<f64> {
        if !self.oblique.is_empty()
            && let Some(mobility) =
                u32::try_from(node).ok().and_then(|node| self.oblique.get(&node))
        {
            return mobility * force;
        }
        self.diagonal.get(node).component_mul(&force)
    }

    /// Whether no support holds a node, and the node has mass.
    pub fn is_free(&self, node: usize) -> bool {
        self.diagonal.get(node).min() > 0.0
            && (self.oblique.is_empty()
                || u32::try_from(node).is_ok_and(|node| !self.oblique.contains_key(&node)))
    }
}

/// A corner of an element whose node is held along other directions than the axes.
#[derive(Debug, Clone)]
pub(super) struct ObliqueCorner {
    /// Corner, 0 to 2.
    pub corner: usize,
    /// Lane.
    pub lane: usize,
    /// W, 1/kg.
    pub mobility: Matrix3<f64>,
}

/// Where the element loop keeps an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slot {
    /// Block.
    pub block: usize,
    /// 0 for the first element of a kite, 1 for the second.
    pub half: usize,
    /// Lane.
    pub lane: usize,
}

/// Eight elements without a common node. Free lanes repeat the first element with zero volume.
#[derive(Debug, Clone)]
pub(super) struct Batch {
    /// Nodes of each corner.
    pub nodes: [[u32; WIDTH]; 3],
    /// Entries a, b and d of Dm⁻¹, 1/m.
    pub inverse_shape: [Lanes; 3],
    /// A t, m³.
    pub volume: Lanes,
    /// Diagonal of W of each corner, 1/kg.
    pub mobility: [[Lanes; 3]; 3],
    /// Corners that need more than the diagonal.
    pub oblique: Vec<ObliqueCorner>,
    /// Where the element loop keeps the elements.
    pub slots: [Slot; WIDTH],
    /// Number of elements.
    pub count: usize,
}

/// An element in the order of the element loop.
#[derive(Debug, Clone, Copy)]
struct Element {
    nodes: [u32; 3],
    slot: Slot,
}

/// All elements with a volume, in the order of the element loop.
fn elements(model: &FilmModel) -> Vec<Element> {
    let mut all = Vec::with_capacity(model.elements());
    for (index, [s, a, t, b]) in model.kites.iter().copied().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        for (half, nodes) in [[s, a, t], [s, t, b]].into_iter().enumerate() {
            if model.constants[block][half].minus_volume.0[lane] < 0.0 {
                all.push(Element { nodes, slot: Slot { block, half, lane } });
            }
        }
    }
    all
}

/// Elements by colour: each takes the first colour that no element at its nodes has.
fn colours(nodes: usize, elements: &[Element]) -> Vec<Vec<Element>> {
    let mut colours: Vec<Vec<Element>> = Vec::new();
    let mut of_node: Vec<Vec<bool>> = vec![Vec::new(); nodes];
    for element in elements {
        let taken = |colour: usize| {
            element.nodes.iter().any(|node| of_node[*node as usize].get(colour) == Some(&true))
        };
        let colour = (0..colours.len()).find(|colour| !taken(*colour)).unwrap_or(colours.len());
        if colour == colours.len() {
            colours.push(Vec::new());
        }
        colours[colour].push(*element);
        for node in element.nodes {
            let marks = &mut of_node[node as usize];
            if marks.len() <= colour {
                marks.resize(colour + 1, false);
            }
            marks[colour] = true;
        }
    }
    colours
}

impl Batch {
    /// The batches of a film, in the order of their projections.
    pub fn all(model: &FilmModel, mobility: &Mobility) -> Vec<Self> {
        let colours = colours(model.nodes(), &elements(model));
        let chunks = colours.iter().flat_map(|colour| colour.chunks(WIDTH));
        chunks.map(|chunk| Self::of(model, mobility, chunk)).collect()
    }

    fn of(model: &FilmModel, mobility: &Mobility, chunk: &[Element]) -> Self {
        let lanes: [Element; WIDTH] =
            core::array::from_fn(|lane| *chunk.get(lane).unwrap_or(&chunk[0]));
        let constants = |slot: Slot| &model.constants[slot.block][slot.half];
        let mut batch = Self {
            nodes: [0, 1, 2].map(|corner| lanes.map(|element| element.nodes[corner])),
            inverse_shape: [0, 1, 2].map(|entry| {
                Lanes(lanes.map(|of| constants(of.slot).inverse_shape[entry].0[of.slot.lane]))
            }),
            volume: Lanes::default(),
            mobility: [[Lanes::default(); 3]; 3],
            oblique: Vec::new(),
            slots: lanes.map(|element| element.slot),
            count: chunk.len(),
        };
        for (lane, element) in chunk.iter().enumerate() {
            let Slot { lane: from, .. } = element.slot;
            batch.volume.0[lane] = -constants(element.slot).minus_volume.0[from];
            for (corner, node) in element.nodes.iter().enumerate() {
                let diagonal = mobility.diagonal.get(*node as usize);
                for axis in 0..3 {
                    batch.mobility[corner][axis].0[lane] = diagonal[axis];
                }
                if let Some(mobility) = mobility.oblique.get(node) {
                    batch.oblique.push(ObliqueCorner { corner, lane, mobility: *mobility });
                }
            }
        }
        batch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes::icosphere;
    use crate::scene::Film;
    use crate::system::PressureLoad;

    #[test]
    fn each_element_is_in_one_batch_and_no_batch_has_a_node_twice() {
        let shell = icosphere(2, 0.5);
        let model = FilmModel::of_shell(&Film::PAPER, &shell).expect("a film");
        let system = FilmSystem::free(model, PressureLoad::Overpressure(0.0));
        let batches = Batch::all(&system.model, &Mobility::new(&system));
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for batch in &batches {
            let mut nodes = Vec::new();
            for lane in 0..batch.count {
                let mut triangle = batch.nodes.map(|of_corner| of_corner[lane]);
                nodes.extend(triangle);
                triangle.sort_unstable();
                triangles.push(triangle);
            }
            nodes.sort_unstable();
            assert!(nodes.windows(2).all(|pair| pair[0] != pair[1]));
            assert!(batch.volume.0[batch.count..].iter().all(|volume| volume.to_bits() == 0));
        }
        triangles.sort_unstable();
        let mut all = system.model.triangles.clone();
        for triangle in &mut all {
            triangle.sort_unstable();
        }
        all.sort_unstable();
        assert_eq!(triangles, all);
        // Few batches are filled in part: one a colour.
        assert!(batches.len() <= system.model.elements() / WIDTH + 12, "{}", batches.len());
    }
}
