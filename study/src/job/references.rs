//! Static states runs are judged against: looked for once a design, shared by all its jobs.
//!
//! The id of a reference is that of the scene whose states they are
//! ([`billow_solver::models::reference_scene`]): all that does not matter to them left out.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use billow_solver::models;
use billow_solver::output::measures::Reference;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Scene;

use crate::job::JobId;

/// A reference, or why there is none.
type Found = std::result::Result<Reference, String>;
/// Found once; whoever comes meanwhile waits.
type Slot = Arc<OnceLock<Found>>;

/// References by the scene they are of.
#[derive(Debug, Default)]
pub struct References {
    slots: Mutex<BTreeMap<JobId, Slot>>,
    fresh: Mutex<Vec<(JobId, Reference)>>,
}

impl References {
    /// Those found by earlier runs.
    pub fn known(found: impl IntoIterator<Item = (JobId, Reference)>) -> Self {
        let slots = found.into_iter().map(|(id, one)| (id, Arc::new(OnceLock::from(Ok(one)))));
        Self { slots: Mutex::new(slots.collect()), fresh: Mutex::default() }
    }

    /// The reference of a scene; `None` where its model knows its own. The second value says why
    /// there is none where there should be one. `goes_on` is asked now and then; once it says no the
    /// whole run is ending, and none is looked for again.
    pub fn of(
        &self,
        instruction_set: InstructionSet,
        scene: &Scene,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> (Option<Reference>, Option<String>) {
        let Some(of) = models::reference_scene(scene) else { return (None, None) };
        let id = JobId::of(&of);
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(slots.entry(id.clone()).or_default())
        };
        let found = slot.get_or_init(|| {
            let found =
                models::reference(instruction_set, &of, goes_on).map_err(|error| error.to_string());
            if let Ok(reference) = &found {
                let mut fresh = self.fresh.lock().unwrap_or_else(PoisonError::into_inner);
                fresh.push((id, reference.clone()));
            }
            found
        });
        match found {
            Ok(reference) => (Some(reference.clone()), None),
            Err(problem) => (None, Some(format!("no verdict: {problem}"))),
        }
    }

    /// What has been found since the last call.
    pub fn take_fresh(&self) -> Vec<(JobId, Reference)> {
        core::mem::take(&mut self.fresh.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
