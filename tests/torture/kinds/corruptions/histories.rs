//! Damages of history files.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::time::{Duration, SystemTime};

use super::target::{Damage, Target, cut, edit_file, fault, faults, flip, harmless, zero};
use crate::harness::random::Random;

/// Every damage of a history file.
pub fn all() -> Vec<Damage> {
    vec![
        faults("history: one bit flipped", 8, |target, random| {
            flip(&target.history(&target.job), random)
        }),
        faults("history: other bytes, same size and time", 6, same_size_and_time),
        faults("history: a block of NUL bytes", 2, |target, random| {
            zero(&target.history(&target.job), random)
        }),
        fault("history: truncated", |target, _| cut(&target.history(&target.job), 0.5)),
        fault("history: last byte lost", |target, _| {
            edit_file(&target.history(&target.job), |bytes| bytes.pop().map(|_| ()))
        }),
        fault("history: a byte appended", |target, _| {
            edit_file(&target.history(&target.job), |bytes| {
                bytes.push(0);
                Some(())
            })
        }),
        fault("history: empty", |target, _| fs::write(target.history(&target.job), "").ok()),
        fault("history: deleted", |target, _| fs::remove_file(target.history(&target.job)).ok()),
        fault("history: folder deleted", |target, _| {
            fs::remove_dir_all(target.history(&target.job).parent()?).ok()
        }),
        fault("history: all deleted", |target, _| {
            fs::remove_dir_all(target.results.join("jobs")).ok()
        }),
        fault("history: that of another job", |target, _| {
            let other = target.history(&target.second);
            fs::copy(other, target.history(&target.job)).ok().map(|_| ())
        }),
        fault("history: two swapped", |target, _| {
            let (a, b) = (target.history(&target.job), target.history(&target.second));
            let (first, second) = (fs::read(&a).ok()?, fs::read(&b).ok()?);
            fs::write(a, second).ok()?;
            fs::write(b, first).ok()
        }),
        fault("history: a link to that of another job", |target, _| {
            let path = target.history(&target.job);
            fs::remove_file(&path).ok()?;
            symlink(target.history(&target.second), path).ok()
        }),
        fault("history: a folder in its place", |target, _| {
            let path = target.history(&target.job);
            fs::remove_file(&path).ok()?;
            fs::create_dir(path).ok()
        }),
        harmless(
            "history: only its time changed",
            "its bytes are the recorded ones",
            |target, _| {
                let path = target.history(&target.job);
                let file = File::options().write(true).open(path).ok()?;
                file.set_modified(SystemTime::now() - Duration::from_hours(24)).ok()
            },
        ),
    ]
}

/// Changes one byte and restores the time of the last change.
fn same_size_and_time(target: &Target, random: &mut Random) -> Option<()> {
    let path = target.history(&target.job);
    let time = fs::metadata(&path).ok()?.modified().ok()?;
    flip(&path, random)?;
    File::options().write(true).open(path).ok()?.set_modified(time).ok()
}
