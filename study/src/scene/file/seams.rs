//! Free edges that lie on each other, or near each other, without being joined: film that leaks.
//!
//! ```text
//! d < 0.001 L      d: distance of a vertex of a rim from another vertex or edge of a rim, L: shortest free edge there
//! ```

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::json::Json;
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Distance of rims that are not joined, over the shortest free edge there. Chosen: the layers at the mouth of a flat bag
/// are farther apart, and what programs round or lose at a seam is less.
const NEAR: f64 = 1e-3;
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
    let vertex = |node: u32| shape.numbering.obj_vertex(node);
    let position: [f64; 3] =
        (shape.shell.positions[nearest.node as usize] + shape.numbering.origin).into();
    let (first, [a, b]) = (vertex(nearest.node), nearest.other.map(vertex));
    let places = gaps.iter().map(|gap| gap.node).collect::<BTreeSet<u32>>().len();
    let farthest = at_vertices.iter().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let (near, hint) = if let Some(farthest) = farthest {
        let weld = match farthest.distance {
            0.0 => "0".to_owned(),
            distance => format!("\"{:.1e} m\"", 1.1 * distance),
        };
        let near = format!("vertices {first} and {a} (counted from 1)");
        (near, format!("join the seam, or set mesh.weld to {weld}, which joins these vertices"))
    } else {
        let near = format!("vertex {first} and the edge between {a} and {b} (counted from 1)");
        (near, "make the vertex a corner of the face on the other side too".to_owned())
    };
    let problem = format!(
        "leaks: free edges of the film are not joined ({places} of their vertices); {near} are {} m apart, at {position:?} m",
        shown(nearest.distance)
    );
    let allowed = format!(
        "film with its seams joined where there is pressure, or free edges at least {NEAR} of the shortest of them apart"
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
    // The shortest free edge at each node.
    let mut shortest: BTreeMap<u32, f64> = BTreeMap::new();
    for [a, b] in &edges {
        let length = (at(*a) - at(*b)).norm();
        for node in [a, b] {
            let known = shortest.entry(*node).or_insert(length);
            *known = known.min(length);
        }
    }
    let near = |length: f64| NEAR * length;
    let widest = near(shortest.values().copied().fold(0.0, f64::max));
    let joined: BTreeSet<[u32; 2]> = edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    // Along the axis in which the film is longest.
    let [low, high] = shape.extents();
    let axis = (high - low).imax();
    let along_axis = |node: u32| at(node)[axis];
    let mut sorted: Vec<u32> = shortest.keys().copied().collect();
    sorted.sort_by(|a, b| along_axis(*a).total_cmp(&along_axis(*b)).then(a.cmp(b)));
    let mut gaps = Vec::new();
    for (index, a) in sorted.iter().enumerate() {
        let others = sorted[index + 1..].iter();
        for b in others.take_while(|b| along_axis(**b) - along_axis(*a) < widest) {
            let distance = (at(*a) - at(*b)).norm();
            if distance < near(shortest[a].min(shortest[b])) && !joined.contains(&[*a, *b]) {
                gaps.push(Gap { distance, node: *a, other: [*b, *b] });
            }
        }
    }
    for [a, b] in edges {
        let (from, along) = (at(a), at(b) - at(a));
        let (low, high) =
            (along_axis(a).min(along_axis(b)) - widest, along_axis(a).max(along_axis(b)) + widest);
        let first = sorted.partition_point(|node| along_axis(*node) < low);
        let within = sorted[first..].iter().take_while(|node| along_axis(**node) <= high);
        for node in within.filter(|node| **node != a && **node != b) {
            let x: Vector3<f64> = at(*node);
            let part = (x - from).dot(&along) / along.norm_squared();
            if !(END..1.0 - END).contains(&part) {
                continue;
            }
            let distance = (x - from - along * part).norm();
            if distance < near(shortest[node].min(along.norm())) {
                gaps.push(Gap { distance, node: *node, other: [a, b] });
            }
        }
    }
    gaps
}
