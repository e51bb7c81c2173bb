//! Whether a job of film fits into this machine's memory: better told at once than by the system, which
//! ends whoever takes the last of it.
//!
//! ```text
//! bytes ≥ 5.5e3 e        e elements of the mesh
//! ```
//!
//! Measured on the stowed capsule with contact (282 MB at 49,152 elements); film that lies on film takes
//! up to four times as much.

use billow_solver::scene::ModelKind;

use crate::bench::machine;
use crate::input::value::brief_number;
use crate::platform::error::{Error, InputError, Result};
use crate::study::Study;

/// Bytes an element takes at least.
const LEAST: f64 = 5.5e3;

/// Refuses a study, in this file, of which a mesh has more elements than this machine has memory for.
///
/// # Errors
/// [`Error::Input`].
pub fn check(file: &str, study: &Study) -> Result<()> {
    let runs = study.points().iter().filter(|point| point.infeasible.is_none());
    let scenes = runs.map(|point| &point.scene);
    let film = scenes.filter(|scene| scene.solver.model == ModelKind::Film);
    let elements = film.map(|scene| scene.design.elements()).max().unwrap_or(0);
    match machine::memory().and_then(|memory| too_many(elements, memory)) {
        None => Ok(()),
        Some([problem, allowed]) => Err(Error::Input(InputError {
            file: file.to_owned(),
            key: "design.subdivisions".to_owned(),
            value: String::new(),
            problem,
            allowed,
            hint: "a coarser mesh: n 5 to 16 answers what a study asks (README, Models)".to_owned(),
        })),
    }
}

/// Why so much memory (bytes) does not hold so many elements, and how many it does, in words; `None`
/// where it may.
fn too_many(elements: u64, memory: u64) -> Option<[String; 2]> {
    let (elements, memory) = (elements as f64, memory as f64);
    let problem = || {
        format!(
            "a mesh of {} million elements takes {} GB of memory or more, this machine has {}",
            brief_number(1e-6 * elements),
            brief_number(1e-9 * elements * LEAST),
            brief_number(1e-9 * memory)
        )
    };
    let allowed = || format!("up to {} million elements here", brief_number(1e-6 * memory / LEAST));
    (elements * LEAST > memory).then(|| [problem(), allowed()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_cannot_fit_is_refused() {
        let memory = 24 << 30;
        assert_eq!(too_many(49_152, memory), None);
        assert_eq!(too_many(4_000_000, memory), None);
        let [told, _] = too_many(12_000_000, memory).expect("too many");
        assert!(told.starts_with("a mesh of 12 million elements takes 66 GB"), "{told}");
    }
}
