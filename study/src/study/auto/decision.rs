//! Which mesh replaces the reference mesh, from the pilots.
//!
//! ```text
//! r = ln(m_ref/m_n) − p(x)                   one pilot;  p = ln((1 + b_ref)/(1 + b_n)) from the table of mesh errors if
//!                                            it covers every point and the pilots deviate less with it, otherwise 0
//! m = m_n exp(p(x) + r̄)                      the corrected value of a point
//! error = exp(t s √(1 + 1/k)) − 1            k pilots; t holds nine of ten deviations of Student's distribution with
//!                                            k − 1 degrees of freedom; s² = Σ (r − r̄)²/(k − 1)
//! ```
//! s is at least the scatter of single runs in the table, where it has the mesh: a few pilots can agree by chance.
//! The chosen mesh is the coarsest whose error is within the tolerance of every measure, and whose pilots have the verdicts
//! of the reference mesh.

use super::{Auto, Finished, MIN_PILOTS, job_on};
use crate::accuracy::student::nine_of_ten;
use crate::accuracy::{Features, MeshErrors, Method, PROMISED};
use crate::job::point::Solved;
use crate::study::finished::FinishedRow;
use crate::study::point::StudyPoint;
use billow_solver::scene::{ModelKind, Scene};

/// The mesh of the points that are no pilots.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// Its subdivisions: those of the reference if no rung keeps the tolerances.
    pub chosen: u32,
    /// The rungs, coarsest first.
    pub rungs: Vec<Rung>,
}

/// What the pilots say about a rung.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// Subdivisions.
    pub subdivisions: u32,
    /// Number of pilots whose verdict is another one than on the reference mesh.
    pub other_verdicts: usize,
    /// The correction of each promised measure; `None` where fewer than [`MIN_PILOTS`] pilots have it on both meshes.
    pub corrections: [Option<Correction>; PROMISED.len()],
}

/// How a measure of one mesh is corrected to the reference mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// r̄.
    pub mean: f64,
    /// Relative error of nine of ten corrected values.
    pub error: f64,
    /// Whether the table of mesh errors gives p(x).
    pub from_table: bool,
}

impl Auto {
    /// The mesh of the points that are no pilots; `None` until every pilot has ended.
    pub(super) fn decide(
        &self,
        points: &[StudyPoint],
        finished: &Finished<'_>,
    ) -> Option<Decision> {
        let rows = |n: u32| -> Option<Vec<&FinishedRow>> {
            let pilots = self.pilots.iter();
            pilots.map(|pilot| finished.get(&job_on(&points[*pilot], n)).copied()).collect()
        };
        let reference = rows(self.reference)?;
        let mut rungs = Vec::new();
        for n in &self.rungs {
            let rows = rows(*n)?;
            let pairs: Vec<(&FinishedRow, &FinishedRow)> =
                reference.iter().copied().zip(rows.iter().copied()).collect();
            let other =
                pairs.iter().filter(|(a, b)| (a.status, a.verdict) != (b.status, b.verdict));
            let corrections =
                std::array::from_fn(|index| self.correction(points, *n, index, &pairs));
            rungs.push(Rung { subdivisions: *n, other_verdicts: other.count(), corrections });
        }
        let chosen = rungs.iter().find(|rung| self.keeps(rung));
        let chosen = chosen.map_or(self.reference, |rung| rung.subdivisions);
        Some(Decision { chosen, rungs })
    }

    /// Whether a rung is within every tolerance.
    fn keeps(&self, rung: &Rung) -> bool {
        let within = |(correction, tolerance): (&Option<Correction>, &Option<f64>)| {
            tolerance.is_none_or(|most| correction.is_some_and(|known| known.error <= most))
        };
        rung.other_verdicts == 0 && rung.corrections.iter().zip(&self.tolerances).all(within)
    }

