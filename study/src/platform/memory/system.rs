//! Reads the files of the system. No other file of this folder reads anything.

use std::path::Path;

use super::parse::{self, group_folders};
use super::{ControlGroups, Group, Limit, SystemFiles, limits_of};
use crate::platform::files::{Disk, Files};

/// The limits of this process now. None on a system without `/proc`.
pub fn limits() -> Vec<Limit> {
    let groups = group_folders(&text("/proc/self/cgroup"), &text("/proc/self/mountinfo"));
    limits_of(&SystemFiles {
        meminfo: text("/proc/meminfo"),
        limits: text("/proc/self/limits"),
        status: text("/proc/self/status"),
        groups: groups.iter().filter_map(|(version, folder)| group(*version, folder)).collect(),
    })
}

/// Largest resident memory of this process so far, bytes; `None` if the system does not report it.
pub fn peak_resident() -> Option<u64> {
    parse::kibibytes(&text("/proc/self/status"), "VmHWM")
}

fn group(version: ControlGroups, folder: &Path) -> Option<Group> {
    let texts = version.files().map(|name| text(folder.join(name)));
    version.group(texts.each_ref().map(String::as_str))
}

/// The text of a file; empty if it cannot be read.
fn text(path: impl AsRef<Path>) -> String {
    let bytes = Disk.read(path.as_ref()).unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}
