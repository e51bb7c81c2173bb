//! Nodes that two supports hold along one direction, each its own way.
//!
//! A node may belong to several supports: a corner to two planes, an edge to a mover and to what keeps
//! film flat. Along a direction both hold they must agree on where it goes, and what moves as a free
//! body is held along its normal by nothing else.

use std::collections::BTreeMap;

use billow_solver::scene::film_support::{FilmSupport, Hold};
use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// How far apart two ends may be and still be one, of the way, and how little of a direction may be
/// free.
const SAME: f64 = 1e-9;

/// Refuses the first node held two ways.
pub(super) fn check(
    supports: &[FilmSupport],
    shape: &Shape,
    source: &Source,
) -> Result<(), InputError> {
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (at, support) in supports.iter().enumerate() {
        for node in &support.nodes {
            of_node.entry(*node).or_default().push(at);
        }
    }
    for (node, own) in &of_node {
        let place = shape.shell.positions[*node as usize];
        for (k, second) in own.iter().enumerate() {
            for first in &own[..k] {
                let (a, b) = (&supports[*first], &supports[*second]);
                let Some(direction) = conflict(a, b, place) else { continue };
                let vertex = shape.numbering.vertex(*node).unwrap_or_default();
                let problem = format!(
                    "holds vertex {vertex} (from 0) along {:?}, which {:?} holds too, and moves \
                     otherwise",
                    <[f64; 3]>::from(direction),
                    a.name
                );
                let mut error = source.error(
                    &format!("supports[{second}]"),
                    &format!("{:?}", b.name),
                    problem,
                    "along each direction of a node one motion; a body alone along its normal",
                );
                "leave the node, or a letter of fix, out of one of the two"
                    .clone_into(&mut error.hint);
                return Err(error);
            }
        }
    }
    Ok(())
}

/// A direction that both hold and do not agree on.
fn conflict(a: &FilmSupport, b: &FilmSupport, place: Vector3<f64>) -> Option<Vector3<f64>> {
    let body = |own: &FilmSupport| matches!(own.hold, Hold::Body(_));
    let ways = [a, b].map(|own| way(own, place));
    let clocks =
        [a, b].map(|own| own.motion.map(|motion| (motion.from, motion.to, motion.profile)));
    let both = |direction: &Vector3<f64>| {
        [a, b].iter().all(|own| (own.hold.projector() * direction - direction).norm() < SAME)
    };
    let directions = [a, b].into_iter().flat_map(|own| directions(&own.hold));
    directions.into_iter().filter(both).find(|direction| {
        let [first, second] = ways.map(|way| direction.dot(&way));
        let size = first.abs().max(second.abs());
        let apart = (first - second).abs() > SAME * size;
        body(a) || body(b) || apart || (size > 0.0 && clocks[0] != clocks[1])
    })
}

/// The way of a node to the end of its support's motion, m.
fn way(support: &FilmSupport, place: Vector3<f64>) -> Vector3<f64> {
    support.motion.map_or_else(Vector3::zeros, |motion| motion.position(place, motion.to) - place)
}

/// Unit directions held.
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
