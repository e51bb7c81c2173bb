//! Work-precision diagrams: what each model, mesh and step costs, and how large its error is.
//!
//! ```text
//! error of a run   number: e = |q/q_ref − 1|      course: e = √(∫ (f − f_ref)² dt / ∫ f_ref² dt), common time
//! work             elements × steps; steps for a model without elements
//! reference        the exact value; else the median (course: mean) over the runs of the trusted configuration
//!                  with the finest mesh and of these the most steps, with the relative uncertainty u = √(s² + m²):
//!                  s half the range over its runs (of one run: over those of the next coarser mesh with several)
//!                  m half its difference from the next coarser mesh, all else equal; at least its mesh error, if known;
//!                  where every run has the same mesh, from the next coarser step: then errors are of integration alone
//! front            no other configuration has less or equal work and less or equal max(e, u), one of them less
//! order            p = ln(e₁/e₂)/ln r,  r = √(elements₂/elements₁); of equal meshes r = steps₂/steps₁
//! ```
//! A scene is given by all parameters but the numerical ones (`crate::input::keys::numerical`), a configuration by
//! one combination of these; its runs are the replicates. Any numerical parameter that a table varies joins without
//! a change here. Source of the name: the benchmarks of `SciML`; of the form: Hairer, Norsett, Wanner, Solving Ordinary
//! Differential Equations I, II.10.

use std::sync::Arc;

use super::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;

mod chains;
mod course;
mod front;
mod largest;
mod reference;
pub mod table;
#[cfg(test)]
mod tests;

pub use chains::{Chain, label, words};
pub use course::Course;

/// The runs of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRuns {
    /// Name.
    pub name: String,
    /// What it is, one line.
    pub meaning: String,
    /// What is measured.
    pub quantities: Vec<Quantity>,
    /// Whether the seconds are those of a simulated second; otherwise those of a whole run.
    pub per_simulated_second: bool,
    /// Runs that have ended; failed ones too.
    pub runs: Vec<Run>,
    /// Number of runs that have not ended.
    pub without_result: usize,
}

/// What is measured in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
    /// The exact value, if there is one.
    pub exact: Option<f64>,
    /// Whether it is a course over time.
    pub is_course: bool,
}

/// A numerical choice: parameters and their values; null for one that the model ignores.
pub type Configuration = Vec<(String, Value)>;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Its audit found nothing.
    Trusted,
    /// It has a result, but its audit found what this column of the table says.
    Marked(&'static str),
    /// It failed: there is no result.
    Failed(Status),
}

impl Ending {
    /// Whether the audit found nothing.
    pub fn is_trusted(self) -> bool {
        self == Self::Trusted
    }

    /// Whether there is no result.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Failed(_))
    }

    /// `done`, what the audit found, or how it failed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trusted => Status::Done.name(),
            Self::Marked(audit) => audit,
            Self::Failed(status) => status.name(),
        }
    }

    /// How the runs of a configuration ended: the least of their outcomes.
    fn rank(self) -> u8 {
        match self {
            Self::Trusted => 0,
            Self::Marked(_) => 1,
            Self::Failed(_) => 2,
        }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its numerical choices; the same parameters in every run of a scene.
    pub configuration: Configuration,
    /// How it ended.
    pub ending: Ending,
    /// Elements of its mesh; 0 for a model without one.
    pub elements: f64,
    /// Steps; of a failed run, until it failed.
    pub steps: f64,
    /// Whether its steps, or some of them, solve equations for all nodes: the number of steps is then no measure of the
    /// cost beside explicit ones.
    pub implicit: bool,
    /// Wall time, s; see [`SceneRuns::per_simulated_second`].
    pub seconds: Option<f64>,
    /// Its result for each quantity.
    pub results: Vec<Option<Outcome>>,
    /// The mesh error of each result over its value, where it is known.
    pub mesh_errors: Vec<Option<f64>>,
}

