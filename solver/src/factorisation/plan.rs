//! Symbolic factorisation: the fronts of a film's stiffness, and where each entry is added.
//!
//! Each separator ([`super::order`]) is a front: a dense matrix of its own unknowns and of those unknowns
//! above it that its faces touch. It depends on the mesh and the supports only, so one serves every Newton
//! step.

use nalgebra::Vector3;

use super::dense::Front;
use super::order::{Separator, dissect};
use super::unknowns::Unknowns;
use crate::geometry::field::Field;

/// One unknown of a face: its index in the front, the corner it moves, and the direction.
type FaceUnknown = (u32, usize, Vector3<f64>);

/// A face with its unknowns.
type FaceUnknowns = (usize, Vec<FaceUnknown>);

/// A face of a front: how its stiffness is added.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontFace {
    /// The face.
    pub face: usize,
    /// Its unknowns.
    pub entries: FaceEntries,
}

/// Unknowns of a face in its front.
#[derive(Debug, Clone, PartialEq)]
pub enum FaceEntries {
    /// Each is one component of one corner, and none moves two: (index in the front, row of the stiffness),
    /// ascending.
    Components(Vec<(u32, u32)>),
    /// Index in the front, corner, direction.
    Oblique(Vec<FaceUnknown>),
}

impl FaceEntries {
    fn new(mut unknowns: Vec<FaceUnknown>) -> Self {
        let component = |(local, corner, direction): &FaceUnknown| {
            let axis = (0..3).find(|axis| *direction == Vector3::ith(*axis, 1.0))?;
            Some((*local, u32::try_from(3 * corner + axis).expect("under 2^32")))
        };
        unknowns.sort_by_key(|(local, ..)| *local);
        // A rigid plane may move several corners.
        let shared = unknowns.windows(2).any(|pair| pair[0].0 == pair[1].0);
        match unknowns.iter().map(component).collect() {
            Some(components) if !shared => Self::Components(components),
            _ => Self::Oblique(unknowns),
        }
    }
}

/// The constant data of a front.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Its size.
    pub front: Front,
    /// Its own unknowns, then those above it, both in the order of elimination.
    pub unknowns: Vec<u32>,
    /// Indices of the fronts whose Schur complements it receives.
    pub children: Vec<usize>,
    /// Position in the parent of each unknown above it.
    pub in_parent: Vec<u32>,
    /// Faces assembled into this front.
    pub faces: Vec<FrontFace>,
}

/// Where each unknown is eliminated.
struct Schedule {
    /// Unknowns of each separator, in the order of elimination.
    of_separator: Vec<Vec<u32>>,
    /// Separator of each unknown.
    separator: Vec<usize>,
    /// Rank of each unknown in the order of elimination.
    rank: Vec<usize>,
}

impl Schedule {
    /// Nodes in the order of the tree; the unknowns of rigid planes belong to its root.
    fn new(tree: &[Separator], unknowns: &Unknowns) -> Self {
        let root = tree.len() - 1;
        let of_node = |node: &u32| unknowns.node_range[*node as usize].clone();
        let mut of_separator: Vec<Vec<u32>> =
            tree.iter().map(|set| set.nodes.iter().flat_map(of_node).collect()).collect();
        let count = u32::try_from(unknowns.len()).expect("under 2^32");
        of_separator[root].extend(unknowns.first_plane..count);
        let mut separator = vec![root; unknowns.len()];
        let mut rank = vec![0; unknowns.len()];
        for (index, unknown) in of_separator.iter().flatten().enumerate() {
            rank[*unknown as usize] = index;
        }
        for (index, unknowns) in of_separator.iter().enumerate() {
            for unknown in unknowns {
                separator[*unknown as usize] = index;
            }
        }
        Self { of_separator, separator, rank }
    }

    /// Position of an unknown in a front: both are in the order of elimination.
    fn position(&self, plan: &Plan, unknown: u32) -> u32 {
        let position = plan
            .unknowns
            .binary_search_by_key(&self.rank[unknown as usize], |other| self.rank[*other as usize]);
        u32::try_from(position.expect("an unknown of the front")).expect("under 2^32")
    }
}

