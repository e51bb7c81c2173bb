//! Reads `"model": "auto"` of a study file.

use super::{Auto, MIN_PILOTS, PILOT_SHARE, pilots};
use crate::input::keys::numerical::{AUTO, MESH, MODEL};
use crate::input::keys::{KEYS, position};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;
use crate::study::accuracy::Accuracy;
use crate::study::grid::Grid;
use crate::study::point::StudyPoint;
use crate::study::target::Target;
use billow_solver::scene::ModelKind;

/// The section and the member of the key.
const SOLVER: (&str, &str) = ("solver", "model");
/// The model of every run.
const FILM: &str = "film";
/// The keys that it chooses.
const CHOSEN: [usize; 2] = [position(KEYS, MESH), position(KEYS, MODEL)];

/// Whether a study file asks for it.
pub(in crate::study) fn is_auto(tree: &Json) -> bool {
    let model = tree.get(SOLVER.0).and_then(|solver| solver.get(SOLVER.1));
    matches!(model, Some(Json::Text(text)) if text == AUTO)
}

/// Puts the model of the runs in its place.
pub(in crate::study) fn replace_model(tree: &mut Json) {
    set_model(tree, FILM);
}

/// Puts `auto` back.
pub(in crate::study) fn write_model(tree: &mut Json) {
    set_model(tree, AUTO);
}

fn set_model(tree: &mut Json, model: &str) {
    if let Some(solver) = tree.get_mut(SOLVER.0) {
        solver.set(SOLVER.1, Json::Text(model.to_owned()));
    }
}

impl Auto {
    /// The plan of a study.
    ///
    /// # Errors
    /// No `accuracy`; a key beside it that chooses meshes or models too; too few points for the pilots.
    pub(in crate::study) fn of(
        accuracy: Option<&Accuracy>,
        grid: &Grid,
        points: &[StudyPoint],
        repeats: &[String],
        source: &Source,
    ) -> Result<Self, InputError> {
        let refuse = |problem: &str, allowed: String| {
            source.error(MODEL, &format!("\"{AUTO}\""), problem, allowed)
        };
        let Some(accuracy) = accuracy else {
            let allowed = "beside it \"accuracy\": 0.03, or {\"t_90_z_rim\": 0.03}: relative errors against \
                           design.subdivisions";
            return Err(refuse("has no accuracy to keep", allowed.to_owned()));
        };
        if grid.search.is_some() {
            let allowed = "a grid without \"bisect\", or another model";
            return Err(refuse(
                "cannot run a search, which judges single runs",
                allowed.to_owned(),
            ));
        }
        if !grid.meshes().is_empty() {
            let allowed = "one of the two";
            return Err(refuse("is given beside solver.meshes", allowed.to_owned()));
        }
        let varied =
            |key: &usize| grid.columns.iter().any(|column| column.target == Target::Key(*key));
        if let Some(key) = CHOSEN.into_iter().find(varied) {
            let problem = format!("chooses {}, which the grid varies", KEYS[key].path);
            return Err(refuse(&problem, format!("one value of {}", KEYS[key].path)));
        }
        debug_assert!(points.iter().all(|point| point.scene.solver.model == ModelKind::Film));
        let reference = points.first().map_or(0, |point| point.scene.design.subdivisions);
        let rungs = pilots::rungs(reference);
        if rungs.is_empty() {
            let problem =
                format!("has no mesh from n 3 to half of design.subdivisions, {reference}");
            return Err(refuse(&problem, "design.subdivisions 6 or more".to_owned()));
        }
        let pilots = pilots::choose(points, &rungs, reference, repeats);
        if pilots.len() < MIN_PILOTS {
            let share = 100.0 * PILOT_SHARE;
            let problem = format!(
                "has too few points: pilots may cost {share} % of all {} points on the reference mesh, which pays for \
                 {}, and the correction needs {MIN_PILOTS}",
                points.len(),
                pilots.len()
            );
            let most = PILOT_SHARE / MIN_PILOTS as f64;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "about 45")]
            let enough = libm::ceil(1.2 / most) as u32;
            let mut error = refuse(&problem, format!("about {enough} points or more"));
            "a smaller study runs whole: \"model\": \"film\"; without design.subdivisions accuracy chooses its mesh"
                .clone_into(&mut error.hint);
            return Err(error);
        }
        Ok(Self { tolerances: accuracy.tolerances, reference, rungs, pilots })
    }
}
