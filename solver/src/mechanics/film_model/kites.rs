//! Elements two by two: kites, whose halves share an edge.
//!
//! ```text
//!        b                first  = (s, a, t)      corners of a kite: s, a, t, b
//!      /   \              second = (s, t, b)
//!    s ----- t            both counter-clockwise seen from outside
//!      \   /
//!        a
//! ```
//!
//! A kite has four corners where two elements have six, so a third of what is fetched from nodes and of
//! what is added to them is saved. An element that finds no other is a kite whose second half has no
//! area: b is s once more.

use std::collections::BTreeMap;

/// Two elements that share an edge, or one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kite {
    /// Nodes s, a, t, b.
    pub corners: [u32; 4],
    /// The first half: the element, and which of its corners is s.
    pub first: (usize, usize),
    /// The second half, likewise; none where the first is alone.
    pub second: Option<(usize, usize)>,
}

/// Every element in one kite. The order is that of the elements, each of which takes the neighbour that
/// has the fewest others left, the first of several.
pub fn kites(triangles: &[[u32; 3]]) -> Vec<Kite> {
    // The element that goes along an edge this way, and the corner it begins at.
    let mut ways = BTreeMap::new();
    for (element, nodes) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let way = (nodes[corner], nodes[(corner + 1) % 3]);
            ways.entry(way).or_insert((element, corner));
        }
    }
    // Across an element's edge: who goes the other way.
    let across = |element: usize, corner: usize| -> Option<(usize, usize)> {
        let nodes = triangles[element];
        let other = ways.get(&(nodes[(corner + 1) % 3], nodes[corner])).copied();
        other.filter(|(other, _)| *other != element)
    };
    let mut taken = vec![false; triangles.len()];
    let mut kites = Vec::with_capacity(triangles.len() / 2 + 1);
    for element in 0..triangles.len() {
        if taken[element] {
            continue;
        }
        taken[element] = true;
        let free = |other: usize| {
            (0..3)
                .filter_map(|corner| across(other, corner))
                .filter(|(own, _)| !taken[*own])
                .count()
        };
        let found = (0..3)
            .filter_map(|corner| Some((corner, across(element, corner)?)))
            .filter(|(_, (other, _))| !taken[*other])
            .min_by_key(|(_, (other, _))| (free(*other), *other));
        // The shared edge goes from t to s in the first half, from s to t in the second.
        let kite = if let Some((corner, (other, begin))) = found {
            taken[other] = true;
            let own = triangles[element];
            let (t, s, a) = (own[corner], own[(corner + 1) % 3], own[(corner + 2) % 3]);
            let corners = [s, a, t, triangles[other][(begin + 2) % 3]];
            Kite { corners, first: (element, (corner + 1) % 3), second: Some((other, begin)) }
        } else {
            let [s, a, t] = triangles[element];
            Kite { corners: [s, a, t, s], first: (element, 0), second: None }
        };
        kites.push(kite);
    }
    kites
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn turned(nodes: [u32; 3], by: usize) -> [u32; 3] {
        [nodes[by], nodes[(by + 1) % 3], nodes[(by + 2) % 3]]
    }

    /// Every element once, its corners as the kite says, the halves across one edge.
    fn check(triangles: &[[u32; 3]]) -> usize {
        let kites = kites(triangles);
        let mut met = vec![0; triangles.len()];
        for Kite { corners: [s, a, t, b], first, second } in &kites {
            met[first.0] += 1;
            assert_eq!(turned(triangles[first.0], first.1), [*s, *a, *t]);
            match second {
                Some(second) => {
                    met[second.0] += 1;
                    assert_eq!(turned(triangles[second.0], second.1), [*s, *t, *b]);
                }
                None => assert_eq!(b, s),
            }
        }
        assert!(met.iter().all(|times| *times == 1), "{met:?}");
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
    fn a_sheet_and_a_ball_pair_up() {
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
