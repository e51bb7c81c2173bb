//! The runs of a study by scene and mesh.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use billow_solver::scene::{ModelKind, Scene};

use billow_study::accuracy::features::step;
use billow_study::accuracy::promised::promise;
use billow_study::accuracy::{Features, Promised};
use billow_study::input::keys::numerical::{self, MESH, MODEL, SEED};
use billow_study::job::canonical_json;
use billow_study::job::row::{Cells, ColumnId};
use billow_study::store::stored::Stored;

/// One trusted run.
#[derive(Debug, Clone)]
pub(super) struct MeshRun {
    pub(super) scene: Scene,
    pub(super) features: Features,
    pub(super) cells: Cells,
}

/// The runs of one scene, with whatever mesh, model and seed.
#[derive(Debug, Clone)]
pub(super) struct SceneRuns {
    pub(super) runs: Vec<MeshRun>,
    /// The parameters of the scene but mesh, model and seed, as text.
    pub(super) label: String,
}

impl MeshRun {
    /// A measure. The state at the end counts only where the capsule is deployed: it is at rest then.
    pub(super) fn measure(&self, measure: ColumnId) -> Option<f64> {
        let at_end = promise(measure.name()).is_some_and(Promised::is_at_end);
        if at_end && self.cells.verdict() != Some(Verdict::Deployed) {
            return None;
        }
        self.cells.number(measure)
    }

    /// Model and subdivisions; a model without mesh has 0.
    pub(super) fn mesh(&self) -> (ModelKind, u32) {
        match self.scene.solver.model {
            ModelKind::Film => (ModelKind::Film, self.scene.design.subdivisions),
            meshless => (meshless, 0),
        }
    }
}

/// The trusted runs of stored results, by scene.
pub(super) fn by_scene(all: &[Stored<'_>]) -> Vec<SceneRuns> {
    let mut scenes: BTreeMap<String, SceneRuns> = BTreeMap::new();
    for (stored, point) in
        all.iter().flat_map(|stored| stored.points.iter().map(move |point| (stored, point)))
    {
        let cells = stored.cells(point);
        let (Some(solved), true) = (point.solved, cells.is_trusted()) else { continue };
        let scene = &point.job.scene;
        let features = Features::of(scene, solved.top_radius, solved.height);
        let label = point
            .job
            .parameters
            .iter()
            .filter(|(name, _)| numerical::path(name).is_none_or(|path| !NO_SCENE.contains(&path)))
            .map(|(name, value)| format!("{name}={}", value.short()));
        let label = label.collect::<Vec<_>>().join(" ");
        let entry = scenes.entry(key(scene));
        let entry = entry.or_insert_with(|| SceneRuns { runs: Vec::new(), label });
        entry.runs.push(MeshRun {
            scene: Scene::clone(scene),
            features,
            cells: cells.into_owned(),
        });
    }
    scenes.into_values().collect()
}

/// Parameters that name no scene.
const NO_SCENE: [&str; 3] = [MESH, MODEL, SEED];

/// Text that is equal for runs of one scene.
fn key(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.design.subdivisions = 0;
    scene.seed = 0;
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = step(&scene);
    scene.outputs.frames = 0;
    canonical_json(&scene)
}
