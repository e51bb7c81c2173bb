//! Static equilibria with which runs are compared: computed when a run needs them, shared by the jobs of
//! one design.
//!
//! The id of a design's equilibria is the id of its [`billow_solver::models::reference_scene`]: the scene
//! without everything that does not change them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use billow_solver::models;
use billow_solver::models::film::Ladder;
use billow_solver::output::measures::{NoReference, Reference};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Scene;

use crate::job::JobId;

/// Number of designs whose positions of nodes are kept. Chosen: about 1 MB each at 8 subdivisions.
const MAX_DESIGNS_WITH_POSITIONS: usize = 8;

/// The equilibria of one design. One job computes at a time; the others wait.
type Slot = Arc<Mutex<Option<Ladder>>>;

/// Equilibria by the id of their scene.
#[derive(Debug, Default)]
pub struct References {
    slots: Mutex<BTreeMap<JobId, Slot>>,
    /// Designs used last, the latest at the end.
    recent: Mutex<VecDeque<JobId>>,
}

impl References {
    /// The reference of a run of this scene: its design shape and, with a final overpressure (Pa), its
    /// shape there. `None` for a model that judges its own runs. `continues` is called from time to time;
    /// when it returns `false` the search ends.
    ///
    /// # Errors
    /// [`NoReference::Stopped`] if `continues` returned `false`. Other reasons are in the reference.
    pub fn of(
        &self,
        instruction_set: InstructionSet,
        scene: &Scene,
        final_overpressure: Option<f64>,
        continues: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Reference>, NoReference> {
        let Some(scene) = models::reference_scene(scene) else { return Ok(None) };
        let id = JobId::of(&scene);
        let slot = Arc::clone(locked(&self.slots).entry(id.clone()).or_default());
        let Some(mut slot) = wait_for(&slot, continues) else { return Err(NoReference::Stopped) };
        if slot.is_none() {
            match models::ladder(instruction_set, &scene) {
                Ok(ladder) => *slot = Some(ladder),
                Err(error) => {
                    let missing = NoReference::NoCapsule(error.to_string());
                    return Ok(Some(Reference { design: Err(missing.clone()), end: Err(missing) }));
                }
            }
        }
        let Some(ladder) = slot.as_mut() else { return Ok(None) };
        let design = ladder.design(continues);
        let end = match final_overpressure {
            Some(overpressure) => ladder.at(overpressure, continues),
            // The final shape of a run that failed is not used.
            None => design.clone(),
        };
        drop(slot);
        self.forget_positions(id);
        let stopped = [&design, &end].into_iter().any(|found| *found == Err(NoReference::Stopped));
        if stopped { Err(NoReference::Stopped) } else { Ok(Some(Reference { design, end })) }
    }

    /// Notes the use of a design and forgets the positions of the one not used for longest.
    fn forget_positions(&self, id: JobId) {
        let oldest = {
            let mut recent = locked(&self.recent);
            recent.retain(|other| *other != id);
            recent.push_back(id);
            if recent.len() > MAX_DESIGNS_WITH_POSITIONS { recent.pop_front() } else { None }
        };
        let Some(oldest) = oldest else { return };
        let slot = locked(&self.slots).get(&oldest).map(Arc::clone);
        if let Some(slot) = slot
            && let Some(ladder) = locked(&slot).as_mut()
        {
            ladder.forget_positions();
        }
    }
}

/// Time between two attempts to get the equilibria of a design that another job computes. Chosen: short
/// against a search.
const PAUSE: Duration = Duration::from_millis(5);

/// The equilibria of a design, once no other job computes; `None` if `continues` returned `false` before.
fn wait_for<'a, T>(
    mutex: &'a Mutex<T>,
    continues: &mut dyn FnMut() -> bool,
) -> Option<MutexGuard<'a, T>> {
    loop {
        match mutex.try_lock() {
            Ok(guard) => return Some(guard),
            Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) if !continues() => return None,
            Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
        }
    }
}

/// The content of a mutex, also after a panic of another thread: a ladder is consistent at any time.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
