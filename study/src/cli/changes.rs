//! What has changed since results were computed: the study, its name, or the physics.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::provenance::PHYSICS_VERSION;
use crate::scene::summary;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::{JOB_LIMITS, Study, StudyKey, UNITS};

/// The study of a given file where it differs from that of the results in its limits, or the ranges of what is assumed,
/// alone: these judge stored rows and change no job. Says on stderr in which keys it differs.
///
/// # Errors
/// A study.json that cannot be read.
pub fn other_limits(of: &Stored<'_>, study: Study, path: &Path) -> Result<Option<Study>> {
    let stored = &of.study;
    if of.results.holds(&study.name, study.file())? {
        return Ok(None);
    }
    let judges_as =
        (study.result_limits(), study.assumed()) == (stored.result_limits(), stored.assumed());
    if !judges_as && stored.plans_as(&study) {
        let limits = |study: &Study| match study.result_limits() {
            [] => "none".to_owned(),
            limits => limits.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        };
        let continues = || format!("; `billow run {}` continues the search", path.display());
        let next = match study.searched() {
            Some(_) => continues(),
            None if study.budget().is_some() => continues(),
            None if study.meshes().of_pilots => {
                format!("; `billow run {}` runs the pilots that these limits need", path.display())
            }
            None => String::new(),
        };
        if study.assumed() != stored.assumed() {
            eprintln!("note: the last run had other ranges of what is assumed");
        }
        if study.result_limits() == stored.result_limits() {
            return Ok(Some(study));
        }
        eprintln!("note: limits {}; the last run had {}{next}", limits(&study), limits(stored));
        return Ok(Some(study));
    }
    let changes = between(stored, &study).join(", ");
    eprintln!(
        "billow: {file} is not the study of these rows ({changes}): the last run had another file or \
         --set; give the same --set, or `billow run {file}`: it keeps all finished jobs",
        file = path.display()
    );
    Ok(None)
}

/// The keys in which two studies differ, with both values: "film.thickness 25.4 um → 30 um".
pub fn between(from: &Study, to: &Study) -> Vec<String> {
    const MAX_SHOWN: usize = 4;
    const GRID: &str = "grid";
    let values = |study: &Study| -> BTreeMap<String, String> {
        let mut json = serde_json::to_value(study.file()).unwrap_or_default();
        // The grid is named as a whole.
        // How a number is shown is no change, nor are the limits of jobs.
        json.as_object_mut().and_then(|keys| keys.remove(UNITS));
        json.as_object_mut().and_then(|keys| keys.remove(JOB_LIMITS));
        json.as_object_mut().and_then(|keys| keys.remove(GRID));
        let grid = serde_json::to_string(&study.file().get(GRID)).unwrap_or_default();
        let rows = summary::rows(&json).into_iter();
        rows.map(|row| (row[0].to_string(), row[1].to_string()))
            .chain([(GRID.to_owned(), grid)])
            .collect()
    };
    let (old, new) = (values(from), values(to));
    let keys: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let differing = keys.into_iter().filter(|key| old.get(*key) != new.get(*key));
    // Both values in one unit, whatever the files write.
    let shown = |study: &Study, key: &str, value: Option<&String>| {
        let known = study.key(key).filter(|known| matches!(known.value, Value::Number(_)));
        let in_unit = |known: StudyKey| {
            to.display_units().of(&known.name, known.key.unit()).quantity(&known.value)
        };
        value
            .map_or_else(|| "none".to_owned(), |value| known.map_or_else(|| value.clone(), in_unit))
    };
    let mut changes: Vec<String> = differing
        .map(|key| match key.as_str() {
            GRID => GRID.to_owned(),
            _ => format!(
                "{key} {} → {}",
                shown(from, key, old.get(key)),
                shown(to, key, new.get(key))
            ),
        })
        .collect();
    let more = changes.len().saturating_sub(MAX_SHOWN);
    changes.truncate(MAX_SHOWN);
    if more > 0 {
        changes.push(format!("and {more} more"));
    }
    changes
}

