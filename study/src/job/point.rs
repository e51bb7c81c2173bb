//! A point of the grid: its job, or the reason why it has none.

use std::sync::Arc;

use billow_solver::geometry::fold::{FoldPattern, Nearest};
use billow_solver::scene::Scene;

use crate::input::value::Value;
use crate::job::JobId;

/// The varied parameters of a point, in the order of the study's axes: name and value (SI). Copies share them.
pub type Parameters = Arc<[(String, Value)]>;

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
    /// All that the model reads; shared with the plan of its study.
    pub scene: Arc<Scene>,
}

/// One point of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its job. For an infeasible point it gives id and parameters of the row.
    pub job: Job,
    /// Set when no fold pattern satisfies the design: the point is a row without a run.
    pub infeasible: Option<Infeasible>,
    /// Solved dimensions of the fold pattern; `None` for an infeasible point.
    pub solved: Option<Solved>,
    /// Whether a search runs along it.
    pub searched: Searched,
    /// Parameters of later points that resolve to the same job.
    pub merged: Vec<Parameters>,
}

/// Whether a search runs along a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Searched {
    /// It is a single point that gives the key of the search, or there is no search.
    No,
    /// It is a point of the product.
    InProduct,
    /// It is a single point.
    Single,
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
    /// Volume of the erected cone, m³.
    pub erected_volume: f64,
}

impl Solved {
    /// Dimensions of a pattern.
    pub fn of(pattern: &FoldPattern) -> Self {
        Self {
            phi: pattern.angles.phi,
            half_angle: pattern.half_angle,
            top_radius: pattern.top_radius,
            height: pattern.height,
            erected_volume: pattern.erected_volume(),
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
