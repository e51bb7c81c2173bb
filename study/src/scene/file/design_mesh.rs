//! `design.mesh` of a study: film from a mesh in place of a folded capsule, read and judged once for all its points.
//!
//! ```text
//! {"mesh": "bag.obj", "unit": "mm"}  →  Shape, supports, closed volume  →  MeshDesign;  the surfaces as OBJ text
//! ```
//! A results folder holds the text of the surfaces in its study.json, so that it needs no other file.

use std::path::Path;
use std::sync::Arc;

use billow_solver::geometry::mesh_io::obj;
use billow_solver::geometry::shell::Shell;
use billow_solver::models::film::capsule;
use billow_solver::platform::seal::hexadecimal;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::{Filling, FilmContact, FilmOutputs, FilmScene, FilmSolver};
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::{MeshDesign, MeshFilm};
use nalgebra::Vector3;
use sha2::{Digest, Sha256};

use super::components::ZERO_VOLUME;
use super::contact::Start;
use super::memory::Needs;
use super::reader::Reader;
use super::{Checked, conflicts, contact, far_away, filling, judge, mesh, scene_error, supports};
use crate::input::json::Json;
use crate::input::sections::has_mesh;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::memory;

/// Default amplitude of the imperfection over the contact distance of the mesh as its file has it. Chosen: as that of a
/// capsule.
const AMPLITUDE_PER_DISTANCE: f64 = 0.5;
/// Keys of `design` beside `mesh`.
const BESIDE: [&str; 3] = ["mesh", "unit", "subdivisions"];

/// Film from a mesh in a study.
pub(crate) struct StudyMesh {
    /// The film.
    pub design: MeshDesign,
    /// `design.mesh` as a results folder keeps it.
    pub stored: Json,
    /// What a reader of its results must know.
    pub notes: Vec<String>,
}

/// Reads the film of a study from its mesh, each triangle of which is cut into n² pieces; `None` for a capsule. `settings`
/// are those of the file, without its grid.
///
/// # Errors
/// A mesh file that cannot be read; film that no run can start from, with its place; the first wrong key.
pub(crate) fn read(
    tree: &Json,
    settings: &Settings,
    n: u32,
    source: &Source,
) -> Checked<Option<StudyMesh>> {
    let Some(design) = tree.get("design").filter(|_| has_mesh(tree)) else { return Ok(None) };
    let mut json = as_object(design, source)?;
    json.set("subdivisions", Json::Integer(n.into()));
    let path = Path::new(&source.file);
    let mut reader = Reader { source: source.clone(), keep: Some(Vec::new()), ..Reader::new(path) };
    let read = film((&json, n), tree, settings, &mut reader).map_err(|error| match error {
        Error::Input(error) => in_design(error),
        other => source.error("design.mesh", named(&json), other.to_string(), ""),
    })?;
    Ok(Some(read))
}

/// Puts `design.mesh` as a results folder keeps it into a study.
pub(crate) fn store(tree: &mut Json, mesh: Json) {
    if let Some(design) = tree.get_mut("design") {
        if let Json::Object(members) = design {
            members.retain(|(name, _)| name != "unit");
        }
        design.set("mesh", mesh);
    }
}

/// `design.mesh` as an object with the keys of a scene's `mesh`.
fn as_object(design: &Json, source: &Source) -> Checked<Json> {
    if let Json::Object(members) = design
        && let Some((name, value)) =
            members.iter().find(|(name, _)| !BESIDE.contains(&name.as_str()))
    {
        let problem = "is given beside mesh, which has no fold pattern";
        return Err(source.error(
            &format!("design.{name}"),
            value,
            problem,
            "mesh, unit and subdivisions, or a design without mesh",
        ));
    }
    let mut mesh = match design.get("mesh") {
        Some(mesh @ Json::Object(_)) => mesh.clone(),
        Some(name @ Json::Text(_)) => Json::Object(vec![("positions".to_owned(), name.clone())]),
        other => {
            let other = other.unwrap_or(&Json::Null);
            let allowed = "the name of a file, or an object as in {\"positions\": \"bag.obj\", \"reference\": \"flat.obj\"}";
            return Err(source.error("design.mesh", other, "is not a mesh", allowed));
        }
    };
    if let Some(n) = mesh.get("subdivisions") {
        let (key, problem) = ("design.mesh.subdivisions", "is that of a scene");
        return Err(source.error(key, n, problem, "design.subdivisions, which the grid can vary"));
    }
    if let Some(unit) = design.get("unit") {
        mesh.set("unit", unit.clone());
    }
    Ok(mesh)
}

