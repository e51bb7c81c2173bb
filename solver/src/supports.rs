//! What holds film: components of nodes that stay, or move at a velocity of their own.
//!
//! A held component takes no part in the balance of momentum: its velocity is prescribed, and the
//! support bears whatever force acts on it. A support that stands does no work.

use nalgebra::Vector3;

use crate::mesh::{Mesh, Part};
use crate::scene::{Support, SupportPlace};
use crate::state::Field;

/// Which components of which nodes are held.
#[derive(Debug, Clone, PartialEq)]
pub struct Supports {
    /// 1 where a component is free, 0 where it is held.
    pub free: Field,
    /// Nodes held in a component that moves, in order.
    pub moving: Vec<u32>,
}

impl Supports {
    /// No supports for this many nodes.
    pub fn none(nodes: usize) -> Self {
        let ones = || vec![1.0; nodes];
        Self { free: Field { x: ones(), y: ones(), z: ones() }, moving: Vec::new() }
    }

    /// The supports of a scene on a capsule's mesh.
    pub fn of_capsule(supports: &[Support], mesh: &Mesh) -> Self {
        let mut all = Self::none(mesh.positions.len());
        for support in supports {
            let nodes = match support.on {
                SupportPlace::BottomRing => mesh.bottom_ring.clone(),
                SupportPlace::TopRing => mesh.top_ring.clone(),
                SupportPlace::BottomCap => part_nodes(mesh, Part::BottomCap),
                SupportPlace::TopCap => part_nodes(mesh, Part::TopCap),
            };
            all.hold(&nodes, &support.fix);
        }
        all
    }

    /// Holds the components of these nodes that `fix` names: letters of "xyz".
    pub fn hold(&mut self, nodes: &[u32], fix: &str) {
        for node in nodes {
            let node = *node as usize;
            for axis in fix.chars() {
                match axis {
                    'x' => self.free.x[node] = 0.0,
                    'y' => self.free.y[node] = 0.0,
                    'z' => self.free.z[node] = 0.0,
                    _ => {}
                }
            }
        }
    }

    /// 1 in the free components of a node, 0 in the held.
    pub fn free(&self, node: usize) -> Vector3<f64> {
        self.free.get(node)
    }
}

fn part_nodes(mesh: &Mesh, part: Part) -> Vec<u32> {
    let own = mesh.triangles.iter().zip(&mesh.parts).filter(|(_, own)| **own == part);
    let mut nodes: Vec<u32> = own.flat_map(|(triangle, _)| *triangle).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
