//! A real full disk, and a real disk without inodes: a small tmpfs. It needs root, or user namespaces.

use std::process::Command;
use std::time::Duration;

use crate::harness::check::{self, Truth};
use crate::harness::place::{self, Place};
use crate::harness::program::{self, BILLOW, Finish, HANG};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Sizes of the small disk, kB: the study needs less than the last one.
const SIZES: [usize; 16] = [4, 8, 12, 20, 28, 40, 60, 80, 120, 160, 200, 240, 280, 320, 360, 1000];
/// Inodes of the small disk: the study needs less than the last one.
const INODES: [usize; 16] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 18, 20, 24, 60];

/// The kind.
pub struct Disk {
    truth: Truth,
    /// Prefix of the commands that may mount; `None` where none may.
    prefix: Option<Vec<&'static str>>,
}

/// Runs the study undisturbed, and looks whether a disk can be mounted.
pub fn prepare(place: &Place) -> Result<Disk, String> {
    place.write_study(&studies::small());
    let truth = Truth::of_run(place)?;
    let can_mount = |prefix: &Vec<&'static str>| {
        let mut words = prefix.clone();
        words.extend(["mount", "-t", "tmpfs", "-o", "size=1m", "none"]);
        let target = place.join("probe");
        let _ = std::fs::create_dir(&target);
        let mounted = Command::new(words[0]).args(&words[1..]).arg(target).output();
        mounted.is_ok_and(|output| output.status.success())
    };
    // Each prefix ends its mounts with its process.
    let prefixes = [vec!["unshare", "--mount"], vec!["unshare", "--map-root-user", "--mount"]];
    let prefix = prefixes.into_iter().find(can_mount);
    Ok(Disk { truth, prefix })
}

impl Kind for Disk {
    fn trials(&self) -> usize {
        SIZES.len() + INODES.len()
    }

    fn limit(&self) -> Duration {
        HANG
    }

    fn trial(&self, number: usize, _: &mut Random, place: &Place) -> Trial {
        let option = match SIZES.get(number) {
            Some(size) => format!("size={size}k"),
            None => format!("size=10m,nr_inodes={}", INODES[number - SIZES.len()]),
        };
        let mut trial = Trial::new(option.clone());
        let Some(prefix) = &self.prefix else {
            trial.skipped = Some("no right to mount a tmpfs (root or unshare -rm)".to_owned());
            return trial;
        };
        place.write_study(&studies::small());
        std::fs::create_dir_all(place.join("results")).expect("a folder of a trial");
        let finish = on_small_disk(place, prefix, &option);
        trial.time(finish.wall);
        trial.detected = finish.code == Some(2);
        finish.check_refusal(&mut trial, "run", &[0, 2]);
        if trial.detected && !finish.stderr.contains("No space left on device") {
            trial.fault(Fault::WrongMessage, format!("another cause: {}", finish.said()));
        }
        // What was stored is now on a disk with space.
        let stored = place.join("stored");
        std::fs::create_dir_all(place.results()).expect("a folder of a trial");
        if stored.is_dir() {
            place::copy(&stored, &place.results());
        }
        let last = studies::run(place);
        last.check_refusal(&mut trial, "run", &[0]);
        check::compare(&mut trial, place, &self.truth);
        check::compare_journal(&mut trial, place);
        trial
    }
}

/// Runs the study with its results on a small disk, and copies them away.
fn on_small_disk(place: &Place, prefix: &[&str], option: &str) -> Finish {
    let script = "mount -t tmpfs -o \"$1\" none results || exit 99
        \"$0\" run s.json --quiet --threads 2; code=$?
        [ ! -d results/s ] || cp -a results/s stored; exit $code";
    let mut command = Command::new(prefix[0]);
    command.args(&prefix[1..]).args(["sh", "-c", script, BILLOW, option]);
    command.current_dir(place.path());
    program::start(place, command).finish(HANG)
}
