//! Memory that this process may use: the smallest of what the machine has available, the limits of its
//! control groups and the limit of its address space.
//!
//! ```text
//! usable = limit − in use − margin        of the limit that leaves least
//! ```
//!
//! In use: other processes for the machine, the group for a control group, this process for the address space.
//! Margin: what the program needs beside its jobs (`Limit::margin`).

mod arenas;
mod parse;
mod system;

use std::fmt;

use parse::ControlGroups;

pub use arenas::share_if_limited;
pub use system::{limits, peak_resident};

/// What limits the memory of this process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
    /// The memory of the machine that is available now.
    Machine,
    /// A control group, of version 1 or 2.
    ControlGroup,
    /// The address space of the process, `ulimit -v`.
    AddressSpace,
}

/// A limit of the memory of this process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// What sets it.
    pub kind: LimitKind,
    /// The limit, bytes.
    pub total: u64,
    /// What is not in use, bytes.
    pub free: u64,
}

/// Memory of the program beside its jobs: table, history file, libraries, bytes. Measured: 60 MB for a run of one
/// small job, most of them before the first job.
const PROGRAM: u64 = 48 << 20;
/// Address space of the program beside its jobs and threads, bytes. Measured: a study of small jobs needs 60 MB
/// above its start, arenas of other threads 66 MB each while there is room for them.
const PROGRAM_ADDRESS_SPACE: u64 = 96 << 20;
/// Memory and address space of a command without threads beside its mesh, bytes. Chosen: libraries and buffers.
const COMMAND: u64 = 24 << 20;
/// Address space of a thread, bytes: an arena of glibc's malloc (64 MiB) and a stack (2 MiB). Source:
/// `HEAP_MAX_SIZE` of glibc; the standard library of Rust.
const THREAD_ADDRESS_SPACE: u64 = 66 << 20;
/// Memory of a thread beside its job, bytes. Measured: 1 to 3 MB.
const THREAD: u64 = 4 << 20;

impl Limit {
    /// What the program needs beside the jobs of this number of threads, bytes.
    fn margin(&self, threads: usize) -> u64 {
        let threads = threads as u64;
        match self.kind {
            LimitKind::Machine | LimitKind::ControlGroup => PROGRAM + threads * THREAD,
            LimitKind::AddressSpace => PROGRAM_ADDRESS_SPACE + threads * THREAD_ADDRESS_SPACE,
        }
    }

    /// What jobs on this number of threads may use together, bytes.
    pub fn usable(&self, threads: usize) -> u64 {
        self.free.saturating_sub(self.margin(threads))
    }

    /// What a command that computes on its first thread may use, bytes.
    pub fn usable_alone(&self) -> u64 {
        let arena = match self.kind {
            LimitKind::Machine | LimitKind::ControlGroup => 0,
            // That of the thread that waits for signals.
            LimitKind::AddressSpace => THREAD_ADDRESS_SPACE,
        };
        self.free.saturating_sub(COMMAND + arena)
    }

    /// The largest number of threads up to `threads` that leaves half of the free memory to jobs; at least one.
    pub fn threads(&self, threads: usize) -> usize {
        let fits = |threads: &usize| 2 * self.margin(*threads) <= self.free;
        (1..=threads).rev().find(fits).unwrap_or(1)
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let total = size(self.total);
        match self.kind {
            LimitKind::Machine => write!(f, "the machine's memory of {total}"),
            LimitKind::ControlGroup => write!(f, "the control group's limit of {total} (cgroup)"),
            LimitKind::AddressSpace => write!(f, "the address space limit of {total} (ulimit -v)"),
        }
    }
}

/// The limit that leaves least to jobs on this number of threads; `None` if the system reports none.
pub fn smallest(limits: &[Limit], threads: usize) -> Option<Limit> {
    limits.iter().copied().min_by_key(|limit| limit.usable(threads))
}

/// A number of bytes for a message, in two digits: "700 MB", "1.7 GB".
pub fn size(bytes: u64) -> String {
    let (unit, name) = match bytes {
        0..1_000_000 => (1e3, "kB"),
        1_000_000..1_000_000_000 => (1e6, "MB"),
        1_000_000_000..1_000_000_000_000 => (1e9, "GB"),
        _ => (1e12, "TB"),
    };
    let number = bytes as f64 / unit;
    if number < 9.95 { format!("{number:.1} {name}") } else { format!("{number:.0} {name}") }
}

/// The limits of what files of the system say.
fn limits_of(files: &SystemFiles) -> Vec<Limit> {
    let machine = || {
        let total = parse::kibibytes(&files.meminfo, "MemTotal")?;
        let free = parse::kibibytes(&files.meminfo, "MemAvailable")?;
        Some(Limit { kind: LimitKind::Machine, total, free })
    };
    let address_space = || {
        let total = parse::address_space_limit(&files.limits)?;
        let used = parse::kibibytes(&files.status, "VmSize")?;
        let free = total.saturating_sub(used);
        Some(Limit { kind: LimitKind::AddressSpace, total, free })
    };
    let groups = files.groups.iter().map(|group| Limit {
        kind: LimitKind::ControlGroup,
        total: group.limit,
        free: group.limit.saturating_sub(group.used),
    });
    machine().into_iter().chain(groups).chain(address_space()).collect()
}

/// Text of the files of the system that say what limits this process.
#[derive(Debug, Default)]
struct SystemFiles {
    /// `/proc/meminfo`.
    meminfo: String,
    /// `/proc/self/limits`.
    limits: String,
    /// `/proc/self/status`.
    status: String,
    /// Control groups with a limit.
    groups: Vec<Group>,
}

/// Limit and usage of a control group, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Group {
    limit: u64,
    used: u64,
}

#[cfg(test)]
mod tests;
