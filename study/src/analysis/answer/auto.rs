//! What a study with `"model": "auto"` ran, whether it keeps its promise, and what it cost.
//!
//! ```text
//! cost = Σ element-steps of all runs / (Σ of the pilots on the reference mesh · Σ_all w/Σ_pilots w)
//! w = N M end_time       estimated cost of a point, [`crate::study::auto`]
//! ```

use crate::accuracy::PROMISED;
use crate::input::value::Value;
use crate::job::row::ColumnId;
use crate::job::{JobId, Status};
use crate::store::stored::Stored;
use crate::study::auto::{Auto, Check, Outcome, estimated_cost};

/// What such a study ran.
#[derive(Debug, Clone, PartialEq)]
pub struct AutoAnswer {
    /// Subdivisions of the reference mesh.
    pub reference: u32,
    /// Subdivisions of the mesh of the other points: the reference if no coarser one keeps the tolerances; `None`
    /// while pilots are missing.
    pub chosen: Option<u32>,
    /// Number of pilots.
    pub pilots: usize,
    /// Number of points that are no pilots and have a job.
    pub others: usize,
    /// The measures with a tolerance: on the chosen mesh, or on the finest of the coarser meshes if none keeps them.
    pub kept: Vec<Kept>,
    /// Subdivisions of the finest of the coarser meshes.
    pub finest_rung: u32,
    /// Number of points to check.
    pub planned_checks: usize,
    /// Subdivisions of the mesh of the checks.
    pub check_mesh: u32,
    /// The checks that have ended.
    pub checks: Vec<Check>,
    /// Whether every planned run has ended.
    pub is_complete: bool,
    /// Element-steps of all runs over the estimate for all points on the reference mesh.
    pub cost: Option<f64>,
}

/// One measure with a tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// Name of the measure.
    pub measure: &'static str,
    /// Largest relative error that the study asks for.
    pub tolerance: f64,
    /// Mean correction of the mesh, relative, beside that of the table of mesh errors if it is used.
    pub correction: Option<f64>,
    /// Whether the table of mesh errors corrects the bias of each point.
    pub from_table: bool,
    /// Relative error after it.
    pub error: Option<f64>,
}

impl AutoAnswer {
    /// That of a results folder; `None` for a study that names its model.
    pub fn of(stored: &Stored<'_>) -> Option<Self> {
        let auto = stored.study.auto()?;
        let outcome = stored.outcome()?;
        let points = stored.study.points();
        let jobs = points.iter().filter(|point| point.infeasible.is_none()).count();
        Some(Self {
            reference: auto.reference,
            chosen: outcome.decision.as_ref().map(|decision| decision.chosen),
            pilots: auto.pilots.len(),
            others: jobs - auto.pilots.len(),
            kept: kept(auto, &outcome),
            finest_rung: auto.rungs.last().copied().unwrap_or(0),
            planned_checks: outcome.planned_checks,
            check_mesh: outcome.decision.as_ref().map_or(0, |known| auto.finer(known.chosen)),
            checks: outcome.checks,
            is_complete: is_complete(stored),
            cost: cost(stored, auto),
        })
    }

    /// The checks that break the promise.
    pub fn broken(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.is_broken())
    }
}

fn kept(auto: &Auto, outcome: &Outcome) -> Vec<Kept> {
    let rung = outcome.decision.as_ref().and_then(|decision| {
        let chosen = decision.rungs.iter().find(|rung| rung.subdivisions == decision.chosen);
        chosen.or(decision.rungs.last())
    });
    let measures = PROMISED.iter().enumerate().filter_map(|(index, promised)| {
        let correction = rung.and_then(|rung| rung.corrections[index]);
        Some(Kept {
            measure: promised.measure.name(),
            tolerance: auto.tolerances[index]?,
            correction: correction.map(|known| libm::exp(known.mean) - 1.0),
            from_table: correction.is_some_and(|known| known.from_table),
            error: correction.map(|known| known.error),
        })
    });
    measures.collect()
}

fn is_complete(stored: &Stored<'_>) -> bool {
    let mut jobs = stored.points.iter().filter(|point| point.infeasible.is_none());
    jobs.all(|point| stored.cells(point).status() != Status::Pending)
}

fn cost(stored: &Stored<'_>, auto: &Auto) -> Option<f64> {
    let points = stored.study.points();
    let element_steps = |point: &crate::job::point::Point| {
        let cells = stored.cells(point);
        match (cells.get(ColumnId::Elements), cells.get(ColumnId::Steps)) {
            (Value::Integer(elements), Value::Integer(steps)) => *elements as f64 * *steps as f64,
            _ => 0.0,
        }
    };
    let all: f64 = stored.points.iter().map(element_steps).sum();
    let on_reference = |point: &&crate::job::point::Point| {
        let pilots = auto.pilots.iter().map(|pilot| &points[*pilot]);
        pilots.map(|pilot| JobId::of(&pilot.scene)).any(|id| id == point.job.id)
    };
    let pilots: f64 = stored.points.iter().filter(on_reference).map(element_steps).sum();
    let feasible = points.iter().filter(|point| point.infeasible.is_none());
    let weight: f64 = feasible.map(estimated_cost).sum();
    let of_pilots: f64 = auto.pilots.iter().map(|pilot| estimated_cost(&points[*pilot])).sum();
    let reference = pilots * weight / of_pilots;
    (reference > 0.0).then(|| all / reference)
}
