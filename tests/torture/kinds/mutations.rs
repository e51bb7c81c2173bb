//! Mutated studies, scenes and checkpoints: a result or a message, never a panic, an abort or a hang.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use billow_solver::platform::seal;
use serde_json::Value;

use super::Prepared;
use crate::check::without_costs;
use crate::mutate;
use crate::program::{Finish, Place, RUN, files};
use crate::studies;
use crate::trial::Trial;

/// Number of mutated studies and scenes, and of checkpoints.
const INPUTS: usize = 5_000;
const CHECKPOINTS: usize = 1_500;
/// Time after which a run of a mutated study is asked to stop. Chosen: some jobs of it are finished.
const RUN_TIME: Duration = Duration::from_millis(300);
/// Limit of the address space, MB. Chosen: enough for every shipped file, and two fit on a small machine.
const ADDRESS_SPACE: u32 = 4000;

/// Mutated studies, which run for a moment, and scenes, which are solved.
pub fn mutations(_: &Place) -> Result<Prepared, String> {
    let mut studies = shipped("studies")?;
    studies.push(("small.json".to_owned(), studies::small()));
    let scenes = shipped("scenes")?;
    Ok(Prepared::new(INPUTS, move |trial, random, place| {
        if trial.number.is_multiple_of(5) {
            let (name, study) = random.pick(&studies);
            trial.what = format!("study {name}");
            place.write("s.json", &mutate::json(study, random));
            let running = place.start(place.limited(ADDRESS_SPACE, RUN));
            sleep(RUN_TIME);
            running.signal("TERM");
            let finish = running.finish();
            trial.count("studies run", usize::from(place.results().exists()));
            if finish.signal == Some(15) && !place.results().exists() {
                // It was still planning, as on a busy machine: nothing handles the signal yet, nothing is there to lose.
                return;
            }
            return check(trial, "run", &finish, &[0, 1, 2, 143]);
        }
        let (name, scene) = random.pick(&scenes);
        trial.what = format!("scene {name}");
        place.copy_from(&folder("scenes"));
        let text = mutate::json(scene, random);
        // A static scene has no steps: it is solved.
        let is_static = text.windows(8).any(|word| word == b"\"static\"");
        let steps = if is_static { "" } else { " --stop-after 3 --checkpoint c.json" };
        place.write(name, &text);
        solve(trial, place, &format!("{name}{steps}"), &[0, 1, 2]);
    }))
}

/// Checkpoints with changed bytes, which `solve` refuses or (a change without meaning) completes with the same
/// summary; and those with another content and its checksum, which must not be trusted.
pub fn checkpoints(place: &Place) -> Result<Prepared, String> {
    const START: &str = "--stop-after 150 --checkpoint checkpoint.json";
    const RESUME: &str = "--resume checkpoint.json --stop-after 100 --checkpoint end.json";
    const WHOLE: &str = "--stop-after 250 --checkpoint whole.json";
    let scene = folder("scenes").join("capsule.json");
    fs::copy(&scene, place.join("s.json")).map_err(|error| error.to_string())?;
    let solve = |trial: &mut Trial, place: &Place, arguments, codes: &[i32]| {
        solve(trial, place, &format!("s.json --set design.subdivisions=2 {arguments}"), codes)
    };
    let mut trial = Trial::default();
    solve(&mut trial, place, START, &[]);
    let whole = summary(&solve(&mut trial, place, WHOLE, &[0]));
    let resumed = summary(&solve(&mut trial, place, RESUME, &[0]));
    if !trial.faults.is_empty() || resumed != whole {
        return Err(format!("the checkpoint gives another summary: {:?}", trial.faults));
    }
    let valid = fs::read(place.join("checkpoint.json")).map_err(|error| error.to_string())?;
    let content =
        seal::open(&String::from_utf8_lossy(&valid)).map_err(|error| error.to_string())?;
    let content: Value = serde_json::from_str(&content).map_err(|error| error.to_string())?;
    let template = place.join("");
    Ok(Prepared::new(CHECKPOINTS, move |trial, random, place| {
        let object = String::from_utf8(mutate::json(&content, random)).unwrap_or_default();
        let sealed = trial.number.is_multiple_of(2) && object.starts_with('{');
        let (what, text) = if sealed {
            ("content changed", seal::seal(&object).into_bytes())
        } else {
            ("bytes changed", mutate::bytes(&valid, random))
        };
        what.clone_into(&mut trial.what);
        place.copy_from(&template);
        place.write("checkpoint.json", &text);
        let codes: &[i32] = if sealed { &[0, 1, 2] } else { &[0, 2] };
        let finish = solve(trial, place, RESUME, codes);
        if !sealed && finish.succeeded() {
            trial.count("accepted with the same summary", 1);
            if summary(&finish) != whole {
                trial.fault("silently wrong: accepted, and the summary is another one");
            }
        }
    }))
}

fn summary(finish: &Finish) -> Option<Value> {
    let value = serde_json::from_str(&finish.stdout).ok()?;
    finish.succeeded().then(|| without_costs(value))
}

fn solve(trial: &mut Trial, place: &Place, arguments: &str, codes: &[i32]) -> Finish {
    let command = format!("solve -q {arguments}");
    let finish = place.start(place.limited(ADDRESS_SPACE, &command)).finish();
    check(trial, &command, &finish, codes);
    finish
}

fn check(trial: &mut Trial, command: &str, finish: &Finish, codes: &[i32]) {
    trial.time(finish.wall);
    trial.detected |= finish.code == Some(2);
    trial.check(command, finish, codes);
}

/// A folder of the repository.
fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// The shipped studies or scenes, with their names.
fn shipped(name: &str) -> Result<Vec<(String, Value)>, String> {
    let mut paths = files(&folder(name));
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
    let read = |path: &PathBuf| {
        let text = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let value = serde_json::from_slice(&text).map_err(|error| error.to_string())?;
        Ok((path.file_name().unwrap_or_default().to_string_lossy().into_owned(), value))
    };
    paths.iter().map(read).collect()
}
