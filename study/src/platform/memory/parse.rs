//! Reads the files of Linux that say what limits a process. Every function takes text.

use std::path::{Path, PathBuf};

use super::Group;

/// The value of a line `name: value kB`, bytes.
pub(super) fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let value = text.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == name).then_some(value)
    })?;
    let kibibytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// The soft limit of the address space in `/proc/PID/limits`, bytes; `None` if there is none.
pub(super) fn address_space_limit(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// A hierarchy of control groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ControlGroups {
    /// Version 1, controller `memory`.
    V1,
    /// Version 2.
    V2,
}

impl ControlGroups {
    /// Names of the files of a group with its limit, its usage and its statistics.
    pub(super) fn files(self) -> [&'static str; 3] {
        match self {
            Self::V1 => ["memory.limit_in_bytes", "memory.usage_in_bytes", "memory.stat"],
            Self::V2 => ["memory.max", "memory.current", "memory.stat"],
        }
    }

    /// Name of the statistic of file contents that the system drops when memory is short, in bytes.
    fn reclaimable(self) -> &'static str {
        match self {
            Self::V1 => "total_inactive_file",
            Self::V2 => "inactive_file",
        }
    }

    /// Limit and usage of a group by the text of its [`Self::files`]; `None` without a limit.
    pub(super) fn group(self, [limit, used, statistics]: [&str; 3]) -> Option<Group> {
        // Version 1 writes a number near 2⁶³ for no limit.
        let limit = limit.trim().parse().ok().filter(|limit| *limit < 1 << 60)?;
        let used: u64 = used.trim().parse().ok()?;
        let reclaimable = statistics.lines().find_map(|line| {
            let (name, value) = line.split_once(' ')?;
            if name == self.reclaimable() { value.trim().parse().ok() } else { None }
        });
        Some(Group { limit, used: used.saturating_sub(reclaimable.unwrap_or(0)) })
    }
}

/// Folders of the groups of a process, the innermost first, by `/proc/self/cgroup` and
/// `/proc/self/mountinfo`. A limit of an outer group holds too.
pub(super) fn group_folders(cgroup: &str, mountinfo: &str) -> Vec<(ControlGroups, PathBuf)> {
    let mut folders = Vec::new();
    for (version, root, mount) in mountinfo.lines().filter_map(mount) {
        let Some(path) = cgroup.lines().find_map(|line| path_of(line, version)) else { continue };
        // In a container the mount may show a part of the hierarchy, or only the group itself.
        let inside = Path::new(path).strip_prefix(root).unwrap_or(Path::new(""));
        let mount = Path::new(mount);
        let whole = mount.join(inside.strip_prefix("/").unwrap_or(inside));
        let folder = whole.ancestors().take_while(|folder| folder.starts_with(mount));
        folders.extend(folder.map(|folder| (version, folder.to_owned())));
    }
    folders
}

/// Version, root and mount point of a line of mountinfo that mounts a hierarchy of memory groups.
fn mount(line: &str) -> Option<(ControlGroups, &str, &str)> {
    let (mount, system) = line.split_once(" - ")?;
    let mut fields = mount.split(' ').skip(3);
    let (root, point) = (fields.next()?, fields.next()?);
    let mut system = system.split(' ');
    match (system.next()?, system.nth(1)?) {
        ("cgroup2", _) => Some((ControlGroups::V2, root, point)),
        ("cgroup", options) if options.split(',').any(|option| option == "memory") => {
            Some((ControlGroups::V1, root, point))
        }
        _ => None,
    }
}

/// The path of a group in a line `number:controllers:path` of `/proc/self/cgroup`.
fn path_of(line: &str, version: ControlGroups) -> Option<&str> {
    let mut fields = line.splitn(3, ':');
    let (number, controllers, path) = (fields.next()?, fields.next()?, fields.next()?);
    let found = match version {
        ControlGroups::V1 => controllers.split(',').any(|controller| controller == "memory"),
        ControlGroups::V2 => number == "0" && controllers.is_empty(),
    };
    found.then_some(path)
}
