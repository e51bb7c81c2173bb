//! Film of any shape: nodes, triangles, their stress-free reference, and the faces that close its
//! volume without being film.
//!
//! ```text
//! V = Σ x0·(x1 × x2)/6     over film and closing faces, wound outward
//! ```
//!
//! A closed shell needs no closing faces. An open one is closed by those of its own (the walls of
//! a cylinder behind a piston), or by a fan over each free boundary loop: about the loop's mean where
//! the loop lies in a plane that misses the origin, else about the origin. That is exact wherever the missing surface is
//! plane, or made of symmetry planes through the origin.

use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};

use crate::geometry::mesh::Mesh;

/// Film of any shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shell {
    /// Where the nodes are at the start, m.
    pub positions: Vec<Vector3<f64>>,
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Flat coordinates of each element's nodes where it is free of stress, m; counter-clockwise.
    pub reference: Vec<[Vector2<f64>; 3]>,
    /// Faces that close the volume and are no film; pressure on them passes to their nodes.
    pub closure: Vec<[u32; 3]>,
}

/// Why a shell is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ShellError {
    /// A face names a node that is not there, or one twice.
    #[error("face {face} names node {node}; allowed: three different nodes, 0 to {last}")]
    Node {
        /// Face: elements first, closing faces after them.
        face: usize,
        /// Node.
        node: u32,
        /// Largest node there is.
        last: usize,
    },
    /// Two faces that share an edge run along it the same way, or more than two share it.
    #[error(
        "nodes {} and {} are the edge of more than two faces, or of two that wind against each other",
        edge[0], edge[1]
    )]
    Edge {
        /// Its nodes.
        edge: [u32; 2],
    },
}

/// Share of a loop's size within which it counts as plane.
const PLANE: f64 = 1e-9;

impl Shell {
    /// Film that is free of stress where it is, each element laid flat by itself.
    pub fn relaxed(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Self {
        let reference = triangles.iter().map(|t| flat(t.map(|n| positions[n as usize]))).collect();
        Self { positions, triangles, reference, closure: Vec::new() }
    }

    /// The film of a capsule.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
            reference: mesh.reference.clone(),
            closure: Vec::new(),
        }
    }

    /// Takes its stress-free reference from other places (m) of the same nodes, each element laid
    /// flat by itself.
    #[must_use]
    pub fn with_reference(mut self, places: &[Vector3<f64>]) -> Self {
        self.reference =
            self.triangles.iter().map(|t| flat(t.map(|n| places[n as usize]))).collect();
        self
    }

    /// Area of the film where it is free of stress, m².
    pub fn reference_area(&self) -> f64 {
        self.reference.iter().map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a))).sum()
    }

    fn faces(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.triangles.iter().chain(&self.closure)
    }

    /// Checks nodes, and that every edge has at most two faces which run along it opposite ways.
    ///
    /// # Errors
    /// [`ShellError`].
    pub fn check(&self) -> Result<(), ShellError> {
        let last = self.positions.len().saturating_sub(1);
        let mut runs = BTreeMap::new();
        for (face, &[a, b, c]) in self.faces().enumerate() {
            let stray = [a, b, c].into_iter().find(|node| *node as usize > last);
            let twice = if a == b || a == c { Some(a) } else { (b == c).then_some(b) };
            if let Some(node) = stray.or(twice) {
                return Err(ShellError::Node { face, node, last });
            }
            for edge in [[a, b], [b, c], [c, a]] {
                if runs.insert(edge, face).is_some() {
                    return Err(ShellError::Edge { edge });
                }
            }
        }
        Ok(())
    }

    /// Boundary loops, each in the order its closing faces run along it; none where closed.
    pub fn boundary(&self) -> Vec<Vec<u32>> {
        let mut runs = std::collections::BTreeSet::new();
        for &[a, b, c] in self.faces() {
            runs.extend([[a, b], [b, c], [c, a]]);
        }
        // A face beyond the edge runs along it the other way.
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b] in runs.iter().filter(|[a, b]| !runs.contains(&[*b, *a])) {
            next.entry(b).or_default().push(a);
        }
        let mut loops = Vec::new();
        while let Some((&first, _)) = next.iter().find(|(_, to)| !to.is_empty()) {
            let (mut path, mut node) = (Vec::new(), first);
            while let Some(to) = next.get_mut(&node).and_then(Vec::pop) {
                path.push(node);
                node = to;
            }
            loops.push(path);
        }
        loops
    }

    /// Whether film and closing faces enclose a volume.
    pub fn is_closed(&self) -> bool {
        self.boundary().is_empty()
    }

    /// The point each boundary loop's fan is spun about, with the loop.
    pub fn fans(&self) -> Vec<(Vector3<f64>, Vec<u32>)> {
        let apex = |path: &Vec<u32>| {
            let places = || path.iter().map(|node| self.positions[*node as usize]);
            let mean = places().sum::<Vector3<f64>>() / path.len() as f64;
            let size = places().map(|x| (x - mean).norm()).fold(0.0, f64::max);
            // The loop's own normal: twice its vector area.
            let mut normal = Vector3::zeros();
            for (k, node) in path.iter().enumerate() {
                let [a, b] =
                    [*node, path[(k + 1) % path.len()]].map(|n| self.positions[n as usize]);
                normal += (a - mean).cross(&(b - mean));
            }
            let off = places().map(|x| (x - mean).dot(&normal).abs()).fold(0.0, f64::max);
            let slack = PLANE * size * normal.norm();
            // A plane through the origin closes about it: film that starts flat between symmetry
            // planes lies in one, and leaves it.
            if off <= slack && mean.dot(&normal).abs() > slack { mean } else { Vector3::zeros() }
        };
        self.boundary().into_iter().map(|path| (apex(&path), path)).collect()
    }

    /// Closes every boundary loop by a fan of closing faces; gives the nodes added for their tips,
    /// which bear no film and must be held.
    ///
    /// # Panics
    /// At 2³² nodes.
    pub fn close(&mut self) -> Vec<u32> {
        let mut tips = Vec::new();
        for (apex, path) in self.fans() {
            let tip = u32::try_from(self.positions.len()).expect("under 2^32 nodes");
            self.positions.push(apex);
            tips.push(tip);
            for (k, node) in path.iter().enumerate() {
                self.closure.push([*node, path[(k + 1) % path.len()], tip]);
            }
        }
        tips
    }

    /// Enclosed volume, m³, with these places of the nodes (m), boundary loops closed by their fans
    /// at the start.
    pub fn volume(&self, place: impl Fn(u32) -> Vector3<f64>) -> f64 {
        let six = |[a, b, c]: [Vector3<f64>; 3]| a.dot(&b.cross(&c));
        let own: f64 = self.faces().map(|face| six(face.map(&place))).sum();
        let fan = |(apex, path): &(Vector3<f64>, Vec<u32>)| -> f64 {
            let edge = |k: usize| [place(path[k]), place(path[(k + 1) % path.len()]), *apex];
            (0..path.len()).map(|k| six(edge(k))).sum()
        };
        (own + self.fans().iter().map(fan).sum::<f64>()) / 6.0
    }
}

