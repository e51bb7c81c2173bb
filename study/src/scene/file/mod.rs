//! A scene file: one capsule or any mesh, resolved to the film that is run.
//!
//! ```text
//! text → Json → (--set) → settings, mesh, supports … → FilmScene, and the user's names of its nodes
//! ```
//! Every error of a scene is found here, before anything runs.

mod capsule;
pub(super) mod components;
mod conflicts;
mod contact;
mod cut;
pub mod design_mesh;
mod filling;
pub(crate) mod flow_table;
mod formats;
mod judge;
mod memory;
mod mesh;
mod motion;
mod outputs;
mod reader;
mod reference;
mod seams;
mod selection;
mod shape;
mod start;
mod supports;
pub(crate) mod tank;
mod weld;

use std::path::Path;

use billow_solver::geometry::mesh_io::obj_reader::Surface;
use billow_solver::mechanics::supports::PrescribedNodes;
use billow_solver::models::film::Rings;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::film_scene::{FilmScene, FilmSolver};
use nalgebra::Vector3;
use serde_json::json;

use crate::input::json::Json;
use crate::input::keys::{GRAVITY, Refusal, SCENE};
use crate::input::overrides;
use crate::input::sections::{check_sample_interval, check_version};
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::Value;
use crate::input::{standard_flow, study_file, syntax};
use crate::job::canonical_json;
use crate::job::memory::bending;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::hash::bytes_hash;
use crate::platform::provenance::PHYSICS_VERSION;
use contact::Start;
use memory::Needs;
use reader::Reader;
use shape::Shape;

pub use outputs::Recorded;
pub use shape::Numbering;

/// A scene, ready to run.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// What is run.
    pub film: FilmScene,
    /// Motions beside those of the supports: the ring of an erected capsule to its stowed position.
    pub seating: Vec<PrescribedNodes>,
    /// Rings of a capsule; `None` for any other mesh.
    pub rings: Option<Rings>,
    /// Amplitude of the imperfection of a stowed capsule, m; `None` without one.
    pub imperfection_amplitude: Option<f64>,
    /// Names of what is recorded.
    pub recorded: Recorded,
    /// From the numbers of the user's file to those of the run.
    pub numbering: Numbering,
    /// The scene as given, with its overrides and the hashes of the files it names.
    pub json: serde_json::Value,
    /// Hash of everything that decides its results.
    pub fingerprint: String,
    /// What a reader of its results must know.
    pub notes: Vec<String>,
}

impl SceneFile {
    /// Reads a scene file, with `--set key=value` overrides applied to it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`] when the file, or a file it names, cannot be read;
    /// [`crate::platform::error::Error::Input`] for the first error, with its key, its value and what
    /// is allowed.
    pub fn load(path: &Path, sets: &[String], instruction_set: InstructionSet) -> Result<Self> {
        let bytes = study_file::read(path, "scene file", "scenes/sphere.json")?;
        let file = path.display().to_string();
        Self::from_text(study_file::text_of(&bytes, &file)?, path, sets, instruction_set)
    }

    /// The surface of the mesh of a scene as its file has it, m: also of a scene that is refused for what its mesh is.
    /// `None` for a capsule.
    ///
    /// # Errors
    /// A scene or a mesh that cannot be read.
    pub fn surface(path: &Path, sets: &[String]) -> Result<Option<Surface>> {
        let bytes = study_file::read(path, "scene file", "scenes/sphere.json")?;
        let file = path.display().to_string();
        let mut tree = syntax::parse(study_file::text_of(&bytes, &file)?, &file)?;
        let mut reader = Reader::new(path);
        overrides::apply(&mut tree, sets, &SCENE, &mut reader.source)?;
        tree.get("mesh").map(|json| mesh::surface(json, &mut reader)).transpose()
    }

    /// Reads a scene from its text; `path` is where its file would be.
    ///
    /// # Errors
    /// As [`Self::load`], except for the file of the scene itself.
    pub fn from_text(
        text: &str,
        path: &Path,
        sets: &[String],
        instruction_set: InstructionSet,
    ) -> Result<Self> {
        let file = path.display().to_string();
        let tree = syntax::parse(text, &file)?;
        Self::from_tree(tree, path, sets, instruction_set).map_err(|error| match error {
            Error::Input(error) => Error::Input(syntax::with_place(error, text, &file)),
            other => other,
        })
    }

