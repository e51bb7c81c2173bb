//! What a scene file means: one capsule or any mesh, resolved to the film that is run.
//!
//! ```text
//! text → Json → (--set) → settings, mesh, supports … → FilmScene, and what its nodes are called
//! ```
//! Everything that can be wrong with a scene is found here, before anything runs.

mod conflicts;
mod contact;
mod filling;
mod mesh;
mod object;
mod outputs;
mod shape;
mod supports;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use billow_solver::mechanics::supports::PrescribedNodes;
use billow_solver::models::film::Rings;
use billow_solver::platform::simd;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::film_scene::{FilmScene, FilmSolver};
use nalgebra::Vector3;
use serde_json::json;

use crate::input::keys::{GRAVITY, SCENE};
use crate::input::settings::{Settings, check_version, number, unsigned};
use crate::input::source::Source;
use crate::input::study_file::{self, Json};
use crate::job::canonical_json;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files;
use crate::platform::provenance::PHYSICS_VERSION;
use crate::store::history_file::bytes_hash;
use crate::study::apply_overrides;

pub use outputs::Followed;
pub use shape::Numbering;

/// Largest mesh file read, bytes.
const LARGEST_MESH: u64 = 1 << 30;

/// A scene, ready to run.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// What is run.
    pub film: FilmScene,
    /// What moves beside the supports' own motions: the ring of an erected capsule to its place.
    pub seating: Vec<PrescribedNodes>,
    /// What makes it a capsule.
    pub rings: Option<Rings>,
    /// What is followed, by name.
    pub followed: Followed,
    /// From the numbers of the user's file to those of the run.
    pub numbering: Numbering,
    /// The scene as given, with its overrides and the hashes of the files it names.
    pub json: serde_json::Value,
    /// Hash of all that decides its results.
    pub fingerprint: String,
    /// What a reader of its results should know.
    pub notes: Vec<String>,
}

const BESIDE: &str = "\n  next: paths in a scene are relative to the scene file";

/// Where a scene's values and files come from.
pub(crate) struct Reader {
    source: Source,
    folder: PathBuf,
    /// Hash of each file read, by the name the scene gives it.
    hashes: BTreeMap<String, String>,
}

impl Reader {
    /// The text of a file that a key names.
    fn text(&mut self, key: &str, name: &str) -> Result<String> {
        let path = self.folder.join(name);
        let disk = |problem: String| Error::Disk { path: path.clone(), problem };
        let bytes = files::read_at_most(&path, LARGEST_MESH)
            .map_err(|error| disk(format!("cannot read what {key} names: {error}{BESIDE}")))?
            .ok_or_else(|| disk(format!("larger than {} MiB", LARGEST_MESH >> 20)))?;
        self.hashes.insert(name.to_owned(), bytes_hash(&bytes));
        String::from_utf8(bytes).map_err(|error| {
            disk(format!("no text: not UTF-8 from byte {} on", error.utf8_error().valid_up_to()))
        })
    }
}

impl SceneFile {
    /// Reads a scene file, with `--set key=value` overrides applied to it. `path` of the instruction
    /// set is the solver's.
    ///
    /// # Errors
    /// [`Error::Disk`] when it, or a file it names, cannot be read; [`Error::Input`] for the first
    /// thing found wrong, with its key, its value and what is allowed.
    pub fn load(path: &Path, sets: &[String], simd: simd::InstructionSet) -> Result<Self> {
        let bytes = study_file::read(path, "scene file", "scenes/sphere.json")?;
        let file = path.display().to_string();
        Self::from_text(study_file::text_of(&bytes, &file)?, path, sets, simd)
    }

    /// Reads a scene from its text, as if it lay at `path`.
    ///
    /// # Errors
    /// As [`Self::load`], but for the file of the scene itself.
    pub fn from_text(
        text: &str,
        path: &Path,
        sets: &[String],
        simd: simd::InstructionSet,
    ) -> Result<Self> {
        let file = path.display().to_string();
        let mut tree = study_file::parse(text, &file)?;
        let mut source = Source::new(&file);
        if !matches!(tree, Json::Object(_)) {
            let problem = format!("is {}, not an object", tree.kind());
            return Err(source.error("", "", problem, "one JSON object: {\"mesh\": …}").into());
        }
        let written = tree.get("format") == Some(&Json::Text("billow-study".to_owned()));
        if written || tree.get("grid").is_some() {
            let key = if written { "format" } else { "grid" };
            let error = source.error(key, "", "is of a study, not of a scene", "");
            return Err(InputError { hint: format!("billow run {file}"), ..error }.into());
        }
        apply_overrides(&mut tree, sets, &SCENE, &mut source)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut reader = Reader { source, folder, hashes: BTreeMap::new() };
        Self::read(&tree, &mut reader, simd)
    }

