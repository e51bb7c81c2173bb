//! The files that a scene names, read and hashed.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use billow_solver::geometry::mesh_io::obj_reader::Surface;

use super::formats::{self, Read};
use super::memory::{Needs, check_file};
use crate::input::json::Json;
use crate::input::source::Source;
use crate::platform::error::{Error, Result};
use crate::platform::files;
use crate::platform::hash::bytes_hash;

/// Largest mesh file read, bytes (chosen: 1 GiB holds tens of millions of vertices).
const MAX_MESH_SIZE: u64 = 1 << 30;

/// Next step after a file that cannot be read.
const RELATIVE: &str = "\n  next: paths in a file are relative to it";

/// Where a scene's values and files come from.
pub(crate) struct Reader {
    /// The file and flags that give its values.
    pub source: Source,
    /// Folder of the scene file.
    pub folder: PathBuf,
    /// Hash of each file read, by the name that the scene gives it.
    pub hashes: BTreeMap<String, String>,
    /// What decides the memory of the scene.
    pub needs: Needs,
    /// How files were read.
    pub notes: Vec<String>,
    /// The surfaces read, with key and name, where they are kept.
    pub keep: Option<Vec<(String, String, Surface)>>,
}

impl Reader {
    /// The reader of a scene file.
    pub fn new(path: &Path) -> Self {
        Self {
            source: Source::new(&path.display().to_string()),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            hashes: BTreeMap::new(),
            needs: Needs::default(),
            notes: Vec::new(),
            keep: None,
        }
    }

    /// The surface of a mesh file that a key names, or whose text it has; and its name. Notes how it was read.
    pub fn surface(&mut self, key: &str, given: &Json) -> Result<(Surface, String)> {
        let text = |name| match given.get(name) {
            Some(Json::Text(text)) => Some(text.as_str()),
            _ => None,
        };
        let (name, file, bytes) = match (given, text("obj")) {
            (Json::Text(name), _) => (name.as_str(), name.as_str(), self.bytes(key, name)?),
            (_, Some(obj)) => (text("file").unwrap_or("obj"), "text.obj", obj.as_bytes().to_vec()),
            _ => {
                let problem = format!("is {}, not a mesh", given.kind());
                let allowed = "the name of a file, or {\"obj\": the text of an OBJ file}";
                return Err(self.source.error(key, given, problem, allowed).into());
            }
        };
        let name = name.to_owned();
        let Read { surface, note } =
            formats::read(file, &bytes).map_err(|(problem, allowed)| {
                self.source.error(key, format!("{name:?}"), problem, allowed)
            })?;
        self.notes.extend(note.map(|note| format!("{key}: {note}")));
        self.needs.check_surface(&surface, key, &name, &self.source)?;
        if let Some(kept) = &mut self.keep {
            kept.push((key.to_owned(), name.clone(), surface.clone()));
        }
        Ok((surface, name))
    }

    /// The bytes of a file that a key names.
    pub fn bytes(&mut self, key: &str, name: &str) -> Result<Vec<u8>> {
        let path = self.folder.join(name);
        let disk = |problem: String| Error::Disk { path: path.clone(), problem };
        let bytes = files::read_at_most(&path, MAX_MESH_SIZE)
            .map_err(|error| {
                let near =
                    files::nearest_name(&path).filter(|_| error.kind() == ErrorKind::NotFound);
                let near = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
                disk(format!("cannot read the file of {key}: {error}{RELATIVE}{near}"))
            })?
            .ok_or_else(|| {
                let limit = MAX_MESH_SIZE >> 20;
                disk(format!("is larger than {limit} MiB\n  next: give a coarser mesh"))
            })?;
        check_file(bytes.len(), key, name, &self.source)?;
        self.hashes.insert(name.to_owned(), bytes_hash(&bytes));
        Ok(bytes)
    }
}
