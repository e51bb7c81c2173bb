//! What a mesh makes of its film, before anything runs: its size, its stretch at the start, the face that sets the step.
//!
//! ```text
//! Δt < 2/ω,  N > ω t_end/2      ω: largest frequency of an element; Δt, N: step and number of steps of `explicit`
//! ```

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::resultants::stretches;
use billow_solver::scene::IntegratorKind;
use billow_solver::scene::film_scene::FilmScene;

use super::shape::{Numbering, extents};
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Size of a film above which a note asks for its unit, m. Chosen: no film that was ever inflated is larger.
const MAX_SIZE: f64 = 150.0;
/// Size below which it does, m. Chosen.
const MIN_SIZE: f64 = 2e-3;
/// Largest stretch at the start of which no note is made. Chosen: film that a program unfolds keeps its lengths to less.
const MAX_STRETCH: f64 = 1.01;
/// Largest stretch of any element below which film is slack everywhere. Chosen: folds keep lengths.
const SLACK_STRETCH: f64 = 0.9;
/// Frequency of an element over the median one from which a note names it. Chosen: the run then takes ten times as long
/// as the other faces need.
const MAX_FREQUENCY: f64 = 10.0;

/// Notes about a film; an error if its steps cannot suffice.
pub(super) fn notes(
    film: &FilmScene,
    numbering: &Numbering,
    has_reference: bool,
    source: &Source,
) -> Result<Vec<String>, InputError> {
    let mut notes = Vec::new();
    let Ok(model) = FilmModel::of_shell(&film.film.elastic(), &film.shell) else {
        return Ok(notes);
    };
    let positions = Field::of(&film.shell.positions);
    notes.extend(size(film));
    if has_reference {
        notes.extend(stretch(&model, &positions, numbering));
    }
    if !film.solver.statics && film.solver.integrator == IntegratorKind::Explicit {
        notes.extend(step(film, &model, numbering, source)?);
    }
    Ok(notes)
}

/// A film whose size suggests another unit.
fn size(film: &FilmScene) -> Option<String> {
    let [low, high] = extents(&film.shell.positions);
    let size = (high - low).max();
    let is = match size {
        size if size > MAX_SIZE => "large",
        size if size < MIN_SIZE => "large, no more",
        _ => return None,
    };
    Some(format!(
        "the film is {} m {is}: if its file has another unit than metres, give it, as in \"unit\": \"mm\" (mesh.unit; in a \
         study design.unit)",
        shown(size)
    ))
}

/// Film that is stretched, or slack, where it starts.
fn stretch(model: &FilmModel, positions: &Field, numbering: &Numbering) -> Option<String> {
    let [_, (largest, element)] = stretches(model, positions);
    let place = numbering.place(element);
    if largest > MAX_STRETCH {
        return Some(format!(
            "the film starts stretched to {largest:.4} times its stress-free length, at {place}: do positions and \
             reference have the same faces in the same order, and the same unit?"
        ));
    }
    (largest < SLACK_STRETCH).then(|| {
        format!(
            "the film is slack everywhere at the start: no face is longer than {largest:.3e} of its stress-free \
             length; is mesh.reference in the unit of mesh.positions?"
        )
    })
}

/// The face that sets the step, where it does so alone; an error if the steps cannot suffice.
fn step(
    film: &FilmScene,
    model: &FilmModel,
    numbering: &Numbering,
    source: &Source,
) -> Result<Option<String>, InputError> {
    let fastest = (0..model.elements()).fold(0, |fastest, element| {
        if model.frequency[element] > model.frequency[fastest] { element } else { fastest }
    });
    let frequency = model.frequency[fastest];
    let mut sorted = model.frequency.clone();
    sorted.sort_by(f64::total_cmp);
    let ratio = frequency / sorted[sorted.len() / 2];
    let (step, needed) = (2.0 / frequency, 0.5 * frequency * film.solver.end_time);
    let place = numbering.place(fastest);
    let sets = format!(
        "{place} allows steps of {step:.1e} s at most, {ratio:.0} times shorter than the median face: the run needs \
         more than {needed:.1e} steps"
    );
    if needed > film.solver.step_limit as f64 {
        let hint = format!(
            "make this face larger (or weld it away, mesh.weld), or set solver.integrator \"implicit\", solver.end_time, \
             or solver.step_limit {:.0}",
            libm::ceil(4.0 * needed)
        );
        let limit = film.solver.step_limit.to_string();
        let allowed = "as many steps as the smallest face needs";
        return Err(source.error("solver.step_limit", limit, sets, allowed).with_hint(hint));
    }
    Ok((ratio > MAX_FREQUENCY).then_some(sets))
}
