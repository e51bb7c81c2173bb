//! What the machine itself can do, so that a slow one shows.
//!
//! Arithmetic: multiplications and additions of f64 on one core, not fused, as billow's own are.
//! Memory: a copy between two buffers, bytes read and bytes written counted; once larger than any
//! core's own cache, once within it. A shared cache may be larger still than what is copied.

use std::path::Path as FilePath;
use std::time::Instant;

use billow_solver::platform::probe;
use billow_solver::platform::simd::InstructionSet;

use super::{Effort, Line, interrupted};
use crate::input::value::Value;
use crate::platform::error::Result;
use crate::platform::files::{Disk, Files};
use crate::platform::provenance;
use crate::platform::stop::Stop;

/// Bytes of a buffer beyond a core's own cache.
const LARGE: usize = 64 << 20;
/// Bytes of a buffer within it.
const SMALL: usize = 256 << 10;

/// What was measured of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Processor, as the system calls it.
    pub cpu: Option<String>,
    /// Threads the system gives.
    pub cores: Option<usize>,
    /// Instruction set in use.
    pub path: InstructionSet,
    /// Pairs of a multiplication and an addition, 1/s of one core.
    pub multiply_adds: Option<f64>,
    /// Bytes read and written a second, beyond a core's own cache.
    pub copied: Option<f64>,
    /// The same within it.
    pub copied_in_cache: Option<f64>,
    /// Most memory the process has held, bytes.
    pub peak_memory: Option<u64>,
}

impl Machine {
    /// Its name, unmeasured.
    pub fn named(path: InstructionSet) -> Self {
        Self {
            cpu: cpu(),
            cores: std::thread::available_parallelism().ok().map(std::num::NonZero::get),
            path,
            multiply_adds: None,
            copied: None,
            copied_in_cache: None,
            peak_memory: None,
        }
    }

    /// Measures it.
    ///
    /// # Errors
    /// A signal.
    pub fn measure(&mut self, effort: Effort, stop: &Stop) -> Result<()> {
        let (repeats, rounds) = match effort {
            Effort::Quick => (3, 200_000),
            Effort::Usual | Effort::Full => (10, 2_000_000),
        };
        let mut best = 0.0_f64;
        for _ in 0..repeats {
            let start = Instant::now();
            let (pairs, sum) = probe::multiply_add(self.path, std::hint::black_box(rounds));
            std::hint::black_box(sum);
            best = best.max(pairs as f64 / start.elapsed().as_secs_f64());
            interrupted(stop)?;
        }
        self.multiply_adds = Some(best);
        self.copied = Some(copy(LARGE, repeats, 1));
        interrupted(stop)?;
        self.copied_in_cache = Some(copy(SMALL, repeats, 200));
        interrupted(stop)
    }

    /// As a row.
    pub fn line(&self) -> Line {
        let text = |text: &str| Value::Text(text.to_owned());
        let number = |number: Option<f64>| number.map_or(Value::Null, Value::Number);
        let count = |count: u64| i64::try_from(count).map_or(Value::Null, Value::Integer);
        vec![
            ("cpu", self.cpu.as_deref().map_or(Value::Null, text)),
            ("cores", self.cores.map_or(Value::Null, |cores| count(cores as u64))),
            ("path", text(self.path.name())),
            ("multiply_adds_per_second", number(self.multiply_adds)),
            ("copy_bytes_per_second", number(self.copied)),
            ("copy_bytes", count(LARGE as u64)),
            ("cached_copy_bytes_per_second", number(self.copied_in_cache)),
            ("cached_copy_bytes", count(SMALL as u64)),
            ("peak_memory", self.peak_memory.map_or(Value::Null, count)),
            ("program_version", text(provenance::PROGRAM_VERSION)),
            ("commit", text(provenance::COMMIT)),
        ]
    }
}

/// Most bytes read and written a second, copying `bytes` from one buffer to another.
fn copy(bytes: usize, repeats: u32, passes: u32) -> f64 {
    let source = vec![1.0_f64; bytes / size_of::<f64>()];
    let mut target = vec![0.0_f64; source.len()];
    let once = |_| {
        let start = Instant::now();
        for _ in 0..passes {
            target.copy_from_slice(std::hint::black_box(&source));
            std::hint::black_box(&mut target);
        }
        f64::from(passes) * 2.0 * bytes as f64 / start.elapsed().as_secs_f64()
    };
    (0..repeats).map(once).fold(0.0, f64::max)
}

/// A line `name : value` of a file the system writes.
fn said(file: &str, name: &str) -> Option<String> {
    let bytes = Disk.read(FilePath::new(file)).ok()?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let value = |line: &str| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == name).then(|| value.trim().to_owned())
    };
    text.lines().find_map(value)
}

fn cpu() -> Option<String> {
    said("/proc/cpuinfo", "model name")
}

/// Time this thread has run on a core so far, s; `None` where the system does not say. Unlike wall time
/// it leaves out who else uses the core.
pub fn core_seconds() -> Option<f64> {
    let bytes = Disk.read(FilePath::new("/proc/thread-self/schedstat")).ok()?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}

/// Wall time below which the share on a core is not told, s: the system books a thread's time a tick of
/// some milliseconds after it is spent.
const TELLING: f64 = 0.1;

/// Share of a wall time (s) a thread was on a core for so long (s); `None` where that is not known, or
/// the wall time too short to tell.
pub fn core_share(core: Option<f64>, wall: f64) -> Option<f64> {
    core.filter(|_| wall >= TELLING).map(|core| core / wall)
}

/// Memory of this machine, bytes; `None` where the system does not say.
pub fn memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemTotal")
}

/// Most memory this process has held, bytes; `None` where the system does not say.
pub fn peak_memory() -> Option<u64> {
    kibibytes("/proc/self/status", "VmHWM")
}

/// A line `name : value kB` of a file the system writes, bytes.
fn kibibytes(file: &str, name: &str) -> Option<u64> {
    let kibibytes: u64 = said(file, name)?.strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}
