//! The checks: points that also run one rung finer than the chosen mesh.
//!
//! ```text
//! broken:  |m/m' − 1| > tolerance, or another verdict     m, m': corrected values of the chosen and of the finer mesh
//! correction of a mesh n that is no rung:  ln F_n = ln F ln(n_ref/n)/ln(n_ref/n_chosen)
//! ```
//! Both values are corrected to the reference mesh, so their difference shows how far the correction fails at a
//! point that is no pilot. Checked are those with the smallest job ids on the reference mesh. Ids are hashes, so this is
//! a draw, and the same one each time.

use super::{Auto, CHECKED, Decision, Finished, job_on};
use crate::accuracy::PROMISED;
use crate::job::{JobId, Parameters};
use crate::study::point::StudyPoint;

/// A point with runs on the chosen mesh and on the next finer one.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The varied parameters of the point.
    pub parameters: Parameters,
    /// The run on the finer mesh.
    pub job: JobId,
    /// Subdivisions of the finer mesh.
    pub subdivisions: u32,
    /// |m/m' − 1| of each measure with a tolerance that both runs have.
    pub differences: [Option<f64>; PROMISED.len()],
    /// Whether the verdicts differ.
    pub other_verdict: bool,
    /// Positions of the measures that differ by more than their tolerance.
    pub broken: Vec<usize>,
}

impl Check {
    /// Whether it shows that the promise is broken.
    pub fn is_broken(&self) -> bool {
        self.other_verdict || !self.broken.is_empty()
    }
}

impl Auto {
    /// Positions of the points to check; none on the reference mesh.
    pub(super) fn checked(&self, points: &[StudyPoint], decision: &Decision) -> Vec<usize> {
        if decision.chosen == self.reference {
            return Vec::new();
        }
        let others = self.others(points);
        let count = others.len().div_ceil(CHECKED);
        let mut drawn: Vec<(JobId, usize)> =
            others.into_iter().map(|index| (JobId::of(&points[index].scene), index)).collect();
        drawn.sort();
        drawn.dedup_by(|a, b| a.0 == b.0);
        let mut checked: Vec<usize> =
            drawn.into_iter().take(count).map(|(_, index)| index).collect();
        checked.sort_unstable();
        checked
    }

    /// The check of a point; `None` until both runs have ended.
    pub(super) fn check(
        &self,
        point: &StudyPoint,
        decision: &Decision,
        finished: &Finished<'_>,
    ) -> Option<Check> {
        let on = |n: u32| {
            let mut point = point.clone();
            point.scene.design.subdivisions = n;
            point
        };
        let subdivisions = self.finer(decision.chosen);
        let job = job_on(point, subdivisions);
        let (chosen, finer) = (on(decision.chosen), on(subdivisions));
        let coarse = finished.get(&job_on(point, decision.chosen))?;
        let fine = finished.get(&job)?;
        let difference = |index: usize| {
            self.tolerances[index]?;
            let (value, other) = (coarse.promised[index]?, fine.promised[index]?);
            let (value, _) = self.corrected_point(decision, &chosen, index, value)?;
            let factor = self.factor_of_finer(decision, &chosen, &finer, index)?;
            Some((value / (other * factor) - 1.0).abs())
        };
        let differences: [Option<f64>; PROMISED.len()] = std::array::from_fn(difference);
        let is_broken = |index: &usize| {
            let pair = differences[*index].zip(self.tolerances[*index]);
            pair.is_some_and(|(difference, most)| difference > most)
        };
        Some(Check {
            parameters: point.parameters.clone(),
            job,
            subdivisions,
            broken: (0..PROMISED.len()).filter(is_broken).collect(),
            differences,
            other_verdict: (coarse.status, coarse.verdict) != (fine.status, fine.verdict),
        })
    }

    fn corrected_point(
        &self,
        decision: &Decision,
        point: &StudyPoint,
        measure: usize,
        value: f64,
    ) -> Option<(f64, f64)> {
        self.corrected(decision, &point.scene, point.solved, measure, value)
    }

    /// The factor that corrects the finer mesh; between two rungs linear in ln n.
    fn factor_of_finer(
        &self,
        decision: &Decision,
        chosen: &StudyPoint,
        finer: &StudyPoint,
        measure: usize,
    ) -> Option<f64> {
        if let Some((factor, _)) = self.corrected_point(decision, finer, measure, 1.0) {
            return Some(factor);
        }
        let (factor, _) = self.corrected_point(decision, chosen, measure, 1.0)?;
        let finer_than = |n: u32| libm::log(f64::from(self.reference) / f64::from(n));
        let [far, near] = [chosen, finer].map(|point| finer_than(point.scene.design.subdivisions));
        Some(libm::exp(libm::log(factor) * near / far))
    }
}
