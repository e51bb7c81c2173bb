//! Free edges that lie on each other, or near each other, without being joined: film that leaks.
//!
//! ```text
//! d < 0.01 L       d: distance of a vertex of a rim from another vertex or edge of a rim, L: mean length of free edges
//! ```

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::json::Json;
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Distance of rims that are not joined, over the mean length of free edges. Chosen: layers of folded film are farther
/// apart, and what programs round or lose at a seam is less.
const NEAR: f64 = 0.01;
/// Part of an edge at each end that counts as its vertex.
const END: f64 = 0.02;

/// A place where film is not joined.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gap {
    distance: f64,
    node: u32,
    /// The other vertex, or the ends of the edge.
    other: [u32; 2],
}

/// Refuses film with rims that are near each other without being joined.
pub(super) fn check(shape: &Shape, source: &Source) -> Result<(), InputError> {
    let gaps = gaps(shape);
    let by_distance = |a: &&Gap, b: &&Gap| a.distance.total_cmp(&b.distance);
    let Some(nearest) = gaps.iter().min_by(by_distance) else { return Ok(()) };
    let at_vertices: Vec<&Gap> = gaps.iter().filter(|gap| gap.other[0] == gap.other[1]).collect();
    let vertex = |node: u32| shape.numbering.vertex(node).map_or(0, |vertex| vertex + 1);
    let position: [f64; 3] = shape.shell.positions[nearest.node as usize].into();
    let (first, [a, b]) = (vertex(nearest.node), nearest.other.map(vertex));
    let places = gaps.iter().map(|gap| gap.node).collect::<BTreeSet<u32>>().len();
    let farthest = at_vertices.iter().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let (near, hint) = if let Some(farthest) = farthest {
        let weld = match farthest.distance {
            0.0 => "0".to_owned(),
            distance => format!("\"{:.1e} m\"", 1.1 * distance),
        };
        let near = format!("OBJ vertices {first} and {a} (counted from 1)");
        (near, format!("join the seam, or set mesh.weld to {weld}, which joins these vertices"))
    } else {
        let near = format!("OBJ vertex {first} and the edge between {a} and {b} (counted from 1)");
        (near, "make the vertex a corner of the face on the other side too".to_owned())
    };
    let problem = format!(
        "leaks: free edges of the film are not joined, at {places} vertices; {near} are {} m apart, at {position:?} m",
        shown(nearest.distance)
    );
    let allowed = format!(
        "film with its seams joined where there is pressure, or free edges at least {NEAR} of their length apart"
    );
    let file = Json::Text(shape.file.clone());
    Err(source.error("mesh.positions", file, problem, allowed).with_hint(hint))
}

/// Where rims are near each other.
fn gaps(shape: &Shape) -> Vec<Gap> {
    let positions = &shape.shell.positions;
    let at = |node: u32| positions[node as usize];
    let loops = shape.shell.boundary();
    let edges: Vec<[u32; 2]> = loops
        .iter()
        .flat_map(|nodes| (0..nodes.len()).map(|k| [nodes[k], nodes[(k + 1) % nodes.len()]]))
        .collect();
    let length: f64 = edges.iter().map(|[a, b]| (at(*a) - at(*b)).norm()).sum();
    let tolerance = NEAR * length / edges.len().max(1) as f64;
    let joined: BTreeSet<[u32; 2]> = edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    let nodes: BTreeSet<u32> = edges.iter().flatten().copied().collect();
    let mut by_x: Vec<u32> = nodes.into_iter().collect();
    by_x.sort_by(|a, b| at(*a).x.total_cmp(&at(*b).x).then(a.cmp(b)));
    let mut gaps = Vec::new();
    for (index, a) in by_x.iter().enumerate() {
        let near = by_x[index + 1..].iter().take_while(|b| at(**b).x - at(*a).x < tolerance);
        for b in near.filter(|b| !joined.contains(&[*a, **b])) {
            let distance = (at(*a) - at(*b)).norm();
            if distance < tolerance {
                gaps.push(Gap { distance, node: *a, other: [*b, *b] });
            }
        }
    }
    for [a, b] in edges {
        let (from, along) = (at(a), at(b) - at(a));
        let (low, high) =
            (from.inf(&at(b)).add_scalar(-tolerance), from.sup(&at(b)).add_scalar(tolerance));
        let first = by_x.partition_point(|node| at(*node).x < low.x);
        let within = by_x[first..].iter().take_while(|node| at(**node).x <= high.x);
        for node in within.filter(|node| **node != a && **node != b) {
            let x: Vector3<f64> = at(*node);
            let inside = (0..3).all(|axis| low[axis] <= x[axis] && x[axis] <= high[axis]);
            let part = (x - from).dot(&along) / along.norm_squared();
            if !inside || !(END..1.0 - END).contains(&part) {
                continue;
            }
            let distance = (x - from - along * part).norm();
            if distance < tolerance {
                gaps.push(Gap { distance, node: *node, other: [a, b] });
            }
        }
    }
    gaps
}
