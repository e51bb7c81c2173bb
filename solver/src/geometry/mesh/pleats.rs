//! Pleats: the gas around a ring line, between the film below and above it, and what opens it to the middle.
//!
//! ```text
//! film      facets on the ring of the storey below and of the storey above; at the lowest and topmost ring, a cap
//! mouth     the surface between the inner borders of both layers, ruled between their nodes: it closes the volume
//! rim       nodes on the diagonals of a layer, which lie nearest to the axis, each with its part of their length
//! ```
//!
//! A panel's layers meet in their side of the ring, and each has one corner more, its apex; the mouth of a panel lies
//! between the sides from the ring to both. The pleats of all rings and the space between their mouths are the whole
//! volume.

use nalgebra::Vector3;

use super::Mesh;
use super::pieces::{Piece, PieceCorner};
use crate::geometry::fold::{Corner, FoldPattern};

/// Most parts that nodes of a rim divide a diagonal into. Chosen: all nodes at n 8.
const RIM_PARTS: usize = 8;

/// Gas around a ring line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pleat {
    /// The layers below and above the ring line.
    pub layers: [PleatLayer; 2],
    /// Triangles that close the volume of both layers, counter-clockwise seen from outside.
    pub mouth: Vec<[u32; 3]>,
    /// Mean length of the diagonals of its rims, m.
    pub diagonal: f64,
}

/// Film on one side of a pleat.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PleatLayer {
    /// Nodes of each element, counter-clockwise seen from outside.
    pub film: Vec<[u32; 3]>,
    /// Nodes of the rim, each with its part (m) of the length of the diagonals; none for a cap.
    pub rim: Vec<(u32, f64)>,
}

/// The pleats of all rings, the lowest first. `nodes_between`: the nodes from one corner to another of the same piece.
pub(super) fn pleats(
    pattern: &FoldPattern,
    pieces: &[Piece],
    mesh: &Mesh,
    nodes_between: impl Fn([PieceCorner; 2]) -> Vec<u32>,
) -> Vec<Pleat> {
    let (panels, storeys) = (pattern.design.panels, pattern.design.storeys);
    let elements = mesh.triangles.len() / pieces.len();
    let caps = 2 * panels * storeys;
    let pleat = |ring: u32| {
        let mut pleat = Pleat::default();
        for panel in 0..panels {
            let below = match ring.checked_sub(1) {
                None => caps + panel,
                Some(storey) => 2 * (storey * panels + panel) + 1,
            };
            let top_cap = caps + panels + panel;
            let above = if ring == storeys { top_cap } else { 2 * (ring * panels + panel) };
            let ends = [panel, panel + 1].map(|corner| Corner { ring, corner });
            let sides = [below as usize, above as usize].map(|piece| {
                let (apex, diagonal) = apex(&pieces[piece], ends);
                let film = &mesh.triangles[piece * elements..(piece + 1) * elements];
                let to_apex = ends.map(|end| nodes_between([PieceCorner::Ring(end), apex]));
                (film, to_apex, diagonal)
            });
            for (layer, (film, to_apex, diagonal)) in pleat.layers.iter_mut().zip(&sides) {
                layer.film.extend(*film);
                if let Some(diagonal) = diagonal {
                    layer.add_rim(&to_apex[*diagonal], &mesh.positions);
                }
            }
            // Seen from outside, film above the ring runs from its second corner to the apex and on to the first.
            let [(_, below, _), (_, above, _)] = &sides;
            pleat.close(&above[0], &below[0]);
            pleat.close(&below[1], &above[1]);
        }
        let rims = || pleat.layers.iter().filter(|layer| !layer.rim.is_empty());
        let length: f64 = rims().flat_map(|layer| &layer.rim).map(|(_, length)| length).sum();
        pleat.diagonal = length / (f64::from(panels) * rims().count() as f64);
        pleat
    };
    (0..=storeys).map(pleat).collect()
}

/// The corner of a piece that is not one of these ends of its side on a ring, and the end that a diagonal joins to it.
fn apex(piece: &Piece, ends: [Corner; 2]) -> (PieceCorner, Option<usize>) {
    let on_ring = ends.map(PieceCorner::Ring);
    let apex = piece.corners.into_iter().find(|corner| !on_ring.contains(corner));
    let apex = apex.expect("a piece has a corner that is not on this ring");
    let diagonal = match apex {
        PieceCorner::Ring(apex) => ends.iter().position(|end| end.corner != apex.corner),
        PieceCorner::BottomCentre | PieceCorner::TopCentre => None,
    };
    (apex, diagonal)
}

impl Pleat {
    /// Closes the mouth between two rows of nodes that begin at the same node.
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
    /// Adds nodes of a diagonal, given all of them.
    fn add_rim(&mut self, diagonal: &[u32], positions: &[Vector3<f64>]) {
        let last = diagonal.len() - 1;
        let parts = last.min(RIM_PARTS);
        let first = self.rim.len();
        self.rim.extend((0..=parts).map(|part| (diagonal[part * last / parts], 0.0)));
        for k in first..first + parts {
            let [a, b] = [k, k + 1].map(|k| positions[self.rim[k].0 as usize]);
            let half = 0.5 * (b - a).norm();
            self.rim[k].1 += half;
            self.rim[k + 1].1 += half;
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
            mesh.pleats[ring].layers[layer].rim.iter().map(|(_, length)| length).sum()
        };
        assert!(length(1, 0) > 1.0 && (length(1, 0) - length(0, 1)).abs() < 1e-12);
        assert!(mesh.pleats[0].layers[0].rim.is_empty() && mesh.pleats[3].layers[1].rim.is_empty());
    }
}
