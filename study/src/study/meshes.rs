//! `solver.meshes` of a study: each point runs on several meshes, and its row has the values extrapolated from them. Of
//! one mesh, each point runs on it alone.
//!
//! The meshes are an axis that varies fastest, as replicates do. They must be meshes of the table of mesh errors,
//! which has the weights of the extrapolation.

use billow_solver::scene::{ModelKind, Scene};

use super::column::Column;
use super::grid::{Axis, AxisKind, Context, Grid};
use crate::accuracy::{Features, MeshErrors};
use crate::input::json::Json;
use crate::input::keys::{self, KEYS, position, short_name};
use crate::input::object::list;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::Value;
use crate::job::point::Point;
use crate::platform::error::InputError;

/// The key, for errors.
const MESHES: &str = "solver.meshes";
/// The key that the meshes vary.
pub(super) const SUBDIVISIONS: usize = position(KEYS, "design.subdivisions");

/// The meshes from which values of a study are extrapolated.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Meshes {
    /// Subdivisions, coarsest first; empty without any.
    pub list: Vec<u32>,
    /// Whether the pilots alone run on all of them.
    pub of_pilots: bool,
    /// Whether they cut the triangles of a mesh file: values are then those of the finest.
    pub of_file: bool,
}

/// "4 and 6", "4, 6 and 8".
pub fn meshes_text(meshes: &[u32]) -> String {
    let [coarser @ .., finest] = meshes else { return String::new() };
    let coarser: Vec<String> = coarser.iter().map(ToString::to_string).collect();
    format!("{} and {finest}", coarser.join(", "))
}

impl Grid {
    /// Reads the meshes, as the last axis.
    pub(super) fn read_meshes(
        &mut self,
        json: Option<&Json>,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        let source = context.source;
        let meshes = read_list(json, &known(context.settings), source)?;
        let refuse = |problem: &str| {
            source.error(MESHES, json, problem, "a study in which nothing else varies the mesh")
        };
        let name = short_name(SUBDIVISIONS).to_owned();
        let column = Column { name, key: &KEYS[SUBDIVISIONS], index: SUBDIVISIONS };
        if self.columns.contains(&column) {
            return Err(refuse("varies subdivisions, which another axis varies already"));
        }
        let searches = self.search.is_some() || self.optimise.is_some();
        if searches && meshes.len() > 1 {
            return Err(refuse(
                "extrapolates from several meshes, and a search judges single runs",
            ));
        }
        self.columns.push(column);
        let rows = meshes.iter().map(|n| vec![Value::Integer(i64::from(*n))]).collect();
        let columns = vec![self.columns.len() - 1];
        self.axes.push(Axis { columns, rows, kind: AxisKind::Meshes });
        Ok(())
    }

    /// The values of the subdivisions on the grid.
    pub(super) fn mesh_values(&self) -> Vec<u32> {
        let of_axis = self.axes.iter().flat_map(|axis| {
            let column = axis.columns.iter().position(|c| self.columns[*c].index == SUBDIVISIONS);
            axis.rows.iter().filter_map(move |row| column.map(|column| &row[column]))
        });
        let single = self.points.iter().flatten();
        let single = single.filter(|(column, _)| self.columns[*column].index == SUBDIVISIONS);
        of_axis.chain(single.map(|(_, value)| value)).filter_map(whole).collect()
    }

    /// The meshes of each point, coarsest first; empty where the study does not give them.
    pub(super) fn meshes(&self) -> Vec<u32> {
        let axes = self.axes.iter().filter(|axis| axis.kind == AxisKind::Meshes);
        let values = axes.flat_map(|axis| &axis.rows).flatten();
        values.filter_map(whole).collect()
    }
}

fn whole(value: &Value) -> Option<u32> {
    match value {
        Value::Integer(n) => u32::try_from(*n).ok(),
        _ => None,
    }
}

/// The meshes that a study may extrapolate from: those of the table of mesh errors; of film from a mesh any.
pub(super) fn known(settings: &Settings) -> Vec<u32> {
    if settings.meshes.is_empty() { MeshErrors::shipped().meshes() } else { (1..=8).collect() }
}

/// Reads a list of meshes that are known.
fn read_list(json: &Json, known: &[u32], source: &Source) -> Result<Vec<u32>, InputError> {
    let names = known.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let allowed = format!("1 to 3 of {names}, the coarsest first, as in [4, 8]");
    let mesh = |item: &Json| match item {
        Json::Integer(n) => u32::try_from(*n).ok().filter(|n| known.contains(n)),
        _ => None,
    };
    let meshes: Option<Vec<u32>> = list(json, MESHES, source, &allowed)?.iter().map(mesh).collect();
    let problem = match meshes {
        None => "has a mesh that is not known",
        Some(meshes) if matches!(meshes.len(), 1..=3) && meshes.is_sorted_by(|a, b| a < b) => {
            return Ok(meshes);
        }
        Some(_) => "is not 1 to 3 meshes in ascending order",
    };
    Err(source.error(MESHES, json, problem, allowed))
}

/// The scene of a point with the features on which mesh errors depend; `None` for an infeasible point, and for film from a
/// mesh.
pub(crate) fn features(point: &Point) -> Option<(&Scene, Features)> {
    let (scene, solved) = (&*point.job.scene, point.solved?);
    Some((scene, Features::of(scene, solved.top_radius, solved.height)?))
}

/// Refuses models without a mesh: their runs on each would be equal.
pub(super) fn refuse_other_models(
    grid: &Grid,
    points: &[Point],
    source: &Source,
) -> Result<(), InputError> {
    let meshes = grid.meshes();
    let other = points
        .iter()
        .map(|point| point.job.scene.solver.model)
        .find(|kind| *kind != ModelKind::Film);
    let Some(other) = other.filter(|_| !meshes.is_empty()) else { return Ok(()) };
    let problem = format!("has meshes, and the model {} has none", keys::model(other).name);
    let found = Json::List(meshes.iter().map(|n| Json::Integer(i64::from(*n))).collect());
    Err(source.error(MESHES, found, problem, "a study in which every point has the model film"))
}
