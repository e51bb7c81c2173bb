//! The film of a scene, and the numbers that its user knows it by.

use billow_solver::geometry::mesh_io::obj_reader::Surface;
use billow_solver::geometry::shell::Shell;
use billow_solver::models::film::Rings;
use nalgebra::Vector3;

/// The film of a scene.
pub(super) struct Shape {
    /// The film: positions at the start, stress-free shape, triangles, closure.
    pub shell: Shell,
    pub numbering: Numbering,
    /// Positions of the nodes where the film is free of stress, m; `None` where they are those at the start, or where
    /// pieces are cut apart.
    pub unstressed: Option<Vec<Vector3<f64>>>,
    /// Rings of a capsule; `None` for any other mesh.
    pub rings: Option<Rings>,
    /// Rings and caps of a capsule by name, with their nodes in ascending order.
    pub regions: Vec<(&'static str, Vec<u32>)>,
    /// Centre nodes of a capsule by name.
    pub centres: Vec<(&'static str, u32)>,
    /// Whether it starts folded.
    pub folded: bool,
    /// Amplitude of the imperfection of a stowed capsule, m; `None` without one.
    pub imperfection_amplitude: Option<f64>,
    /// Stowed positions of the nodes of an erected capsule, m: its bottom ring is held there.
    pub stowed: Option<Vec<Vector3<f64>>>,
    /// Name of its file in errors; empty for a design.
    pub file: String,
}

impl Shape {
    /// Smallest and largest coordinates of the nodes, m.
    pub fn extents(&self) -> [Vector3<f64>; 2] {
        extents(&self.shell.positions)
    }

    /// Largest extent of the film, m.
    pub fn size(&self) -> f64 {
        let [low, high] = self.extents();
        (high - low).max()
    }
}

/// Smallest and largest coordinates of positions, m; 0 of none.
pub(super) fn extents(positions: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let first = positions.first().copied().unwrap_or_default();
    let (low, high) = positions.iter().fold((first, first), |(a, b), x| (a.inf(x), b.sup(x)));
    [low, high]
}

/// Maps the numbers of the user's mesh to those of the run: vertices to nodes, triangles (of faces,
/// in file order) to elements. For a design both are equal.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbering {
    /// The mesh as given, vertices in m.
    pub surface: Surface,
    /// Node of each vertex; `None` for a vertex without a face.
    pub node: Vec<Option<u32>>,
    /// Element of each triangle, the first of its pieces; `None` for a triangle that closes the volume.
    pub element: Vec<Option<u32>>,
    /// Pieces into which each triangle is cut.
    pub pieces: u32,
    /// Where the coordinates of the run begin in those of the file, m: 0 unless the film is far away.
    pub origin: Vector3<f64>,
}

impl Numbering {
    /// The triangle of an element in words: line of its face, vertices, a place.
    pub fn place(&self, element: usize) -> String {
        let element = u32::try_from(element).ok().map(|element| element - element % self.pieces);
        let triangle = self.element.iter().position(|known| known.is_some() && *known == element);
        let mut rest = triangle.unwrap_or_default();
        for face in &self.surface.faces {
            let triangles = face.corners.len() - 2;
            if rest < triangles {
                let corner = self.surface.vertices[face.corners[0] as usize] + self.origin;
                let [x, y, z] = corner.into();
                let vertices: Vec<String> =
                    face.corners.iter().map(|vertex| (vertex + 1).to_string()).collect();
                return format!(
                    "the face {} (vertices {}, at [{x}, {y}, {z}] m)",
                    face.place,
                    vertices.join(" ")
                );
            }
            rest -= triangles;
        }
        "a face".to_owned()
    }

    /// The face of each element, by its index in the surface.
    pub fn faces_of_elements(&self) -> Vec<usize> {
        let faces = self.surface.faces.iter().enumerate();
        let triangles = faces.flat_map(|(index, face)| vec![index; face.corners.len() - 2]);
        let film = triangles.zip(&self.element).filter(|(_, element)| element.is_some());
        film.flat_map(|(face, _)| vec![face; self.pieces as usize]).collect()
    }

    /// The first vertex of a node as the file counts them, from 1; 0 for a node that is not in it.
    pub fn obj_vertex(&self, node: u32) -> usize {
        self.vertex(node).map_or(0, |vertex| vertex + 1)
    }

    /// The first vertex of a node.
    pub fn vertex(&self, node: u32) -> Option<usize> {
        self.node.iter().position(|known| *known == Some(node))
    }
}