    fn from_tree(
        mut tree: Json,
        path: &Path,
        sets: &[String],
        instruction_set: InstructionSet,
    ) -> Result<Self> {
        let file = path.display().to_string();
        let mut source = Source::new(&file);
        if !matches!(tree, Json::Object(_)) {
            let problem = format!("is {}, not an object", tree.kind());
            return Err(source.error("", "", problem, "one JSON object: {\"mesh\": …}").into());
        }
        refuse_study(&tree, &file, &source)?;
        let mut notes = overrides::apply(&mut tree, sets, &SCENE, &mut source)?;
        notes.extend(standard_flow::convert(&mut tree, &source)?);
        let mut reader = Reader { source, ..Reader::new(path) };
        Self::read(&tree, notes, &mut reader, instruction_set)
    }

    fn read(
        tree: &Json,
        mut notes: Vec<String>,
        reader: &mut Reader,
        instruction_set: InstructionSet,
    ) -> Result<Self> {
        check_version(tree, &reader.source)?;
        let mut settings = Settings::new(&SCENE);
        settings.read("", tree, &reader.source)?;
        check_one_shape(tree, &reader.source)?;
        let has_design = tree.get("design").is_some();
        if has_design {
            settings.fold_design(&reader.source)?;
        }
        let statics = is_static(&settings);
        let contact = contact::read(tree, &settings, &reader.source);
        let film = settings.film(&reader.source)?;
        if let Some(moment) = film.yield_moment.filter(|_| statics) {
            let problem =
                "is given, but a static equilibrium does not know what has yielded before";
            let allowed = "no film.yield_moment with solver.static";
            return Err(reader.source.error("film.yield_moment", moment, problem, allowed).into());
        }
        let integrator = settings.integrator(&reader.source)?;
        let bending = bending(&film, integrator).map(|stiff| stiff || statics);
        let has_contact = matches!(contact, Ok(Some(_)));
        reader.needs = Needs { contact: has_contact, statics, bending, pieces: 1 };
        let mut shape = match tree.get("mesh") {
            Some(json) => mesh::read(json, reader)?,
            None => capsule::read(&settings, reader.needs, &reader.source)?,
        };
        notes.append(&mut reader.notes);
        let supports = supports::read(tree, &settings, &shape, &reader.source)?;
        let filling = filling::read(tree, &settings, &mut shape, &supports, &mut notes, reader)?;
        conflicts::check(&supports, &shape, &reader.source)?;
        let mut seating = supports::seating(&supports, &shape);
        if statics {
            seat(&mut shape, std::mem::take(&mut seating));
        }
        let velocities = start::velocities(tree.get("start"), &shape, &reader.source)?;
        let (outputs, recorded) =
            outputs::read(tree.get("outputs"), &shape, &mut notes, &reader.source)?;
        let end_time = end_time(&settings, &reader.source)?;
        check_sample_interval(outputs.sample_interval, end_time, &reader.source)?;
        let mut contact = contact?;
        let origin = shape.numbering.origin;
        for plate in contact.iter_mut().flat_map(|contact| &mut contact.plates) {
            plate.point -= origin;
        }
        notes.extend(far_away(origin));
        if contact.is_none() && !statics && shape.folded {
            notes
                .push("contact is off: film passes through film, and it is not counted".to_owned());
        }
        let mut film = FilmScene {
            shell: shape.shell,
            velocities,
            film,
            filling,
            supports,
            gravity: gravity(tree.get("gravity"), &reader.source)?,
            release_time: settings.needed("release_time", &reader.source)?,
            solver: FilmSolver {
                integrator,
                cfl: settings.needed("solver.cfl", &reader.source)?,
                end_time,
                statics,
                mass_damping: settings.needed("solver.mass_damping", &reader.source)?,
                step_limit: settings.whole("solver.step_limit", &reader.source)?,
                instruction_set,
            },
            outputs,
            contact,
        };
        memory::check_outputs(&film, &reader.source)?;
        mesh::check_closure(&film, &shape.numbering, &reader.source)?;
        contact::check_plates(&film, &reader.source)?;
        let displaced = shape.imperfection_amplitude.is_some();
        notes.extend(without_effect(&film, displaced, &settings));
        if let Some(mesh) = tree.get("mesh") {
            let has_reference = mesh::has_reference(mesh);
            notes.extend(judge::notes(&film, &shape.numbering, has_reference, &reader.source)?);
        }
        let (start, numbering) = (Start::of_scene(tree, &settings), &shape.numbering);
        contact::settle_start(&mut film, start, numbering, &mut notes, &reader.source)?;
        if statics {
            notes.extend(contact::crossing_film(&film, numbering));
        }
        notes.extend(reader.source.warnings());
        let (json, fingerprint) = identity(tree, reader);
        Ok(Self {
            film,
            seating,
            rings: shape.rings,
            imperfection_amplitude: shape.imperfection_amplitude,
            recorded,
            numbering: shape.numbering,
            json,
            fingerprint,
            notes,
        })
    }
}

