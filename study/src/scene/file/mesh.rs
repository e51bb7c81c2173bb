//! `mesh`: film from files of any program. Vertices without a face are dropped, vertices that
//! coincide are joined only with `weld`; the user's numbers are kept.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use billow_solver::geometry::refinement::Refinement;
use billow_solver::geometry::shell::{Shell, ShellError};
use billow_solver::mechanics::closure::ClosureNodes;
use billow_solver::mechanics::supports::Supports;
use billow_solver::scene::film_scene::FilmScene;
use nalgebra::Vector3;

use super::cut;
use super::reader::Reader;
use super::reference::{flat_key, flattened, reference};
use super::shape::{Numbering, Shape, extents};
use super::weld;
use crate::input::json::Json;
use crate::input::keys::MESH_KEYS;
use crate::input::object::Object;
use crate::input::source::Source;
use crate::input::units::{self, Dimension};
use crate::platform::error::{InputError, Result};

fn object<'a>(json: &'a Json, source: &'a Source) -> Result<Object<'a>> {
    Ok(Object::new(json, "mesh", "a mesh", MESH_KEYS, &["reference", "closure"], source)?)
}

/// Length of one unit of the mesh files, m.
fn scale(object: &Object<'_>) -> std::result::Result<f64, InputError> {
    let Some(unit) = object.text("unit")? else { return object.needed("scale") };
    if object.given("scale").is_some() {
        let problem = "is given beside scale: both are the length of one unit of the files";
        return Err(object.error("unit", problem, "one of the two"));
    }
    units::parse(&format!("1 {unit}"), Dimension::Length).map_err(|_| {
        let allowed = format!("one of {}", Dimension::Length.units().join(", "));
        object.error("unit", "is not a unit of length", allowed)
    })
}

/// The surface at the start as its file has it, in m, and the name of the file.
fn surface_of(object: &Object<'_>, reader: &mut Reader) -> Result<(Surface, String)> {
    let given = object.given("positions").ok_or_else(|| object.missing("positions"))?;
    let scale = scale(object)?;
    let (mut surface, file) = reader.surface("mesh.positions", given)?;
    for vertex in &mut surface.vertices {
        *vertex *= scale;
    }
    Ok((surface, file))
}

/// The surface of `mesh` at the start as its file has it, in m.
pub(super) fn surface(json: &Json, reader: &mut Reader) -> Result<Surface> {
    let source = reader.source.clone();
    Ok(surface_of(&object(json, &source)?, reader)?.0)
}

/// Whether a mesh has a stress-free shape of its own.
pub(super) fn has_reference(mesh: &Json) -> bool {
    ["reference", "texture_unit"].iter().any(|key| mesh.get(key).is_some())
}

/// Reads `mesh`.
pub(super) fn read(json: &Json, reader: &mut Reader) -> Result<Shape> {
    let source = reader.source.clone();
    let object = object(json, &source)?;
    reader.needs.pieces = u64::from(object.count("subdivisions")?).pow(2);
    let (mut surface, file) = surface_of(&object, reader)?;
    let scale = scale(&object)?;
    let origin = origin(&surface.vertices);
    for vertex in &mut surface.vertices {
        *vertex -= origin;
    }
    if surface.faces.is_empty() {
        let problem = "has no faces";
        return Err(object.error("positions", problem, super::formats::FORMATS).into());
    }
    let tolerance = object.number("weld")?;
    let joined = weld::joined(&surface.vertices, tolerance);
    if tolerance.is_some() {
        let others = (0..).zip(&joined).filter(|(vertex, first)| *vertex != **first).count();
        reader.notes.push(format!("mesh.weld: vertices joined to others: {others}"));
    }
    let closes = closing_groups(&object, &surface)?;
    let film: Vec<bool> = surface.faces.iter().map(|face| !closes[face.names]).collect();
    if !film.contains(&true) {
        let problem = "names every face, so no face is film";
        return Err(object.error("closure", problem, "groups that leave some film").into());
    }
    let closing = surface.faces.iter().zip(&film).filter(|(_, film)| !**film);
    let closing: Vec<&Face> = closing.map(|(face, _)| face).collect();
    let node = weld::nodes(&surface, &joined, &film, &closing);
    let flat = reference(&object, &surface, &film, scale, reader)?;
    let has_reference = object.given("reference").is_some();
    let triangles = triangles(&surface, &flat, &object)?;
    let mut shell = Shell { positions: positions(&surface, &node), ..Shell::default() };
    let corners = |face: &Face, triangle: [usize; 3]| -> Result<[u32; 3]> {
        let node = |k: usize| node[face.corners[k] as usize].unwrap_or_default();
        let triangle = triangle.map(node);
        check_triangle(&file, face, triangle, &source)?;
        Ok(triangle)
    };
    let n = object.count("subdivisions")?;
    let pieces = n.saturating_mul(n);
    let mut element = Vec::new();
    let mut next = 0;
    for (index, (face, film)) in surface.faces.iter().zip(&film).enumerate() {
        for triangle in &triangles[index] {
            let nodes = corners(face, *triangle)?;
            if *film {
                shell.triangles.push(nodes);
                let flat = triangle.map(|corner| flat[index][corner]);
                shell.reference.push(flattened(flat, face, &object)?);
                element.push(Some(next));
                next += pieces;
            } else {
                shell.closure.push(nodes);
                element.push(None);
            }
        }
    }
    let numbering = Numbering { surface, node, element, pieces, origin };
    check_edges(&shell, &numbering, &file, &source)?;
    let mut unstressed = has_reference.then(|| unstressed(&shell, &numbering, &flat)).flatten();
    if n > 1 {
        let finer = Refinement::new(&shell, n);
        unstressed = unstressed.map(|corners| finer.at_nodes(&corners));
        shell = finer.shell(&shell);
    }
    Ok(Shape {
        shell,
        unstressed,
        numbering,
        rings: None,
        regions: Vec::new(),
        centres: Vec::new(),
        folded: false,
        imperfection_amplitude: None,
        stowed: None,
        file,
    })
}

