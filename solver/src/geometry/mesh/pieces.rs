//! The pieces of a pattern: facets of the lateral film in the order of [`FoldPattern::facets`], then the wedges of the
//! bottom cap and of the top cap, in the order of the panels.

use super::Part;
use crate::geometry::fold::{Corner, FoldPattern};

/// A triangle to subdivide: a facet of the lateral film or a wedge of a cap.
pub(super) struct Piece {
    pub(super) part: Part,
    pub(super) corners: [PieceCorner; 3],
}

/// A corner of a piece. `Ring` distinguishes corner N, on the other side of the seam, from corner 0: they
/// have different positions in the developed film, but are the same node.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum PieceCorner {
    Ring(Corner),
    BottomCentre,
    TopCentre,
}

pub(super) fn pieces(pattern: &FoldPattern) -> Vec<Piece> {
    let lateral = pattern.facets().into_iter().map(|facet| Piece {
        part: Part::Storey(facet.storey),
        corners: facet.corners.map(PieceCorner::Ring),
    });
    let wedge = |ring: u32, panel: u32| {
        [Corner { ring, corner: panel }, Corner { ring, corner: panel + 1 }].map(PieceCorner::Ring)
    };
    let bottom = (0..pattern.design.panels).map(|panel| {
        let [p, q] = wedge(0, panel);
        Piece { part: Part::BottomCap, corners: [PieceCorner::BottomCentre, q, p] }
    });
    let top = (0..pattern.design.panels).map(|panel| {
        let [p, q] = wedge(pattern.design.storeys, panel);
        Piece { part: Part::TopCap, corners: [PieceCorner::TopCentre, p, q] }
    });
    lateral.chain(bottom).chain(top).collect()
}
