//! What is known of the errors of one row: mesh errors, changes with the assumed values, and the uncertainty of a value.

use billow_solver::output::measures::Verdict;
use billow_solver::scene::{ModelKind, Scene};

use super::promised::{PROMISED, promise};
use super::{AssumedRanges, Features, MeshErrors, Method};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{CellType, Cells, ColumnGroup, ColumnId};

/// The errors of one row, in the order of [`PROMISED`], and why some are not known.
pub struct RowErrors {
    /// Mesh errors, in the unit of the measure: how far below and above it the value on the finest mesh may be.
    pub errors: [Option<[f64; 2]>; PROMISED.len()],
    /// Changes over the ranges of the assumed values, below and above it.
    pub assumed: [Option<[f64; 2]>; PROMISED.len()],
    /// Why some mesh errors are not known.
    pub reason: Option<String>,
}

impl RowErrors {
    /// Those of a row without a result.
    pub const NONE: Self =
        Self { errors: [None; PROMISED.len()], assumed: [None; PROMISED.len()], reason: None };

    /// Those of the row of a job, with what is assumed in these ranges.
    pub fn of(scene: &Scene, cells: &Cells, ranges: &AssumedRanges) -> Self {
        if cells.status() != Status::Done {
            return Self::NONE;
        }
        let table = MeshErrors::shipped();
        let dimensions = [ColumnId::TopRadius, ColumnId::Height].map(|column| cells.number(column));
        let features = match dimensions {
            [Some(top_radius), Some(height)] => Features::of(scene, top_radius, height),
            _ => None,
        };
        let method = Method::of(scene);
        let assumed = |features: &Features| {
            PROMISED.map(|promised| {
                let value = cells.number(promised.measure)?;
                let sides = table.assumed(features, &promised, ranges)?;
                Some(sides.map(|side| side * value.abs()))
            })
        };
        let gap = match &features {
            Some(features) => table.gap(scene, features),
            None => scene.design.folded().is_err().then(|| OF_CAPSULES.to_owned()),
        };
        if let Some(gap) = gap {
            // What is assumed changes other scenes too: as much as in the middle of the table.
            let middle = Features { values: table.coordinates.base };
            let film = method.model == ModelKind::Film;
            let assumed = if film { assumed(&middle) } else { Self::NONE.assumed };
            return Self { reason: Some(gap), assumed, ..Self::NONE };
        }
        let Some(features) = features else { return Self::NONE };
        if method.model != ModelKind::Film {
            let known = PROMISED.map(|promised| table.error(&method, &features, &promised));
            let reason = match known.iter().find_map(|error| error.as_ref().ok()) {
                Some(_) => of_another_model(&method),
                None => known.into_iter().find_map(Result::err).unwrap_or_default(),
            };
            return Self { reason: Some(reason), ..Self::NONE };
        }
        let mut reason = None;
        let deployed = cells.verdict() == Some(Verdict::Deployed) || cells.verdict().is_none();
        let errors = PROMISED.map(|promised| {
            let value = cells.number(promised.measure)?;
            if promised.is_at_end() && !deployed {
                reason = Some(NOT_DEPLOYED.to_owned());
                return None;
            }
            match table.error(&method, &features, &promised) {
                Ok(error) => Some(error.of_itself.map(|side| side * value.abs())),
                Err(gap) => {
                    reason = Some(gap);
                    None
                }
            }
        });
        Self { errors, assumed: assumed(&features), reason }
    }

    /// Uncertainty of a value of this row.
    pub fn uncertainty(&self, measure: ColumnId, cells: &Cells) -> Option<[f64; 2]> {
        let near = *cells.get(ColumnId::NearThreshold) == Value::Bool(true);
        let parts = |index: usize| [self.errors[index], self.assumed[index]];
        uncertainty(measure, near, self.reason.as_deref(), parts)
    }
}

/// Uncertainty of a value of a row, SI, below and above it: `None` where it is not known.
///
/// ```text
/// u² = e² + a²      on each side;  e: mesh error,  a: change over the ranges of the assumed values
/// ```
/// A verdict has none, or an infinite one near a threshold; what depends on no mesh has none. `parts` are e and a of a
/// promised measure, by its position; `reason` says why a row has no mesh errors.
pub fn uncertainty(
    measure: ColumnId,
    near_threshold: bool,
    reason: Option<&str>,
    parts: impl Fn(usize) -> [Option<[f64; 2]>; 2],
) -> Option<[f64; 2]> {
    if measure == ColumnId::Verdict {
        let known =
            reason.is_none_or(|reason| !is_unknown(reason) && !reason.contains(VERDICTS_DIFFER));
        return known.then_some([if near_threshold { f64::INFINITY } else { 0.0 }; 2]);
    }
    if depends_on_no_mesh(measure) {
        return Some([0.0; 2]);
    }
    let promised = promise(measure.name())?;
    let [error, assumed] = parts(PROMISED.iter().position(|one| one == promised)?);
    Some(together(error?, assumed))
}

/// Uncertainty by a mesh error and by what is assumed, where that is known: below and above a value.
pub fn together(error: [f64; 2], assumed: Option<[f64; 2]>) -> [f64; 2] {
    let assumed = assumed.unwrap_or_default();
    [0, 1].map(|side| libm::hypot(error[side], assumed[side]))
}