/// The result of a run for one quantity.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A number, SI.
    Number(f64),
    /// A course over time.
    Course(Arc<Course>),
}

/// The work-precision diagram of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagram {
    /// Name of the scene.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// As in [`SceneRuns`].
    pub per_simulated_second: bool,
    /// Number of runs that have not ended, or failed beside others of the same configuration.
    pub without_result: usize,
    /// Its configurations, in the order of their first runs.
    pub members: Vec<Member>,
    /// Lists of members that differ in one parameter, coarse to fine.
    pub chains: Vec<Chain>,
    /// Error of each quantity.
    pub quantities: Vec<Errors>,
}

/// A configuration and its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Its numerical choices.
    pub configuration: Configuration,
    /// Number of runs that count: the trusted ones; where there is none, those with a result; else the failed ones.
    pub runs: usize,
    /// How they ended: as the first of them.
    pub ending: Ending,
    /// Elements of its mesh.
    pub elements: f64,
    /// Steps, median over the runs.
    pub steps: f64,
    /// As in [`Run`].
    pub implicit: bool,
    /// Wall time, s, median over the runs.
    pub seconds: Option<f64>,
}

/// What a configuration costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Element-steps: repeatable.
    Work,
    /// Wall time: of this machine.
    Seconds,
}

/// The errors of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// The quantity.
    pub quantity: Quantity,
    /// What the errors refer to; `None` where no run has a value.
    pub reference: Option<Reference>,
    /// One point per member; `None` for one without a value.
    pub points: Vec<Option<Point>>,
    /// Order fitted to each chain; `None` with fewer than two errors above twice the uncertainty.
    pub orders: Vec<Option<f64>>,
}

/// What errors refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Its value, SI; `None` for a course.
    pub value: Option<f64>,
    /// The member it is the median of; `None` for an exact value.
    pub member: Option<usize>,
    /// Its relative uncertainty: 0 for an exact value, `None` where there is nothing to estimate it from.
    pub uncertainty: Option<f64>,
}

/// The error of a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Its value, SI, median over the runs; `None` for a course.
    pub value: Option<f64>,
    /// Relative error: least, median and largest over the runs. Of the reference itself: its uncertainty.
    pub error: Spread,
    /// Observed order between the next coarser member of its first chain and this one.
    pub order: Option<f64>,
    /// Whether it is the reference.
    pub is_reference: bool,
    /// Whether it is on the front of work and of seconds.
    front: [bool; 2],
}

impl Member {
    /// Element-steps; steps for a model without elements.
    pub fn work(&self) -> f64 {
        if self.elements > 0.0 { self.elements * self.steps } else { self.steps }
    }

    /// The cost of a kind.
    pub fn cost(&self, kind: Cost) -> Option<f64> {
        match kind {
            Cost::Work => Some(self.work()),
            Cost::Seconds => self.seconds,
        }
    }
}

impl Point {
    /// Whether no other configuration is cheaper and more accurate.
    pub fn on_front(&self, cost: Cost) -> bool {
        self.front[usize::from(cost == Cost::Seconds)]
    }
}

impl Diagram {
    /// The diagram of the runs of a scene.
    pub fn of(scene: SceneRuns) -> Self {
        let groups = groups(&scene.runs);
        // A failed run counts where no other one of its configuration has a result.
        let counted: usize =
            groups.iter().flatten().filter(|run| scene.runs[**run].ending.is_failure()).count();
        let failed = scene.runs.iter().filter(|run| run.ending.is_failure()).count();
        let members: Vec<Member> = groups.iter().map(|runs| member(&scene.runs, runs)).collect();
        let chains = chains::of(&members);
        let quantities = scene.quantities.iter().enumerate().map(|(index, quantity)| {
            let results = |run: &usize| scene.runs[*run].results[index].clone();
            let outcomes: Vec<Vec<Outcome>> =
                groups.iter().map(|runs| runs.iter().filter_map(results).collect()).collect();
            let mesh_error =
                |run: &usize| scene.runs[*run].mesh_errors.get(index).copied().flatten();
            let mesh_errors = groups
                .iter()
                .map(|runs| Some(Spread::of(runs.iter().filter_map(mesh_error))?.median));
            let mesh_errors: Vec<Option<f64>> = mesh_errors.collect();
            Errors::of(quantity, &outcomes, &mesh_errors, &members, &chains)
        });
        let quantities = quantities.collect();
        Self {
            name: scene.name,
            meaning: scene.meaning,
            per_simulated_second: scene.per_simulated_second,
            without_result: scene.without_result + failed - counted,
            members,
            chains,
            quantities,
        }
    }
}

