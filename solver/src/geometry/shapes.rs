//! Simple shells for reference cases and tests: sheets, discs, spheres, tubes, cones.
//!
//! Every shape has one arithmetic and one numbering of nodes and elements: reference cases and the
//! guard of the physics version depend on its bits.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};

use super::shell::Shell;

/// A flat sheet in z = 0 of `width` × `height` m with uneven cells: inner nodes lie off the regular
/// grid by up to 8 % of a cell, diagonals alternate. Its reference is its own plane.
pub fn sheet(columns: u32, rows: u32, width: f64, height: f64) -> Shell {
    let (wide, high) = (f64::from(columns), f64::from(rows));
    let position = |i: u32, j: u32| {
        let inside = i > 0 && j > 0 && i < columns && j < rows;
        let off = if inside { 0.04 * f64::from((i * 7 + j * 5) % 5) - 0.08 } else { 0.0 };
        [(f64::from(i) + off) / wide * width, (f64::from(j) - 0.7 * off) / high * height]
    };
    cells(columns, rows, position, |i, j| (i + j) % 2 == 0)
}

/// A flat sheet in z = 0 from the origin, `columns` × `rows` equal cells, every diagonal from the
/// lower left to the upper right. Its reference is its own plane.
pub fn grid(columns: u32, rows: u32, width: f64, height: f64) -> Shell {
    cells(columns, rows, equal(columns, rows, width, height), |_, _| true)
}

/// [`grid`] with diagonals that alternate, so that the mesh prefers none of its two directions.
pub fn crossed_grid(columns: u32, rows: u32, width: f64, height: f64) -> Shell {
    cells(columns, rows, equal(columns, rows, width, height), |i, j| (i + j) % 2 == 0)
}

/// The nodes of equal cells.
fn equal(columns: u32, rows: u32, width: f64, height: f64) -> impl Fn(u32, u32) -> [f64; 2] {
    move |i, j| [f64::from(i) / f64::from(columns) * width, f64::from(j) / f64::from(rows) * height]
}

/// A flat sheet of cells with these nodes; `rises(column, row)`: whether the diagonal of a cell starts at its
/// lower left.
fn cells(
    columns: u32,
    rows: u32,
    position: impl Fn(u32, u32) -> [f64; 2],
    rises: impl Fn(u32, u32) -> bool,
) -> Shell {
    let node = |i: u32, j: u32| j * (columns + 1) + i;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let [x, y] = position(i, j);
            positions.push(Vector3::new(x, y, 0.0));
            if i < columns && j < rows {
                let corners = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                triangles.extend(halves(corners, rises(i, j)));
            }
        }
    }
    in_plane(positions, triangles)
}

/// The two elements of a cell with these corners; `rises`: whether their diagonal starts at the first corner.
fn halves([a, b, c, d]: [u32; 4], rises: bool) -> [[u32; 3]; 2] {
    if rises { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// A strip along x, one cell wide: every element is the same but for a half turn.
pub fn strip(columns: u32, length: f64, width: f64) -> Shell {
    grid(columns, 1, length, width)
}

/// A flat disc of concentric rings with 6k nodes on ring k, equal radial steps. The disc of twice
/// the rings cuts every element into four, so results on both have one smooth error.
pub fn disc(rings: u32, radius: f64) -> Shell {
    let first = |ring: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    let node = |ring: u32, k: u32| if ring == 0 { 0 } else { first(ring) + k % (6 * ring) };
    let mut positions = vec![Vector3::zeros()];
    for ring in 1..=rings {
        let r = radius * f64::from(ring) / f64::from(rings);
        for k in 0..6 * ring {
            let angle = TAU * f64::from(k) / f64::from(6 * ring);
            let (sin, cos) = libm::sincos(angle);
            positions.push(Vector3::new(r * cos, r * sin, 0.0));
        }
    }
    let mut triangles = Vec::new();
    for ring in 1..=rings {
        for sector in 0..6 {
            for k in 0..ring {
                let (inner, outer) = (sector * (ring - 1) + k, sector * ring + k);
                triangles.push([node(ring, outer), node(ring, outer + 1), node(ring - 1, inner)]);
                if k + 1 < ring {
                    triangles.push([
                        node(ring - 1, inner),
                        node(ring, outer + 1),
                        node(ring - 1, inner + 1),
                    ]);
                }
            }
        }
    }
    in_plane(positions, triangles)
}

/// A sphere: an icosahedron whose faces are cut into four `level` times, wound outward.
pub fn icosphere(level: u32, radius: f64) -> Shell {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut nodes: Vec<Vector3<f64>> = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        nodes.push(Vector3::new(0.0, a, b));
        nodes.push(Vector3::new(a, b, 0.0));
        nodes.push(Vector3::new(b, 0.0, a));
    }
    let mut triangles = Vec::new();
    for a in 0..12_u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|node| nodes[node as usize]);
                // Edges of the icosahedron of these nodes have length 2.
                let edges = [(p - q).norm(), (q - r).norm(), (r - p).norm()];
                if edges.iter().all(|edge| (edge - 2.0).abs() < 1e-9) {
                    let outward = p.dot(&q.cross(&r)) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for node in &mut nodes {
        *node = node.normalize() * radius;
    }
    for _ in 0..level {
        let mut midpoints = BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut midpoint = |p: u32, q: u32| {
                *midpoints.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    let sum = nodes[p as usize] + nodes[q as usize];
                    nodes.push(sum.normalize() * radius);
                    u32::try_from(nodes.len() - 1).expect("fewer than 2^32 nodes")
                })
            };
            let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Shell::relaxed(nodes, triangles)
}