/// Before a run: says on stderr that the folder was last run for another form of this study.
///
/// # Errors
/// A study.json that cannot be read.
pub fn note_before_run(results: &Results<'_>, study: &Study) -> Result<()> {
    // A folder of another study is refused by the run itself.
    // A damaged study.json is written again by the run itself.
    let Ok(owner) = results.owner() else { return Ok(()) };
    if owner.as_ref() != Some(&study.name) || results.holds(&study.name, study.file())? {
        return Ok(());
    }
    let Ok(stored) = Study::load(&results.study_path(), &[]) else { return Ok(()) };
    let changes = between(&stored, study);
    if !changes.is_empty() {
        eprintln!(
            "note: {} was last run for another form of this study ({}): its table follows this run, \
             until that form runs again; finished jobs of both are kept. --results DIR keeps both tables",
            results.root().display(),
            changes.join(", ")
        );
    }
    Ok(())
}

/// Says on stderr which folder beside that of a study holds its jobs, where its folder holds none: the study or the folder
/// has another name. A job is found by the name of its history, which is not read.
pub fn note_elsewhere(results: &Results<'_>, study: &Study) {
    if let Some([other, uses]) = elsewhere(results, study) {
        let empty = results.root().display();
        eprintln!("note: {other}, {empty} holds none: to use them, give {uses}");
    }
}

/// Which folder beside that of a study holds its jobs, and what to give to use them.
///
/// # Errors
/// [`Error::Disk`] where the folder of the study holds no results.
pub fn find_elsewhere(results: &Results<'_>, study: &Study) -> Result<()> {
    if results.owner()?.is_none()
        && let Some([other, uses]) = elsewhere(results, study)
    {
        let problem = format!("no results here; {other}\n  next: give {uses}");
        return Err(Error::Disk { path: results.root().to_owned(), problem });
    }
    note_elsewhere(results, study);
    Ok(())
}

/// The folder that holds the jobs of a study, in words, and what to give to use them.
fn elsewhere(results: &Results<'_>, study: &Study) -> Option<[String; 2]> {
    /// Jobs that are looked for, at most. Chosen: enough to recognise a study.
    const MAX_JOBS: usize = 16;
    let points = study.points().iter().filter(|point| point.infeasible.is_none());
    let jobs: Vec<&JobId> = points.take(MAX_JOBS).map(|point| &point.job.id).collect();
    let held = |folder: &Results<'_>| jobs.iter().filter(|id| folder.job_path(id).exists()).count();
    if held(results) > 0 {
        return None;
    }
    let beside = results.files().list(results.root().parent()?).ok()?;
    let mut beside = beside.iter().map(|path| Results::new(results.files(), path));
    let other = beside.find(|other| 2 * held(other) > jobs.len())?;
    let (root, owner) = (other.root(), other.owner().ok()??);
    let uses = [
        (owner != study.name).then(|| format!("\"name\": {owner:?} in the study file")),
        (root != Path::new("results").join(&owner))
            .then(|| format!("--results {}", root.display())),
    ];
    let uses = uses.into_iter().flatten().collect::<Vec<_>>().join(" and ");
    Some([format!("{} holds jobs of this study", root.display()), uses])
}

/// What to know about finished jobs of other versions of the physics, by version; `None` without any.
pub fn other_physics(versions: &BTreeMap<i64, usize>) -> Option<String> {
    let texts: Vec<String> = versions
        .iter()
        .map(|(version, jobs)| format!("{jobs} of physics version {version}"))
        .collect();
    (!texts.is_empty()).then(|| {
        format!(
            "finished jobs: {}; this program has version {PHYSICS_VERSION} and other job ids, so \
             `billow run` computes them again; the old results stay in the folder (billow job JOB)",
            texts.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finished_jobs_of_other_physics_are_counted() {
        assert_eq!(other_physics(&BTreeMap::new()), None);
        let note = other_physics(&[(3, 2), (4, 31)].into()).unwrap();
        assert!(
            note.starts_with("finished jobs: 2 of physics version 3, 31 of physics version 4;")
        );
    }
}
