//! `design`: a capsule, folded or erected.

use billow_solver::geometry::fold::{Caps, FoldDesign, FoldError, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Part, Shape as State};
use billow_solver::geometry::mesh_io::obj;
use billow_solver::geometry::mesh_io::obj_reader::{Face, Place, Surface};
use billow_solver::geometry::shell::Shell;
use billow_solver::models::film::Rings;
use billow_solver::models::film::capsule::{imperfect, part_nodes};
use nalgebra::Vector3;

use super::memory::Needs;
use super::shape::{Numbering, Shape};
use crate::input::keys::SHAPES;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::short_number;
use crate::platform::error::InputError;

/// Largest number of elements of a capsule (chosen: a larger mesh is an error in `subdivisions`).
const MAX_ELEMENTS: u64 = 4_000_000;

/// Reads the film of a design.
pub(super) fn read(
    settings: &Settings,
    needs: Needs,
    source: &Source,
) -> Result<Shape, InputError> {
    let design = &settings.fold_design(source)?;
    let erected = settings.picked("design.shape", &SHAPES).unwrap_or(needs.statics);
    check(design, erected, source)?;
    let stack = (!erected).then_some([design.panels, design.storeys]);
    needs.check_capsule(design.elements(), stack, design.subdivisions, source)?;
    let fold_error = |error: FoldError| fold_error(error, source);
    let pattern = FoldPattern::new(design).map_err(fold_error)?;
    let stowed = State::Stowed(design.stowed_height);
    let state = if erected { State::Erected } else { stowed };
    let mut mesh = Mesh::new(&pattern, design.subdivisions, state).map_err(fold_error)?;
    let imperfection_amplitude = if erected {
        None
    } else {
        let seed = settings.whole("seed", source)?;
        imperfect(&mut mesh, design, seed, settings.number("imperfection_amplitude"))
            .map_err(|error| source.error("seed", "", error.to_string(), ""))?
    };
    let stowed = if erected && design.caps == Caps::Polygon {
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
        unstressed: None,
        rings: Some(Rings::of(&mesh, design.stowed_height)),
        regions: vec![
            ("bottom_ring", sorted(&mesh.bottom_ring)),
            ("top_ring", sorted(&mesh.top_ring)),
            ("bottom_cap", part_nodes(&mesh, Part::BottomCap)),
            ("top_cap", part_nodes(&mesh, Part::TopCap)),
        ],
        centres: vec![("bottom_centre", mesh.bottom_centre), ("top_centre", mesh.top_centre)],
        folded: !erected,
        imperfection_amplitude,
        stowed,
        numbering: numbering(mesh),
        file: String::new(),
    })
}

/// Refuses a mesh that is too large, and discs on a folded capsule.
fn check(design: &FoldDesign, erected: bool, source: &Source) -> Result<(), InputError> {
    let (n, elements) = (design.subdivisions, design.elements());
    if elements > MAX_ELEMENTS {
        let problem = format!("makes a capsule of {elements} elements");
        let allowed = format!("fewer: 2 N (M + 1) n² up to {MAX_ELEMENTS}");
        return Err(source.error("design.subdivisions", n.to_string(), problem, allowed));
    }
    if design.caps == Caps::Circular && !erected {
        return Err(source.error(
            "design.caps",
            "\"circular\"",
            "cannot be folded: a disc sewn to a flat-folded N-gon strains",
            "polygon; or shape erected",
        ));
    }
    Ok(())
}

/// The error of a design without a pattern.
fn fold_error(error: FoldError, source: &Source) -> InputError {
    match error {
        FoldError::Invalid { key, problem } => {
            source.error(&format!("design.{key}"), "", problem, "what `billow keys design` lists")
        }
        FoldError::Infeasible { reason, nearest } => {
            let near: Vec<String> = nearest
                .iter()
                .map(|near| format!("{} {}", near.key, short_number(near.value)))
                .collect();
            let allowed = if near.is_empty() {
                "a feasible design; try others with `billow fold`".to_owned()
            } else {
                format!("a feasible design; nearest, each change alone: {}", near.join(", "))
            };
            source.error("design", "", format!("infeasible: {reason}"), allowed)
        }
    }
}

/// The numbers of a capsule: those of its mesh.
fn numbering(mesh: Mesh) -> Numbering {
    let nodes = u32::try_from(mesh.positions.len()).expect("under 2^32 nodes");
    let elements = u32::try_from(mesh.triangles.len()).expect("under 2^32 elements");
    let mut surface = Surface { vertices: mesh.positions, ..Surface::default() };
    for (triangle, part) in mesh.triangles.iter().zip(&mesh.parts) {
        let name = obj::name(*part);
        if surface.names.last().is_none_or(|names| names[0] != name) {
            surface.names.push(vec![name]);
        }
        let names = surface.names.len() - 1;
        let place = Place::Number(surface.faces.len() + 1);
        surface.faces.push(Face { corners: triangle.to_vec(), names, texture: Vec::new(), place });
    }
    Numbering {
        surface,
        node: (0..nodes).map(Some).collect(),
        element: (0..elements).map(Some).collect(),
        pieces: 1,
        origin: Vector3::zeros(),
    }
}
