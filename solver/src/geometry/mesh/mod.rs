//! Triangle mesh of a fold pattern: nodes shared between facets, closed, wound outward.
//!
//! Every facet of the lateral film and every wedge of a cap (centre and two ring corners) is cut
//! into n² triangles. Barycentric weights on the corners of the pattern identify a node, so facets that
//! share an edge share its nodes exactly. Each triangle has flat coordinates in the developed film: the
//! stress-free reference.

use nalgebra::{Vector2, Vector3};

use crate::geometry::fold::{FoldError, FoldPattern};

mod build;
mod pieces;
mod pleats;

pub use pleats::{Pleat, PleatLayer};

/// The state of the pattern that defines the node positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Flat-folded, all at z = 0.
    Flat,
    /// Stowed at this stack height, m.
    Stowed(f64),
    /// Rolled onto its cone, folds open. The ring lines are chords of the developed sector, so on the
    /// cone they rise between their corners. N-gon caps follow them.
    Erected,
}

/// The piece of film an element belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// Lateral film of this storey, 0 the lowest.
    Storey(u32),
    /// Bottom cap.
    BottomCap,
    /// Top cap.
    TopCap,
}

/// A closed triangle mesh with its stress-free reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Node positions, m.
    pub positions: Vec<Vector3<f64>>,
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Flat coordinates of each element's nodes in the developed film, m; positively oriented.
    pub reference: Vec<[Vector2<f64>; 3]>,
    /// Piece of film of each element.
    pub parts: Vec<Part>,
    /// Flat sheet of film each element belongs to: a facet, or a whole cap.
    pub facets: Vec<u32>,
    /// Nodes of the bottom ring, counter-clockwise seen from above.
    pub bottom_ring: Vec<u32>,
    /// Nodes of the top ring, counter-clockwise seen from above.
    pub top_ring: Vec<u32>,
    /// Centre node of the bottom cap.
    pub bottom_centre: u32,
    /// Centre node of the top cap.
    pub top_centre: u32,
    /// The pleat of each ring, the lowest first.
    pub pleats: Vec<Pleat>,
}

impl Mesh {
    /// Meshes a pattern in the given shape with n = `subdivisions` parts a facet edge: 2 N (M + 1) n²
    /// elements.
    ///
    /// # Errors
    /// [`FoldError::Invalid`] for circular caps on a folded shape: they cannot be joined without strain.
    pub fn new(pattern: &FoldPattern, subdivisions: u32, shape: Shape) -> Result<Self, FoldError> {
        build::mesh(pattern, subdivisions, shape)
    }

    /// Enclosed volume, m³, by the divergence theorem.
    pub fn volume(&self) -> f64 {
        self.corners().map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }

    /// Area of the developed film, m².
    pub fn reference_area(&self) -> f64 {
        self.reference.iter().map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a))).sum()
    }

    /// Every undirected edge once, lower node first, in ascending order.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Edges on fold lines, which lie between two facets, lower node first; ascending.
    pub fn folds(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (&[a, b, c], facet) in self.triangles.iter().zip(&self.facets) {
            edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], *facet)));
        }
        edges.sort_unstable();
        let two_facets =
            |pair: &&[([u32; 2], u32)]| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1;
        edges.windows(2).filter(two_facets).map(|pair| pair[0].0).collect()
    }

    /// Corner positions of each element.
    pub fn corners(&self) -> impl Iterator<Item = [Vector3<f64>; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|node| self.positions[node as usize]))
    }
}
