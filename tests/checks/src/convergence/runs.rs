//! The runs of a study by scene and mesh.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use billow_solver::scene::paper::LOSS_FACTOR;
use billow_solver::scene::{HeatTransfer, ModelKind, Scene};

use billow_study::accuracy::features::step;
use billow_study::accuracy::promised::promise;
use billow_study::accuracy::{Features, Promised};
use billow_study::analysis::statistics::Spread;
use billow_study::input::keys::numerical::{self, MESH, MODEL, SEED};
use billow_study::job::canonical_json;
use billow_study::job::row::{Cells, ColumnId};
use billow_study::store::stored::Stored;

/// The default heat transfer coefficient, W/(m² K).
const HEAT_TRANSFER: f64 = 0.3;

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

    /// The assumed value in which it differs from the default, as in `film.loss_factor 0.003`; empty where it does not.
    pub(super) fn assumed(&self) -> String {
        let (film, heat) = (&self.scene.film, self.scene.gas.heat_transfer);
        match heat {
            _ if film.loss_factor != LOSS_FACTOR => {
                format!("film.loss_factor {}", film.loss_factor)
            }
            HeatTransfer::Coefficient(h) if h != HEAT_TRANSFER => format!("gas.heat_transfer {h}"),
            _ => String::new(),
        }
    }

    /// Model and subdivisions; a model without mesh has 0.
    pub(super) fn mesh(&self) -> (ModelKind, u32) {
        match self.scene.solver.model {
            ModelKind::Film => (
                ModelKind::Film,
                self.scene.design.folded().map_or(0, |design| design.subdivisions),
            ),
            meshless => (meshless, 0),
        }
    }
}

impl SceneRuns {
    /// The median of a measure on a mesh, without the runs in which an assumed value differs; `None` where it is 0.
    pub(super) fn median(&self, measure: ColumnId, mesh: (ModelKind, u32)) -> Option<f64> {
        let on = |run: &&MeshRun| run.mesh() == mesh && run.assumed().is_empty();
        let values = self.runs.iter().filter(on).filter_map(|run| run.measure(measure));
        Spread::of(values).map(|spread| spread.median).filter(|median| *median != 0.0)
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
        let Some(features) = features else { continue };
        let label = point
            .job
            .parameters
            .iter()
            .filter(|(name, _)| numerical::path(name).is_none_or(|path| !NO_SCENE.contains(&path)))
            .map(|(name, value)| format!("{name}={}", value.short()));
        let label = label.collect::<Vec<_>>().join(" ");
        let entry = scenes.entry(key(scene));
        let entry = entry.or_insert_with(|| SceneRuns { runs: Vec::new(), label });
        entry.runs.push(MeshRun { scene: Scene::clone(scene), features, cells });
    }
    scenes.into_values().collect()
}

/// Parameters that name no scene.
const NO_SCENE: [&str; 5] = [MESH, MODEL, SEED, "film.loss_factor", "gas.heat_transfer"];

/// Text that is equal for runs of one scene.
pub(super) fn key(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.film.loss_factor = LOSS_FACTOR;
    scene.gas.heat_transfer = HeatTransfer::Coefficient(HEAT_TRANSFER);
    scene.design.folded_mut().unwrap().subdivisions = 0;
    scene.seed = 0;
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = step(&scene);
    scene.outputs.frames = 0;
    canonical_json(&scene)
}
