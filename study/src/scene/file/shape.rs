//! The film of a scene, a design's or a mesh's, and the numbers its user knows it by.

use billow_solver::geometry::fold::{Caps, FoldError, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Part, Shape as State};
use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use billow_solver::geometry::shell::Shell;
use billow_solver::models::film::Rings;
use billow_solver::models::film::capsule::{imperfect, part_nodes};
use billow_solver::platform::simd::InstructionSet;
use nalgebra::Vector3;

use super::{Reader, mesh};
use crate::input::settings::{Settings, design, film, unsigned};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::value::short_number;
use crate::platform::error::{InputError, Result};

/// The film of a scene.
pub(super) struct Shape {
    pub shell: Shell,
    pub numbering: Numbering,
    /// What makes it a capsule.
    pub rings: Option<Rings>,
    /// Named places of a capsule and their nodes, in ascending order.
    pub places: Vec<(&'static str, Vec<u32>)>,
    /// Named nodes of a capsule.
    pub centres: Vec<(&'static str, u32)>,
    /// Whether it starts folded.
    pub folded: bool,
    /// Where the nodes of an erected capsule are stowed: where its bottom ring is held.
    pub seats: Option<Vec<Vector3<f64>>>,
    /// Its file, as errors call it; empty for a design.
    pub file: String,
}

impl Shape {
    /// Largest extent of the film, m.
    pub fn size(&self) -> f64 {
        let places = &self.shell.positions;
        let first = places.first().copied().unwrap_or_default();
        let (low, high) = places.iter().fold((first, first), |(a, b), x| (a.inf(x), b.sup(x)));
        (high - low).max()
    }
}

/// From the numbers of the user's mesh to those of the run: vertices to nodes, triangles (faces cut
/// into fans, in file order) to elements. Those of a design are its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbering {
    /// The mesh as given, vertices in m.
    pub surface: Surface,
    /// Node of each vertex; none of those no face uses.
    pub node: Vec<Option<u32>>,
    /// Element of each triangle; none of those that close the volume.
    pub element: Vec<Option<u32>>,
}

impl Numbering {
    /// The first vertex of a node.
    pub fn vertex(&self, node: u32) -> Option<usize> {
        self.node.iter().position(|own| *own == Some(node))
    }
}

/// Reads `design` or `mesh`.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    reader: &mut Reader,
    instruction_set: InstructionSet,
) -> Result<Shape> {
    match (tree.get("design"), tree.get("mesh")) {
        (Some(_), None) => Ok(capsule(settings, &reader.source, instruction_set)?),
        (None, Some(json)) => mesh::read(json, reader),
        (given, _) => {
            let problem = if given.is_some() {
                "gives both design and mesh"
            } else {
                "gives neither design nor mesh"
            };
            let allowed = "one of design (a capsule) and mesh (OBJ files)";
            Err(reader.source.error("", "", problem, allowed).into())
        }
    }
}

/// Most elements of a capsule.
const MOST_ELEMENTS: u64 = 4_000_000;

fn capsule(
    settings: &Settings,
    source: &Source,
    instruction_set: InstructionSet,
) -> std::result::Result<Shape, InputError> {
    let design = design(settings, source)?;
    let statics = settings.flag("solver.static");
    let word = settings.maybe_text("design.shape");
    let erected = word.map_or(statics, |word| word == "erected");
    let (n, elements) = (design.subdivisions, design.elements());
    if elements > MOST_ELEMENTS {
        let problem = format!("makes a capsule of {elements} elements");
        let allowed = format!("fewer: 2 N (M + 1) n² up to {MOST_ELEMENTS}");
        return Err(source.error("design.subdivisions", &n.to_string(), problem, allowed));
    }
    if design.caps == Caps::Circular && !erected {
        return Err(source.error(
            "design.caps",
            "\"circular\"",
            "cannot be folded: a disc sewn to a flat-folded N-gon strains",
            "polygon; or shape erected",
        ));
    }
    let fold_error = |error: FoldError| match error {
        FoldError::Invalid { key, problem } => {
            source.error(&format!("design.{key}"), "", problem, "")
        }
        FoldError::Infeasible { reason, nearest } => {
            let near: Vec<String> = nearest
                .iter()
                .map(|near| format!("{} {}", near.key, short_number(near.value)))
                .collect();
            let allowed = if near.is_empty() {
                String::new()
            } else {
                format!("a design some pattern meets; nearest, each alone: {}", near.join(", "))
            };
            source.error("design", "", format!("infeasible: {reason}"), allowed)
        }
    };
    let pattern = FoldPattern::new(&design).map_err(fold_error)?;
    let state = if erected { State::Erected } else { State::Stowed(design.stowed_height) };
    let mut mesh = Mesh::new(&pattern, design.subdivisions, state).map_err(fold_error)?;
    if !erected {
        let seed = unsigned(settings, "seed", source)?;
        imperfect(instruction_set, &mut mesh, &film(settings, source)?, seed)
            .map_err(|error| source.error("seed", "", error.to_string(), ""))?;
    }
    let seats = if erected && design.caps == Caps::Polygon {
        let stowed = State::Stowed(design.stowed_height);
        Some(Mesh::new(&pattern, design.subdivisions, stowed).map_err(fold_error)?.positions)
    } else {
        None
    };
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    Ok(Shape {
        shell: Shell::of_mesh(&mesh),
        rings: Some(Rings::of(&mesh, design.stowed_height)),
        places: vec![
            ("bottom_ring", sorted(&mesh.bottom_ring)),
            ("top_ring", sorted(&mesh.top_ring)),
            ("bottom_cap", part_nodes(&mesh, Part::BottomCap)),
            ("top_cap", part_nodes(&mesh, Part::TopCap)),
        ],
        centres: vec![("bottom_centre", mesh.bottom_centre), ("top_centre", mesh.top_centre)],
        folded: !erected,
        seats,
        numbering: numbered(mesh),
        file: String::new(),
    })
}

/// A capsule's mesh as a surface of its own numbers.
fn numbered(mesh: Mesh) -> Numbering {
    let nodes = u32::try_from(mesh.positions.len()).expect("under 2^32 nodes");
    let elements = u32::try_from(mesh.triangles.len()).expect("under 2^32 elements");
    let mut surface = Surface { vertices: mesh.positions, ..Surface::default() };
    for (triangle, part) in mesh.triangles.iter().zip(&mesh.parts) {
        let name = billow_solver::geometry::mesh_io::obj::name(*part);
        if surface.names.last().is_none_or(|names| names[0] != name) {
            surface.names.push(vec![name]);
        }
        let names = surface.names.len() - 1;
        surface.faces.push(Face { corners: triangle.to_vec(), names, line: 0 });
    }
    Numbering {
        surface,
        node: (0..nodes).map(Some).collect(),
        element: (0..elements).map(Some).collect(),
    }
}