    fn read(tree: &Json, reader: &mut Reader, simd: simd::InstructionSet) -> Result<Self> {
        check_version(tree, &reader.source)?;
        let mut settings = Settings::new(&SCENE);
        settings.read("", tree, &reader.source)?;
        let mut notes = Vec::new();
        let statics = settings.flag("solver.static");
        let mut shape = shape::read(tree, &settings, reader, simd)?;
        let filling = filling::read(tree, &settings, &mut shape, &mut notes, &reader.source)?;
        let supports = supports::read(tree, &settings, &shape, &reader.source)?;
        conflicts::check(&supports, &shape, &reader.source)?;
        let mut seating = supports::seating(&supports, &shape);
        if statics {
            for mover in std::mem::take(&mut seating) {
                for (node, place) in mover.positions(mover.motion.to) {
                    let own = &mut shape.shell.positions[node as usize];
                    *own += mover.held * (place - *own);
                }
            }
        }
        let velocities = outputs::velocities(tree.get("start"), &shape, reader)?;
        let (outputs, followed) =
            outputs::read(tree.get("outputs"), &shape, &mut notes, &reader.source)?;
        let end_time = end_time(&settings, &reader.source)?;
        outputs::check_interval(outputs.sample_interval, end_time, &reader.source)?;
        let contact = contact::read(tree, &settings, &reader.source)?;
        if contact.is_none() && !statics && shape.folded {
            notes.push("contact is off: film passes through film, uncounted".to_owned());
        }
        let mut film = FilmScene {
            shell: shape.shell,
            velocities,
            film: crate::input::settings::film(&settings, &reader.source)?,
            filling,
            supports,
            gravity: gravity(tree.get("gravity"), &reader.source)?,
            release_time: number(&settings, "release_time", &reader.source)?,
            solver: FilmSolver {
                cfl: number(&settings, "solver.cfl", &reader.source)?,
                end_time,
                statics,
                mass_damping: number(&settings, "solver.mass_damping", &reader.source)?,
                step_limit: unsigned(&settings, "solver.step_limit", &reader.source)?,
                instruction_set: simd,
            },
            outputs,
            contact,
        };
        contact::check_plates(&film, &reader.source)?;
        if statics && settings.number("solver.end_time").is_some() {
            notes.push("solver.end_time has no effect: a state of rest has no time".to_owned());
        }
        if film.release_time > 0.0 && (statics || film.release_time >= end_time) {
            let why =
                if statics { "a state of rest is not packed" } else { "it is packed to the end" };
            notes.push(format!("release_time releases nothing: {why}"));
        }
        // Whatever of the film is none is found before anything runs.
        let unsound = |error| scene_error(error, &reader.source);
        if contact::lies_on_itself(&film).map_err(unsound)? {
            let problem = "film lies on film at the start, so contact cannot tell its sides";
            if tree.get("contact").is_some() {
                let allowed = "a gap between layers, however small; or contact.enabled false";
                return Err(reader.source.error("contact", "", problem, allowed).into());
            }
            notes.push(format!("{problem}: it is off, and film passes through film"));
            film.contact = None;
        }
        let json = json!({"scene": to_value(tree), "files": reader.hashes});
        let identity = json!({"physics_version": PHYSICS_VERSION, "input": json});
        Ok(Self {
            film,
            seating,
            rings: shape.rings,
            followed,
            numbering: shape.numbering,
            fingerprint: bytes_hash(canonical_json(&identity).as_bytes()),
            json,
            notes,
        })
    }
}

/// A value, or what is wrong with it.
type Checked<T> = std::result::Result<T, InputError>;

/// The end, s; no meaning for statics, which needs none.
fn end_time(settings: &Settings, source: &Source) -> Checked<f64> {
    let statics = settings.flag("solver.static");
    match settings.number("solver.end_time") {
        Some(time) => Ok(time),
        None if statics => Ok(1.0),
        None => number(settings, "solver.end_time", source),
    }
}

fn gravity(json: Option<&Json>, source: &Source) -> Checked<Vector3<f64>> {
    let [along, vector] = &GRAVITY;
    let Some(json) = json else { return Ok(Vector3::zeros()) };
    let refused = |refusal: crate::input::keys::Refusal| {
        source.error("gravity", &json.brief(), refusal.problem, refusal.allowed)
    };
    if matches!(json, Json::List(_)) {
        return Ok(vector.read_vector(json).map_err(refused)?.into());
    }
    match along.read(json).map_err(refused)? {
        crate::input::value::Value::Number(number) => Ok(Vector3::new(0.0, 0.0, number)),
        _ => Ok(Vector3::zeros()),
    }
}

/// What the solver refuses, as an error of the file.
pub(crate) fn scene_error(error: SceneError, source: &Source) -> InputError {
    match error {
        SceneError::Invalid { key, problem } => {
            let (problem, allowed) = problem.split_once("; allowed: ").unwrap_or((&problem, ""));
            source.error(&key, "", problem, allowed)
        }
        SceneError::Fold(error) => source.error("design", "", error.to_string(), ""),
    }
}

/// The tree as JSON.
fn to_value(json: &Json) -> serde_json::Value {
    match json {
        Json::Null => serde_json::Value::Null,
        Json::Bool(value) => (*value).into(),
        Json::Integer(value) => (*value).into(),
        Json::Number(value) => (*value).into(),
        Json::Text(value) => value.as_str().into(),
        Json::List(items) => items.iter().map(to_value).collect::<Vec<_>>().into(),
        Json::Object(members) => {
            let members = members.iter().map(|(key, value)| (key.clone(), to_value(value)));
            members.collect::<serde_json::Map<_, _>>().into()
        }
    }
}
