//! One table row: what a job was, how it ended, what it measured, what it cost.

use billow_solver::geometry::fold::{FoldError, FoldPattern};
use billow_solver::output::measures::Verdict;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::scene::error::SceneError;

use crate::input::value::Value;
use crate::job::Job;
use crate::job::executor::Outcome;
use crate::job::point::Infeasible;
use crate::platform::provenance;

mod columns;
mod counts;

pub use columns::{COLUMNS, Kind, RowColumn, index};
pub use counts::Counts;

/// Status of a point whose job has not ended yet.
pub const PENDING: &str = "pending";
/// Status of a run that reached its end time.
pub const DONE: &str = "done";
/// Status of a point no fold pattern meets.
pub const INFEASIBLE: &str = "infeasible";
/// Status of a scene the model refused to start.
pub const INVALID: &str = "invalid";
/// Status of a job that panicked.
pub const PANICKED: &str = "panicked";

/// Whether a status means that a job failed. Done, infeasible and pending points did not.
pub fn is_failure(status: &str) -> bool {
    !matches!(status, DONE | INFEASIBLE | PENDING)
}

/// The cells of one row, in the order of [`COLUMNS`].
#[derive(Debug, Clone, PartialEq)]
pub struct Cells(Vec<Value>);

impl Cells {
    /// All null, but for the status.
    pub fn new(status: &str) -> Self {
        let mut cells = Self(vec![Value::Null; COLUMNS.len()]);
        cells.set("status", status);
        cells
    }

    /// The cell of that column.
    ///
    /// # Panics
    /// When no column has that name: names are fixed at compile time.
    pub fn get(&self, name: &str) -> &Value {
        &self.0[index(name).unwrap_or_else(|| panic!("no column {name:?}"))]
    }

    /// Fills a cell.
    ///
    /// # Panics
    /// When no column has that name: names are fixed at compile time.
    pub fn set(&mut self, name: &str, value: impl Into<Cell>) {
        let position = index(name).unwrap_or_else(|| panic!("no column {name:?}"));
        self.0[position] = value.into().0;
    }

    /// The text of that cell, empty when it holds none.
    pub fn text(&self, name: &str) -> &str {
        if let Value::Text(text) = self.get(name) { text } else { "" }
    }

    /// The cell at that position of [`COLUMNS`].
    pub fn at(&self, position: usize) -> &Value {
        &self.0[position]
    }

    /// How the job ended.
    pub fn status(&self) -> &str {
        self.text("status")
    }

    /// Columns and their cells.
    pub fn iter(&self) -> impl Iterator<Item = (&'static RowColumn, &Value)> {
        COLUMNS.iter().zip(&self.0)
    }

    /// The row of a point no pattern meets.
    pub fn infeasible(infeasible: &Infeasible) -> Self {
        let mut cells = Self::new(INFEASIBLE);
        cells.set("reason", infeasible.reason.as_str());
        if !infeasible.nearest.is_empty() {
            cells.set("nearest", infeasible.nearest_text());
        }
        cells
    }

    /// The row of a job that ended; `None` for one that was cancelled, of which nothing is kept.
    pub fn of(job: &Job, outcome: &Outcome) -> Option<Self> {
        let mut cells = match outcome {
            Outcome::Cancelled => return None,
            Outcome::Ran { deployment, .. } => match &deployment.stop {
                Stop::Cancelled => return None,
                Stop::Done => Self::new(DONE),
                Stop::Failed(failure) => {
                    let mut cells = Self::new(failure.kind.name());
                    cells.set("stop_time", failure.time);
                    cells.set("stop_place", failure.place.as_str());
                    cells
                }
            },
            Outcome::Refused(error) => {
                let infeasible = matches!(error, SceneError::Fold(FoldError::Infeasible { .. }));
                let mut cells = Self::new(if infeasible { INFEASIBLE } else { INVALID });
                cells.set("reason", error.to_string());
                cells
            }
            Outcome::Panicked(message) => {
                let mut cells = Self::new(PANICKED);
                cells.set("reason", message.as_str());
                cells
            }
        };
        // A job that panicked may do so again when its pattern is solved once more.
        if !matches!(outcome, Outcome::Panicked(_)) {
            cells.design(job);
        }
        if let Outcome::Ran { deployment, seconds, note } = outcome {
            cells.deployment(deployment, *seconds);
            cells.set("reason", note.as_deref());
        }
        cells.set("program_version", provenance::PROGRAM_VERSION);
        cells.set("commit", provenance::COMMIT);
        cells.set("physics_version", i64::from(provenance::PHYSICS_VERSION));
        Some(cells)
    }