fn film(
    (json, n): (&Json, u32),
    tree: &Json,
    settings: &Settings,
    reader: &mut Reader,
) -> Result<StudyMesh> {
    let source = reader.source.clone();
    reader.needs = Needs { contact: true, statics: true, bending: None, pieces: 1 };
    let mut shape = mesh::read(json, reader)?;
    let unstressed = shape.unstressed.take();
    let mut notes = std::mem::take(&mut reader.notes);
    let supports = supports::read(tree, settings, &shape, &source)?;
    let nodes = shape.shell.positions.len();
    notes.extend(supports.iter().map(|FilmSupport { name, nodes: held, .. }| {
        format!("support {name} is on {} of {nodes} nodes", held.len())
    }));
    filling::closed(&mut shape, &supports, &mut notes, &source)?;
    conflicts::check(&supports, &shape, &source)?;
    let moves =
        |support: &FilmSupport| support.motion.is_some() || matches!(support.hold, Hold::Body(_));
    let is_moved = supports.iter().any(moves);
    let unstressed = unstressed.filter(|positions| {
        !is_moved
            && positions.len() == shape.shell.positions.len()
            && encloses(&shape.shell, positions)
    });
    let end_time = settings.number("solver.end_time").unwrap_or(0.0);
    let mut film = FilmScene {
        shell: shape.shell,
        velocities: Vec::new(),
        film: settings.film(&source)?,
        filling: Filling::Pressure(0.0),
        supports,
        // A distance that a study gives belongs to its points.
        contact: Some(FilmContact::default()),
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            integrator: settings.integrator(&source)?,
            cfl: settings.number("solver.cfl").unwrap_or(1.0),
            end_time,
            statics: false,
            mass_damping: 0.0,
            step_limit: settings.whole("solver.step_limit", &source)?,
            instruction_set: InstructionSet::detect(),
        },
        outputs: FilmOutputs {
            sample_interval: 1.0,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: 0,
        },
    };
    let numbering = &shape.numbering;
    notes.extend(far_away(numbering.origin));
    mesh::check_closure(&film, numbering, &source)?;
    notes.extend(judge::notes(&film, numbering, mesh::has_reference(json), &source)?);
    let start =
        Start { may_touch: true, may_cross: false, allowed: "a gap between layers, however small" };
    let found = contact::settle_start(&mut film, start, numbering, &mut notes, &source)?;
    let without_pairs = || {
        let (system, ..) =
            capsule::constants(&film).map_err(|error| scene_error(error, &source))?;
        Ok(system.contact.map_or(0.0, |contact| contact.distance))
    };
    let contact_distance = found.map_or_else(without_pairs, Checked::Ok)?;
    let ignored = film.contact.map_or_else(Vec::new, |contact| contact.ignored);
    let film = MeshFilm {
        shell: film.shell,
        unstressed,
        supports: film.supports,
        contact_distance,
        imperfection_amplitude: settings
            .meshes
            .values()
            .next()
            .map_or(AMPLITUDE_PER_DISTANCE * contact_distance, |first| {
                first.film.imperfection_amplitude
            }),
        ignored,
    };
    let design = MeshDesign { hash: hash(&film), subdivisions: n, film: Arc::new(film) };
    Ok(StudyMesh { design, stored: stored(json, reader)?, notes })
}