    fn correction(
        &self,
        points: &[StudyPoint],
        n: u32,
        measure: usize,
        pairs: &[(&FinishedRow, &FinishedRow)],
    ) -> Option<Correction> {
        let ratios: Vec<(&StudyPoint, f64)> = self
            .pilots
            .iter()
            .zip(pairs)
            .filter_map(|(pilot, (reference, rung))| {
                let ratio = reference.promised[measure]? / rung.promised[measure]?;
                let usable = ratio.is_finite() && ratio > 0.0;
                usable.then(|| (&points[*pilot], libm::log(ratio)))
            })
            .collect();
        let count = ratios.len();
        if count < MIN_PILOTS {
            return None;
        }
        let expected = |point: &StudyPoint| self.expected(&point.scene, point.solved, n, measure);
        let feasible = || points.iter().filter(|point| point.infeasible.is_none());
        let plain = Deviations::of(&ratios.iter().map(|(_, ratio)| *ratio).collect::<Vec<f64>>());
        let with_table = feasible().all(|point| expected(point).is_some()).then(|| {
            let residuals = ratios.iter().filter_map(|(point, r)| Some(r - expected(point)?));
            Deviations::of(&residuals.collect::<Vec<f64>>())
        });
        let from_table = with_table.filter(|known| known.deviation < plain.deviation);
        let Deviations { mean, deviation } = from_table.unwrap_or(plain);
        let deviation = deviation.max(scatter(n, measure).unwrap_or(0.0));
        let student = nine_of_ten(count - 1);
        let error = libm::exp(student * deviation * (1.0 + 1.0 / count as f64).sqrt()) - 1.0;
        Some(Correction { mean, error, from_table: from_table.is_some() })
    }

    /// p(x) of a point; `None` where the table of mesh errors has no such scene or mesh.
    fn expected(
        &self,
        scene: &Scene,
        solved: Option<Solved>,
        n: u32,
        measure: usize,
    ) -> Option<f64> {
        let table = MeshErrors::shipped();
        let solved = solved?;
        let features = Features::of(scene, solved.top_radius, solved.height);
        if table.gap(scene, &features).is_some() {
            return None;
        }
        let name = PROMISED[measure].measure.name();
        let bias = |n: u32| table.bias(n, name, &features);
        Some(libm::log((1.0 + bias(self.reference)?) / (1.0 + bias(n)?)))
    }

    /// A value of a point on a mesh, corrected to the reference mesh, and its relative error against it; `None` where
    /// the pilots do not tell the correction.
    pub(crate) fn corrected(
        &self,
        decision: &Decision,
        scene: &Scene,
        solved: Option<Solved>,
        measure: usize,
        value: f64,
    ) -> Option<(f64, f64)> {
        let n = scene.design.subdivisions;
        if n == self.reference {
            return Some((value, 0.0));
        }
        let rung = decision.rungs.iter().find(|rung| rung.subdivisions == n)?;
        let correction = rung.corrections[measure]?;
        let p = if correction.from_table { self.expected(scene, solved, n, measure)? } else { 0.0 };
        Some((value * libm::exp(p + correction.mean), correction.error))
    }
}

/// Mean and standard deviation of the pilots.
#[derive(Clone, Copy)]
struct Deviations {
    mean: f64,
    deviation: f64,
}

impl Deviations {
    /// Those of at least two numbers.
    fn of(numbers: &[f64]) -> Self {
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let squares: f64 = numbers.iter().map(|r| (r - mean) * (r - mean)).sum();
        Self { mean, deviation: (squares / (count - 1.0)).sqrt() }
    }
}

/// Scatter of single runs on a mesh, relative; `None` where the table of mesh errors has no such mesh.
fn scatter(n: u32, measure: usize) -> Option<f64> {
    let method = Method { model: ModelKind::Film, meshes: vec![n] };
    let entry = MeshErrors::shipped().entry(&method, PROMISED[measure].measure.name())?;
    Some(entry.scatter)
}