/// A note where the coordinates of the run begin elsewhere than those of the file.
fn far_away(origin: Vector3<f64>) -> Option<String> {
    let at = <[f64; 3]>::from(origin);
    (origin != Vector3::zeros()).then(|| {
        format!(
            "the film is far from the origin of its file: the run and its results count from {at:?} m; --shape of \
             billow solve has the coordinates of the file"
        )
    })
}

fn refuse_study(tree: &Json, file: &str, source: &Source) -> Result<()> {
    let is_study = tree.get("format") == Some(&Json::Text("billow-study".to_owned()));
    if !is_study && tree.get("grid").is_none() {
        return Ok(());
    }
    let key = if is_study { "format" } else { "grid" };
    let error = source.error(key, "", "belongs to a study, not to a scene", "");
    Err(InputError { hint: format!("billow run {file}"), ..error }.into())
}

/// Refuses a scene without a film, and one with two.
fn check_one_shape(tree: &Json, source: &Source) -> Result<()> {
    let problem = match (tree.get("design"), tree.get("mesh")) {
        (Some(_), None) | (None, Some(_)) => return Ok(()),
        (Some(_), Some(_)) => "gives both design and mesh",
        (None, None) => "gives neither design nor mesh",
    };
    let allowed = "one of design (a capsule) and mesh (files)";
    Err(source.error("", "", problem, allowed).into())
}

/// Moves the nodes of a shape to the ends of their motions: static equilibrium has no time.
fn seat(shape: &mut Shape, movers: Vec<PrescribedNodes>) {
    for mover in movers {
        for (node, end) in mover.positions(mover.motion.to) {
            let position = &mut shape.shell.positions[node as usize];
            *position += mover.held * (end - *position);
        }
    }
}

/// Keys that have no effect on this scene; `displaced`: whether it has an imperfection.
fn without_effect(film: &FilmScene, displaced: bool, settings: &Settings) -> Vec<String> {
    let mut notes = Vec::new();
    let statics = film.solver.statics;
    if statics && settings.number("solver.end_time").is_some() {
        notes.push("solver.end_time has no effect: static equilibrium has no time".to_owned());
    }
    if film.release_time > 0.0 && (statics || film.release_time >= film.solver.end_time) {
        let reason = if statics {
            "static equilibrium is solved without packing"
        } else {
            "the film stays packed until solver.end_time"
        };
        notes.push(format!("release_time has no effect: {reason}"));
    }
    if film.film.creases.is_some() && film.shell.folds.is_empty() {
        notes.push("creases has no effect: a mesh has no fold lines".to_owned());
    }
    for key in ["seed", "imperfection_amplitude"] {
        if !displaced && settings.value(key).any_number().is_some_and(|value| value > 0.0) {
            notes.push(format!("{key} has no effect: a scene displaces a stowed design alone"));
        }
    }
    notes
}

/// The scene as stored, and the hash of everything that decides its results.
fn identity(tree: &Json, reader: &Reader) -> (serde_json::Value, String) {
    let input = json!({"scene": tree, "files": reader.hashes});
    let identity = json!({"physics_version": PHYSICS_VERSION, "input": input});
    let hash = bytes_hash(canonical_json(&identity).as_bytes());
    (input, hash)
}

/// A value, or its error.
type Checked<T> = std::result::Result<T, InputError>;

/// The end of the run, s. Static equilibrium needs none and ignores it.
fn end_time(settings: &Settings, source: &Source) -> Checked<f64> {
    match settings.number("solver.end_time") {
        None if is_static(settings) => Ok(1.0),
        _ => settings.needed("solver.end_time", source),
    }
}

/// Whether static equilibrium is solved instead of motion.
fn is_static(settings: &Settings) -> bool {
    settings.flag("solver.static") == Some(true)
}

fn gravity(json: Option<&Json>, source: &Source) -> Checked<Vector3<f64>> {
    let [along, vector] = &GRAVITY;
    let Some(json) = json else { return Ok(Vector3::zeros()) };
    let refused =
        |refusal: Refusal| source.error("gravity", json, refusal.problem, refusal.allowed);
    if matches!(json, Json::List(_)) {
        return Ok(vector.read_vector(json).map_err(refused)?.into());
    }
    match along.read(json).map_err(refused)? {
        Value::Number(number) => Ok(Vector3::new(0.0, 0.0, number)),
        _ => Ok(Vector3::zeros()),
    }
}

/// The error of a scene that the solver refuses.
fn scene_error(error: SceneError, source: &Source) -> InputError {
    match error {
        SceneError::Invalid { key, problem } => {
            let (problem, allowed) = problem.split_once("; allowed: ").unwrap_or((&problem, ""));
            source.error(&key, "", problem, allowed)
        }
        SceneError::Fold(error) => source.error("design", "", error.to_string(), ""),
    }
}
