//! A point of the grid: its job, or the reason why it has none.

use billow_solver::geometry::fold::{FoldPattern, Nearest};
use billow_solver::scene::{Scene, Solver};

use crate::input::value::Value;
use crate::job::{JobId, Status};

/// The varied parameters of a point, in the order of the study's axes: name and value (SI).
pub type Parameters = Vec<(String, Value)>;

/// Parameters as text, in SI: "N=5 M=2".
pub fn label(parameters: &Parameters) -> String {
    let texts: Vec<String> =
        parameters.iter().map(|(name, value)| format!("{name}={}", value.short())).collect();
    texts.join(" ")
}

/// One scene to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Id: hash of the scene and the physics version.
    pub id: JobId,
    /// The varied parameters of the point.
    pub parameters: Parameters,
    /// All that the model reads.
    pub scene: Scene,
}

/// One point of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The job whose result its row shows. For an infeasible point it gives id and parameters of the row.
    pub job: Job,
    /// The runs with a remedy, after the planned job failed; `None` where there was none.
    pub remedied: Option<Remedied>,
    /// Set when no fold pattern satisfies the design: the point is a row without a run.
    pub infeasible: Option<Infeasible>,
    /// Solved dimensions of the fold pattern; `None` for an infeasible point.
    pub solved: Option<Solved>,
    /// Parameters of later points that resolve to the same job.
    pub merged: Vec<Parameters>,
}

impl Point {
    /// The job that the study plans for the point: that of its row, unless a remedy gave the result.
    pub fn planned_id(&self) -> &JobId {
        self.remedied.as_ref().map_or(&self.job.id, |remedied| &remedied.planned)
    }

    /// Whether its row shows the result of a remedy.
    pub fn shows_remedy(&self) -> bool {
        self.remedied.as_ref().is_some_and(|remedied| remedied.shown.is_some())
    }

    /// Every job of the point: the planned one, and those of its remedies.
    pub fn jobs(&self) -> impl Iterator<Item = &JobId> {
        let runs = self.remedied.iter().flat_map(|remedied| &remedied.runs);
        std::iter::once(self.planned_id()).chain(runs.map(|run| &run.job))
    }
}

/// The runs of a point with remedies ([`crate::job::remedy`]): the planned job failed.
#[derive(Debug, Clone, PartialEq)]
pub struct Remedied {
    /// The planned job.
    pub planned: JobId,
    /// The runs, in the order in which they were tried.
    pub runs: Vec<RemedyRun>,
    /// Position of the run that the row shows; `None` where none has a result: the row is that of the planned job.
    pub shown: Option<usize>,
}

/// A run with a remedy.
#[derive(Debug, Clone, PartialEq)]
pub struct RemedyRun {
    /// Its job.
    pub job: JobId,
    /// Its settings.
    pub settings: Solver,
    /// What was changed: "solver.cfl 0.45 -> 0.225".
    pub text: String,
    /// How it ended; `None` where its record is lost.
    pub status: Option<Status>,
}

impl Remedied {
    /// What was changed for the result of the row; `None` where no remedy has a result.
    pub fn remedy(&self) -> Option<&str> {
        Some(self.runs[self.shown?].text.as_str())
    }

    /// The remedies that did not help, each with the status of its run; `None` without one.
    pub fn failed(&self) -> Option<String> {
        let failed = self.runs.iter().filter_map(|run| Some((run, run.status?)));
        let texts: Vec<String> = failed
            .filter(|(_, status)| *status != Status::Done)
            .map(|(run, status)| format!("{}: {status}", run.text))
            .collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }
}

/// Dimensions that the solution of the fold pattern gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Fold angle ϕ, rad.
    pub phi: f64,
    /// Half top angle, rad.
    pub half_angle: f64,
    /// Radius of the top ring, m.
    pub top_radius: f64,
    /// Erected height, m.
    pub height: f64,
}

impl Solved {
    /// Dimensions of a pattern.
    pub fn of(pattern: &FoldPattern) -> Self {
        Self {
            phi: pattern.angles.phi,
            half_angle: pattern.half_angle,
            top_radius: pattern.top_radius,
            height: pattern.height,
        }
    }
}

/// Why a point has no fold pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// Reason.
    pub reason: String,
    /// Nearest feasible values. Each one is for a change of its key alone.
    pub nearest: Vec<Nearest>,
}

impl Infeasible {
    /// The nearest feasible values as a table cell shows them; empty when there are none.
    pub fn nearest_text(&self) -> String {
        let nearest = self.nearest.iter();
        let texts: Vec<String> =
            nearest.map(|near| format!("{} = {}", near.key, near.value)).collect();
        texts.join(" or ")
    }
}