/// A surface of revolution about z: `rings` + 1 rings of `around` nodes, two elements a cell, ring k
/// at the radius and height `profile(k)` (m). Outward is away from the axis where heights rise.
///
/// All diagonals lean alike, so that every node of a ring bears the same; `crossed` alternates them,
/// so that the mesh has no sense of rotation.
pub fn revolved(
    rings: u32,
    around: u32,
    crossed: bool,
    profile: impl Fn(u32) -> [f64; 2],
) -> Shell {
    let mut positions = Vec::new();
    for ring in 0..=rings {
        let [radius, height] = profile(ring);
        for i in 0..around {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(around));
            positions.push(Vector3::new(radius * cos, radius * sin, height));
        }
    }
    let node = |ring: u32, i: u32| ring * around + i % around;
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for i in 0..around {
            let [a, b] = [node(ring, i), node(ring, i + 1)];
            let corners = [a, b, node(ring + 1, i + 1), node(ring + 1, i)];
            triangles.extend(halves(corners, !crossed || (ring + i) % 2 == 0));
        }
    }
    Shell::relaxed(positions, triangles)
}

/// Nodes of one ring of [`revolved`].
pub fn ring_nodes(ring: u32, around: u32) -> Vec<u32> {
    (ring * around..(ring + 1) * around).collect()
}

/// An open tube about z from z = 0: `around` cells round, `along` up, wound outward.
pub fn tube(around: u32, along: u32, radius: f64, length: f64) -> Shell {
    revolved(along, around, false, |ring| [radius, length * f64::from(ring) / f64::from(along)])
}

/// Several pieces of film as one shell, without closing faces.
pub fn joined(pieces: &[Shell]) -> Shell {
    let mut whole = Shell::default();
    for piece in pieces {
        let first = u32::try_from(whole.positions.len()).expect("fewer than 2^32 nodes");
        whole.positions.extend(&piece.positions);
        whole.triangles.extend(piece.triangles.iter().map(|t| t.map(|node| node + first)));
        whole.reference.extend(&piece.reference);
        whole.folds.extend(piece.folds.iter().map(|edge| edge.map(|node| node + first)));
    }
    whole
}

/// A shell whose nodes are moved; its reference stays.
pub fn moved(mut shell: Shell, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Shell {
    shell.positions.iter_mut().for_each(|position| *position = map(*position));
    shell
}

/// Nodes whose position has a property.
pub fn nodes_where(shell: &Shell, has: impl Fn(&Vector3<f64>) -> bool) -> Vec<u32> {
    (0_u32..).zip(&shell.positions).filter(|(_, x)| has(x)).map(|(node, _)| node).collect()
}

/// Pseudo-random vectors with components in [−1, 1), the same on every machine: a 64-bit linear
/// congruential generator with the constants of D. E. Knuth's MMIX.
pub fn pseudo_random(count: usize, seed: u64) -> Vec<Vector3<f64>> {
    let mut state = seed;
    let mut next = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| Vector3::new(next(), next(), next())).collect()
}

/// Film in the plane z = 0 that is its own reference.
fn in_plane(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Shell {
    let flat = |node: u32| -> Vector2<f64> { positions[node as usize].xy() };
    let reference = triangles.iter().map(|t: &[u32; 3]| t.map(flat)).collect();
    Shell { positions, triangles, reference, ..Shell::default() }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    fn relative_error(value: f64, expected: f64) -> f64 {
        (value / expected - 1.0).abs()
    }

    #[test]
    fn flat_shapes_have_their_area() {
        for (shell, area) in [
            (sheet(5, 4, 0.3, 0.2), 0.06),
            (grid(3, 7, 0.3, 0.2), 0.06),
            (crossed_grid(3, 7, 0.3, 0.2), 0.06),
            (strip(9, 0.5, 0.1), 0.05),
        ] {
            assert!(relative_error(shell.reference_area(), area) < 1e-14);
        }
        assert!(relative_error(disc(16, 0.5).reference_area(), PI * 0.25) < 2e-3);
    }

    #[test]
    fn closed_shapes_have_their_volume() {
        let volume = |shell: &Shell| shell.volume(|node| shell.positions[node as usize]);
        assert!(relative_error(volume(&icosphere(4, 0.5)), PI / 6.0) < 5e-3);
        assert_eq!(icosphere(0, 1.0).triangles.len(), 20);
    }

    #[test]
    fn pseudo_random_components_fill_their_range() {
        let vectors = pseudo_random(1000, 3);
        let components = || vectors.iter().flat_map(|v| v.iter().copied());
        assert!(components().all(|c| (-1.0..1.0).contains(&c)));
        assert!(components().any(|c| c > 0.99) && components().any(|c| c < -0.99));
        assert_eq!(vectors, pseudo_random(1000, 3));
        assert_ne!(vectors, pseudo_random(1000, 4));
    }
}
