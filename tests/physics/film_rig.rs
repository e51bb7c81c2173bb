//! Small films for the tests of the explicit solver.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::explicit::{Explicit, Parameters, PressureLoad};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::forces::membrane::{NodeForces, ViscousHistory, assemble_membrane};
use billow_solver::mechanics::gas::{Gas, GasState};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Film;
use billow_solver::scene::timeline::Phase;
use nalgebra::{Vector2, Vector3};

use crate::rig::{PAPER_FILM, supply};

/// Film without viscosity, tension field.
pub const ELASTIC: Film = Film { viscosity: 0.0, ..PAPER_FILM };

/// Nodes, triangles and flat references of a piece of film.
#[derive(Clone)]
pub struct Piece {
    pub nodes: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    pub reference: Vec<[Vector2<f64>; 3]>,
}

impl Piece {
    /// A piece that is stress free where it is, each element laid flat by itself.
    pub fn relaxed(nodes: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Self {
        let Shell { positions, triangles, reference, .. } = Shell::relaxed(nodes, triangles);
        Self { nodes: positions, triangles, reference }
    }

    pub fn model(&self, film: &Film) -> FilmModel {
        FilmModel::new(film, self.nodes.len(), &self.triangles, &self.reference).expect("a film")
    }
}

/// A flat sheet of uneven cells, `width` × `height` m, nodes off the grid by a fixed pattern.
pub fn sheet(columns: u32, rows: u32, width: f64, height: f64) -> Piece {
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let mut nodes = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let inside = i > 0 && j > 0 && i < columns && j < rows;
            let off = if inside { 0.2 * f64::from((i * 7 + j * 5) % 5) / 5.0 - 0.08 } else { 0.0 };
            let x = (f64::from(i) + off) / f64::from(columns) * width;
            let y = (f64::from(j) - 0.7 * off) / f64::from(rows) * height;
            nodes.push(Vector3::new(x, y, 0.0));
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
    let flat = |node: u32| nodes[node as usize].xy();
    let reference = triangles.iter().map(|t| t.map(flat)).collect();
    Piece { nodes, triangles, reference }
}

/// An icosahedron, every face cut into four `level` times, on a sphere.
pub fn icosphere(level: u32, radius: f64) -> Piece {
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
    assert_eq!(triangles.len(), 20);
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
                    nodes.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Piece::relaxed(nodes, triangles)
}

/// Film forces on nodes at these places, at rest.
pub fn film_forces(model: &FilmModel, places: &Field) -> NodeForces {
    let mut nodes = NodeForces::new(model);
    let past = &mut ViscousHistory::at_rest(model);
    let _ = assemble_membrane(InstructionSet::detect(), model, places, 0.0, past, &mut nodes);
    nodes
}

/// Places of a piece under x = F X + t, and the field of them.
pub fn mapped(piece: &Piece, mut map: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Field {
    Field::of(&piece.nodes.iter().map(|node| map(*node)).collect::<Vec<_>>())
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

/// A piece of film at rest where it is stress free.
pub fn at_rest(piece: &Piece, film: &Film, interior: PressureLoad, gas: GasState) -> Explicit {
    let viscosity = film.viscosity;
    let setting = Parameters { viscosity, ..Parameters::free(interior, piece.nodes.len()) };
    let still = Field::zeros(piece.nodes.len());
    Explicit::new(piece.model(film), setting, Field::of(&piece.nodes), still, gas)
}

pub fn free() -> Phase {
    Phase::default()
}

pub fn nitrogen_gas() -> Gas {
    Gas::new(&supply(), 293.0, 1.0)
}

/// Order of convergence of three errors on meshes halved each time.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).abs().log2()).collect()
}
