//! Mutated scenes and checkpoints: a result or a message, never a panic, an abort
//! or a hang.

use std::fs;
use std::path::Path;
use std::time::Duration;

use billow_solver::platform::seal;
use serde_json::Value;

use crate::harness::place::Place;
use crate::harness::program::{self, Finish};
use crate::harness::random::Random;
use crate::harness::trial::{Fault, Kind, Trial};

pub mod bytes;
mod json;

/// Number of mutated inputs.
const TRIALS: usize = 6_000;
/// Time after which a command counts as hanging.
const LIMIT: Duration = Duration::from_mins(1);
/// Limit of the address space, in kB. Chosen: enough for every shipped file, and two fit on a small machine.
const ADDRESS_SPACE: &str = "-v 4000000";
/// Steps of a mutated scene.
const STEPS: &str = "3";

/// A file to mutate.
struct Input {
    name: String,
    value: Value,
}

/// The kind.
pub struct Mutations {
    scenes: Vec<Input>,
    /// OBJ files of the scenes, by name.
    meshes: Vec<(String, Vec<u8>)>,
    /// A scene and its checkpoint.
    capsule: Value,
    checkpoint: Vec<u8>,
}

/// Reads the shipped files, and makes a checkpoint.
pub fn prepare(place: &Place) -> Result<Mutations, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let scenes = inputs(&root.join("scenes"))?;
    let meshes = files(&root.join("scenes"), "obj")?;
    let capsule = scenes.iter().find(|scene| scene.name == "capsule.json");
    let mut capsule = capsule.ok_or("scenes/capsule.json is missing")?.value.clone();
    capsule["design"]["subdivisions"] = 2.into();
    place.write("scene.json", capsule.to_string().as_bytes());
    let arguments =
        ["solve", "scene.json", "--stop-after", "100", "--checkpoint", "checkpoint.json", "-q"];
    let finish = program::run(place, &arguments);
    let checkpoint = fs::read(place.join("checkpoint.json"))
        .map_err(|error| format!("checkpoint.json: {error}: {}", finish.said()))?;
    Ok(Mutations { scenes, meshes, capsule, checkpoint })
}

fn files(folder: &Path, ending: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    let problem = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(problem)? {
        let path = entry.map_err(problem)?.path();
        if path.extension().is_some_and(|extension| extension == ending) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            found.push((name, fs::read(&path).map_err(problem)?));
        }
    }
    found.sort();
    Ok(found)
}

fn inputs(folder: &Path) -> Result<Vec<Input>, String> {
    let parse = |(name, bytes): (String, Vec<u8>)| match serde_json::from_slice(&bytes) {
        Ok(value) => Ok(Input { name, value }),
        Err(error) => Err(format!("{name}: {error}")),
    };
    files(folder, "json")?.into_iter().map(parse).collect()
}

impl Kind for Mutations {
    fn trials(&self) -> usize {
        TRIALS
    }

    fn limit(&self) -> Duration {
        LIMIT
    }

    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        let mut trial = match number % 10 {
            0..7 => self.scene(random, place),
            _ => self.checkpoint(random, place),
        };
        if trial.longest > LIMIT {
            trial.fault(Fault::Slow, format!("{:.1?}", trial.longest));
        }
        trial
    }

    fn note(&self) -> String {
        "scenes, checkpoints".to_owned()
    }
}

impl Mutations {
    /// `solve` for a few steps.
    fn scene(&self, random: &mut Random, place: &Place) -> Trial {
        let input = random.pick(&self.scenes);
        let mut trial = Trial::new(format!("scene {}", input.name));
        self.write_meshes(place);
        place.write("scene.json", &mutated_json(&input.value, random));
        check(&mut trial, "solve", &solve(place), &[0, 1, 2]);
        trial
    }

    /// A mutated checkpoint.
    fn checkpoint(&self, random: &mut Random, place: &Place) -> Trial {
        let mut trial = Trial::new("checkpoint");
        place.write("scene.json", self.capsule.to_string().as_bytes());
        place.write("checkpoint.json", &self.mutated_checkpoint(random));
        let arguments = [
            "solve",
            "scene.json",
            "--quiet",
            "--resume",
            "checkpoint.json",
            "--stop-after",
            "110",
            "--checkpoint",
            "other.json",
        ];
        check(&mut trial, "solve --resume", &limited(place, &arguments), &[0, 1, 2]);
        trial
    }

    /// Half of the checkpoints get a right checksum: the program must not trust their content.
    fn mutated_checkpoint(&self, random: &mut Random) -> Vec<u8> {
        let text = String::from_utf8_lossy(&self.checkpoint);
        let object = seal::open(&text).unwrap_or_else(|_| text.clone().into_owned());
        let Ok(value) = serde_json::from_str(&object) else { return self.checkpoint.clone() };
        let mutated = String::from_utf8(mutated_json(&value, random)).unwrap_or_default();
        let seals = random.below(2) == 0 && mutated.starts_with('{');
        if seals { seal::seal(&mutated).into_bytes() } else { mutated.into_bytes() }
    }

    fn write_meshes(&self, place: &Place) {
        for (name, text) in &self.meshes {
            place.write(name, text);
        }
    }
}

fn mutated_json(value: &Value, random: &mut Random) -> Vec<u8> {
    let text = json::mutated(value, random);
    if random.below(4) == 0 { bytes::mutated(&text, random) } else { text }
}

fn limited(place: &Place, arguments: &[&str]) -> Finish {
    program::start(place, program::limited(place, ADDRESS_SPACE, arguments)).finish(LIMIT)
}

/// A few steps of `scene.json`. A static scene has no steps: it is solved.
fn solve(place: &Place) -> Finish {
    let scene = fs::read_to_string(place.join("scene.json")).unwrap_or_default();
    let all = ["solve", "scene.json", "--quiet", "--stop-after", STEPS, "--checkpoint", "c.json"];
    limited(place, if scene.contains("\"static\"") { &all[..3] } else { &all })
}

fn check(trial: &mut Trial, command: &str, finish: &Finish, codes: &[i32]) {
    trial.time(finish.wall);
    trial.detected |= finish.code == Some(2);
    finish.check_end(trial, command);
    let Some(code) = finish.code else { return };
    if !codes.contains(&code) && code != 101 {
        let text = format!("{command}: exit code {code}: {}", finish.said());
        trial.fault(Fault::WrongMessage, text);
    } else if code == 2 && !finish.stderr.contains("next:") && !finish.stderr.contains("allowed") {
        let text = format!("{command}: no next step: {}", finish.said());
        trial.fault(Fault::WrongMessage, text);
    }
}
