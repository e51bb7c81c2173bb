//! Vertices to nodes: vertices that coincide are joined where asked, those without a face dropped.

use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use nalgebra::Vector3;

/// The vertex that each vertex is joined to: itself, or the first of those within the tolerance (m).
pub(super) fn joined(vertices: &[Vector3<f64>], tolerance: Option<f64>) -> Vec<u32> {
    let mut first: Vec<u32> = (0_u32..).take(vertices.len()).collect();
    let Some(tolerance) = tolerance else { return first };
    let mut by_x = first.clone();
    by_x.sort_by(|a, b| vertices[*a as usize].x.total_cmp(&vertices[*b as usize].x).then(a.cmp(b)));
    for (index, a) in by_x.iter().enumerate() {
        let from = vertices[*a as usize];
        for b in &by_x[index + 1..] {
            let to = vertices[*b as usize];
            if to.x - from.x > tolerance {
                break;
            }
            if (to - from).norm() <= tolerance {
                let (low, high) = (root(&first, *a), root(&first, *b));
                first[low.max(high) as usize] = low.min(high);
            }
        }
    }
    (0_u32..).take(vertices.len()).map(|vertex| root(&first, vertex)).collect()
}

/// The first vertex of the set that a vertex belongs to (union-find).
fn root(first: &[u32], mut vertex: u32) -> u32 {
    while first[vertex as usize] != vertex {
        vertex = first[vertex as usize];
    }
    vertex
}

/// Node of each vertex with a face, numbered in file order. `film` says which faces of the surface are
/// film; `closing` are the other faces.
pub(super) fn nodes(
    surface: &Surface,
    joined: &[u32],
    film: &[bool],
    closing: &[&Face],
) -> Vec<Option<u32>> {
    let mut used = vec![false; joined.len()];
    let of_film = surface.faces.iter().zip(film).filter(|(_, film)| **film).map(|(face, _)| face);
    for face in of_film.chain(closing.iter().copied()) {
        for vertex in &face.corners {
            used[joined[*vertex as usize] as usize] = true;
        }
    }
    let mut next = 0;
    let number = |used: &bool| {
        used.then(|| {
            next += 1;
            next - 1
        })
    };
    let node: Vec<Option<u32>> = used.iter().map(number).collect();
    joined.iter().map(|vertex| node[*vertex as usize]).collect()
}