/// A triangle laid flat, its first edge along x.
pub fn flat([a, b, c]: [Vector3<f64>; 3]) -> [Vector2<f64>; 3] {
    let (p, q) = (b - a, c - a);
    let length = p.norm();
    let x = q.dot(&p) / length;
    let y = p.cross(&q).norm() / length;
    [Vector2::zeros(), Vector2::new(length, 0.0), Vector2::new(x, y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit cube without its top, and without two sides.
    fn cube(faces: &[[u32; 4]]) -> Shell {
        let corner =
            |k: u32| Vector3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Shell::relaxed((0..8).map(corner).collect(), triangles)
    }

    const BOTTOM: [u32; 4] = [0, 2, 3, 1];
    const TOP: [u32; 4] = [4, 5, 7, 6];
    const SIDES: [[u32; 4]; 4] = [[0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];

    #[test]
    fn plane_holes_close_about_their_middle() {
        for open in [&SIDES[..], &[SIDES[0], SIDES[1], SIDES[2], SIDES[3], BOTTOM][..]] {
            let mut shell = cube(open);
            shell.check().unwrap();
            let start = shell.positions.clone();
            let volume = shell.volume(|node| start[node as usize]);
            assert!((volume - 1.0).abs() < 1e-15, "{volume}");
            let tips = shell.close();
            assert_eq!(tips.len(), if open.len() == 4 { 2 } else { 1 });
            assert!(shell.is_closed());
            shell.check().unwrap();
            let places = shell.positions.clone();
            assert!((shell.volume(|node| places[node as usize]) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn symmetry_planes_through_the_origin_close_about_it() {
        // Three faces round the corner (1, 1, 1): what is missing lies in x = 0, y = 0, z = 0.
        let shell = cube(&[TOP, SIDES[1], SIDES[2]]);
        assert_eq!(shell.boundary().len(), 1);
        let volume = shell.volume(|node| shell.positions[node as usize]);
        assert!((volume - 1.0).abs() < 1e-15, "{volume}");
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        let mut shell = cube(&[BOTTOM, TOP]);
        shell.triangles[0][1] = 99;
        assert!(matches!(shell.check(), Err(ShellError::Node { face: 0, node: 99, .. })));
        let shell = cube(&[BOTTOM, BOTTOM]);
        assert!(matches!(shell.check(), Err(ShellError::Edge { .. })));
    }

    #[test]
    fn laying_flat_keeps_the_triangle() {
        let corners =
            [Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.0, 1.0, 5.0), Vector3::new(4.0, 4.0, 4.0)];
        let [a, b, c] = flat(corners);
        let [p, q, r] = corners;
        assert!(((b - a).norm() - (q - p).norm()).abs() < 1e-15);
        assert!(((c - a).norm() - (r - p).norm()).abs() < 1e-15);
        assert!(((c - b).norm() - (r - q).norm()).abs() < 1e-15);
        assert!((b - a).perp(&(c - a)) > 0.0);
    }
}
