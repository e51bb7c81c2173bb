//! Finer meshes of a film: each triangle is cut into n² equal ones.
//!
//! ```text
//! x = (i a + j b + k c)/n,   i + j + k = n      a, b, c: corners of a face; i, j, k whole numbers
//! ```
//! The corners keep their numbers; then come the nodes on edges, then those inside faces. The pieces of a triangle stand
//! together, in the order of the triangles.

use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};

use super::shell::{Shell, flat};

/// The nodes of a finer mesh, each by corners of the coarse one.
pub struct Refinement {
    /// Pieces along each edge.
    n: u32,
    /// Corners and their weights, which sum to n.
    nodes: Vec<[(u32, u32); 3]>,
    /// First node on each edge of the coarse mesh, the lower node first.
    edges: BTreeMap<[u32; 2], u32>,
    /// First node inside each face.
    inside: Vec<u32>,
}

impl Refinement {
    /// That of a shell with n pieces along each edge; n is at least 1.
    pub fn new(shell: &Shell, n: u32) -> Self {
        let corners = (0_u32..).take(shell.positions.len());
        let mut nodes: Vec<_> = corners.map(|node| [(node, n), (node, 0), (node, 0)]).collect();
        let mut edges = BTreeMap::new();
        let next = |nodes: &Vec<_>| u32::try_from(nodes.len()).unwrap_or(u32::MAX);
        let faces = || shell.triangles.iter().chain(&shell.closure);
        for &[a, b, c] in faces() {
            for [a, b] in [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]) {
                if edges.contains_key(&[a, b]) {
                    continue;
                }
                edges.insert([a, b], next(&nodes));
                nodes.extend((1..n).map(|k| [(a, n - k), (b, k), (b, 0)]));
            }
        }
        let mut inside = Vec::new();
        for &[a, b, c] in faces() {
            inside.push(next(&nodes));
            for i in 1..n {
                nodes.extend((1..n - i).map(|j| [(a, n - i - j), (b, i), (c, j)]));
            }
        }
        Self { n, nodes, edges, inside }
    }

    /// The values of a linear field at the nodes, from those at the corners.
    pub fn at_nodes(&self, corners: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let value = |(node, weight): &(u32, u32)| corners[*node as usize] * f64::from(*weight);
        let at = |parts: &[(u32, u32); 3]| {
            // A corner keeps its bits.
            match parts {
                [(node, weight), ..] if *weight == self.n => corners[*node as usize],
                _ => parts.iter().map(value).sum::<Vector3<f64>>() / f64::from(self.n),
            }
        };
        self.nodes.iter().map(at).collect()
    }

    /// The node of a face (its corners, its number) at b i/n, c j/n from its first corner.
    fn node(&self, [a, b, c]: [u32; 3], face: usize, i: u32, j: u32) -> u32 {
        let n = self.n;
        let on_edge = |from: u32, to: u32, k: u32| match k {
            0 => from,
            _ if k == n => to,
            _ if from < to => self.edges[&[from, to]] + k - 1,
            _ => self.edges[&[to, from]] + n - k - 1,
        };
        if j == 0 {
            on_edge(a, b, i)
        } else if i == 0 {
            on_edge(a, c, j)
        } else if i + j == n {
            on_edge(b, c, j)
        } else {
            // Rows of i have n − 1 − i nodes each.
            let before: u32 = (1..i).map(|row| n - 1 - row).sum();
            self.inside[face] + before + j - 1
        }
    }

    /// The pieces of a face as steps from its first corner along both edges, in one sense with it.
    fn pieces(&self) -> impl Iterator<Item = [(u32, u32); 3]> {
        let n = self.n;
        (0..n).flat_map(move |i| {
            (0..n - i).flat_map(move |j| {
                let up = [(i, j), (i + 1, j), (i, j + 1)];
                let down = (i + j + 2 <= n).then_some([(i + 1, j), (i + 1, j + 1), (i, j + 1)]);
                core::iter::once(up).chain(down)
            })
        })
    }

    /// The finer shell. Fans close it later.
    pub fn shell(&self, coarse: &Shell) -> Shell {
        let n = f64::from(self.n);
        let nodes_of = |face: usize, corners: [u32; 3]| {
            self.pieces().map(move |piece| piece.map(|(i, j)| self.node(corners, face, i, j)))
        };
        let films = coarse.triangles.len();
        let reference = coarse.reference.iter().flat_map(|[a, b, c]| {
            self.pieces().map(move |piece| {
                let at = |(i, j): (u32, u32)| -> Vector3<f64> {
                    let [along, across]: [Vector2<f64>; 2] = [b - a, c - a];
                    (along * (f64::from(i) / n) + across * (f64::from(j) / n)).push(0.0)
                };
                flat(piece.map(at))
            })
        });
        let folds = coarse.folds.iter().flat_map(|&[a, b]| {
            let on = move |k: u32| self.node([a, b, b], 0, k, 0);
            (0..self.n).map(move |k| [on(k).min(on(k + 1)), on(k).max(on(k + 1))])
        });
        let mut folds: Vec<[u32; 2]> = folds.collect();
        folds.sort_unstable();
        let triangles = coarse.triangles.iter().enumerate();
        let closure = coarse.closure.iter().enumerate();
        Shell {
            positions: self.at_nodes(&coarse.positions),
            triangles: triangles.flat_map(|(face, corners)| nodes_of(face, *corners)).collect(),
            reference: reference.collect(),
            closure: closure.flat_map(|(face, corners)| nodes_of(films + face, *corners)).collect(),
            walls: Vec::new(),
            folds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_tetrahedron_has_the_same_film() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let positions: Vec<Vector3<f64>> = corners.map(Vector3::from).to_vec();
        let mut coarse = Shell::relaxed(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]]);
        coarse.closure = vec![[2, 0, 3]];
        coarse.folds = vec![[0, 1]];
        for n in 1..=5 {
            let fine = Refinement::new(&coarse, n).shell(&coarse);
            assert_eq!(fine.check(), Ok(()));
            assert!(fine.is_closed());
            // Euler: nodes − edges + faces = 2, with 3 edges for each two faces.
            let faces = fine.triangles.len() + fine.closure.len();
            assert_eq!((faces, fine.positions.len()), (4 * (n * n) as usize, faces / 2 + 2));
            assert_eq!(fine.folds.len(), n as usize);
            assert_eq!(fine.positions[..4], coarse.positions[..]);
            let volume = |shell: &Shell| shell.volume(|node| shell.positions[node as usize]);
            assert!((volume(&fine) / volume(&coarse) - 1.0).abs() < 1e-14);
            let area = fine.reference_area() / coarse.reference_area();
            assert!((area - 1.0).abs() < 1e-14);
            // Free of stress, each piece has the size that it has at the start.
            for (triangle, [a, b, c]) in fine.triangles.iter().zip(&fine.reference) {
                let [p, q, r] = triangle.map(|node| fine.positions[node as usize]);
                let (flat, solid) = ((b - a).perp(&(c - a)), (q - p).cross(&(r - p)).norm());
                assert!(flat > 0.0 && (flat / solid - 1.0).abs() < 1e-12);
            }
        }
    }
}
