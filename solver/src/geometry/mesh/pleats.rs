//! Pleats: the gas around a ring line, between the film below and above it, and what opens it to the middle.
//!
//! ```text
//! film      facets on the ring of the storey below and of the storey above; at the lowest and topmost ring, a cap
//! mouth     the surface between the inner borders of both layers, ruled between their nodes: it closes the volume
//! rim       nodes on the diagonals of a layer, which lie nearest to the axis, each with its share of their length
//! ```
//!
//! A panel's layers meet in their side of the ring, and each has one corner more, its apex; the mouth of a panel lies
//! between the sides from the ring to both. The pleats of all rings and the space between their mouths are the whole
//! volume.

use nalgebra::Vector3;

/// Most parts that nodes of a rim divide a diagonal into. Chosen: all nodes at n 8.
const RIM_PARTS: usize = 8;

/// Gas around a ring line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pleat {
    /// The layers below and above the ring line.
    pub layers: [PleatLayer; 2],
    /// Triangles that close the volume of both layers, counter-clockwise seen from outside.
    pub mouth: Vec<[u32; 3]>,
}

/// Film on one side of a pleat.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PleatLayer {
    /// Nodes of each element, counter-clockwise seen from outside.
    pub film: Vec<[u32; 3]>,
    /// Nodes of the rim, each with its share (m) of the length of the diagonals; none for a cap.
    pub rim: Vec<(u32, f64)>,
}

/// A facet or wedge of a cap that has a side on a ring line: nodes from one corner to another.
pub(super) struct Side<'a> {
    /// Nodes from the first and from the second corner of the side on the ring to the apex.
    pub to_apex: [Vec<u32>; 2],
    /// Which of the two is a diagonal.
    pub diagonal: Option<usize>,
    /// Its elements.
    pub film: &'a [[u32; 3]],
}

impl Pleat {
    /// The pleat of one ring: below and above each side of the ring, in the order of the panels.
    pub(super) fn new(panels: &[[Side<'_>; 2]], positions: &[Vector3<f64>]) -> Self {
        let mut pleat = Self::default();
        for sides in panels {
            for (layer, side) in pleat.layers.iter_mut().zip(sides) {
                layer.film.extend(side.film);
                if let Some(diagonal) = side.diagonal {
                    layer.add_rim(&side.to_apex[diagonal], positions);
                }
            }
            // Seen from outside, film above the ring runs from its second corner to the apex and on to the first.
            let [below, above] = sides.each_ref().map(|side| &side.to_apex);
            pleat.close(&above[0], &below[0]);
            pleat.close(&below[1], &above[1]);
        }
        pleat
    }

    /// Closes the mouth between two paths that begin at the same node.
    fn close(&mut self, a: &[u32], b: &[u32]) {
        for (a, b) in a.windows(2).zip(b.windows(2)) {
            if a[0] != b[0] {
                self.mouth.push([b[0], a[0], b[1]]);
            }
            self.mouth.push([a[0], a[1], b[1]]);
        }
    }
}

impl PleatLayer {
    /// Adds nodes of a diagonal, about eight parts apart.
    fn add_rim(&mut self, path: &[u32], positions: &[Vector3<f64>]) {
        let last = path.len() - 1;
        let parts = last.min(RIM_PARTS);
        let chosen: Vec<u32> = (0..=parts).map(|part| path[part * last / parts]).collect();
        let length =
            |pair: &[u32]| (positions[pair[1] as usize] - positions[pair[0] as usize]).norm();
        let lengths: Vec<f64> = chosen.windows(2).map(length).collect();
        for (k, node) in chosen.iter().enumerate() {
            let (before, after) = (k.checked_sub(1).map_or(0.0, |k| lengths[k]), lengths.get(k));
            self.rim.push((*node, 0.5 * (before + after.copied().unwrap_or(0.0))));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::geometry::fold::FoldPattern;
    use crate::geometry::mesh::{Mesh, Shape};
    use crate::scene::paper;

    #[test]
    fn pleats_share_the_film_among_them_and_each_is_closed() {
        let pattern = FoldPattern::new(&paper::design(8)).unwrap();
        let mesh = Mesh::new(&pattern, 3, Shape::Stowed(0.04)).unwrap();
        let layers = || mesh.pleats.iter().flat_map(|pleat| &pleat.layers);
        let film: BTreeSet<[u32; 3]> = layers().flat_map(|layer| &layer.film).copied().collect();
        let count: usize = layers().map(|layer| layer.film.len()).sum();
        assert_eq!((film.len(), count), (mesh.triangles.len(), mesh.triangles.len()));
        for pleat in &mesh.pleats {
            let film = pleat.layers.iter().flat_map(|layer| &layer.film);
            let edges: Vec<[u32; 2]> =
                film.chain(&pleat.mouth).flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            let count = |edge: [u32; 2]| edges.iter().filter(|other| **other == edge).count();
            assert!(edges.iter().all(|[a, b]| count([*a, *b]) == count([*b, *a])));
        }
        // The diagonals of a storey are the rim of the pleat above it and of the one below.
        let length = |layer: usize, ring: usize| -> f64 {
            mesh.pleats[ring].layers[layer].rim.iter().map(|(_, share)| share).sum()
        };
        assert!(length(1, 0) > 1.0 && (length(1, 0) - length(0, 1)).abs() < 1e-12);
        assert!(mesh.pleats[0].layers[0].rim.is_empty() && mesh.pleats[3].layers[1].rim.is_empty());
    }
}
