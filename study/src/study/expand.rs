//! From axes to points: the product, the single points, the filter.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use billow_solver::geometry::fold::{FoldDesign, FoldError, FoldPattern};
use billow_solver::models;
use billow_solver::scene::Scene;
use billow_solver::scene::error::SceneError;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use super::filter::{Filter, Fold};
use super::grid::{Axis, AxisKind, Grid};
use super::resolve;
use crate::input::keys::{self, KEYS};
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::input::value::{Value, json_value};
use crate::job::point::{Infeasible, Point, Searched, Solved};
use crate::job::surroundings::Surroundings;
use crate::job::{Job, JobId, Parameters};
use crate::platform::error::InputError;

/// The points that a study plans first, and how many of the product its filter removed.
pub(super) fn points(
    settings: &Settings,
    grid: &Grid,
    source: &Source,
    max_points: usize,
) -> Result<(Vec<Point>, usize), InputError> {
    let (product, count) = count(grid, source, max_points)?;
    let mut expansion = Expansion::new(settings, grid, source);
    if grid.search.is_some() {
        expansion.searched = Searched::InProduct;
    }
    let axes: Vec<&Axis> = grid.axes.iter().collect();
    let mut filtered = 0;
    let mut point = settings.clone();
    for number in 0..product {
        set_axes(&mut point, grid, &axes, number);
        filtered += usize::from(!expansion.add(&point, grid.filter.as_ref())?);
    }
    let searched = grid.search.as_ref().map(|search| search.column);
    for values in &grid.points {
        let mut point = settings.clone();
        for (column, value) in values {
            point.set(grid.columns[*column].index, value.clone());
        }
        // A point that does not give the key of the search is searched as those of the product.
        let gives = |column: usize| values.iter().any(|(given, _)| *given == column);
        let is_searched = searched.is_some_and(|column| !gives(column));
        expansion.searched = if is_searched { Searched::Single } else { Searched::No };
        let scan = grid.axes.iter().filter(|axis| axis.kind == AxisKind::Search);
        let scan: Vec<&Axis> = scan.filter(|_| is_searched).collect();
        for number in 0..scan.iter().map(|axis| axis.rows.len()).product() {
            set_axes(&mut point, grid, &scan, number);
            expansion.add_replicates(&point, None)?;
        }
    }
    if expansion.points.is_empty() {
        let problem = format!("keeps none of the {count} points");
        let text = grid.filter.as_ref().map_or("", |filter| filter.text());
        let allowed = "a condition that at least one point meets";
        return Err(source.error("grid.filter", text, problem, allowed));
    }
    Ok((expansion.into_points(), filtered))
}

/// The runs of one searched point, with these values by column; those of replicates are not used.
pub(super) fn points_at(
    settings: &Settings,
    grid: &Grid,
    source: &Source,
    values: &[Value],
    searched: Searched,
) -> Result<Vec<Point>, InputError> {
    let mut expansion = Expansion::new(settings, grid, source);
    expansion.searched = searched;
    let mut point = settings.clone();
    for (column, value) in grid.columns.iter().zip(values) {
        point.set(column.index, value.clone());
    }
    // The filter does not concern single points.
    let filter = grid.filter.as_ref().filter(|_| searched == Searched::InProduct);
    expansion.add_replicates(&point, filter)?;
    Ok(expansion.into_points())
}

/// Sets the values of the combination with this number. The last axis varies fastest; axes are independent,
/// so the order of setting is free.
fn set_axes(point: &mut Settings, grid: &Grid, axes: &[&Axis], number: usize) {
    let mut rest = number;
    for Axis { columns, rows, .. } in axes.iter().rev() {
        let row = &rows[rest % rows.len()];
        rest /= rows.len();
        for (column, value) in columns.iter().zip(row) {
            point.set(grid.columns[*column].index, value.clone());
        }
    }
}

/// Number of points of the product, and of all points before the filter.
fn count(grid: &Grid, source: &Source, max_points: usize) -> Result<(usize, usize), InputError> {
    let has_axes = grid.axes.iter().any(|axis| !axis.kind.repeats());
    let product = match (has_axes, grid.points.is_empty()) {
        // Without axes, single points stand alone; without either, the study is one point.
        (false, false) => Some(0),
        _ => grid.axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.rows.len())),
    };
    let single = grid.single_points().checked_mul(grid.replicate_count());
    let all = product.zip(single).and_then(|(product, single)| product.checked_add(single));
    if let (Some(product), Some(all)) = (product, all)
        && all <= max_points
    {
        return Ok((product, all));
    }
    let size = all.map_or_else(|| "more than 10^19".to_owned(), |count| count.to_string());
    let allowed = format!("up to {max_points} points");
    Err(source.error("grid", "", format!("has {size} points"), allowed).with_hint(format!(
        "give {} fewer values; a search finds a border with few points ({{\"bisect\": [low, high], \"on\": …}}); a \
         filter counts after this; or make several studies",
        longest_axes(grid)
    )))
}

/// The axes with the most values, two at most: "film.thickness (1000 values) and N (500 values)".
fn longest_axes(grid: &Grid) -> String {
    let mut axes: Vec<&Axis> = grid.axes.iter().collect();
    axes.sort_by_key(|axis| std::cmp::Reverse(axis.rows.len()));
    let text = |axis: &&Axis| {
        let names: Vec<&str> =
            axis.columns.iter().map(|column| grid.columns[*column].name.as_str()).collect();
        format!("{} ({} values)", names.join(", "), axis.rows.len())
    };
    let texts: Vec<String> = axes.iter().take(2).map(text).collect();
    if texts.is_empty() { "grid.points".to_owned() } else { texts.join(" and ") }
}