impl Errors {
    fn of(
        quantity: &Quantity,
        outcomes: &[Vec<Outcome>],
        mesh_errors: &[Option<f64>],
        members: &[Member],
        chains: &[Chain],
    ) -> Self {
        let (reference, target) =
            reference::of(quantity, outcomes, mesh_errors, members, chains).unzip();
        let point = |index: usize| -> Option<Point> {
            let reference = reference.as_ref()?;
            let is_reference = reference.member == Some(index);
            let errors = outcomes[index]
                .iter()
                .filter_map(|outcome| reference::error(outcome, target.as_ref()?));
            let error = if is_reference {
                Spread::of([reference.uncertainty?])?
            } else {
                Spread::of(errors)?
            };
            let value = reference::median(&outcomes[index]);
            Some(Point { value, error, order: None, is_reference, front: [false; 2] })
        };
        let points = (0..members.len()).map(point).collect();
        let mut errors = Self { quantity: quantity.clone(), reference, points, orders: Vec::new() };
        errors.finish(members, chains);
        errors
    }

    /// Fills in orders and fronts.
    fn finish(&mut self, members: &[Member], chains: &[Chain]) {
        let floor = self.uncertainty();
        self.orders = chains
            .iter()
            .map(|chain| chains::fitted(chain, &self.points, members, floor))
            .collect();
        for chain in chains.iter().rev() {
            for (index, order) in chains::between(chain, &self.points, members, floor) {
                if let Some(point) = &mut self.points[index] {
                    point.order = Some(order);
                }
            }
        }
        for (kind, cost) in [Cost::Work, Cost::Seconds].into_iter().enumerate() {
            for index in front::of(&self.points, members, cost, floor) {
                if let Some(point) = &mut self.points[index] {
                    point.front[kind] = true;
                }
            }
        }
    }

    /// The relative uncertainty of the reference; 0 where it is exact or unknown.
    pub fn uncertainty(&self) -> f64 {
        self.reference.as_ref().and_then(|reference| reference.uncertainty).unwrap_or(0.0)
    }
}

/// The runs of each configuration that count, in the order of their first runs.
fn groups(runs: &[Run]) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let same = |group: &&mut Vec<usize>| runs[group[0]].configuration == run.configuration;
        match found.iter_mut().find(same) {
            Some(group) => group.push(index),
            None => found.push(vec![index]),
        }
    }
    for group in &mut found {
        let rank = |run: &usize| runs[*run].ending.rank();
        let best = group.iter().map(rank).min();
        group.retain(|run| Some(rank(run)) == best);
    }
    found
}

/// The configuration of some runs.
fn member(runs: &[Run], group: &[usize]) -> Member {
    let median = |of: &dyn Fn(&Run) -> Option<f64>| {
        Spread::of(group.iter().filter_map(|run| of(&runs[*run]))).map(|spread| spread.median)
    };
    let first = &runs[group[0]];
    Member {
        configuration: first.configuration.clone(),
        runs: group.len(),
        ending: first.ending,
        elements: first.elements,
        steps: median(&|run| Some(run.steps)).unwrap_or(0.0),
        implicit: group.iter().any(|run| runs[*run].implicit),
        seconds: median(&|run| run.seconds),
    }
}
