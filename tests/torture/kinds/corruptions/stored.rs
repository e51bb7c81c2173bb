//! Damages of study.json, references, the table, and other files and folders.

use std::fs;
use std::os::unix::fs::symlink;

use super::target::{
    Damage, Expect, Target, cut, fault, faults, flip, harmless, sealed_again, with_other_digit,
    with_other_number, with_other_text,
};

/// Every damage of study.json.
pub fn study_json() -> Vec<Damage> {
    vec![
        fault("study.json: truncated", |target, _| cut(&path(target), 0.5)),
        fault("study.json: empty", |target, _| fs::write(path(target), "").ok()),
        fault("study.json: deleted", |target, _| fs::remove_file(path(target)).ok()),
        fault("study.json: not UTF-8", |target, _| fs::write(path(target), b"\xff\xfe{}").ok()),
        fault("study.json: not JSON", |target, _| fs::write(path(target), "study").ok()),
        fault("study.json: a value edited", |target, _| {
            edit_study(target, |text| Some(text.replacen("0.01", "0.02", 1)))
        }),
        fault("study.json: another number edited", |target, random| {
            edit_study(target, |text| with_other_number(text, "bottom_radius", random))
        }),
        fault("study.json: name edited", |target, _| {
            edit_study(target, |text| with_other_text(text, "name", "other"))
        }),
        fault("study.json: question edited", |target, _| {
            edit_study(target, |text| with_other_text(text, "question", "Is it so?"))
        }),
        fault("study.json: checksum edited", |target, random| {
            edit_study(target, |text| with_other_digit(text, "checksum", random))
        }),
        Damage {
            name: "study.json: of a newer program",
            apply: |target, _| {
                edit_study(target, |text| sealed_again(text, "\"version\": ", "\"version\": 9"))
            },
            expect: Expect::Newer,
            trials: 1,
        },
        faults("study.json: one bit flipped", 6, |target, random| flip(&path(target), random)),
        fault("study.json: a folder in its place", |target, _| {
            fs::remove_file(path(target)).ok()?;
            fs::create_dir(path(target)).ok()
        }),
    ]
}

fn path(target: &Target) -> std::path::PathBuf {
    target.results.join("study.json")
}

fn edit_study(target: &Target, edit: impl FnOnce(&str) -> Option<String>) -> Option<()> {
    let text = fs::read_to_string(path(target)).ok()?;
    let edited = edit(&text)?;
    (edited != text).then(|| fs::write(path(target), edited).ok())?
}

/// Every damage of a static reference.
pub fn references() -> Vec<Damage> {
    vec![
        faults("reference: a number edited", 4, |target, random| {
            edit_reference(target, |text| with_other_number(text, "states", random))
        }),
        fault("reference: 0.8 or 0.9 changed to 0.4", |target, _| {
            edit_reference(target, |text| {
                Some(text.replacen(",0.9", ",0.4", 1).replacen(",0.8", ",0.4", 1))
            })
        }),
        fault("reference: checksum edited", |target, random| {
            edit_reference(target, |text| {
                let key = if text.contains("\"checksum\"") { "checksum" } else { "sha256" };
                with_other_digit(text, key, random)
            })
        }),
        fault("reference: two swapped", |target, _| {
            let (a, b) = two_references(target)?;
            let (first, second) = (fs::read(&a).ok()?, fs::read(&b).ok()?);
            fs::write(a, second).ok()?;
            fs::write(b, first).ok()
        }),
        fault("reference: another one in its place", |target, _| {
            let (a, b) = two_references(target)?;
            fs::copy(a, b).ok().map(|_| ())
        }),
        fault("reference: under another id", |target, _| {
            let (a, _) = two_references(target)?;
            fs::rename(&a, a.with_file_name(format!("{}.json", "0".repeat(32)))).ok()
        }),
        faults("reference: one bit flipped", 4, |target, random| {
            flip(target.references().first()?, random)
        }),
        fault("reference: truncated", |target, _| cut(target.references().first()?, 0.6)),
        fault("reference: empty", |target, _| fs::write(target.references().first()?, "").ok()),
        fault("reference: not UTF-8", |target, _| {
            fs::write(target.references().first()?, b"\xff\xfe").ok()
        }),
        harmless("reference: deleted", "it is computed again when needed", |target, _| {
            fs::remove_file(target.references().first()?).ok()
        }),
        harmless(
            "references: folder deleted",
            "they are computed again when needed",
            |target, _| fs::remove_dir_all(target.results.join("references")).ok(),
        ),
    ]
}

fn two_references(target: &Target) -> Option<(std::path::PathBuf, std::path::PathBuf)> {
    let mut references = target.references().into_iter();
    Some((references.next()?, references.next()?))
}

fn edit_reference(target: &Target, edit: impl FnOnce(&str) -> Option<String>) -> Option<()> {
    let path = target.references().into_iter().next()?;
    let text = fs::read_to_string(&path).ok()?;
    let edited = edit(&text)?;
    (edited != text).then(|| fs::write(path, edited).ok())?
}

/// Every damage of the table, and of files and folders that hold no result.
pub fn others() -> Vec<Damage> {
    vec![
        Damage {
            name: "table: one bit flipped",
            apply: |target, random| flip(&target.results.join("summary.parquet"), random),
            expect: Expect::Harmless("doctor compares every cell; other bytes hold no result"),
            trials: 4,
        },
        fault("table: truncated", |target, _| cut(&target.results.join("summary.parquet"), 0.7)),
        fault("table: empty", |target, _| {
            fs::write(target.results.join("summary.parquet"), "").ok()
        }),
        fault("table: of another study", |target, _| {
            let name = "summary.parquet";
            fs::copy(target.other.join(name), target.results.join(name)).ok().map(|_| ())
        }),
        fault("table: a folder in its place", |target, _| {
            let path = target.results.join("summary.parquet");
            fs::remove_file(&path).ok()?;
            fs::create_dir(path).ok()
        }),
        harmless("table: deleted", "readers use the journal", |target, _| {
            fs::remove_file(target.results.join("summary.parquet")).ok()
        }),
        harmless("lock: deleted", "a run creates it", |target, _| {
            fs::remove_file(target.results.join("lock")).ok()
        }),
        harmless("lock: with content", "only the lock of the system counts", |target, _| {
            fs::write(target.results.join("lock"), "99999").ok()
        }),
        harmless("temporary files of dead processes", "a run removes them", |target, _| {
            let folders = ["", "journal", "references", "charts", "checkpoints"];
            for folder in folders.map(|folder| target.results.join(folder)) {
                fs::create_dir_all(&folder).ok()?;
                fs::write(folder.join(".x.1-0.tmp"), "half").ok()?;
            }
            let history = target.history(&target.job);
            fs::write(history.with_file_name(".x.h5.1-0.tmp"), "half").ok()
        }),
        harmless("attempts of a dead process: not readable", "they count deaths", |target, _| {
            fs::write(target.results.join("attempts.jsonl"), "{\"format\":\nhalf").ok()
        }),
        harmless("a checkpoint of a finished job", "a run removes it", |target, _| {
            let folder = target.results.join("checkpoints");
            fs::create_dir_all(&folder).ok()?;
            fs::write(folder.join(format!("{}.json", target.job)), "{}").ok()
        }),
        harmless("files of another program", "billow ignores them", |target, _| {
            fs::write(target.results.join("notes.txt"), "mine").ok()?;
            symlink("/nowhere", target.results.join("dangling")).ok()
        }),
    ]
}