    fn design(&mut self, job: &Job) {
        let thresholds = job.scene.outputs.thresholds;
        self.set("deployed_volume_threshold", thresholds.deployed_volume);
        self.set("deployed_height_threshold", thresholds.deployed_height);
        self.set("stalled_volume_threshold", thresholds.stalled_volume);
        self.set("close_margin", thresholds.near_threshold_margin);
        if let Ok(pattern) = FoldPattern::new(&job.scene.design) {
            self.set("phi", pattern.angles.phi);
            self.set("half_angle", pattern.half_angle);
            self.set("top_radius", pattern.top_radius);
            self.set("height", pattern.height);
        }
    }

    fn deployment(&mut self, deployment: &Deployment, seconds: f64) {
        let measures = &deployment.measures;
        self.set("verdict", measures.verdict.map(Verdict::name));
        if measures.verdict.is_some() {
            self.set("close", measures.near_threshold);
        }
        for (name, value) in [
            ("volume_ratio", measures.volume_ratio),
            ("height_ratio", measures.height_ratio),
            ("reference_volume", measures.reference_volume),
            ("reference_height", measures.reference_height),
            ("t_50_z_rim", measures.t_50_z_rim),
            ("t_90_z_rim", measures.t_90_z_rim),
            ("t_50_volume", measures.t_50_volume),
            ("t_90_volume", measures.t_90_volume),
            ("t_deployed", measures.t_deployed),
            ("peak_vz", measures.peak_vz),
            ("t_peak_vz", measures.t_peak_vz),
            ("peak_kinetic_energy", measures.peak_kinetic_energy),
            ("overshoot", measures.overshoot),
            ("ringing_rms", measures.ringing_rms),
            ("ringing_frequency", measures.ringing_frequency),
            ("t_settled", measures.t_settled),
            ("final_z_rim", measures.final_z_rim),
            ("final_volume", measures.final_volume),
            ("final_pressure", measures.final_pressure),
            ("final_temperature", measures.final_temperature),
            ("film_stress", measures.film_stress),
            ("peak_lid_force", measures.peak_lid_force),
        ] {
            self.set(name, value);
        }
        let audit = &deployment.audit;
        self.set("passages", audit.passages.map(integer));
        self.set("intersections", audit.intersections.map(integer));
        let extreme = |name: &str, pick: fn(f64, f64) -> f64| {
            deployment.followed(name).iter().copied().reduce(pick)
        };
        self.set("interlayer_pressure", extreme("interlayer_pressure", f64::max));
        self.set("contact_area_fraction", extreme("contact_area_fraction", f64::max));
        self.set("smallest_gap", extreme("smallest_gap", f64::min));
        self.set("ledger_residual", audit.ledger_residual);
        self.set("gas_residual", audit.gas_residual);
        self.set("viscous_fraction", audit.viscous_fraction);

        self.set("steps", integer(deployment.steps));
        self.set("elements", integer(deployment.elements as u64));
        self.set("wall_seconds", seconds);
        let element_steps = deployment.steps as f64 * deployment.elements as f64;
        if element_steps > 0.0 {
            self.set("ns_per_element_step", seconds * 1e9 / element_steps);
        }
    }
}

fn integer(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

/// Whatever fits a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell(Value);

impl From<Value> for Cell {
    fn from(value: Value) -> Self {
        Self(value)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self(Value::Bool(value))
    }
}

impl From<i64> for Cell {
    fn from(value: i64) -> Self {
        Self(Value::Integer(value))
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self(Value::Number(value))
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self(Value::Text(value.to_owned()))
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self(Value::Text(value))
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self(Value::Null), Into::into)
    }
}
