//! One point of the grid.

use billow_solver::scene::Scene;

use crate::job::Parameters;
use crate::job::point::{Infeasible, Solved};

/// One point of the grid, in plan order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StudyPoint {
    /// The varied parameters.
    pub parameters: Parameters,
    /// The scene of its job.
    pub scene: Scene,
    /// Why it has no job; `None` for a feasible point.
    pub infeasible: Option<Infeasible>,
    /// What the fold solves; `None` for an infeasible point.
    pub solved: Option<Solved>,
}
