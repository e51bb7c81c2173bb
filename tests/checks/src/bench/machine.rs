//! Speed of the machine's memory, to compare reports of different machines: a copy between two buffers, bytes
//! read plus bytes written; one copy larger than the private cache of a core, one within it. A shared cache may
//! be larger than both.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use billow_solver::platform::simd::InstructionSet;
use billow_study::platform::files::{Disk, Files};
use billow_study::platform::provenance;

use super::Row;

/// Repeats of a measurement, of which the fastest counts. Chosen: a second in all.
const REPEATS: u32 = 10;
/// Bytes of a buffer larger than the private cache of a core. Chosen.
const LARGE: usize = 64 << 20;
/// Bytes of a buffer within that cache. Chosen.
const SMALL: usize = 256 << 10;

/// What the machine and the program are.
pub(super) fn row(set: InstructionSet) -> Row {
    let cores = std::thread::available_parallelism().ok().map(std::num::NonZero::get);
    vec![
        ("cpu", cpu().into()),
        ("cores", cores.into()),
        ("instruction_set", set.name().into()),
        ("program_version", provenance::PROGRAM_VERSION.into()),
        ("commit", provenance::COMMIT.into()),
    ]
}

/// Speed of memory on one core.
pub(super) fn speed() -> Row {
    vec![
        ("copy_bytes_per_second", copy(LARGE, 1).into()),
        ("copy_bytes", LARGE.into()),
        ("cached_copy_bytes_per_second", copy(SMALL, 200).into()),
        ("cached_copy_bytes", SMALL.into()),
    ]
}

/// Largest number of bytes read and written per second while `bytes` are copied between two buffers.
fn copy(bytes: usize, passes: u32) -> f64 {
    let source = vec![1.0_f64; bytes / size_of::<f64>()];
    let mut target = vec![0.0_f64; source.len()];
    let once = |_| {
        let start = Instant::now();
        for _ in 0..passes {
            target.copy_from_slice(black_box(&source));
            black_box(&mut target);
        }
        f64::from(passes) * 2.0 * bytes as f64 / start.elapsed().as_secs_f64()
    };
    (0..REPEATS).map(once).fold(0.0, f64::max)
}

/// A file of the system as text.
fn system_text(file: &str) -> Option<String> {
    Some(String::from_utf8_lossy(&Disk.read(Path::new(file)).ok()?).into_owned())
}

fn cpu() -> Option<String> {
    let text = system_text("/proc/cpuinfo")?;
    let model = text.lines().find(|line| line.starts_with("model name"))?;
    Some(model.split_once(':')?.1.trim().to_owned())
}

/// Wall time and time on a core of this thread.
pub(super) struct Watch {
    start: Instant,
    on_core: Option<f64>,
}

impl Watch {
    /// Starts now.
    pub(super) fn start() -> Self {
        Self { start: Instant::now(), on_core: core_seconds() }
    }

    /// Wall time and time on a core so far, s; that of the core only if the system reports it.
    pub(super) fn seconds(&self) -> (f64, Option<f64>) {
        let wall = self.start.elapsed().as_secs_f64();
        (wall, core_seconds().zip(self.on_core).map(|(now, then)| now - then))
    }
}

/// Time this thread has run on a core so far, s, without other processes.
fn core_seconds() -> Option<f64> {
    let text = system_text("/proc/thread-self/schedstat")?;
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}

/// Shortest wall time with a known core share, s. Chosen: the system accounts a thread's time in ticks
/// of some milliseconds.
const MIN_WALL_TIME: f64 = 0.1;

/// Fraction of a wall time (s) in which a thread ran on a core (s); `None` if that is unknown, or if
/// the wall time is too short.
pub(super) fn core_share((wall, on_core): (f64, Option<f64>)) -> Option<f64> {
    on_core.filter(|_| wall >= MIN_WALL_TIME).map(|on_core| on_core / wall)
}
