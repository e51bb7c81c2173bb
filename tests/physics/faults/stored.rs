//! Changes of what a checkpoint holds, whatever the integrator.

use billow_solver::integrators::implicit::PendingStep;

use crate::prelude::*;

/// The step that goes beyond the state, if there is one.
pub fn ahead(stored: &mut StoredIntegrator) -> Option<&mut PendingStep> {
    match stored {
        StoredIntegrator::Implicit(stored) => stored.motion.ahead.as_deref_mut(),
        StoredIntegrator::Hybrid(stored) => ahead(&mut stored.active),
        StoredIntegrator::Explicit(_) => None,
    }
}

/// What central differences keep, if they are at work.
fn explicit(stored: &mut StoredIntegrator) -> Option<&mut StoredExplicit> {
    match stored {
        StoredIntegrator::Explicit(stored) => Some(stored),
        StoredIntegrator::Hybrid(stored) => explicit(&mut stored.active),
        StoredIntegrator::Implicit(_) => None,
    }
}

/// Changes the state from which the next step begins.
pub fn change_state(stored: &mut StoredFilm, change: impl Fn(&mut FilmState)) {
    change(&mut stored.state);
    if let Some(ahead) = ahead(&mut stored.integrator) {
        change(&mut ahead.to.0);
    }
}

/// Changes the velocities with which the next step begins.
pub fn change_velocities(stored: &mut StoredFilm, change: impl Fn(&mut Field)) {
    if let Some(explicit) = explicit(&mut stored.integrator) {
        change(&mut explicit.motion.velocities);
    }
    change_state(stored, |state| change(&mut state.velocities));
}

/// Forgets the numerical stress of every element, and the strain and stress that it is computed from.
pub fn forget_numerical_stress(stored: &mut StoredFilm) {
    if let Some(explicit) = explicit(&mut stored.integrator) {
        explicit.histories.fill_with(Default::default);
    }
}

/// Moves the last node of the film along z by this distance (m).
pub fn teleport(stored: &mut StoredFilm, distance: f64) {
    change_state(stored, |state| {
        let node = state.positions.len() - 1;
        state.positions.set(node, state.positions.get(node) + Vector3::z() * distance);
    });
}

/// Length of the first edge of the last element, m.
pub fn edge_length(stored: &StoredFilm, system: &FilmSystem) -> f64 {
    let [a, b, _] = *system.model.triangles.last().expect("an element");
    let position = |node: u32| stored.state.positions.get(node as usize);
    (position(a) - position(b)).norm()
}
