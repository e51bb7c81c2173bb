//! Arenas of glibc's malloc under a limit of the address space.
//!
//! A thread that allocates reserves an arena of 64 MiB of address space, if there is room, and a command has threads of its
//! libraries. Under `ulimit -v` that leaves the last megabytes to chance: a run of small jobs in 300 MB lost its first
//! thread's stack, or 8 MB for the Parquet file, to arenas.

#![expect(unsafe_code, reason = "a call into the C library")]

use super::{LimitKind, limits};

/// Lets all threads share one arena, if the address space of the process is limited. Without a limit nothing changes.
pub fn share_if_limited() {
    if limits().iter().any(|limit| limit.kind == LimitKind::AddressSpace) {
        #[cfg(target_env = "gnu")]
        // SAFETY: mallopt only sets a parameter of malloc; it is called before the program starts a thread.
        unsafe {
            libc::mallopt(libc::M_ARENA_MAX, 1);
        }
    }
}
