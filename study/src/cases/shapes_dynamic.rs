//! Shapes of film the cases move.

use billow_solver::geometry::shell::Shell;
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use nalgebra::Vector3;

use super::rig::held;

/// A column of gas between two square plates of film, the walls no film.
#[derive(Debug, Clone)]
pub struct Column {
    /// Plates and walls.
    pub shell: Shell,
    /// Nodes of the lower plate.
    pub lower: Vec<u32>,
    /// Nodes of the upper plate.
    pub upper: Vec<u32>,
}

/// A column of this area (m²) and height (m), standing on z = 0.
pub fn column(area: f64, height: f64) -> Column {
    let half = 0.5 * area.sqrt();
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let plate = |z: f64| corners.map(|(x, y)| Vector3::new(x, y, z));
    let positions = [plate(0.0), plate(height)].concat();
    let mut shell = Shell::relaxed(positions, vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]);
    for side in 0..4_u32 {
        let next = (side + 1) % 4;
        shell.closure.extend([[side, next, next + 4], [side, next + 4, side + 4]]);
    }
    Column { shell, lower: (0..4).collect(), upper: (4..8).collect() }
}

impl Column {
    /// Both plates held: a rigid vessel.
    pub fn rigid(&self) -> Vec<FilmSupport> {
        vec![held([self.lower.clone(), self.upper.clone()].concat(), "xyz")]
    }

    /// The lower plate held, the upper one a rigid plane of this mass in all (kg, the film of this
    /// area density, kg/m², included) that moves along z at this speed (m/s) under a constant force
    /// (N).
    pub fn piston(&self, mass: f64, film: f64, speed: f64, force: f64) -> Vec<FilmSupport> {
        let plate = 0.5 * self.shell.reference_area() * film;
        let body = PlaneBody { normal: Vector3::z(), mass: mass - plate, velocity: speed, force };
        vec![
            held(self.lower.clone(), "xyz"),
            held(self.upper.clone(), "xy"),
            FilmSupport {
                name: "piston".to_owned(),
                nodes: self.upper.clone(),
                hold: Hold::Body(body),
                motion: None,
            },
        ]
    }
}

/// A flat sheet of uneven cells in z = 0, `width` × `height` m, nodes off the grid by a fixed
/// pattern; its reference is its own plane.
pub fn sheet(columns: u32, rows: u32, width: f64, height: f64) -> Shell {
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let mut positions = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let inside = i > 0 && j > 0 && i < columns && j < rows;
            let off = if inside { 0.04 * f64::from((i * 7 + j * 5) % 5) - 0.08 } else { 0.0 };
            let x = (f64::from(i) + off) / f64::from(columns) * width;
            let y = (f64::from(j) - 0.7 * off) / f64::from(rows) * height;
            positions.push(Vector3::new(x, y, 0.0));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if (i + j) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    in_plane(positions, triangles)
}

/// A strip along x of equal cells, all diagonals one way: every element the same.
pub fn strip(columns: u32, length: f64, width: f64) -> Shell {
    let row = |y: f64| {
        (0..=columns).map(move |i| Vector3::new(f64::from(i) / f64::from(columns) * length, y, 0.0))
    };
    let mut triangles = Vec::new();
    for a in 0..columns {
        let d = a + columns + 1;
        triangles.extend([[a, a + 1, d + 1], [a, d + 1, d]]);
    }
    in_plane(row(0.0).chain(row(width)).collect(), triangles)
}

/// A flat disc of rings: 6k nodes on ring k of `rings`, equal steps outward. Twice the rings is the
/// same disc with every element cut into four, so that what is computed on both has one smooth error.
pub fn disc(rings: u32, radius: f64) -> Shell {
    let first = |ring: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    let node = |ring: u32, k: u32| if ring == 0 { 0 } else { first(ring) + k % (6 * ring) };
    let mut positions = vec![Vector3::zeros()];
    for ring in 1..=rings {
        let r = radius * f64::from(ring) / f64::from(rings);
        for k in 0..6 * ring {
            let angle = core::f64::consts::TAU * f64::from(k) / f64::from(6 * ring);
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

/// Nodes of the rim of a [`disc`] of so many rings.
pub fn rim(rings: u32) -> Vec<u32> {
    (1 + 3 * rings * (rings - 1)..=3 * rings * (rings + 1)).collect()
}

/// Film in the plane z = 0, its own reference.
fn in_plane(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Shell {
    let flat = |node: u32| positions[node as usize].xy();
    let reference = triangles.iter().map(|t| t.map(flat)).collect();
    Shell { positions, triangles, reference, closure: Vec::new() }
}

/// An icosahedron, every face cut into four `level` times, on a sphere.
///
/// # Panics
/// Beyond 2^32 nodes.
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
                let sides = [(p - q).norm(), (q - r).norm(), (r - p).norm()];
                if sides.iter().all(|side| (side - 2.0).abs() < 1e-9) {
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
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |p: u32, q: u32| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    let place = nodes[p as usize] + nodes[q as usize];
                    nodes.push(place.normalize() * radius);
                    u32::try_from(nodes.len() - 1).expect("under 2^32 nodes")
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Shell::relaxed(nodes, triangles)
}

/// A fixed pattern of vectors within ±1 a component.
pub fn pattern(length: usize, seed: u64) -> Vec<Vector3<f64>> {
    let mut state = seed;
    let mut next = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..length).map(|_| Vector3::new(next(), next(), next())).collect()
}

/// An open tube about z from z = 0 on: `around` cells round, `along` up, wound outward.
pub fn tube(around: u32, along: u32, radius: f64, length: f64) -> Shell {
    let mut positions = Vec::new();
    for row in 0..=along {
        for k in 0..around {
            let angle = core::f64::consts::TAU * f64::from(k) / f64::from(around);
            let (sin, cos) = libm::sincos(angle);
            let z = length * f64::from(row) / f64::from(along);
            positions.push(Vector3::new(radius * cos, radius * sin, z));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..along {
        for k in 0..around {
            let next = (k + 1) % around;
            let [a, b] = [row * around + k, row * around + next];
            triangles.extend([[a, b, b + around], [a, b + around, a + around]]);
        }
    }
    Shell::relaxed(positions, triangles)
}
