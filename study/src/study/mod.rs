//! A study: defaults filled, units converted, axes expanded to points, every point resolved to its
//! scene.
//!
//! ```text
//! text → Json → (--set) → Settings + Grid → points: parameters, Scene, feasible or why not
//! ```
//! Every error of a study is found here, before anything runs.
//!
//! A value of the grid, from text to scene, passes six files: `grid/read.rs` takes the text of an axis;
//! `input/keys/key.rs` reads it with its unit as a [`Value`] in SI; `expand.rs` sets it in the settings of each point
//! (`input/settings.rs`), by the index that `column.rs` finds for the name of the axis; `resolve.rs` makes the scene of
//! these settings, `inflow.rs` its inflow windows, from numbers that `Settings::needed` takes. A study without strategies
//! has one, `direct`, with one window, which takes the values of section `gas`; a burst of residual gas is a window too.

mod assumed;
pub mod assumptions;
mod column;
mod expand;
mod filter;
pub mod finished;
mod generations;
mod grid;
pub(crate) mod ground;
mod inflow;
mod mesh_film;
mod meshes;
mod optimise;
mod parameters;
mod pilots;
pub mod plan;
mod range;
mod replicates;
mod resolve;
mod result_limits;
mod samples;
mod search;
mod units;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use billow_solver::scene::Design;

use crate::accuracy::AssumedRanges;
use crate::input::json::Json;
use crate::input::keys::STUDY;
use crate::input::keys::numerical::is_numerical;
use crate::input::overrides;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::units::DisplayUnits;
use crate::input::value::Value;
use crate::input::{standard_flow, study_file, syntax};
use crate::job::JobId;
use crate::job::limits::JobLimits;
use crate::job::point::{Point, Searched};
use crate::job::result_limit::ResultLimit;
use crate::platform::error::{InputError, Result as BillowResult};
use crate::scene::file::flow_table;
use grid::{Context, Grid};
pub(crate) use meshes::features;
pub use meshes::{Meshes, meshes_text};
pub use optimise::{Optimum, Proposed, Trial};
pub use parameters::{StudyKey, Zipped};
pub use pilots::MAX_CONFIRMED;
pub use search::{Border, Criterion, Level, SearchResult};

/// Number of points of a grid, before its filter, at most (chosen: a quarter of a million are planned in
/// seconds and fit in memory).
pub const MAX_POINTS: usize = 250_000;

/// The key of the units in which quantities are shown. It changes no job.
pub(crate) const UNITS: &str = "units";
/// Key of the checksum of study.json. A study file has none.
const CHECKSUM: &str = "checksum";

/// The section of the limits of results. It changes no job.
pub(crate) const LIMITS: &str = "limits";
/// The section of the search of an optimum.
pub(crate) const OPTIMISE: &str = "optimise";
/// The section of the samples.
pub(crate) const SAMPLES: &str = "samples";
/// The section of the replicates.
pub(crate) const REPLICATES: &str = "replicates";

/// The section of the limits of jobs. It changes no job.
pub(crate) const JOB_LIMITS: &str = "job_limits";

/// A validated study.
#[derive(Debug, Clone)]
pub struct Study {
    /// Name of the study and of its results folder.
    pub name: String,
    /// The question it answers, in words.
    pub question: String,
    /// Its file, with overrides and defaults.
    file: Json,
    /// What `--set` replaces in the file.
    notes: Vec<String>,
    /// Warnings about its values.
    warnings: Vec<String>,
    /// The units in which its quantities are shown.
    units: DisplayUnits,
    settings: Settings,
    grid: Grid,
    /// What its results must meet to be safe.
    result_limits: Vec<ResultLimit>,
    /// The ranges of what is assumed.
    assumed: AssumedRanges,
    /// Its points in plan order: those of the product that the filter keeps, the first axis slowest, then
    /// the single points, which it does not concern.
    points: Arc<Vec<Point>>,
    /// Number of points of the product that the filter removed.
    filtered: usize,
    /// The meshes of its pilots, where it needs them.
    pilots: Option<[u32; 3]>,
}