/// Whether a column is no measure of the motion: a count, a word, a number of the audit.
fn depends_on_no_mesh(column: ColumnId) -> bool {
    let column = column.column();
    let of_motion = matches!(column.group, ColumnGroup::Measures | ColumnGroup::Outcome);
    column.cell_type != CellType::Number || !of_motion
}

/// Whether the error of a measure can be known, or it needs none.
pub fn has_error(measure: ColumnId) -> bool {
    depends_on_no_mesh(measure) || promise(measure.name()).is_some()
}

/// How the reason of a model without mesh begins.
pub const OF_FILM: &str = "the error columns are those of film";

/// Why rows of a model without mesh have no error, though the table knows it.
fn of_another_model(method: &Method) -> String {
    format!(
        "{OF_FILM}, not of {}; billow plan STUDY --accuracy names a method that keeps an error",
        method.name()
    )
}

/// Why film from a mesh has no error.
pub const OF_CAPSULES: &str =
    "film from a mesh: the table of mesh errors has folded capsules alone";

/// Why the state at the end of some runs has no error.
const NOT_DEPLOYED: &str = "not deployed: final_z_rim and final_volume have a mesh error only where the capsule is deployed";

/// What stands before the reason of a row that has the errors of pilots.
const OF_PILOTS: &str = "the largest error of the pilots";

/// What is in it where the verdict of a pilot is not the same on its meshes.
const VERDICTS_DIFFER: &str = ", whose verdicts differ";

/// The reason of a row that has the errors of pilots on these meshes; `gap`: why the table has none, `verdicts_agree`:
/// whether every pilot has one verdict on all its meshes.
pub fn of_pilots(gap: &str, meshes: &[u32], verdicts_agree: bool) -> String {
    let meshes: Vec<String> = meshes.iter().map(ToString::to_string).collect();
    let differ = if verdicts_agree { "" } else { VERDICTS_DIFFER };
    format!("{OF_PILOTS} (n {}){differ}; outside the table: {gap}", meshes.join(", "))
}

/// The reason of a row of film from a mesh that has an error from these meshes; `verdicts_agree`: whether its runs on all
/// have one verdict.
pub fn of_meshes(meshes: &[u32], verdicts_agree: bool) -> String {
    let meshes: Vec<String> = meshes.iter().map(ToString::to_string).collect();
    let differ = if verdicts_agree { "" } else { VERDICTS_DIFFER };
    format!("{OF_MESHES} of n {}{differ}", meshes.join(", "))
}

/// What stands before the reason of such a row.
const OF_MESHES: &str = "the grid convergence index";

/// Whether a reason says that the mesh errors of a row are not known.
pub fn is_unknown(reason: &str) -> bool {
    reason != NOT_DEPLOYED && !is_of_pilots(reason) && !reason.starts_with(OF_MESHES)
}

/// Whether it says that pilots gave them.
pub fn is_of_pilots(reason: &str) -> bool {
    reason.starts_with(OF_PILOTS)
}

#[cfg(test)]
mod tests {

    use billow_solver::scene::Stepping;

    use super::*;

    /// The errors of a row of the paper's capsule, computed by a model.
    fn of_row(model: ModelKind, stepping: Stepping) -> RowErrors {
        let mut scene = crate::accuracy::tests::covered();
        scene.design.folded_mut().unwrap().subdivisions = 4;
        scene.solver.model = model;
        scene.solver.stepping = stepping;
        let mut cells = Cells::new(Status::Done);
        cells.set(ColumnId::TopRadius, 0.365);
        cells.set(ColumnId::Height, 1.0);
        cells.set(ColumnId::T90ZRim, 0.2);
        cells.set(ColumnId::Verdict, "deployed");
        RowErrors::of(&scene, &cells, &AssumedRanges::default())
    }

    #[test]
    fn rows_of_film_have_errors_and_rows_of_another_model_say_where_theirs_are() {
        let film = of_row(ModelKind::Film, Stepping::Stable(0.45));
        assert!(
            film.errors[1].is_some_and(|sides| sides.iter().all(|side| (0.0..0.2).contains(side)))
        );
        assert_eq!(film.reason, None);
        let said = |model: &str| {
            format!(
                "the error columns are those of film, not of {model}; billow plan STUDY --accuracy names a method that keeps an error"
            )
        };
        let piston = of_row(ModelKind::Piston, Stepping::Adaptive(1e-9));
        assert_eq!((piston.errors, piston.reason), (RowErrors::NONE.errors, Some(said("piston"))));
        let storeys = of_row(ModelKind::Storeys, Stepping::Stable(0.45));
        assert_eq!(storeys.errors, RowErrors::NONE.errors);
        assert_eq!(storeys.reason, Some(said("storeys")));
        // Where the table has no error of the model either, the reason is that.
        let outside = of_row(ModelKind::Storeys, Stepping::Stable(0.2));
        assert_eq!(outside.errors, RowErrors::NONE.errors);
        assert_eq!(
            outside.reason.as_deref(),
            Some("solver.cfl 0.2: the runs of the table have 0.45")
        );
    }
}
