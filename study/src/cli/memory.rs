//! Whether a job of film fits into this machine's memory: better told at once than by the system, which
//! ends whoever takes the last of it.
//!
//! ```text
//! bytes ≥ 5.5e3 e        e = 2 N (M + 1) n² for a capsule
//! ```
//!
//! Measured on the stowed capsule with contact (282 MB at 49,152 elements); film that lies on film takes
//! up to four times as much.

use billow_solver::scene::{ModelKind, Scene};

use crate::bench::machine;
use crate::error::{Error, InputError, Result};
use crate::study::Study;
use crate::value::brief_number;

/// Bytes an element takes at least.
const LEAST: f64 = 5.5e3;

/// Elements of a capsule's mesh; 0 where its model has none.
fn elements(scene: &Scene) -> f64 {
    let design = &scene.design;
    let n = f64::from(design.subdivisions);
    match scene.solver.model {
        ModelKind::Film => 2.0 * f64::from(design.panels) * f64::from(design.storeys + 1) * n * n,
        ModelKind::Piston => 0.0,
    }
}

/// Why so many elements do not fit, in words; `None` where they may, or nobody knows.
fn too_many(elements: f64, memory: Option<u64>) -> Option<String> {
    let memory = memory? as f64;
    (elements * LEAST > memory).then(|| {
        format!(
            "a mesh of {} million elements takes {} GB of memory or more, this machine has {}",
            brief_number(1e-6 * elements),
            brief_number(1e-9 * elements * LEAST),
            brief_number(1e-9 * memory)
        )
    })
}

/// Refuses a mesh this machine has no memory for. `file` and `key` are what decides it.
///
/// # Errors
/// [`Error::Input`].
pub fn check(file: &str, key: &str, elements: f64) -> Result<()> {
    let Some(problem) = too_many(elements, machine::memory()) else { return Ok(()) };
    Err(Error::Input(InputError {
        file: file.to_owned(),
        key: key.to_owned(),
        value: String::new(),
        problem,
        allowed: format!("up to {} million elements here", brief_number(most(machine::memory()))),
        hint: "a coarser mesh: n 5 to 16 answers what a study asks (README, Models)".to_owned(),
    }))
}

/// Millions of elements so much memory holds at most.
fn most(memory: Option<u64>) -> f64 {
    memory.map_or(f64::INFINITY, |memory| 1e-6 * memory as f64 / LEAST)
}

/// The same for every job of a study.
///
/// # Errors
/// [`Error::Input`].
pub fn check_study(file: &str, study: &Study) -> Result<()> {
    let largest = study.points().iter().map(|point| elements(&point.scene)).fold(0.0, f64::max);
    check(file, "design.subdivisions", largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_cannot_fit_is_refused() {
        let memory = Some(24 << 30);
        assert_eq!(too_many(49_152.0, memory), None);
        assert_eq!(too_many(4.0e6, memory), None);
        let told = too_many(12.0e6, memory).expect("too many");
        assert!(told.starts_with("a mesh of 12 million elements takes 66 GB"), "{told}");
        assert_eq!(too_many(12.0e6, None), None, "nobody knows");
    }
}
