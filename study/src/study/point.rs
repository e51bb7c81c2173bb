//! One point of the grid.

use std::sync::Arc;

use billow_solver::scene::Scene;

use crate::accuracy::Features;
use crate::job::Parameters;
use crate::job::point::{Infeasible, Solved};

/// Whether a search runs along a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Searched {
    /// It is a single point that gives the key of the search, or there is no search.
    No,
    /// It is a point of the product.
    InProduct,
    /// It is a single point.
    Single,
}

/// One point of the grid, in plan order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StudyPoint {
    /// The varied parameters.
    pub parameters: Parameters,
    /// The scene of its job.
    pub scene: Arc<Scene>,
    /// Why it has no job; `None` for a feasible point.
    pub infeasible: Option<Infeasible>,
    /// What the fold solves; `None` for an infeasible point.
    pub solved: Option<Solved>,
    /// Whether a search runs along it.
    pub searched: Searched,
}

impl StudyPoint {
    /// Its scene with the features on which mesh errors depend; `None` for an infeasible point.
    pub fn features(&self) -> Option<(&Scene, Features)> {
        let solved = self.solved?;
        Some((&self.scene, Features::of(&self.scene, solved.top_radius, solved.height)))
    }
}