/// Nodes with unknowns that share a face with each node with unknowns, ascending.
fn neighbours(nodes: usize, faces: &[&[u32]], free: impl Fn(u32) -> bool) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); nodes];
    for face in faces {
        for node in face.iter().filter(|node| free(**node)) {
            let others = face.iter().filter(|other| *other != node && free(**other));
            neighbours[*node as usize].extend(others.copied());
        }
    }
    for nodes in &mut neighbours {
        nodes.sort_unstable();
        nodes.dedup();
    }
    neighbours
}

/// The unknowns that move a face; those of its first corner come first.
fn unknowns_of_face(face: &[u32], unknowns: &Unknowns) -> Vec<FaceUnknown> {
    let corner = |(corner, node): (usize, &u32)| {
        let of_node = unknowns.of_node[*node as usize].iter();
        of_node.map(move |(unknown, direction)| (*unknown, corner, *direction))
    };
    face.iter().enumerate().flat_map(corner).collect()
}

/// Assigns each face to the first separator that eliminates one of its unknowns.
fn faces_of_separators(
    faces: &[&[u32]],
    unknowns: &Unknowns,
    schedule: &Schedule,
) -> Vec<Vec<FaceUnknowns>> {
    let mut assigned: Vec<Vec<FaceUnknowns>> = vec![Vec::new(); schedule.of_separator.len()];
    for (index, face) in faces.iter().enumerate() {
        let face_unknowns = unknowns_of_face(face, unknowns);
        let separators =
            face_unknowns.iter().map(|(unknown, ..)| schedule.separator[*unknown as usize]);
        if let Some(first) = separators.min() {
            assigned[first].push((index, face_unknowns));
        }
    }
    assigned
}

/// The fronts without their faces, children before parents. Positions in parents are not set yet.
fn fronts(tree: Vec<Separator>, faces: &[Vec<FaceUnknowns>], schedule: &Schedule) -> Vec<Plan> {
    let mut plans: Vec<Plan> = Vec::with_capacity(tree.len());
    for (index, (separator, faces)) in tree.into_iter().zip(faces).enumerate() {
        let from_children = separator.children.iter().flat_map(|child| {
            let plan = &plans[*child];
            plan.unknowns[plan.front.pivots..].iter().copied()
        });
        let from_faces = faces.iter().flat_map(|(_, of_face)| of_face.iter().map(|(u, ..)| *u));
        let mut above: Vec<u32> = from_children
            .chain(from_faces)
            .filter(|unknown| schedule.separator[*unknown as usize] > index)
            .collect();
        above.sort_unstable_by_key(|unknown| schedule.rank[*unknown as usize]);
        above.dedup();
        let mut unknowns = schedule.of_separator[index].clone();
        let pivots = unknowns.len();
        unknowns.extend(above);
        let front = Front { pivots, size: unknowns.len() };
        let children = separator.children;
        plans.push(Plan { front, unknowns, children, in_parent: Vec::new(), faces: Vec::new() });
    }
    plans
}

/// Sets the positions of the children's unknowns, and of the unknowns of faces, in each front.
fn locate(plans: &mut [Plan], faces: Vec<Vec<FaceUnknowns>>, schedule: &Schedule) {
    for (index, faces) in faces.into_iter().enumerate() {
        for child in plans[index].children.clone() {
            let above = plans[child].unknowns[plans[child].front.pivots..].to_vec();
            let parent = &plans[index];
            plans[child].in_parent =
                above.into_iter().map(|unknown| schedule.position(parent, unknown)).collect();
        }
        let located = faces.into_iter().map(|(face, mut unknowns)| {
            for (unknown, ..) in &mut unknowns {
                *unknown = schedule.position(&plans[index], *unknown);
            }
            FrontFace { face, entries: FaceEntries::new(unknowns) }
        });
        plans[index].faces = located.collect();
    }
}

/// The fronts of these unknowns, coupled by faces (nodes of each); children before parents. Their dissection uses the
/// positions (m).
pub fn plan(faces: &[&[u32]], unknowns: &Unknowns, positions: &Field) -> Vec<Plan> {
    let count = unknowns.of_node.len();
    let free = |node: u32| !unknowns.node_range[node as usize].is_empty();
    let neighbours = neighbours(count, faces, free);
    let nodes = (0_u32..).take(count).filter(|node| free(*node)).collect();
    let tree = dissect(nodes, &neighbours, positions);
    let schedule = Schedule::new(&tree, unknowns);
    let faces = faces_of_separators(faces, unknowns, &schedule);
    let mut plans = fronts(tree, &faces, &schedule);
    locate(&mut plans, faces, &schedule);
    plans
}
