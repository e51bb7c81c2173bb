//! `"model": "auto"`: most points of a grid run on a coarse mesh, corrected by a few pilots on the mesh of the study.
//!
//! ```text
//! pilots:   points far from each other in the grid, up to 8 % of the cost of all points on the reference mesh;
//!           each runs on the reference mesh and on every rung n ≤ n_ref/2
//! cost:     N M (n/n_ref)³ end_time      elements ∝ N M n², steps ∝ n end_time
//! then:     all other points on the coarsest rung whose error is within the tolerances (`decision`),
//!           or on the reference mesh if none is; a tenth of them also one rung finer (`checks`)
//! ```
//! The reference mesh is `design.subdivisions` of the study. No clock and no draw has a part in the plan: the same study
//! and the same finished jobs give the same plan. Models that cannot lock (piston, storeys) are no rungs, since a row
//! must say whether its capsule deploys.

mod checks;
mod decision;
mod pilots;
mod read;

pub use checks::Check;
pub use decision::{Correction, Decision};
pub(crate) use pilots::cost as estimated_cost;
pub(super) use read::{is_auto, replace_model, write_model};

use std::collections::HashMap;

use super::point::StudyPoint;
use crate::accuracy::PROMISED;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::JobId;
use crate::study::finished::FinishedRow;

/// Meshes that can be rungs, coarsest first. Chosen: the cost doubles to triples from one to the next.
const LADDER: [u32; 9] = [3, 4, 6, 8, 12, 16, 24, 32, 48];
/// A rung has at most this part of the subdivisions of the reference: an eighth of its cost.
const COARSER: u32 = 2;
/// Largest cost of the pilots over that of all points on the reference mesh.
pub const PILOT_SHARE: f64 = 0.08;
/// Fewest pilots from which an error can be judged; and most. Chosen: of three values the standard deviation is rough
/// but known; sixteen tell it within a fifth.
pub const MIN_PILOTS: usize = 3;
const MAX_PILOTS: usize = 16;
/// The number of points that are no pilots, over that of checks.
const CHECKED: usize = 10;

/// The plan of a study with `"model": "auto"`.
#[derive(Debug, Clone, PartialEq)]
pub struct Auto {
    /// Largest relative error of each promised measure, against the reference mesh.
    pub tolerances: [Option<f64>; PROMISED.len()],
    /// Subdivisions of the reference mesh.
    pub reference: u32,
    /// Subdivisions of the meshes that may replace it, coarsest first.
    pub rungs: Vec<u32>,
    /// Positions of the pilots among the points.
    pub pilots: Vec<usize>,
}

/// The finished rows by job.
type Finished<'a> = HashMap<&'a JobId, &'a FinishedRow>;

/// What the finished jobs of such a study say.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Which mesh the points have, and how their values are corrected; `None` until every pilot has ended.
    pub decision: Option<Decision>,
    /// The checked points of which both runs have ended.
    pub checks: Vec<Check>,
    /// Number of points to check.
    pub planned_checks: usize,
}

impl Auto {
    /// The points of the first generation: every pilot on every rung and on the reference mesh, and the points without a
    /// fold pattern.
    pub(crate) fn first_points(&self, points: &[StudyPoint]) -> Vec<StudyPoint> {
        let pilots = self.pilots.iter().flat_map(|pilot| {
            let meshes = self.rungs.iter().chain([&self.reference]);
            meshes.map(|n| run_on(&points[*pilot], *n))
        });
        let infeasible = points.iter().filter(|point| point.infeasible.is_some());
        pilots.chain(infeasible.map(|point| run_on(point, self.reference))).collect()
    }

    /// The points of the second generation: all others on the chosen mesh, and the checks. `None` until every pilot has
    /// ended.
    pub(crate) fn other_points(
        &self,
        points: &[StudyPoint],
        finished: &[FinishedRow],
    ) -> Option<Vec<StudyPoint>> {
        let decision = self.decide(points, &by_job(finished))?;
        let others = self.others(points);
        let chosen = others.iter().map(|index| run_on(&points[*index], decision.chosen));
        let finer = self.finer(decision.chosen);
        let checked = self.checked(points, &decision);
        let checks = checked.into_iter().map(|index| run_on(&points[index], finer));
        Some(chosen.chain(checks).collect())
    }

    /// What the finished jobs say.
    pub(crate) fn outcome(&self, points: &[StudyPoint], finished: &[FinishedRow]) -> Outcome {
        let finished = by_job(finished);
        let Some(decision) = self.decide(points, &finished) else {
            return Outcome { decision: None, checks: Vec::new(), planned_checks: 0 };
        };
        let checked = self.checked(points, &decision);
        let checks = checked.iter();
        let checks = checks.filter_map(|index| self.check(&points[*index], &decision, &finished));
        Outcome {
            checks: checks.collect(),
            planned_checks: checked.len(),
            decision: Some(decision),
        }
    }

    /// For each point the run that its row shows: on the reference mesh for a pilot, otherwise on the chosen mesh.
    pub(crate) fn shown(&self, points: &[StudyPoint], outcome: &Outcome) -> Vec<StudyPoint> {
        let chosen = outcome.decision.as_ref().map_or(self.reference, |decision| decision.chosen);
        let mut shown = points.to_vec();
        for index in self.others(points) {
            shown[index].scene.design.subdivisions = chosen;
        }
        shown
    }

    /// Positions of the points that are no pilots and have a job.
    fn others(&self, points: &[StudyPoint]) -> Vec<usize> {
        let mut is_pilot = vec![false; points.len()];
        for pilot in &self.pilots {
            is_pilot[*pilot] = true;
        }
        let other = |index: &usize| !is_pilot[*index] && points[*index].infeasible.is_none();
        (0..points.len()).filter(other).collect()
    }

    /// The mesh one rung finer.
    pub(crate) fn finer(&self, rung: u32) -> u32 {
        let finer = LADDER.iter().find(|n| **n > rung && **n < self.reference);
        finer.copied().unwrap_or(self.reference)
    }
}

/// A point as a run on a mesh; the mesh is one of its parameters.
fn run_on(point: &StudyPoint, subdivisions: u32) -> StudyPoint {
    let mut point = point.clone();
    point.scene.design.subdivisions = subdivisions;
    point.parameters.push((MESH_PARAMETER.to_owned(), Value::Integer(i64::from(subdivisions))));
    point
}

/// The job of a point on a mesh.
fn job_on(point: &StudyPoint, subdivisions: u32) -> JobId {
    let mut scene = point.scene.clone();
    scene.design.subdivisions = subdivisions;
    JobId::of(&scene)
}

fn by_job(finished: &[FinishedRow]) -> Finished<'_> {
    finished.iter().map(|row| (&row.id, row)).collect()
}

#[cfg(test)]
mod tests;
