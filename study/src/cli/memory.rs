//! Whether a film job fits into the memory of this machine. A clear error is better than a process that
//! the operating system kills.
//!
//! ```text
//! bytes ≥ 5.5e3 e        e elements of the mesh
//! ```

use billow_solver::scene::ModelKind;

use crate::bench::machine;
use crate::input::value::brief_number;
use crate::platform::error::{Error, InputError, Result};
use crate::study::Study;

/// Least memory per element, bytes. Measured on the stowed capsule with contact; film with many contacts
/// needs up to four times as much.
const MIN_BYTES_PER_ELEMENT: f64 = 5.5e3;

/// Refuses a study with a mesh that needs more memory than this machine has. `file` is the study file.
///
/// # Errors
/// [`Error::Input`].
pub fn check(file: &str, study: &Study) -> Result<()> {
    let runs = study.points().iter().filter(|point| point.infeasible.is_none());
    let scenes = runs.map(|point| &point.scene);
    let film = scenes.filter(|scene| scene.solver.model == ModelKind::Film);
    let elements = film.map(|scene| scene.design.elements()).max().unwrap_or(0);
    match machine::memory().and_then(|memory| excess(elements, memory)) {
        None => Ok(()),
        Some([problem, allowed]) => Err(Error::Input(InputError {
            file: file.to_owned(),
            key: "design.subdivisions".to_owned(),
            value: String::new(),
            problem,
            allowed,
            hint: "use a coarser mesh: n = 5 to 16 is enough for a study (README, Models)"
                .to_owned(),
        })),
    }
}

/// The problem and what is allowed, as texts, when this number of elements needs more than `memory`
/// bytes.
fn excess(elements: u64, memory: u64) -> Option<[String; 2]> {
    let (elements, memory) = (elements as f64, memory as f64);
    let problem = || {
        format!(
            "a mesh of {} million elements needs at least {} GB of memory; this machine has {} GB",
            brief_number(1e-6 * elements),
            brief_number(1e-9 * elements * MIN_BYTES_PER_ELEMENT),
            brief_number(1e-9 * memory)
        )
    };
    let allowed = || {
        let most = 1e-6 * memory / MIN_BYTES_PER_ELEMENT;
        format!("up to {} million elements on this machine", brief_number(most))
    };
    (elements * MIN_BYTES_PER_ELEMENT > memory).then(|| [problem(), allowed()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_mesh_that_cannot_fit_is_refused() {
        let memory = 24 << 30;
        assert_eq!(excess(49_152, memory), None);
        assert_eq!(excess(4_000_000, memory), None);
        let [problem, _] = excess(12_000_000, memory).expect("too many elements");
        assert!(problem.starts_with("a mesh of 12 million elements needs at least 66 GB"));
    }
}