/// Positions of the nodes where the film is free of stress, m; `None` where the corners of its faces at a node have
/// several.
fn unstressed(
    shell: &Shell,
    numbering: &Numbering,
    flat: &[Vec<Vector3<f64>>],
) -> Option<Vec<Vector3<f64>>> {
    let mut positions: Vec<Option<Vector3<f64>>> = vec![None; shell.positions.len()];
    let tolerance = EQUAL * shell.reference_area().sqrt();
    for (face, corners) in numbering.surface.faces.iter().zip(flat) {
        for (vertex, corner) in face.corners.iter().zip(corners) {
            let position = &mut positions[numbering.node[*vertex as usize]? as usize];
            if (position.get_or_insert(*corner).metric_distance(corner)) > tolerance {
                return None;
            }
        }
    }
    positions.into_iter().collect()
}

/// Distance of positions that count as one over the square root of the area of the film. Chosen: far above rounding.
const EQUAL: f64 = 1e-9;

/// Distance of a film from the origin of its file over its size from which the run has an origin of its own. Chosen:
/// coordinates lose two of their sixteen digits there.
const FAR: f64 = 100.0;

/// The middle of a film that is far from the origin of its file, m; 0 of any other.
fn origin(vertices: &[Vector3<f64>]) -> Vector3<f64> {
    let [low, high] = extents(vertices);
    let middle = (low + high) * 0.5;
    if middle.norm() > FAR * (high - low).norm() { middle } else { Vector3::zeros() }
}

/// Triangles of each face, as indices of its corners, cut where it is free of stress.
fn triangles(
    surface: &Surface,
    flat: &[Vec<Vector3<f64>>],
    object: &Object<'_>,
) -> Result<Vec<Vec<[usize; 3]>>> {
    let of_face = |(face, corners): (&Face, &Vec<Vector3<f64>>)| {
        cut::triangles(corners).ok_or_else(|| {
            let problem = format!(
                "the face {} has no area, or crosses itself, and cannot be cut into triangles",
                face.place
            );
            let allowed = "faces that do not cross themselves, in one plane or near it";
            object.error(flat_key(object), problem, allowed).into()
        })
    };
    surface.faces.iter().zip(flat).map(of_face).collect()
}

/// Position of each node: that of its first vertex, m.
fn positions(surface: &Surface, node: &[Option<u32>]) -> Vec<Vector3<f64>> {
    let mut vertices: Vec<(u32, u32)> =
        (0_u32..).zip(node).filter_map(|(vertex, node)| Some(((*node)?, vertex))).collect();
    vertices.sort_unstable();
    vertices.dedup_by_key(|(node, _)| *node);
    vertices.iter().map(|(_, vertex)| surface.vertices[*vertex as usize]).collect()
}

/// An error about the content of a file that a key names.
fn refuse(
    file: &str,
    key: &str,
    problem: impl Into<String>,
    allowed: impl Into<String>,
    source: &Source,
) -> InputError {
    source.error(key, Json::Text(file.to_owned()), problem, allowed)
}