/// The error of a mesh, with the key that it has in a study.
fn in_design(mut error: InputError) -> InputError {
    if error.key == "mesh" || error.key.starts_with("mesh.") {
        error.key.insert_str(0, "design.");
    }
    if error.hint.contains(" mesh.weld") {
        error.hint.push_str("; design.mesh is then an object, {\"positions\": FILE, \"weld\": …}");
    }
    error.hint = error.hint.replace(" mesh.", " design.mesh.");
    error
}

/// The file of a mesh, for errors.
fn named(mesh: &Json) -> String {
    mesh.get("positions").map_or_else(String::new, Json::to_string)
}

/// Whether these positions (m) of a closed shell enclose a volume.
fn encloses(shell: &Shell, positions: &[Vector3<f64>]) -> bool {
    let area = shell.reference_area();
    shell.volume(|node| positions[node as usize]) > ZERO_VOLUME * area * area.sqrt()
}

/// Hash of all that decides a run of the film.
fn hash(film: &MeshFilm) -> String {
    let MeshFilm { shell, unstressed, supports, contact_distance, ignored, .. } = film;
    let Shell { positions, triangles, reference, closure, walls, folds } = shell;
    let mut hasher = Sha256::new();
    let mut list = |name: &str, bytes: &mut dyn Iterator<Item = [u8; 8]>| {
        hasher.update(name.as_bytes());
        let mut length = 0_u64;
        for bytes in bytes {
            hasher.update(bytes);
            length += 1;
        }
        hasher.update(length.to_le_bytes());
    };
    let numbers = |vector: &Vector3<f64>| <[f64; 3]>::from(*vector).map(f64::to_le_bytes);
    let faces = |face: &[u32; 3]| face.map(|node| u64::from(node).to_le_bytes());
    let pairs = |pair: &[u32; 2]| pair.map(|node| u64::from(node).to_le_bytes());
    list("positions", &mut positions.iter().flat_map(numbers));
    list("triangles", &mut triangles.iter().flat_map(faces));
    let corners = reference.iter().flatten().flat_map(|corner| [corner.x, corner.y]);
    list("reference", &mut corners.map(f64::to_le_bytes));
    list("closure", &mut closure.iter().flat_map(faces));
    let apexes = walls.iter().flat_map(|wall| [u64::from(wall.apex), u64::from(wall.fixed)]);
    list("walls", &mut apexes.map(u64::to_le_bytes));
    list("folds", &mut folds.iter().flat_map(pairs));
    list("unstressed", &mut unstressed.iter().flatten().flat_map(numbers));
    // The amplitude too: with a seed it decides the start.
    let lengths = [*contact_distance, film.imperfection_amplitude].map(f64::to_le_bytes);
    list("lengths", &mut lengths.into_iter());
    list("ignored", &mut ignored.iter().flat_map(pairs));
    // The text of a support has every number in its shortest digits.
    hasher.update(format!("{supports:?}"));
    hexadecimal(&hasher.finalize())
}

/// Largest text of the surfaces of a mesh, bytes. Chosen: with it, study.json is smaller than the largest file read.
const MAX_TEXT: usize = 12 << 20;

/// `mesh` with the text of its surfaces in place of their files.
fn stored(mesh: &Json, reader: &Reader) -> Result<Json> {
    let mut stored = mesh.clone();
    if let Json::Object(members) = &mut stored {
        // It belongs to the points.
        members.retain(|(name, _)| name != "subdivisions");
    }
    let mut size = 0;
    for (key, name, surface) in reader.keep.iter().flatten() {
        let text = obj::surface(surface, &surface.vertices, name);
        size += text.len();
        let members = [("file", name.clone()), ("obj", text)];
        let members = members.map(|(name, text)| (name.to_owned(), Json::Text(text)));
        stored.set(key.trim_start_matches("mesh."), Json::Object(members.into()));
    }
    if size > MAX_TEXT {
        let problem = format!(
            "has {} of vertices and faces, which a results folder keeps",
            memory::size(size as u64)
        );
        let allowed = format!("up to {}; a coarser mesh", memory::size(MAX_TEXT as u64));
        return Err(reader.source.error("design.mesh", named(mesh), problem, allowed).into());
    }
    Ok(stored)
}
