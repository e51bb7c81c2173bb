//! A point of the grid: its job, or why it has none.

use billow_solver::geometry::fold::{FoldPattern, Nearest};

use crate::job::{Job, Parameters};

/// One point of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The job; for an infeasible point it carries the id and the parameters of its row.
    pub job: Job,
    /// Set when no fold pattern meets the design: the point is a row, not a run.
    pub infeasible: Option<Infeasible>,
    /// What the fold solves; `None` where no pattern meets the design.
    pub solved: Option<Solved>,
    /// Parameters of later points that resolve to the same job.
    pub merged: Vec<Parameters>,
}

/// What the fold of a point solves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// ϕ, rad.
    pub phi: f64,
    /// Half top angle, rad.
    pub half_angle: f64,
    /// r1, m.
    pub top_radius: f64,
    /// H, m.
    pub height: f64,
}

impl Solved {
    /// Of a pattern.
    pub fn of(pattern: &FoldPattern) -> Self {
        Self {
            phi: pattern.angles.phi,
            half_angle: pattern.half_angle,
            top_radius: pattern.top_radius,
            height: pattern.height,
        }
    }
}

/// Why a point has no pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// Reason.
    pub reason: String,
    /// Nearest feasible values, each for a change of that key alone.
    pub nearest: Vec<Nearest>,
}

impl Infeasible {
    /// The nearest feasible values in words, as a table cell has them; empty where there are none.
    pub fn nearest_text(&self) -> String {
        let nearest = self.nearest.iter();
        let texts: Vec<String> =
            nearest.map(|near| format!("{} = {}", near.key, near.value)).collect();
        texts.join(" or ")
    }
}