/// For each list of names of the surface, whether its faces close the volume without being film.
fn closing_groups(object: &Object<'_>, surface: &Surface) -> Result<Vec<bool>> {
    let names = match object.given("closure") {
        None => Vec::new(),
        Some(Json::Text(name)) => vec![name.as_str()],
        Some(Json::List(items)) => {
            let names = items.iter().map(|item| match item {
                Json::Text(name) => Some(name.as_str()),
                _ => None,
            });
            let names: Option<Vec<&str>> = names.collect();
            let problem = "has an item that is not a name";
            names.ok_or_else(|| object.error("closure", problem, CLOSURE))?
        }
        Some(_) => {
            return Err(object
                .error("closure", "is not a name or a list of names", CLOSURE)
                .into());
        }
    };
    let mut known: Vec<&str> = surface.names.iter().flatten().map(String::as_str).collect();
    known.sort_unstable();
    known.dedup();
    if let Some(unknown) = names.iter().find(|name| !known.contains(*name)) {
        let problem = format!("{unknown:?} is not a group or object of positions");
        let allowed =
            if known.is_empty() { "the file names none".to_owned() } else { known.join(", ") };
        return Err(object.error("closure", problem, allowed).into());
    }
    let closes = |of_face: &Vec<String>| of_face.iter().any(|name| names.contains(&name.as_str()));
    Ok(surface.names.iter().map(closes).collect())
}

/// Refuses a vertex of closure that belongs to no film and that the rim of its faces does not place.
pub(super) fn check_closure(
    film: &FilmScene,
    numbering: &Numbering,
    source: &Source,
) -> std::result::Result<(), InputError> {
    let supports = Supports::new(&film.supports, &Field::of(&film.shell.positions));
    let Err(error) = ClosureNodes::new(&film.shell, |node| supports.hold_fully(node)) else {
        return Ok(());
    };
    let vertex = numbering.obj_vertex(error.node);
    let problem = format!(
        "vertex {vertex} (counted from 1) of its faces belongs to no film, and the rim of the faces does not \
         determine where it moves"
    );
    let allowed = "faces whose edge is film all round, with vertices that the edge surrounds";
    Err(source.error("mesh.closure", "", problem, allowed).with_hint("make the vertex part of the film, close the faces without it, or hold it with a support (fix xyz)"))
}

/// What `closure` may be, for errors.
const CLOSURE: &str = "names of groups or objects of positions";

/// Refuses a triangle whose corners welding has joined.
fn check_triangle(file: &str, face: &Face, [a, b, c]: [u32; 3], source: &Source) -> Result<()> {
    if a != b && b != c && a != c {
        return Ok(());
    }
    let problem = format!("welding leaves the face {} without area", face.place);
    let mut error = refuse(
        file,
        "mesh.positions",
        problem,
        "faces larger than the tolerance of mesh.weld",
        source,
    );
    "choose a smaller mesh.weld".clone_into(&mut error.hint);
    Err(error.into())
}

/// Most faces that a message names.
const MAX_SHOWN: usize = 4;

/// Refuses an edge with more than two faces, or with two faces wound against each other.
fn check_edges(shell: &Shell, numbering: &Numbering, file: &str, source: &Source) -> Result<()> {
    let Err(error) = shell.check() else { return Ok(()) };
    let ShellError::Edge { edge } = error else {
        let problem = error.to_string();
        return Err(refuse(file, "mesh.positions", problem, "", source).into());
    };
    let [a, b] = edge.map(|node| numbering.obj_vertex(node));
    let has = |triangle: &&[u32; 3]| edge.iter().all(|node| triangle.contains(node));
    let faces = shell.triangles.iter().chain(&shell.closure).filter(has).count();
    let of_film = (0..).zip(&shell.triangles).filter(|(_, triangle)| has(triangle));
    let places: Vec<String> =
        of_film.map(|(element, _)| numbering.place(element)).take(MAX_SHOWN).collect();
    let (problem, hint) = if faces > 2 {
        let hint = "delete the faces that are there twice or divide the volume inside";
        (format!("belongs to {faces} faces, at most two can meet there"), hint)
    } else {
        let hint = "recalculate the normals so that all point outward; wind faces of closure as those of film";
        ("has two faces that wind against each other".to_owned(), hint)
    };
    let problem = format!(
        "the edge between vertices {a} and {b} (counted from 1) {problem}: {}",
        places.join("; ")
    );
    let allowed = "a surface: at most two faces at each edge, all wound in one sense";
    Err(refuse(file, "mesh.positions", problem, allowed, source).with_hint(hint).into())
}
