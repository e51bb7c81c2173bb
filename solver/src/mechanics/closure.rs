//! Vertices of closing faces that belong to no film: they move with the rim of their patch.
//!
//! ```text
//! x_a = m + B c_a + b_a N        m = Σ w_i x_i,   B = Σ w_i x_i q_iᵀ,   N = ½ Σ x_i × x_j over the rim's edges
//! f_i += w_i (Σ f_a + (Σ f_a c_aᵀ) q_i) + ½ (x_next − x_previous) × Σ b_a f_a
//! ```
//!
//! Symbols: `x_a` a vertex without film, `x_i` the rim of its patch (the connected closing faces of such
//! vertices); `w_i` weights in proportion to the length of the rim at i, `q_i` the initial position of i from
//! the mean m; `c_a` and `b_a` constants that place the vertex at its initial position. The patch therefore
//! moves as the best affine map of its rim. The force `f_a` of the pressure on the vertex goes to the rim by
//! the transpose of the same map: the nodal forces are the derivative of the volume, so energy, resultant and
//! moment are exact. A vertex that supports hold in all three directions does not follow: it counts as rim,
//! and its supports take its force.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::geometry::shell::Shell;

/// Smallest area of a rim over that of a circle of the same length at which its normal places vertices off
/// the plane of the rim. Chosen: a rim below it is folded, and its normal is ill-conditioned.
const MIN_RIM_AREA: f64 = 1e-2;
/// Smallest determinant of the second moment of a rim over that of a round one at which the affine map is
/// determined. Chosen: far above rounding.
const MIN_DETERMINANT: f64 = 1e-9;
/// Largest distance, over the size of the rim, at which a vertex counts as placed. Chosen: above rounding.
const MAX_DISTANCE: f64 = 1e-9;

/// A vertex of closing faces that its rim does not place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "node {node} of the closing faces belongs to no film, and the rim of its faces does not determine where it \
     moves; allowed: closing faces whose rim is film and spans an area, without vertices beside it"
)]
pub struct ClosureError {
    /// Node.
    pub node: u32,
}

/// Sums of normals (m²), six times ∂V/∂x, at nodes.
pub trait NormalSums {
    /// The sum at a node, which becomes zero.
    fn take_normal(&mut self, node: usize) -> Vector3<f64>;

    /// Adds to the sum at a node.
    fn add_normal(&mut self, node: usize, normal: Vector3<f64>);
}

/// All vertices of closing faces that follow a rim.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ClosureNodes {
    pub(super) patches: Vec<Patch>,
    /// Faces of the fans on walls: the pressure on them is not part of a reaction.
    wall_faces: Vec<[u32; 3]>,
}

