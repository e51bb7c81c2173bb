//! Nodes that two supports hold along one direction.
//!
//! A node may belong to several supports: a corner to two planes, an edge to a support that moves and
//! to one that keeps film flat. Along a direction that both hold they must prescribe the same motion.
//! Nothing else may hold a free body along its normal.

use std::collections::BTreeMap;

use billow_solver::scene::film_support::{FilmSupport, Hold};
use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Largest relative difference of two displacements that count as equal, and largest free part of a
/// unit direction that counts as held (chosen: far above rounding).
const EQUAL_TOLERANCE: f64 = 1e-9;

/// Refuses the first node for which two supports prescribe different motions.
pub(super) fn check(
    supports: &[FilmSupport],
    shape: &Shape,
    source: &Source,
) -> Result<(), InputError> {
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, support) in supports.iter().enumerate() {
        for node in &support.nodes {
            of_node.entry(*node).or_default().push(index);
        }
    }
    for (node, holders) in &of_node {
        let position = shape.shell.positions[*node as usize];
        for (k, second) in holders.iter().enumerate() {
            for first in &holders[..k] {
                let (a, b) = (&supports[*first], &supports[*second]);
                let Some(direction) = conflict(a, b, position) else { continue };
                let vertex = shape.numbering.vertex(*node).unwrap_or_default();
                let problem = format!(
                    "holds vertex {vertex} (from 0) along {:?}, which {:?} also holds, and moves \
                     otherwise",
                    <[f64; 3]>::from(direction),
                    a.name
                );
                return Err(source.error(
                    &format!("supports[{second}]"),
                    format!("{:?}", b.name),
                    problem,
                    "one motion along each direction of a node; nothing else along the normal of a body",
                ).with_hint("leave the node, or a letter of fix, out of one of the two"));
            }
        }
    }
    Ok(())
}

/// A direction that both hold with different motions.
fn conflict(a: &FilmSupport, b: &FilmSupport, position: Vector3<f64>) -> Option<Vector3<f64>> {
    let body = |support: &FilmSupport| matches!(support.hold, Hold::Body(_));
    let displacements = [a, b].map(|support| displacement(support, position));
    let clocks =
        [a, b].map(|support| support.motion.map(|motion| (motion.from, motion.to, motion.profile)));
    let both = |direction: &Vector3<f64>| {
        [a, b].iter().all(|support| {
            (support.hold.projector() * direction - direction).norm() < EQUAL_TOLERANCE
        })
    };
    let directions = [a, b].into_iter().flat_map(|support| directions(&support.hold));
    directions.into_iter().filter(both).find(|direction| {
        let [first, second] = displacements.map(|displacement| direction.dot(&displacement));
        let size = first.abs().max(second.abs());
        let differ = (first - second).abs() > EQUAL_TOLERANCE * size;
        body(a) || body(b) || differ || (size > 0.0 && clocks[0] != clocks[1])
    })
}

/// The displacement of a node at the end of its support's motion, m.
fn displacement(support: &FilmSupport, position: Vector3<f64>) -> Vector3<f64> {
    support
        .motion
        .map_or_else(Vector3::zeros, |motion| motion.position(position, motion.to) - position)
}

/// Unit directions that a support holds.
fn directions(hold: &Hold) -> Vec<Vector3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    match hold {
        Hold::Components(held) => {
            held.iter().zip(axes).filter(|(held, _)| **held).map(|(_, axis)| axis).collect()
        }
        Hold::Plane(normal) => vec![*normal],
        Hold::Body(body) => vec![body.normal],
    }
}
