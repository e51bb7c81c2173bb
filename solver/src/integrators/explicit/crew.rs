//! Who takes a step: one thread, or two that share what goes over elements.
//!
//! No bit depends on it, so it is no part of what a film is: films that differ in it alone are equal,
//! and a copy has one thread until it is given more.

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{
    Halves, NodeForces, Sums, ViscousHistory, assemble_membrane,
};
use crate::platform::simd::InstructionSet;
use crate::platform::workers::Workers;

/// Fewest elements two threads share: what one has written comes slowly to the other, and of 3,000
/// elements a step took as long by two.
const LEAST: usize = 5_000;

/// Who takes a step.
#[derive(Debug, Default)]
pub(super) struct Crew(Option<Box<Two>>);

#[derive(Debug)]
struct Two {
    workers: Workers,
    halves: Halves,
}

impl Clone for Crew {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Crew {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Crew {
    /// These workers, for a model.
    pub(super) fn new(workers: Workers, model: &FilmModel) -> Self {
        let two = workers.threads() > 1 && model.elements() >= LEAST;
        Self(two.then(|| Box::new(Two { workers, halves: Halves::new(model) })))
    }

    /// [`assemble_membrane`].
    pub(super) fn assemble_membrane(
        &mut self,
        path: InstructionSet,
        model: &FilmModel,
        positions: &Field,
        step: f64,
        past: &mut [[ViscousHistory; 2]],
        out: &mut NodeForces,
    ) -> Sums {
        match self.0.as_deref_mut() {
            Some(Two { workers, halves }) => {
                halves.assemble_membrane(workers, path, model, positions, step, past, out)
            }
            None => assemble_membrane(path, model, positions, step, past, out),
        }
    }
}