/// Connected closing faces with vertices that belong to no film.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Patch {
    pub(super) rim: Vec<RimNode>,
    /// Directed edges of the rim, as indices into `rim`; closed loops.
    pub(super) edges: Vec<[usize; 2]>,
    pub(super) followers: Vec<Follower>,
    pub(super) faces: Vec<[u32; 3]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RimNode {
    pub(super) node: u32,
    /// w.
    pub(super) weight: f64,
    /// q: its initial position from the mean of the rim, m.
    pub(super) offset: Vector3<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Follower {
    pub(super) node: u32,
    /// c, 1/m².
    pub(super) affine: Vector3<f64>,
    /// b, 1/m.
    pub(super) normal: f64,
}

impl ClosureNodes {
    /// The vertices of a shell's closing faces that belong to no film. `held`: whether supports hold a node
    /// in all three directions.
    ///
    /// # Errors
    /// [`ClosureError`] for a vertex that no rim places.
    pub fn new(shell: &Shell, held: impl Fn(u32) -> bool) -> Result<Self, ClosureError> {
        let film: BTreeSet<u32> = shell.triangles.iter().flatten().copied().collect();
        let fixed: BTreeSet<u32> =
            shell.walls.iter().filter(|wall| wall.fixed).map(|wall| wall.apex).collect();
        let follows = |node: u32| !film.contains(&node) && !fixed.contains(&node) && !held(node);
        let patches = patches(&shell.closure, follows);
        let patches = patches.iter().map(|faces| Patch::new(shell, faces, follows));
        let on_wall = |face: &&[u32; 3]| shell.walls.iter().any(|wall| face.contains(&wall.apex));
        Ok(Self {
            patches: patches.collect::<Result<_, _>>()?,
            wall_faces: shell.closure.iter().filter(on_wall).copied().collect(),
        })
    }

    /// Whether no vertex follows a rim.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// Nodes of the rim of each patch.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        let rim = |patch: &Patch| patch.rim.iter().map(|rim| rim.node).collect();
        self.patches.iter().map(rim).collect()
    }

    /// Moves the vertices to their places on the rims.
    pub fn place(&self, positions: &mut Field) {
        for patch in &self.patches {
            let rim = patch.map(|node| positions.get(node as usize));
            for follower in &patch.followers {
                positions.set(follower.node as usize, rim.position(follower));
            }
        }
    }

    /// Moves ∂V/∂x of the vertices to the nodes of their rims. The vertices are at their places.
    pub fn distribute(&self, positions: &Field, forces: &mut impl NormalSums) {
        for patch in &self.patches {
            let (mut sum, mut moment, mut along_normal) =
                (Vector3::zeros(), Matrix3::zeros(), Vector3::zeros());
            for follower in &patch.followers {
                let area = forces.take_normal(follower.node as usize);
                sum += area;
                moment += area * follower.affine.transpose();
                along_normal += area * follower.normal;
            }
            for rim in &patch.rim {
                let share = (sum + moment * rim.offset) * rim.weight;
                forces.add_normal(rim.node as usize, share);
            }
            if along_normal == Vector3::zeros() {
                continue;
            }
            let origin = positions.get(patch.rim[0].node as usize);
            for edge in &patch.edges {
                let [a, b] = edge.map(|index| patch.rim[index].node as usize);
                let [x, y] = [a, b].map(|node| positions.get(node) - origin);
                forces.add_normal(a, y.cross(&along_normal) * 0.5);
                forces.add_normal(b, along_normal.cross(&x) * 0.5);
            }
        }
    }

    /// Six times ∂V/∂x of the faces on walls at the nodes of their rims, m²: node and part.
    pub fn on_walls(&self, positions: &Field) -> BTreeMap<u32, Vector3<f64>> {
        let mut parts = BTreeMap::new();
        if self.wall_faces.is_empty() {
            return parts;
        }
        for face in &self.wall_faces {
            let [a, b, c] = positions.at(*face);
            let normal = (b - a).cross(&(c - a));
            for node in face {
                *parts.entry(*node).or_insert_with(Vector3::zeros) += normal;
            }
        }
        for patch in &self.patches {
            let mut sum = Vector3::zeros();
            let mut moment = Matrix3::zeros();
            for follower in &patch.followers {
                let Some(area) = parts.remove(&follower.node) else { continue };
                sum += area;
                moment += area * follower.affine.transpose();
            }
            if sum != Vector3::zeros() {
                for rim in &patch.rim {
                    let share = (sum + moment * rim.offset) * rim.weight;
                    *parts.entry(rim.node).or_insert_with(Vector3::zeros) += share;
                }
            }
        }
        parts
    }
}

/// Closing faces around nodes that follow, by connected patch, in the order of their first node.
fn patches(closure: &[[u32; 3]], follows: impl Fn(u32) -> bool) -> Vec<Vec<[u32; 3]>> {
    // The first node of the patch of each follower.
    let mut first: BTreeMap<u32, u32> = closure
        .iter()
        .flatten()
        .filter(|node| follows(**node))
        .map(|node| (*node, *node))
        .collect();
    let mut changed = true;
    while changed {
        changed = false;
        for face in closure {
            let Some(lowest) = face.iter().filter_map(|node| first.get(node)).min().copied() else {
                continue;
            };
            for node in face {
                if let Some(known) = first.get_mut(node).filter(|known| **known != lowest) {
                    *known = lowest;
                    changed = true;
                }
            }
        }
    }
    let mut faces: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for face in closure {
        if let Some(patch) = face.iter().find_map(|node| first.get(node)) {
            faces.entry(*patch).or_default().push(*face);
        }
    }
    faces.into_values().collect()
}

/// The rim of a patch now.
struct Rim {
    /// m.
    mean: Vector3<f64>,
    /// B.
    affine: Matrix3<f64>,
    /// N.
    area: Vector3<f64>,
}

impl Rim {
    fn position(&self, follower: &Follower) -> Vector3<f64> {
        self.mean + self.affine * follower.affine + self.area * follower.normal
    }
}

