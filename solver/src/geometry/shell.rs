//! Film of any shape: nodes, triangles, their stress-free reference, and the closing faces, which close
//! the volume and are not film.
//!
//! ```text
//! V = Σ x0·(x1 × x2)/6     over film and closing faces, wound outward
//! ```
//!
//! A closed shell needs no closing faces. An open one has given closing faces (the walls of a cylinder
//! behind a piston), or a fan of closing faces for each free boundary loop. The fan has its apex at the
//! mean of the loop where the loop is in a plane that does not contain the origin, otherwise at the
//! origin. The volume is then exact where the missing surface is plane, or consists of symmetry planes
//! through the origin. [`Shell::close`] knows the supports: a loop that they do not hold along the normals of
//! its fan closes about its mean.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::geometry::mesh::Mesh;

/// Film of any shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shell {
    /// Initial positions of the nodes, m.
    pub positions: Vec<Vector3<f64>>,
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Stress-free flat coordinates of each element's nodes, m; counter-clockwise.
    pub reference: Vec<[Vector2<f64>; 3]>,
    /// Nodes of the closing faces; the pressure on a closing face acts on its nodes.
    pub closure: Vec<[u32; 3]>,
    /// Fans of closing faces on walls.
    pub walls: Vec<Wall>,
    /// Edges on fold lines, the lower node first; ascending.
    pub folds: Vec<[u32; 2]>,
}

/// A fan of closing faces on a wall: supports hold its whole boundary loop along the normals of its faces. It
/// is a symmetry plane, or a wall that the film is fixed to; the pressure on it does not act on the film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wall {
    /// Node at the apex of the fan.
    pub apex: u32,
    /// Whether the apex is fixed in space: that of symmetry planes through the origin. Any other apex moves
    /// with the loop.
    pub fixed: bool,
}

/// Why nodes and faces do not form a shell.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ShellError {
    /// A face names a node that does not exist, or names a node twice.
    #[error("face {face} names node {node}; allowed: three different nodes, 0 to {last}")]
    Node {
        /// Face: elements first, then closing faces.
        face: usize,
        /// Node.
        node: u32,
        /// Largest valid node.
        last: usize,
    },
    /// Two faces contain an edge in the same direction, or more than two faces share it.
    #[error(
        "nodes {} and {} are the edge of more than two faces, or of two that wind against each other",
        edge[0], edge[1]
    )]
    Edge {
        /// Its nodes.
        edge: [u32; 2],
    },
}

/// Largest distance from its plane, over its size, at which a loop counts as plane. Chosen: above
/// rounding.
const MAX_PLANE_DEVIATION: f64 = 1e-9;
/// Largest free part of a unit normal that counts as held. Chosen: above rounding.
const MAX_FREE_PART: f64 = 1e-9;

impl Shell {
    /// Film that is free of stress in its initial shape: each element is its own flat reference.
    pub fn relaxed(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Self {
        let reference = triangles.iter().map(|t| flat(t.map(|n| positions[n as usize]))).collect();
        Self { positions, triangles, reference, ..Self::default() }
    }

    /// The film of a capsule.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
            reference: mesh.reference.clone(),
            folds: mesh.folds(),
            ..Self::default()
        }
    }

    /// Stress-free area of the film, m².
    pub fn reference_area(&self) -> f64 {
        self.reference.iter().map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a))).sum()
    }

    fn faces(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.triangles.iter().chain(&self.closure)
    }

    /// Checks that all nodes exist, and that every edge has at most two faces, with opposite directions.
    pub fn check(&self) -> Result<(), ShellError> {
        let last = self.positions.len().saturating_sub(1);
        let mut directed_edges = BTreeMap::new();
        for (face, &[a, b, c]) in self.faces().enumerate() {
            let unknown = [a, b, c].into_iter().find(|node| *node as usize > last);
            let repeated = if a == b || a == c { Some(a) } else { (b == c).then_some(b) };
            if let Some(node) = unknown.or(repeated) {
                return Err(ShellError::Node { face, node, last });
            }
            for edge in [[a, b], [b, c], [c, a]] {
                if directed_edges.insert(edge, face).is_some() {
                    return Err(ShellError::Edge { edge });
                }
            }
        }
        Ok(())
    }

    /// Boundary loops, each in the direction of a closing face along it; empty for a closed shell.
    pub fn boundary(&self) -> Vec<Vec<u32>> {
        loops(self.faces())
    }

    /// Loops of edges with film on one side only, whether or not a closing face is on the other.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        loops(self.triangles.iter())
    }

    /// Whether film and closing faces enclose a volume.
    pub fn is_closed(&self) -> bool {
        self.boundary().is_empty()
    }

    /// Mean position of nodes, m.
    fn mean(&self, nodes: &[u32]) -> Vector3<f64> {
        let positions = nodes.iter().map(|node| self.positions[*node as usize]);
        positions.sum::<Vector3<f64>>() / nodes.len() as f64
    }

    /// The apex (m) of the fan that closes each boundary loop, with the nodes of the loop.
    pub fn fans(&self) -> Vec<(Vector3<f64>, Vec<u32>)> {
        let apex = |nodes: &Vec<u32>| {
            let positions = || nodes.iter().map(|node| self.positions[*node as usize]);
            let mean = self.mean(nodes);
            let size = positions().map(|x| (x - mean).norm()).fold(0.0, f64::max);
            // Twice the vector area of the loop.
            let mut normal = Vector3::zeros();
            for (k, node) in nodes.iter().enumerate() {
                let [a, b] =
                    [*node, nodes[(k + 1) % nodes.len()]].map(|n| self.positions[n as usize]);
                normal += (a - mean).cross(&(b - mean));
            }
            let deviation = positions().map(|x| (x - mean).dot(&normal).abs()).fold(0.0, f64::max);
            let tolerance = MAX_PLANE_DEVIATION * size * normal.norm();
            // A loop in a plane through the origin closes about the origin: film that starts flat
            // between symmetry planes is in such a plane, and moves out of it.
            let plane = deviation <= tolerance;
            let misses_origin = mean.dot(&normal).abs() > tolerance;
            if plane && misses_origin { mean } else { Vector3::zeros() }
        };
        self.boundary().into_iter().map(|nodes| (apex(&nodes), nodes)).collect()
    }

    /// Closes every boundary loop by a fan of closing faces. `free`: projector onto the free directions of a
    /// node. Returns the new nodes at the apexes, which have no mass.
    pub fn close(&mut self, free: impl Fn(u32) -> Matrix3<f64>) -> Vec<u32> {
        let mut apexes = Vec::new();
        for (apex, nodes) in self.fans() {
            let mean = self.mean(&nodes);
            let moves = |node: u32, normal: Vector3<f64>| {
                (free(node) * normal).norm() > MAX_FREE_PART * normal.norm()
            };
            let on_wall = (0..nodes.len()).all(|k| {
                let edge = [nodes[k], nodes[(k + 1) % nodes.len()]];
                let [a, b] = edge.map(|node| self.positions[node as usize] - apex);
                let normal = a.cross(&b);
                // Rounding gives a face without area a normal.
                normal.norm() <= MAX_PLANE_DEVIATION * a.norm() * b.norm()
                    || !edge.iter().any(|node| moves(*node, normal))
            });
            let new_node = u32::try_from(self.positions.len()).expect("under 2^32 nodes");
            self.positions.push(if on_wall { apex } else { mean });
            apexes.push(new_node);
            if on_wall {
                self.walls.push(Wall { apex: new_node, fixed: apex != mean });
            }
            for (k, node) in nodes.iter().enumerate() {
                self.closure.push([*node, nodes[(k + 1) % nodes.len()], new_node]);
            }
        }
        apexes
    }

    /// Enclosed volume, m³, at these node positions (m). Boundary loops are closed by their fans, with
    /// the apexes of the initial shape.
    pub fn volume(&self, position: impl Fn(u32) -> Vector3<f64>) -> f64 {
        let six = |[a, b, c]: [Vector3<f64>; 3]| a.dot(&b.cross(&c));
        let faces: f64 = self.faces().map(|face| six(face.map(&position))).sum();
        let fan = |(apex, nodes): &(Vector3<f64>, Vec<u32>)| -> f64 {
            let edge =
                |k: usize| [position(nodes[k]), position(nodes[(k + 1) % nodes.len()]), *apex];
            (0..nodes.len()).map(|k| six(edge(k))).sum()
        };
        (faces + self.fans().iter().map(fan).sum::<f64>()) / 6.0
    }
}

