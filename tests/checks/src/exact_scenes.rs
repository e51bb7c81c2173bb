//! Runs of the scenes with an exact answer, on disk: what `billow-checks pareto` ran once.
//!
//! ```text
//! results/exact/exact_scenes.json     {"checksum", "format", "version", "physics_version", "scenes": […]}
//! ```
//!
//! `checksum` is that of [`billow_solver::platform::seal`]. The file only saves time: if it is missing, damaged or of
//! another version, its runs are made again.

use std::io;
use std::path::Path;

use billow_solver::PHYSICS_VERSION;
use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use billow_study::job::Status;
use billow_study::platform::error::Result;
use billow_study::platform::files::{self, Disk, Files, disk_error};

/// Name of the file.
const FILE: &str = "exact_scenes.json";
/// Name of the format.
const FORMAT: &str = "billow-exact-scenes";
/// Version of the format and of the list of runs. Another one is not read.
const VERSION: u32 = 2;

/// A scene and its runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExactScene {
    /// Name.
    pub name: String,
    /// What it is, and how its cost counts; one line.
    pub meaning: String,
    /// What is measured.
    pub quantities: Vec<ExactQuantity>,
    /// Whether the seconds are those of a simulated second; otherwise those of a whole run.
    pub per_simulated_second: bool,
    /// Names of the numerical parameters.
    pub parameters: Vec<String>,
    /// Its runs.
    pub runs: Vec<ExactRun>,
}

/// What is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExactQuantity {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
    /// The exact value; null where none is known.
    pub exact: Option<f64>,
}

/// A run of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExactRun {
    /// The value of each parameter: a number, a text, or null for one that the model ignores.
    pub configuration: Vec<serde_json::Value>,
    /// Elements of the mesh; 0 without one.
    pub elements: f64,
    /// Steps, or Newton steps.
    pub steps: f64,
    /// Whether its steps, or some of them, solve equations for all nodes.
    pub implicit: bool,
    /// Wall time on one thread, s.
    pub seconds: f64,
    /// Status: done, or how it failed.
    pub status: String,
    /// The value of each quantity, SI; none of a run that failed.
    pub values: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: String,
    version: u32,
    physics_version: u32,
    scenes: Vec<ExactScene>,
}

/// The scenes of a text; `None` for a text that this program did not write.
fn decode(bytes: &[u8]) -> Option<Vec<ExactScene>> {
    let object = seal::open(std::str::from_utf8(bytes).ok()?).ok()?;
    let stored: Stored = serde_json::from_str(&object).ok()?;
    let current = (FORMAT, VERSION, PHYSICS_VERSION);
    let fits = |scene: &ExactScene| {
        scene.runs.iter().all(|run| {
            run.configuration.len() == scene.parameters.len()
                && Status::from_name(&run.status).is_some_and(|status| {
                    let expected = if status == Status::Done { scene.quantities.len() } else { 0 };
                    run.values.len() == expected
                })
        })
    };
    ((stored.format.as_str(), stored.version, stored.physics_version) == current)
        .then_some(stored.scenes)
        .filter(|scenes| scenes.iter().all(fits))
}

/// The stored runs of a folder; none where the file is missing, damaged or of another version.
pub fn read(folder: &Path) -> Vec<ExactScene> {
    let bytes = Disk.read(&folder.join(FILE));
    bytes.ok().and_then(|bytes| decode(&bytes)).unwrap_or_default()
}

/// Stores the runs of exact scenes.
///
/// # Errors
/// [`billow_study::platform::error::Error::Disk`].
pub fn write(folder: &Path, scenes: &[ExactScene]) -> Result<()> {
    let path = folder.join(FILE);
    let stored = Stored {
        format: FORMAT.to_owned(),
        version: VERSION,
        physics_version: PHYSICS_VERSION,
        scenes: scenes.to_vec(),
    };
    let write = || -> io::Result<()> {
        let object = serde_json::to_string(&stored).map_err(io::Error::other)?;
        files::write_atomic(&Disk, &path, seal::seal(&(object + "\n")).as_bytes())
    };
    write().map_err(|error| disk_error(&path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use billow_study::platform::files::scratch::Scratch;

    #[test]
    fn stored_runs_are_read_again_and_damaged_ones_are_not() {
        let folder = Scratch::new("exact_scenes").unwrap();
        let folder = folder.path();
        assert!(read(folder).is_empty());
        let scene = ExactScene {
            name: "disc".to_owned(),
            meaning: String::new(),
            quantities: Vec::new(),
            per_simulated_second: true,
            parameters: vec!["rings".to_owned()],
            runs: vec![ExactRun {
                configuration: vec![8.into()],
                elements: 384.0,
                steps: 0.1 + 0.2,
                implicit: false,
                seconds: 1e-3,
                status: "done".to_owned(),
                values: Vec::new(),
            }],
        };
        write(folder, std::slice::from_ref(&scene)).unwrap();
        assert_eq!(read(folder), [scene]);
        let path = folder.join(FILE);
        let text = String::from_utf8(Disk.read(&path).unwrap()).unwrap();
        let text = text.replace("384", "385");
        assert_eq!(decode(text.as_bytes()), None);
    }
}