impl Patch {
    fn new(
        shell: &Shell,
        faces: &[[u32; 3]],
        follows: impl Fn(u32) -> bool,
    ) -> Result<Self, ClosureError> {
        let nodes: BTreeSet<u32> = faces.iter().flatten().copied().collect();
        let (inner, rim): (Vec<u32>, Vec<u32>) = nodes.into_iter().partition(|node| follows(*node));
        let position = |node: u32| shell.positions[node as usize];
        let directed: BTreeSet<[u32; 2]> =
            faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let index = |node: u32| rim.binary_search(&node).ok();
        let mut edges = Vec::new();
        for &[a, b] in directed.iter().filter(|[a, b]| !directed.contains(&[*b, *a])) {
            match (index(a), index(b)) {
                (Some(a), Some(b)) => edges.push([a, b]),
                // A free edge of the closing faces.
                _ => return Err(ClosureError { node: if follows(a) { a } else { b } }),
            }
        }
        let mut lengths = vec![0.0; rim.len()];
        for [a, b] in &edges {
            let length = (position(rim[*a]) - position(rim[*b])).norm();
            lengths[*a] += length;
            lengths[*b] += length;
        }
        let total: f64 = lengths.iter().sum();
        // Written so that NaN is refused too.
        let has_length = total > 0.0;
        if !has_length {
            return Err(ClosureError { node: inner[0] });
        }
        let rim = rim.iter().zip(&lengths).map(|(node, length)| RimNode {
            node: *node,
            weight: length / total,
            offset: Vector3::zeros(),
        });
        let faces = faces.to_vec();
        let mut patch = Self { rim: rim.collect(), edges, followers: Vec::new(), faces };
        let mean = patch.map(position).mean;
        for rim in &mut patch.rim {
            rim.offset = position(rim.node) - mean;
        }
        let start = patch.map(position);
        let fit = Fit::new(&start, 0.5 * total);
        for node in inner {
            let follower = fit.follower(node, position(node) - mean);
            let distance = (start.position(&follower) - position(node)).norm();
            let placed = distance <= MAX_DISTANCE * total;
            if !placed {
                return Err(ClosureError { node });
            }
            patch.followers.push(follower);
        }
        Ok(patch)
    }

    /// The rim at these positions (m) of the nodes.
    fn map(&self, position: impl Fn(u32) -> Vector3<f64>) -> Rim {
        let (mut mean, mut affine) = (Vector3::zeros(), Matrix3::zeros());
        for rim in &self.rim {
            let x = position(rim.node) * rim.weight;
            mean += x;
            affine += x * rim.offset.transpose();
        }
        let origin = self.rim.first().map_or_else(Vector3::zeros, |rim| position(rim.node));
        let at = |index: usize| position(self.rim[index].node) - origin;
        let area: Vector3<f64> = self.edges.iter().map(|[a, b]| at(*a).cross(&at(*b))).sum();
        Rim { mean, affine, area: area * 0.5 }
    }
}

/// How a rim places vertices.
enum Fit {
    /// Along the rim by the affine map of its plane, off it along its area.
    Plane {
        /// Inverse of the second moment in the plane.
        inverse: Matrix3<f64>,
        /// Second moment of the rim.
        moment: Matrix3<f64>,
        /// Vector area of the rim, m².
        area: Vector3<f64>,
    },
    /// By the affine map in space: inverse of the second moment.
    Space(Matrix3<f64>),
    /// At the mean only.
    Mean,
}

impl Fit {
    /// `length`: length of the rim, m.
    fn new(rim: &Rim, length: f64) -> Self {
        // Σ w q = 0, so B is the second moment Σ w q qᵀ of the rim.
        let moment = rim.affine;
        let round = length * length / (4.0 * core::f64::consts::PI);
        let area = rim.area.norm();
        if area >= MIN_RIM_AREA * round {
            let normal = rim.area / area;
            let across = normal * normal.transpose();
            let plane = Matrix3::identity() - across;
            let in_plane = plane * moment * plane;
            let size = 0.5 * in_plane.trace();
            // Regular: `size` along the normal.
            let regular = in_plane + across * size;
            if regular.determinant() >= MIN_DETERMINANT * size * size * size
                && let Some(inverse) = regular.try_inverse()
            {
                return Self::Plane { inverse: plane * inverse * plane, moment, area: rim.area };
            }
        }
        let size = moment.trace() / 3.0;
        let determined = moment.determinant() >= MIN_DETERMINANT * size * size * size;
        match moment.try_inverse().filter(|_| determined) {
            Some(inverse) => Self::Space(inverse),
            None => Self::Mean,
        }
    }

    /// The vertex at this position from the mean of the rim (m).
    fn follower(&self, node: u32, offset: Vector3<f64>) -> Follower {
        match self {
            Self::Plane { inverse, moment, area } => {
                let affine = inverse * offset;
                let rest = offset - moment * affine;
                Follower { node, affine, normal: rest.dot(area) / area.norm_squared() }
            }
            Self::Space(inverse) => Follower { node, affine: inverse * offset, normal: 0.0 },
            Self::Mean => Follower { node, affine: Vector3::zeros(), normal: 0.0 },
        }
    }
}