/// The bits of a design, to find its fold again.
fn bits(design: &FoldDesign) -> [Option<u64>; 12] {
    [
        Some(design.fit as u64),
        Some(design.panels.into()),
        Some(design.storeys.into()),
        Some(design.bottom_radius.to_bits()),
        design.top_radius.map(f64::to_bits),
        design.height.map(f64::to_bits),
        design.half_angle.map(f64::to_bits),
        design.alpha1_over_phi.map(f64::to_bits),
        Some(design.chirality as u64),
        Some(design.stowed_height.to_bits()),
        Some(design.subdivisions.into()),
        Some(design.caps as u64),
    ]
}

/// A point before its job has an id.
type Resolved = (Parameters, Arc<Scene>, Option<Infeasible>, Option<Solved>, Searched);

struct Expansion<'a> {
    settings: &'a Settings,
    grid: &'a Grid,
    source: &'a Source,
    /// Whether a search runs along the points that are added.
    searched: Searched,
    /// Designs already solved: points that share a design share its fold.
    folds: HashMap<[Option<u64>; 12], Rc<Fold>>,
    points: Vec<Resolved>,
}

impl<'a> Expansion<'a> {
    fn new(settings: &'a Settings, grid: &'a Grid, source: &'a Source) -> Self {
        Self {
            settings,
            grid,
            source,
            searched: Searched::No,
            folds: HashMap::new(),
            points: Vec::new(),
        }
    }

    /// Adds a point with all values of its replicates, unless the filter removes it.
    fn add_replicates(
        &mut self,
        point: &Settings,
        filter: Option<&Filter>,
    ) -> Result<(), InputError> {
        let axes: Vec<&Axis> = self.grid.replicates().collect();
        for number in 0..self.grid.replicate_count() {
            let mut point = point.clone();
            set_axes(&mut point, self.grid, &axes, number);
            self.add(&point, filter)?;
        }
        Ok(())
    }

    /// Adds a point, unless the filter removes it; `false` for a removed point.
    fn add(&mut self, point: &Settings, filter: Option<&Filter>) -> Result<bool, InputError> {
        debug_assert_eq!(self.settings.supports, point.supports, "supports are not an axis");
        let design = point.design(self.source);
        let design = design.map_err(|error| self.at_point(point, error))?;
        let fold = design.folded().ok().map(|design| {
            let fold = self.folds.entry(bits(design));
            Rc::clone(fold.or_insert_with(|| Rc::new(FoldPattern::new(design))))
        });
        if let Some(filter) = filter
            && !filter.holds(point, fold.as_deref())
        {
            return Ok(false);
        }
        let (infeasible, solved) = match fold.as_deref() {
            None => (None, None),
            Some(Ok(pattern)) => (None, Some(Solved::of(pattern))),
            Some(Err(FoldError::Infeasible { reason, nearest })) => {
                (Some(Infeasible { reason: reason.clone(), nearest: nearest.clone() }), None)
            }
            Some(Err(FoldError::Invalid { key, problem })) => {
                let error = self.invalid_design(point, key, problem);
                return Err(self.at_point(point, error));
            }
        };
        let scene = resolve::scene(point, design, self.source)
            .and_then(|scene| match models::check(&scene) {
                Ok(()) => Ok(scene),
                Err(error) => Err(self.refused(&error)),
            })
            .map_err(|error| self.at_point(point, error))?;
        let outside = Surroundings::of_scene(&scene, solved.as_ref());
        if let Some(problem) = outside.and_then(|outside| outside.refusal()) {
            let error =
                self.source.error("gravity", shown(scene.gravity), problem, Surroundings::ALLOWED);
            return Err(self.at_point(point, error));
        }
        let parameters = self.parameters(point);
        let scene = Arc::new(scene);
        self.points.push((parameters, scene, infeasible, solved, self.searched));
        Ok(true)
    }

    /// The points with their jobs; ids are hashed on all cores.
    fn into_points(self) -> Vec<Point> {
        let point = |(parameters, scene, infeasible, solved, searched): Resolved| {
            let job = Job { id: JobId::of(&scene), parameters, scene };
            Point { job, infeasible, solved, searched, merged: Vec::new() }
        };
        self.points.into_par_iter().map(point).collect()
    }

    /// The varied parameters of a point.
    fn parameters(&self, point: &Settings) -> Parameters {
        let columns = self.grid.columns.iter();
        columns.map(|column| (column.name.clone(), point.at(column.index).clone())).collect()
    }

    /// The error, with the point it belongs to.
    fn at_point(&self, point: &Settings, mut error: InputError) -> InputError {
        if !self.grid.columns.is_empty() && error.hint.is_empty() {
            let parameters: Vec<String> = self
                .parameters(point)
                .iter()
                .map(|(name, value)| format!("{name} = {}", value.short()))
                .collect();
            error.hint = format!("this is the point {}", parameters.join(", "));
        }
        error
    }

    /// The error of a design that contradicts itself.
    fn invalid_design(&self, point: &Settings, key: &str, problem: &str) -> InputError {
        let path = format!("design.{key}");
        let Some(index) = keys::index(&path) else {
            return self.source.error(&path, "", problem, "");
        };
        let value = match point.at(index) {
            Value::Null => String::new(),
            value => json_value(value).to_string(),
        };
        self.source.error(&path, &value, problem, KEYS[index].allowed())
    }

    /// The error of a scene that its model refuses.
    fn refused(&self, error: &SceneError) -> InputError {
        let SceneError::Invalid { key, problem } = error else {
            return self.source.error("design", "", error.to_string(), "a design that folds");
        };
        let (problem, allowed) = problem.rsplit_once("; ").unwrap_or((problem, ""));
        let allowed = allowed.strip_prefix("allowed: ").unwrap_or(allowed);
        self.source.error(key, "", problem, allowed)
    }
}
