//! Whether runs keep the errors that the table of mesh errors gives them.
//!
//! ```text
//! error of a run = |m/m_ref − 1|      m_ref: median of the runs of its scene on the finest mesh
//! kept:  error ≤ error of the table
//! ```
//! A check with the designs that the table was made from says little; with others it says how far the table can be
//! trusted.

use std::collections::BTreeMap;

use billow_solver::scene::ModelKind;

use super::runs::{MeshRun, SceneRuns};
use billow_study::accuracy::{MeshErrors, Method, PROMISED, Promised};
use billow_study::analysis::statistics::Spread;
use billow_study::job::proportion::Proportion;

/// The runs on one mesh, for one measure.
#[derive(Debug)]
pub(super) struct MeshCheck {
    pub(super) subdivisions: u32,
    pub(super) measure: &'static str,
    /// Of the runs with an error in the table, those that keep it.
    pub(super) kept: Proportion,
    /// Median relative error of these runs.
    pub(super) error: f64,
    /// Median relative error of the table for them.
    pub(super) of_table: f64,
}

/// The checks of film on each mesh coarser than that of `table`, for each promised measure.
pub(super) fn check(scenes: &[SceneRuns], table: &MeshErrors) -> Vec<MeshCheck> {
    // Errors of runs and of the table by mesh and place of the measure.
    let mut pairs: BTreeMap<(u32, usize), Vec<[f64; 2]>> = BTreeMap::new();
    for scene in scenes {
        for (index, promised) in PROMISED.iter().enumerate() {
            for (n, pair) in errors(scene, promised, table) {
                pairs.entry((n, index)).or_default().push(pair);
            }
        }
    }
    let check = |((subdivisions, index), pairs): ((u32, usize), Vec<[f64; 2]>)| {
        let median = |end: usize| Some(Spread::of(pairs.iter().map(|pair| pair[end]))?.median);
        Some(MeshCheck {
            subdivisions,
            measure: PROMISED[index].measure.name(),
            kept: Proportion::count(pairs.iter().map(|[error, of_table]| error <= of_table)),
            error: median(0)?,
            of_table: median(1)?,
        })
    };
    pairs.into_iter().filter_map(check).collect()
}

/// The runs of a scene on coarser meshes: subdivisions, error of the run and error of the table, relative.
fn errors(scene: &SceneRuns, promised: &Promised, table: &MeshErrors) -> Vec<(u32, [f64; 2])> {
    let on_finest = |run: &&MeshRun| run.mesh() == (ModelKind::Film, table.reference);
    let finest = scene.runs.iter().filter(on_finest);
    let finest = Spread::of(finest.filter_map(|run| run.measure(promised.measure)));
    let Some(reference) = finest.map(|spread| spread.median).filter(|median| *median != 0.0) else {
        return Vec::new();
    };
    let of_run = |run: &MeshRun| {
        let (model, n) = run.mesh();
        let method = Method { model, meshes: vec![n] };
        let covered = model == ModelKind::Film
            && n < table.reference
            && table.gap(&run.scene, &run.features).is_none();
        let of_table = covered.then(|| table.error(&method, &run.features, promised).ok())??;
        let value = run.measure(promised.measure)?;
        // Both over the value on the finest mesh; that of the table is the error that the row of the run has.
        let error = (value / reference - 1.0).abs();
        Some((n, [error, of_table.of_itself * (value / reference).abs()]))
    };
    scene.runs.iter().filter_map(of_run).collect()
}
