//! Shapes of film the cases inflate, pull and turn.

use core::f64::consts::TAU;

use billow_solver::geometry::shell::Shell;
use nalgebra::{Vector2, Vector3};

/// Rings of nodes, each of `around`, joined by two elements a cell; ring k at radius and height
/// `place(k)` of `rings` + 1. Outward is away from the axis where heights rise. Diagonals lean one
/// way, so that every node bears the same; or both in turn (`crossed`), so that the mesh has no turn
/// of its own.
pub fn revolved(rings: u32, around: u32, crossed: bool, place: impl Fn(u32) -> [f64; 2]) -> Shell {
    let mut positions = Vec::new();
    for ring in 0..=rings {
        let [radius, height] = place(ring);
        for i in 0..around {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(around));
            positions.push(Vector3::new(radius * cos, radius * sin, height));
        }
    }
    let at = |ring: u32, i: u32| ring * around + i % around;
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for i in 0..around {
            let [a, b] = [at(ring, i), at(ring, i + 1)];
            let [c, d] = [at(ring + 1, i + 1), at(ring + 1, i)];
            if !crossed || (ring + i) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    Shell::relaxed(positions, triangles)
}

/// A flat disc whose elements lie along its radii: `rings` equal steps outward, `around` nodes on
/// each ring, one in the middle, node 0 of the last ring first.
pub fn polar(rings: u32, around: u32, radius: f64) -> Shell {
    let shell = revolved(rings - 1, around, false, |k| {
        [radius * f64::from(rings - k) / f64::from(rings), 0.0]
    });
    let Shell { mut positions, mut triangles, .. } = shell;
    let middle = u32::try_from(positions.len()).expect("under 2^32 nodes");
    positions.push(Vector3::zeros());
    let last = ring(rings - 1, around);
    for i in 0..around as usize {
        triangles.push([last[i], last[(i + 1) % around as usize], middle]);
    }
    Shell::relaxed(positions, triangles)
}

/// Nodes of one ring of [`revolved`].
pub fn ring(ring: u32, around: u32) -> Vec<u32> {
    (ring * around..(ring + 1) * around).collect()
}

/// A grid in z = 0 from the origin, `columns` × `rows` equal cells, all cut along the diagonal from
/// the lower left to the upper right; its reference is its own plane.
pub fn grid(columns: u32, rows: u32, width: f64, height: f64) -> Shell {
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let x = f64::from(i) / f64::from(columns) * width;
            let y = f64::from(j) / f64::from(rows) * height;
            positions.push(Vector3::new(x, y, 0.0));
            if i < columns && j < rows {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let flat = |node: u32| -> Vector2<f64> { Vector3::xy(&positions[node as usize]) };
    let reference = triangles.iter().map(|t: &[u32; 3]| t.map(flat)).collect();
    Shell { positions, triangles, reference, closure: Vec::new() }
}

/// Nodes whose place answers a question.
pub fn nodes_where(shell: &Shell, is: impl Fn(&Vector3<f64>) -> bool) -> Vec<u32> {
    (0_u32..).zip(&shell.positions).filter(|(_, place)| is(place)).map(|(node, _)| node).collect()
}

/// A frustum of film with flat circular caps, its elements near the rims smaller: `fine` steps from
/// a cap's centre to its rim, twice as many along the side. Bottom rim at z = 0.
#[derive(Debug, Clone)]
pub struct Capped {
    /// The film.
    pub shell: Shell,
    /// Nodes of the bottom and the top rim.
    pub rims: [Vec<u32>; 2],
    /// Nodes in the middle of the bottom and the top cap.
    pub poles: [u32; 2],
}

/// A capped frustum of these radii and this height, m.
pub fn capped(fine: u32, [bottom, top]: [f64; 2], height: f64) -> Capped {
    let around = 6 * fine;
    let side = 2 * fine;
    // A cosine crowds the rings at both rims.
    let share = |k: u32, of: u32| {
        0.5 - 0.5 * libm::cos(core::f64::consts::PI * f64::from(k) / f64::from(of))
    };
    // Towards a cap's rim alone.
    let out = |k: u32| libm::sin(0.25 * TAU * f64::from(k) / f64::from(fine));
    let rings = 2 * (fine - 1) + side;
    let shell = revolved(rings, around, false, |k| {
        if k < fine {
            [bottom * out(k + 1), 0.0]
        } else if k <= fine - 1 + side {
            let at = share(k + 1 - fine, side);
            [bottom + (top - bottom) * at, height * at]
        } else {
            [top * out(rings + 1 - k), height]
        }
    });
    let Shell { mut positions, mut triangles, .. } = shell;
    let next = u32::try_from(positions.len()).expect("under 2^32 nodes");
    let poles = [next, next + 1];
    positions.extend([Vector3::zeros(), Vector3::new(0.0, 0.0, height)]);
    let (first, last) = (ring(0, around), ring(rings, around));
    for i in 0..around as usize {
        let j = (i + 1) % around as usize;
        triangles.push([poles[0], first[j], first[i]]);
        triangles.push([poles[1], last[i], last[j]]);
    }
    let rims = [ring(fine - 1, around), ring(fine - 1 + side, around)];
    Capped { shell: Shell::relaxed(positions, triangles), rims, poles }
}