impl Study {
    /// Reads a study file, with `--set key=value` overrides applied to it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`] when the file cannot be read,
    /// [`crate::platform::error::Error::Input`] when it is not a valid study.
    pub fn load(path: &Path, sets: &[String]) -> BillowResult<Self> {
        let bytes = study_file::read(path, "study file", "studies/first.json")?;
        let file = path.display().to_string();
        let text = study_file::text_of(&bytes, &file)?;
        let stem =
            path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self::from_text(text, &file, &stem, sets, MAX_POINTS)?)
    }

    /// Reads a study from its text. `file` is its name in errors, `stem` the name of the study where
    /// it gives none, `sets` the `--set key=value` overrides.
    ///
    /// # Errors
    /// The first error, with its key, its value and what is allowed.
    pub fn from_text(
        text: &str,
        file: &str,
        stem: &str,
        sets: &[String],
        max_points: usize,
    ) -> Result<Self, InputError> {
        let tree = syntax::parse(text, file)?;
        Self::from_tree(tree, file, stem, sets, max_points)
            .map_err(|error| syntax::with_place(error, text, file))
    }

    /// Reads a study from the tree of its text.
    ///
    /// # Errors
    /// As [`Study::from_text`].
    pub fn from_tree(
        mut tree: Json,
        file: &str,
        stem: &str,
        sets: &[String],
        max_points: usize,
    ) -> Result<Self, InputError> {
        let mut source = Source::new(file);
        if !matches!(tree, Json::Object(_)) {
            let problem = format!("is {}, not an object", tree.kind());
            return Err(source.error("", "", problem, "one JSON object: {\"design\": …}"));
        }
        if let Json::Object(members) = &mut tree {
            // That of study.json, a study file that a run wrote.
            members.retain(|(name, _)| name != CHECKSUM);
        }
        if tree.get("format") == Some(&Json::Text("billow-scene".to_owned())) {
            let error = source.error("format", "\"billow-scene\"", "is a scene, not a study", "");
            return Err(InputError { hint: format!("billow solve {file}"), ..error });
        }
        let mut notes = overrides::apply(&mut tree, sets, &STUDY, &mut source)?;
        notes.extend(standard_flow::convert(&mut tree, &source)?);
        let mut settings = Settings::of_study(&tree, &source)?;
        settings.tables = Arc::new(flow_table::of_study(&mut tree, &source)?);
        notes.extend(mesh_film::read_first(&mut tree, &mut settings, &source)?);
        let result_limits = result_limits::read(tree.get(LIMITS), &source)?;
        let mut assumed = assumed::read(tree.get("assumed"), &source)?;
        let context = Context {
            settings: &settings,
            limits: &result_limits,
            assumed: &assumed,
            source: &source,
            max_points,
        };
        let mut grid = Grid::read(&tree, context)?;
        grid.refuse_varied(&source)?;
        mesh_film::refuse_design_keys(&settings, &grid, &source)?;
        mesh_film::read_others(&tree, &mut settings, &grid.mesh_values(), &source)?;
        let units = units::read(&tree, &settings, &source)?;
        // A key that is sampled is not assumed.
        assumed.leave_out(|key| grid.columns_sampled().any(|column| column.key.path == key));
        let (mut points, mut filtered) = expand::points(&settings, &grid, &source, max_points)?;
        if grid.with_prior(&points) {
            (points, filtered) = expand::points(&settings, &grid, &source, max_points)?;
        }
        grid.refuse_without_fold(&points, &source)?;
        meshes::refuse_other_models(&grid, &points, &source)?;
        notes.extend(parameters::alike(&points));
        let pilots = pilots::meshes(&settings, &grid, &result_limits, &points);
        if let Some(meshes) = &pilots {
            mesh_film::read_others(&tree, &mut settings, meshes, &source)?;
            pilots::add_mesh(&settings, &mut grid, &mut points);
        }
        let name = study_name(&settings, stem, &source)?;
        let question = settings.text("question").unwrap_or_default().to_owned();
        let warnings = source.warnings();
        settings.write_defaults(&mut tree);
        tree.set("name", Json::Text(name.clone()));
        Ok(Self {
            name,
            file: tree,
            question,
            notes,
            warnings,
            units,
            settings,
            grid,
            result_limits,
            assumed,
            points: Arc::new(points),
            filtered,
            pilots,
        })
    }

    /// What its results must meet to be safe.
    pub fn result_limits(&self) -> &[ResultLimit] {
        &self.result_limits
    }

    /// The ranges of what is assumed.
    pub fn assumed(&self) -> &AssumedRanges {
        &self.assumed
    }

    /// Names of the parameters that are sampled; they repeat a point too.
    pub fn sampled(&self) -> Vec<String> {
        self.grid.sampled()
    }

    /// Number of samples of each point: 1 without.
    pub fn sample_count(&self) -> usize {
        self.grid.sample_count()
    }

    /// Whether each input that is sampled takes its values whatever the others are.
    pub fn samples_are_independent(&self) -> bool {
        let correlations = self.file.get(SAMPLES).and_then(|samples| samples.get("correlations"));
        correlations.is_none_or(|given| matches!(given, Json::List(pairs) if pairs.is_empty()))
    }

    /// Names of the parameters that repeat a sample of a point; without samples [`Self::replicates`]. Comparisons pair equal
    /// samples, so a sample is a point to them.
    pub fn replicates_of_samples(&self) -> Vec<String> {
        let sampled = self.sampled();
        self.replicates().into_iter().filter(|name| !sampled.contains(name)).collect()
    }

    /// Names of the parameters whose values repeat a point.
    pub fn replicates(&self) -> Vec<String> {
        self.grid.repeated()
    }

    /// The meshes from which the values of each point, or of its pilots, are extrapolated.
    pub fn meshes(&self) -> Meshes {
        let list = self.pilots.map_or_else(|| self.grid.meshes(), Vec::from);
        let list = if list.len() > 1 { list } else { Vec::new() };
        Meshes { list, of_pilots: self.pilots.is_some(), of_file: self.has_mesh() }
    }

    /// Whether its film is that of a mesh.
    pub fn has_mesh(&self) -> bool {
        !self.settings.meshes.is_empty()
    }

    /// A design on a mesh with these subdivisions.
    pub(crate) fn on_mesh(&self, design: &Design, n: u32) -> Design {
        self.settings.on_mesh(design, n)
    }

    /// Number of runs of each point: 1 without replicates.
    pub fn replicate_count(&self) -> usize {
        self.grid.replicate_count()
    }

    /// Whether no row of its table depends on another one: it has a product of axes alone, without replicates and
    /// numerical choices.
    pub fn rows_stand_alone(&self) -> bool {
        let Grid { columns, axes, points, search, optimise, .. } = &self.grid;
        let is_plain = search.is_none()
            && optimise.is_none()
            && points.is_empty()
            && !axes.iter().any(|a| a.kind.repeats());
        is_plain && !columns.iter().any(|column| is_numerical(&column.name))
    }

    /// The limits of its jobs.
    pub fn job_limits(&self) -> JobLimits {
        let steps = match self.settings.value("job_limits.steps") {
            Value::Integer(steps) => u64::try_from(*steps).ok(),
            _ => None,
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1e15")]
        let memory = self.settings.number("job_limits.memory").map(|bytes| bytes as u64);
        JobLimits { wall_time: self.settings.number("job_limits.wall_time"), steps, memory }
    }

    /// Its file as it ran: overrides applied, the defaults of keys written out, its name.
    pub fn file(&self) -> &Json {
        &self.file
    }

    /// Whether another study plans the same jobs in the same order, apart from pilots.
    pub fn plans_as(&self, other: &Self) -> bool {
        let grid = |study: &Self| {
            let mut grid = study.grid.clone();
            if study.pilots.is_some() {
                grid.columns.pop();
                grid.axes.pop();
            }
            grid
        };
        let jobs = |study: &Self| -> Vec<JobId> {
            study.points.iter().map(|point| point.job.id.clone()).collect()
        };
        grid(self) == grid(other) && jobs(self) == jobs(other)
    }

    /// Values that are probably mistaken: likely forgotten units, and times that do not fit the run.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What a reader of the plan must know: an axis that an override replaces.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The points of the study, in plan order: those of the product that the filter keeps, and the single
    /// points.
    pub(crate) fn points(&self) -> &Arc<Vec<Point>> {
        &self.points
    }

    /// The runs of one searched point, with these values by column of the grid. Empty where the filter
    /// removes it: a search ends there.
    pub(crate) fn points_at(&self, values: &[Value], searched: Searched) -> Vec<Point> {
        // A value between two valid ones is valid: what a key allows is an interval.
        expand::points_at(&self.settings, &self.grid, &Source::new(&self.name), values, searched)
            .unwrap_or_default()
    }

    /// Number of points that differ in more than replicates.
    pub(crate) fn point_count(&self) -> usize {
        let replicates = self.replicates();
        let key = |point: &Point| -> Vec<String> {
            let fixed = point.job.parameters.iter().filter(|(name, _)| !replicates.contains(name));
            fixed.map(|(_, value)| value.to_string()).collect()
        };
        self.points().iter().map(key).collect::<BTreeSet<_>>().len()
    }

    /// Number of points of the product that the filter removed.
    pub fn filtered(&self) -> usize {
        self.filtered
    }
}

/// The study's name: the given one, or that of its file; always one that a folder can have.
fn study_name(settings: &Settings, stem: &str, source: &Source) -> Result<String, InputError> {
    let given = settings.text("name");
    let name = given.unwrap_or(stem);
    let valid = !name.is_empty()
        && name.len() <= 100
        && !name.starts_with(['.', '-'])
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
    if valid {
        return Ok(name.to_owned());
    }
    let mut error = source.error(
        "name",
        Json::Text(name.to_owned()),
        "cannot be the name of a results folder",
        "up to 100 letters, digits, - _ and dots, not starting with a dot or -",
    );
    if given.is_none() {
        "the study takes the name of its file; give it a `name`".clone_into(&mut error.hint);
    }
    Err(error)
}
