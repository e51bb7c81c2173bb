//! Notes of a plan on its searches and limits.

use billow_solver::scene::ModelKind;

use crate::input::keys::MODELS;
use crate::job::cost::Costs;
use crate::job::row::ColumnId;
use crate::print::{count, duration};
use crate::study::plan::{PlanCounts, borders};
use crate::study::{Study, meshes_text};

/// Points whose cost is asked, at most.
const MAX_COSTED: usize = 20;

/// Measures that only the film model computes.
const FILM_ONLY: [ColumnId; 7] = [
    ColumnId::FilmStress99,
    ColumnId::TFilmStress99,
    ColumnId::Passages,
    ColumnId::Intersections,
    ColumnId::InterlayerPressure,
    ColumnId::ContactAreaFraction,
    ColumnId::SmallestGap,
];

/// Whether a model does not compute a measure.
fn lacks(model: ModelKind, measure: ColumnId) -> bool {
    match model {
        ModelKind::Film => false,
        ModelKind::Storeys => FILM_ONLY.contains(&measure),
        ModelKind::Piston => FILM_ONLY.contains(&measure) || measure == ColumnId::PeakFilmSpeed,
    }
}

/// What a reader of the plan must know of its searches and limits.
pub(super) fn notes(study: &Study, counts: &PlanCounts) -> Vec<String> {
    let search = search(study, counts).or_else(|| optimise(study, counts));
    let mut notes: Vec<String> = search.into_iter().collect();
    notes.extend(limits(study));
    notes.extend(prior(study));
    notes.extend(pilots(study));
    notes
}

/// What the search learns from a cheap model before film runs.
fn prior(study: &Study) -> Option<String> {
    let points = study.points_of_prior();
    let text = format!(
        "prior: the model of storeys, less than a second a run, shows the search where to look: at {points} points, and at \
         each point that film runs at"
    );
    (points > 0).then_some(text)
}

/// What the pilots of a study cost at most, and how it does without.
fn pilots(study: &Study) -> Option<String> {
    let meshes = study.meshes();
    if !meshes.of_pilots {
        return None;
    }
    let mut costs = Costs::default();
    // Points that differ in the design differ in cost: the dearest of some.
    let film = study.points().iter().filter(|point| point.infeasible.is_none());
    let film = film.filter(|point| point.job.scene.solver.model == ModelKind::Film);
    let film: Vec<_> = film.take(MAX_COSTED).collect();
    let mesh = film.first()?.job.scene.design.subdivisions();
    let others: Vec<u32> = meshes.list.iter().copied().filter(|n| *n != mesh).collect();
    let seconds = others.iter().map(|n| {
        let of_mesh = film.iter().map(|point| {
            let mut scene = (*point.job.scene).clone();
            scene.design = study.on_mesh(&scene.design, *n);
            costs.seconds(&scene)
        });
        of_mesh.fold(0.0, f64::max)
    });
    let runs = study.most_pilots();
    let seconds: f64 = runs as f64 * seconds.sum::<f64>();
    Some(format!(
        "pilots: up to {}, on n {} of {}, about {} of core time; \"solver\": {{\"meshes\": [{mesh}]}} leaves them out",
        count(runs * others.len(), "job"),
        meshes_text(&others),
        study.pilots_are(),
        duration(libm::ceil(seconds)),
    ))
}

/// How many jobs a search takes.
fn search(study: &Study, counts: &PlanCounts) -> Option<String> {
    let (name, _) = study.searched()?;
    let searches = borders(study, &[], &[]);
    let begins = searches.iter().map(|border| border.levels.len()).max().unwrap_or(0);
    let more = study.most_search_values()?.saturating_sub(begins) * study.replicate_count();
    Some(format!(
        "search: {} along {name}; first generation {}; up to {} more in all",
        count(searches.len(), "search"),
        count(counts.jobs, "job"),
        more * searches.len(),
    ))
}

/// How many jobs the search of an optimum takes.
fn optimise(study: &Study, counts: &PlanCounts) -> Option<String> {
    let [budget, batch] = study.budget()?;
    let (runs, first) = (study.replicate_count(), study.point_count());
    let names: Vec<&str> = study.minimised().iter().map(|measure| measure.name()).collect();
    Some(format!(
        "search: smallest {}{}; first generation {} of {}{}; up to {} in all",
        names.join(" and "),
        if study.result_limits().is_empty() { "" } else { " among points that keep the limits" },
        count(first, "point"),
        count(counts.jobs, "job"),
        if first < budget {
            format!("; then generations of {batch} up to {}", count(budget, "point"))
        } else {
            String::new()
        },
        count(budget * runs, "job"),
    ))
}

/// What the limits of the study say, and what they leave open.
fn limits(study: &Study) -> Vec<String> {
    let limits = study.result_limits();
    if limits.is_empty() {
        return Vec::new();
    }
    let texts: Vec<String> = limits.iter().map(ToString::to_string).collect();
    let mut notes = vec![format!("limits: safe is {}", texts.join(" and "))];
    if !limits.iter().any(|limit| limit.measure == ColumnId::Verdict) {
        notes.push(
            "note: limits have no verdict: a capsule that does not deploy can be safe; \"verdict\": \"deployed\" \
             excludes it"
                .to_owned(),
        );
    }
    let of_rings = limits.iter().map(|limit| limit.measure).filter(|_| study.has_mesh());
    for measure in of_rings.filter(|measure| measure.needs_rings()) {
        let other = measure.without_rings();
        let instead =
            if other == measure { String::new() } else { format!("; it has {}", other.name()) };
        notes.push(format!(
            "note: film from a mesh has no {}, so no point can be judged{instead}",
            measure.name()
        ));
    }
    let points: Vec<ModelKind> =
        study.points().iter().map(|point| point.job.scene.solver.model).collect();
    for model in MODELS {
        let points = points.iter().filter(|kind| **kind == model.kind).count();
        let missing = limits.iter().map(|limit| limit.measure);
        let missing = missing.filter(|measure| points > 0 && lacks(model.kind, *measure));
        let missing: Vec<&str> = missing.map(ColumnId::name).collect();
        if !missing.is_empty() {
            notes.push(format!(
                "note: the model {} does not compute {}: {} cannot be judged",
                model.name,
                missing.join(", "),
                count(points, "point")
            ));
        }
    }
    notes
}