/// Loops of edges with a face on one side only, against the direction of its faces.
fn loops<'a>(faces: impl Iterator<Item = &'a [u32; 3]>) -> Vec<Vec<u32>> {
    let mut directed_edges = std::collections::BTreeSet::new();
    for &[a, b, c] in faces {
        directed_edges.extend([[a, b], [b, c], [c, a]]);
    }
    // The face on the other side of an edge contains it in the opposite direction.
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let free = |edge: &&[u32; 2]| !directed_edges.contains(&[edge[1], edge[0]]);
    for &[a, b] in directed_edges.iter().filter(free) {
        next.entry(b).or_default().push(a);
    }
    let mut loops = Vec::new();
    while let Some((&first, _)) = next.iter().find(|(_, to)| !to.is_empty()) {
        let (mut nodes, mut node) = (Vec::new(), first);
        while let Some(to) = next.get_mut(&node).and_then(Vec::pop) {
            nodes.push(node);
            node = to;
        }
        loops.push(nodes);
    }
    loops
}

/// Flat coordinates of a triangle with its first edge along x.
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

    /// These faces of a unit cube.
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
    fn plane_holes_close_about_their_mean() {
        for open in [&SIDES[..], &[SIDES[0], SIDES[1], SIDES[2], SIDES[3], BOTTOM][..]] {
            let mut shell = cube(open);
            shell.check().unwrap();
            let start = shell.positions.clone();
            let volume = shell.volume(|node| start[node as usize]);
            assert!((volume - 1.0).abs() < 1e-15, "{volume}");
            let apexes = shell.close(|_| Matrix3::identity());
            assert!(shell.walls.is_empty());
            assert_eq!(apexes.len(), if open.len() == 4 { 2 } else { 1 });
            assert!(shell.is_closed());
            shell.check().unwrap();
            let positions = shell.positions.clone();
            assert!((shell.volume(|node| positions[node as usize]) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn symmetry_planes_through_the_origin_close_about_it() {
        // Three faces at the corner (1, 1, 1): the missing ones are in x = 0, y = 0, z = 0.
        let shell = cube(&[TOP, SIDES[1], SIDES[2]]);
        assert_eq!(shell.boundary().len(), 1);
        let volume = shell.volume(|node| shell.positions[node as usize]);
        assert!((volume - 1.0).abs() < 1e-15, "{volume}");
    }

    #[test]
    fn invalid_faces_are_refused() {
        let mut shell = cube(&[BOTTOM, TOP]);
        shell.triangles[0][1] = 99;
        assert!(matches!(shell.check(), Err(ShellError::Node { face: 0, node: 99, .. })));
        let shell = cube(&[BOTTOM, BOTTOM]);
        assert!(matches!(shell.check(), Err(ShellError::Edge { .. })));
    }

    #[test]
    fn flat_coordinates_keep_the_edge_lengths() {
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
