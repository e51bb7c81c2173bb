//! The section `accuracy` of a study: the errors that its results must keep. The meshes follow from the table of
//! mesh errors.
//!
//! ```text
//! {"t_90_z_rim": 0.02}  →  the cheapest of one or two meshes whose errors of every point are within these
//! ```
//! A number is the tolerance of every promised measure but `peak_vz`, which scatters by more from seed to seed.
//! The choice stands in study.json beside the errors, so that another version of the table changes no stored study.

use billow_solver::scene::{ModelKind, Scene};

use super::meshes;
use crate::accuracy::{
    Choice, Features, MeshErrors, PROMISED, Tolerances, all_but_peak_vz, choices,
};
use crate::input::fraction::{RELATIVE_ERROR, relative_error_in};
use crate::input::json::Json;
use crate::input::keys::STUDY;
use crate::input::object::object;
use crate::input::source::Source;
use crate::job::point::Point;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// The section.
pub(super) const ACCURACY: &str = "accuracy";
/// Its member with the meshes that were chosen.
const MESHES: &str = "meshes";

/// The errors that results must keep.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Accuracy {
    /// Largest relative error of each promised measure.
    pub tolerances: Tolerances,
    /// The meshes that keep them, coarsest first; empty until they are chosen.
    pub meshes: Vec<u32>,
}

impl Accuracy {
    /// Reads the section.
    ///
    /// # Errors
    /// A measure without a promise, a value that is no relative error.
    pub fn read(json: Option<&Json>, source: &Source) -> Result<Option<Self>, InputError> {
        let Some(json) = json else { return Ok(None) };
        let mut accuracy = Self { tolerances: [None; PROMISED.len()], meshes: Vec::new() };
        if let Json::Text(_) | Json::Number(_) | Json::Integer(_) = json {
            let tolerance = tolerance(json, ACCURACY, source)?;
            accuracy.tolerances = all_but_peak_vz(Some(tolerance));
            return Ok(Some(accuracy));
        }
        for (name, value) in object(json, &STUDY, ACCURACY, source)? {
            let path = format!("{ACCURACY}.{name}");
            if name == MESHES {
                accuracy.meshes = meshes::read_list(value, &path, 1..=3, source)?;
                continue;
            }
            let names = || PROMISED.iter().map(|promised| promised.measure.name());
            let Some(index) = names().position(|known| known == name) else {
                let near = or_nearest(name, names());
                let problem = format!("is not a measure with a known mesh error{near}");
                let allowed = names().collect::<Vec<_>>().join(", ");
                return Err(source.error(&path, value, problem, allowed));
            };
            accuracy.tolerances[index] = Some(tolerance(value, &path, source)?);
        }
        if accuracy.tolerances.iter().all(Option::is_none) {
            let allowed = "measures and their relative errors, as in {\"t_90_z_rim\": 0.02}";
            return Err(source.error(ACCURACY, json, "names no measure", allowed));
        }
        Ok(Some(accuracy))
    }

    /// Chooses the meshes for these points.
    ///
    /// # Errors
    /// Points that the table does not cover; errors that no method keeps.
    pub fn choose(&mut self, points: &[Point], source: &Source) -> Result<(), InputError> {
        let refuse = |problem: String, allowed: String| {
            Err(source.error(ACCURACY, &self.shown(), problem, allowed))
        };
        if points.iter().any(|point| point.job.scene.solver.model != ModelKind::Film) {
            return refuse(
                "chooses the meshes of the model film".to_owned(),
                "solver.model film".to_owned(),
            );
        }
        let scenes: Vec<_> = points.iter().filter_map(features).collect();
        let table = MeshErrors::shipped();
        let film = match choices(table, &scenes) {
            Ok(choices) => {
                choices.into_iter().filter(|choice| choice.method.model == ModelKind::Film)
            }
            Err(gap) => {
                let problem = format!("is not known for every point: {gap}");
                let allowed = "points that the table of mesh errors covers (docs/guide/accuracy.md); elsewhere \
                               solver.meshes with three meshes gives errors";
                return refuse(problem, allowed.to_owned());
            }
        };
        let film: Vec<Choice> = film.collect();
        let Some(choice) = film.iter().find(|choice| choice.keeps(&self.tolerances)) else {
            let best =
                PROMISED.iter().enumerate().filter(|(index, _)| self.tolerances[*index].is_some());
            let best = best.map(|(index, promised)| {
                let least =
                    film.iter().map(|choice| choice.errors[index]).fold(f64::INFINITY, f64::min);
                format!("{} {:.2} % or more", promised.measure.name(), 100.0 * least)
            });
            let best = best.collect::<Vec<_>>().join(", ");
            return refuse("is kept by no mesh of the table of mesh errors".to_owned(), best);
        };
        self.meshes.clone_from(&choice.method.meshes);
        Ok(())
    }

    /// The section as a study file has it, with the meshes that were chosen.
    pub fn to_json(&self) -> Json {
        let mut members = self.members();
        let meshes = self.meshes.iter().map(|n| Json::Integer(i64::from(*n)));
        if !self.meshes.is_empty() {
            members.push((MESHES.to_owned(), Json::List(meshes.collect())));
        }
        Json::Object(members)
    }

    fn members(&self) -> Vec<(String, Json)> {
        let tolerances = PROMISED.iter().zip(self.tolerances);
        tolerances
            .filter_map(|(promised, tolerance)| {
                Some((promised.measure.name().to_owned(), Json::Number(tolerance?)))
            })
            .collect()
    }

    fn shown(&self) -> String {
        let of_number = |tolerance: Option<f64>| all_but_peak_vz(tolerance) == self.tolerances;
        match self.tolerances.into_iter().find(|tolerance| of_number(*tolerance)) {
            Some(Some(tolerance)) => Json::Number(tolerance).to_string(),
            _ => Json::Object(self.members()).to_string(),
        }
    }
}

/// The scene of a point with the features on which mesh errors depend; `None` for an infeasible point.
pub(crate) fn features(point: &Point) -> Option<(&Scene, Features)> {
    let (scene, solved) = (&*point.job.scene, point.solved?);
    Some((scene, Features::of(scene, solved.top_radius, solved.height)))
}

/// A relative error of a study file.
fn tolerance(json: &Json, path: &str, source: &Source) -> Result<f64, InputError> {
    relative_error_in(json)
        .ok_or_else(|| source.error(path, json, "is not a relative error", RELATIVE_ERROR))
}

/// Refuses a mesh that the file gives beside an accuracy, which chooses it.
pub(super) fn refuse_given_mesh(tree: &Json, source: &Source) -> Result<(), InputError> {
    let given = [("design", "subdivisions"), ("solver", MESHES)];
    for (section, key) in given {
        if let Some(value) = tree.get(section).and_then(|section| section.get(key)) {
            let path = format!("{section}.{key}");
            let problem = "is given beside accuracy, which chooses the meshes";
            return Err(source.error(&path, value, problem, "one of the two"));
        }
    }
    Ok(())
}

/// Puts the chosen meshes into the tree of a study file.
pub(super) fn set_meshes(tree: &mut Json, meshes: &[u32]) {
    let whole = |n: &u32| Json::Integer(i64::from(*n));
    let (section, key, value) = match meshes {
        [n] => ("design", "subdivisions", whole(n)),
        meshes => ("solver", MESHES, Json::List(meshes.iter().map(whole).collect())),
    };
    if tree.get(section).is_none() {
        tree.set(section, Json::Object(Vec::new()));
    }
    if let Some(section) = tree.get_mut(section) {
        section.set(key, value);
    }
}
