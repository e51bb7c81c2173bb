//! Kites: pairs of elements that share an edge.
//!
//! ```text
//!        b                first element  = (s, a, t)      corners of a kite: s, a, t, b
//!      /   \              second element = (s, t, b)
//!    s ----- t            both counter-clockwise seen from outside
//!      \   /
//!        a
//! ```
//!
//! A kite has four corners where two elements have six, which saves a third of the gathers from nodes
//! and of the additions to nodes. An element without a partner is a kite whose second element has zero
//! area: b = s.

use std::collections::BTreeMap;

/// An element, and the one of its corners that its edges are counted from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementCorner {
    /// Element.
    pub element: usize,
    /// Corner, 0 to 2.
    pub corner: usize,
}

/// Two elements that share an edge, or one element alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kite {
    /// Nodes s, a, t, b.
    pub corners: [u32; 4],
    /// The first element, at its corner s.
    pub first: ElementCorner,
    /// The second element, at its corner s; `None` where the first is alone.
    pub second: Option<ElementCorner>,
}

/// Pairs elements so that every element is in exactly one kite.
///
/// Elements are visited in their order. Each takes the free neighbour that has the fewest free
/// neighbours itself; of several, the one with the lowest number.
pub fn pair_elements(triangles: &[[u32; 3]]) -> Vec<Kite> {
    // For each directed edge, the element that contains it and the corner it starts at.
    let mut directed_edges = BTreeMap::new();
    for (element, nodes) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let edge = (nodes[corner], nodes[(corner + 1) % 3]);
            directed_edges.entry(edge).or_insert(ElementCorner { element, corner });
        }
    }
    // The neighbour across an element's edge contains it in the opposite direction.
    let neighbour = |element: usize, corner: usize| -> Option<ElementCorner> {
        let nodes = triangles[element];
        let opposite = directed_edges.get(&(nodes[(corner + 1) % 3], nodes[corner])).copied();
        opposite.filter(|neighbour| neighbour.element != element)
    };
    let mut paired = vec![false; triangles.len()];
    let mut kites = Vec::with_capacity(triangles.len() / 2 + 1);
    for element in 0..triangles.len() {
        if paired[element] {
            continue;
        }
        paired[element] = true;
        let free_neighbours = |element: usize| {
            (0..3)
                .filter_map(|corner| neighbour(element, corner))
                .filter(|neighbour| !paired[neighbour.element])
                .count()
        };
        let partner = (0..3)
            .filter_map(|corner| Some((corner, neighbour(element, corner)?)))
            .filter(|(_, partner)| !paired[partner.element])
            .min_by_key(|(_, partner)| (free_neighbours(partner.element), partner.element));
        // The shared edge goes from t to s in the first element, from s to t in the second.
        let kite = if let Some((corner, partner)) = partner {
            paired[partner.element] = true;
            let nodes = triangles[element];
            let (t, s, a) = (nodes[corner], nodes[(corner + 1) % 3], nodes[(corner + 2) % 3]);
            let b = triangles[partner.element][(partner.corner + 2) % 3];
            let first = ElementCorner { element, corner: (corner + 1) % 3 };
            Kite { corners: [s, a, t, b], first, second: Some(partner) }
        } else {
            let [s, a, t] = triangles[element];
            let first = ElementCorner { element, corner: 0 };
            Kite { corners: [s, a, t, s], first, second: None }
        };
        kites.push(kite);
    }
    kites
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn nodes_from(
        triangles: &[[u32; 3]],
        ElementCorner { element, corner }: ElementCorner,
    ) -> [u32; 3] {
        [0, 1, 2].map(|step| triangles[element][(corner + step) % 3])
    }

    /// Asserts that every element is in one kite and has the nodes of its half. Returns the number of
    /// kites.
    fn check(triangles: &[[u32; 3]]) -> usize {
        let kites = pair_elements(triangles);
        let mut uses = vec![0; triangles.len()];
        for Kite { corners: [s, a, t, b], first, second } in &kites {
            uses[first.element] += 1;
            assert_eq!(nodes_from(triangles, *first), [*s, *a, *t]);
            match second {
                Some(second) => {
                    uses[second.element] += 1;
                    assert_eq!(nodes_from(triangles, *second), [*s, *t, *b]);
                }
                None => assert_eq!(b, s),
            }
        }
        assert!(uses.iter().all(|number| *number == 1), "{uses:?}");
        kites.len()
    }

    proptest! {
        #[test]
        fn every_element_is_in_one_kite(
            triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 0..60),
        ) {
            check(&triangles);
        }
    }

    #[test]
    fn a_sheet_and_a_tetrahedron_pair_completely() {
        let mut sheet = Vec::new();
        for j in 0..6 {
            for i in 0..7 {
                let [a, b, c, d] = [8 * j + i, 8 * j + i + 1, 8 * j + i + 9, 8 * j + i + 8];
                sheet.extend([[a, b, c], [a, c, d]]);
            }
        }
        assert_eq!(check(&sheet), sheet.len() / 2);
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(check(&tetrahedron), 2);
        assert_eq!(check(&tetrahedron[..3]), 2);
    }
}
