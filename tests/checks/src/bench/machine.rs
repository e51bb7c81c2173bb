//! Speed of the machine itself, to compare reports of different machines.
//!
//! Arithmetic: multiplications and additions of f64 on one core, not fused, as in billow's kernels.
//! Memory: a copy between two buffers, bytes read plus bytes written; one copy larger than the private
//! cache of a core, one within it. A shared cache may be larger than both.

use std::path::Path as FilePath;
use std::time::Instant;

use billow_solver::platform::probe;
use billow_solver::platform::simd::InstructionSet;

use super::{Effort, Line, interrupted};
use billow_study::input::value::Value;
use billow_study::platform::error::Result;
use billow_study::platform::files::{Disk, Files};
use billow_study::platform::provenance;
use billow_study::platform::stop::Stop;

/// Bytes of a buffer larger than the private cache of a core. Chosen.
const LARGE: usize = 64 << 20;
/// Bytes of a buffer within that cache. Chosen.
const SMALL: usize = 256 << 10;

/// Measurements of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Processor, as named by the system.
    pub cpu: Option<String>,
    /// Number of threads the system offers.
    pub cores: Option<usize>,
    /// Instruction set in use.
    pub instruction_set: InstructionSet,
    /// Pairs of a multiplication and an addition per second, on one core.
    pub multiply_adds: Option<f64>,
    /// Bytes read and written per second, beyond the private cache.
    pub copied: Option<f64>,
    /// The same within the private cache.
    pub copied_in_cache: Option<f64>,
    /// Peak memory of the process, bytes.
    pub peak_memory: Option<u64>,
}

impl Machine {
    /// The machine before any measurement.
    pub fn named(instruction_set: InstructionSet) -> Self {
        Self {
            cpu: cpu(),
            cores: std::thread::available_parallelism().ok().map(std::num::NonZero::get),
            instruction_set,
            multiply_adds: None,
            copied: None,
            copied_in_cache: None,
            peak_memory: None,
        }
    }

    /// Measures the machine.
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
            let (pairs, sum) =
                probe::multiply_add(self.instruction_set, std::hint::black_box(rounds));
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

    /// As a row of the report.
    pub fn line(&self) -> Line {
        let text = |text: &str| Value::Text(text.to_owned());
        let number = |number: Option<f64>| number.map_or(Value::Null, Value::Number);
        let count = |count: u64| i64::try_from(count).map_or(Value::Null, Value::Integer);
        vec![
            ("cpu", self.cpu.as_deref().map_or(Value::Null, text)),
            ("cores", self.cores.map_or(Value::Null, |cores| count(cores as u64))),
            ("instruction_set", text(self.instruction_set.name())),
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

/// Largest number of bytes read and written per second while `bytes` are copied between two buffers.
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

/// The value of a line `name : value` in a file of the system.
fn system_value(file: &str, name: &str) -> Option<String> {
    let bytes = Disk.read(FilePath::new(file)).ok()?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let value = |line: &str| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == name).then(|| value.trim().to_owned())
    };
    text.lines().find_map(value)
}

fn cpu() -> Option<String> {
    system_value("/proc/cpuinfo", "model name")
}

/// Time this thread has run on a core so far, s, without other processes; `None` if the system does
/// not report it.
pub fn core_seconds() -> Option<f64> {
    let bytes = Disk.read(FilePath::new("/proc/thread-self/schedstat")).ok()?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}

/// Shortest wall time with a known core share, s. Chosen: the system accounts a thread's time in ticks
/// of some milliseconds.
const MIN_WALL_TIME: f64 = 0.1;

/// Fraction of a wall time (s) in which a thread ran on a core (s); `None` if that is unknown, or if
/// the wall time is too short.
pub fn core_share(core: Option<f64>, wall: f64) -> Option<f64> {
    core.filter(|_| wall >= MIN_WALL_TIME).map(|core| core / wall)
}
