//! Static references that the verdicts of runs need: computed once per design, shared by its jobs.
//!
//! The id of a reference is the id of its [`billow_solver::models::reference_scene`]: the scene
//! without everything that does not change the static states.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use billow_solver::models;
use billow_solver::output::measures::Reference;
use billow_solver::scene::Scene;

use crate::job::JobId;

/// A reference, or the reason why there is none.
type Computed = std::result::Result<Reference, String>;
/// Computed by the first job that needs it; the other jobs wait.
type Slot = Arc<OnceLock<Computed>>;

/// References by the id of their scene.
#[derive(Debug, Default)]
pub struct References {
    slots: Mutex<BTreeMap<JobId, Slot>>,
    new: Mutex<Vec<(JobId, Reference)>>,
}

impl References {
    /// Starts with references that earlier runs stored.
    pub fn known(stored: impl IntoIterator<Item = (JobId, Reference)>) -> Self {
        let slots =
            stored.into_iter().map(|(id, reference)| (id, Arc::new(OnceLock::from(Ok(reference)))));
        Self { slots: Mutex::new(slots.collect()), new: Mutex::default() }
    }

    /// The reference of a scene, `None` for a model that needs none, and the reason when a model
    /// needs one and there is none. `goes_on` is called from time to time; when it returns `false`
    /// the computation ends. The whole run is ending then, so the reference stays missing.
    pub fn of(
        &self,
        scene: &Scene,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> (Option<Reference>, Option<String>) {
        let Some(scene) = models::reference_scene(scene) else { return (None, None) };
        let id = JobId::of(&scene);
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(slots.entry(id.clone()).or_default())
        };
        let computed = slot.get_or_init(|| {
            let computed = models::reference(&scene, goes_on).map_err(|error| error.to_string());
            if let Ok(reference) = &computed {
                let mut new = self.new.lock().unwrap_or_else(PoisonError::into_inner);
                new.push((id, reference.clone()));
            }
            computed
        });
        match computed {
            Ok(reference) => (Some(reference.clone()), None),
            Err(problem) => (None, Some(format!("no verdict: {problem}"))),
        }
    }

    /// References computed since the last call.
    pub fn take_new(&self) -> Vec<(JobId, Reference)> {
        core::mem::take(&mut self.new.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
