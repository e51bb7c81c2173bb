//! Pieces of film that enclose a volume each: their sense, and which lies inside which.
//!
//! ```text
//! w(x) = Σ Ω_f/4π        winding number of a piece about x: Ω_f solid angle of face f;  ±1 inside, 0 outside
//! tan(Ω/2) = a·(b × c) / (|a||b||c| + a·b |c| + b·c |a| + c·a |b|)      a, b, c: corners from x
//! ```
//! A. Van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30 (1983).

use billow_solver::geometry::shell::Shell;
use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::json::Json;
use crate::input::source::Source;
use crate::input::value::brief_number;
use crate::platform::error::InputError;

/// Pieces of which the nesting is looked at, at most: each is compared with each.
const MAX_PIECES: usize = 64;
/// Faces of a piece whose vertices are asked where they lie, at most.
const MAX_VERTICES: usize = 16;

/// Largest enclosed volume that counts as zero, as a fraction of A^(3/2) of the film's area A (chosen:
/// far above rounding).
pub(super) const ZERO_VOLUME: f64 = 1e-12;

/// A connected piece of film with its closing faces.
pub struct Piece {
    /// Film and closing faces.
    pub faces: Vec<[u32; 3]>,
    /// Enclosed volume, m³; of an open piece that of the cone from its first vertex.
    pub volume: f64,
    /// Area of its faces, m².
    area: f64,
}

impl Piece {
    /// Whether it encloses nothing, as layers that lie on each other do.
    fn is_flat(&self) -> bool {
        self.volume.abs() <= ZERO_VOLUME * self.area * self.area.sqrt()
    }
}

/// Refuses a closed piece of several whose faces are wound inward, and notes one whose volume counts twice.
pub(super) fn check(
    shape: &Shape,
    notes: &mut Vec<String>,
    source: &Source,
) -> Result<(), InputError> {
    let pieces = pieces(&shape.shell);
    if !shape.shell.is_closed() || pieces.len() < 2 || pieces.len() > MAX_PIECES {
        return Ok(());
    }
    let at = |node: u32| shape.shell.positions[node as usize];
    for (index, piece) in pieces.iter().enumerate() {
        let first = piece.faces[0][0];
        let vertices = some_vertices(piece);
        // Most vertices: those of a piece that stands on another one may lie on its face.
        let inside = |(other, around): &(usize, &Piece)| {
            let within = |node: &&u32| winding(around, at(**node), at).abs() > 0.5;
            *other != index && 2 * vertices.iter().filter(within).count() > vertices.len()
        };
        if piece.is_flat() {
            continue;
        }
        let around: Vec<usize> =
            pieces.iter().enumerate().filter(inside).map(|(other, _)| other).collect();
        let is_cavity = around.len() % 2 == 1;
        let vertex = shape.numbering.obj_vertex(first);
        let position: [f64; 3] = (at(first) + shape.numbering.origin).into();
        let place = format!(
            "piece {} of {} (with vertex {vertex}, counted from 1, at {position:?} m)",
            index + 1,
            pieces.len()
        );
        let volume = brief_number(piece.volume);
        if is_cavity && piece.volume > 0.0 {
            notes.push(format!(
                "{place} lies inside another one and is wound as that is: its {volume} m³ count twice; reverse its \
                 faces if it is a cavity"
            ));
        } else if !is_cavity && piece.volume < 0.0 {
            let problem =
                format!("{place} encloses {volume} m³: its faces are wound inward, others outward");
            let allowed = "faces counter-clockwise seen from outside, in each piece";
            let file = Json::Text(shape.file.clone());
            let error = source.error("mesh.positions", file, problem, allowed);
            return Err(error.with_hint("flip the normals of this piece"));
        }
    }
    Ok(())
}

/// The pieces, in the order of their first face.
pub fn pieces(shell: &Shell) -> Vec<Piece> {
    let mut first: Vec<usize> = (0..shell.positions.len()).collect();
    let faces = || shell.triangles.iter().chain(&shell.closure);
    for face in faces() {
        let [a, b, c] = face.map(|node| root(&mut first, node as usize));
        let least = a.min(b).min(c);
        for node in [a, b, c] {
            first[node] = least;
        }
    }
    let mut index: Vec<Option<usize>> = vec![None; first.len()];
    let mut pieces: Vec<Piece> = Vec::new();
    for face in faces() {
        let root = root(&mut first, face[0] as usize);
        let piece = *index[root].get_or_insert_with(|| {
            pieces.push(Piece { faces: Vec::new(), volume: 0.0, area: 0.0 });
            pieces.len() - 1
        });
        pieces[piece].faces.push(*face);
    }
    for piece in &mut pieces {
        let origin = shell.positions[piece.faces[0][0] as usize];
        let six = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|node| shell.positions[node as usize] - origin);
            a.dot(&b.cross(&c))
        };
        piece.volume = piece.faces.iter().map(six).sum::<f64>() / 6.0;
        let twice = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|node| shell.positions[node as usize]);
            (b - a).cross(&(c - a)).norm()
        };
        piece.area = piece.faces.iter().map(twice).sum::<f64>() / 2.0;
    }
    pieces
}

/// The first node of the set that a node belongs to (union-find).
fn root(first: &mut [usize], mut node: usize) -> usize {
    while first[node] != node {
        first[node] = first[first[node]];
        node = first[node];
    }
    node
}

/// Vertices of a piece, evenly among its faces.
fn some_vertices(piece: &Piece) -> Vec<u32> {
    let every = piece.faces.len().div_ceil(MAX_VERTICES);
    piece.faces.iter().step_by(every).flatten().copied().collect()
}

/// Winding number of a piece about a position, m.
fn winding(piece: &Piece, about: Vector3<f64>, at: impl Fn(u32) -> Vector3<f64>) -> f64 {
    let solid_angle = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|node| at(node) - about);
        let [x, y, z] = [a.norm(), b.norm(), c.norm()];
        let lower = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        2.0 * libm::atan2(a.dot(&b.cross(&c)), lower)
    };
    piece.faces.iter().map(solid_angle).sum::<f64>() / (4.0 * core::f64::consts::PI)
}
