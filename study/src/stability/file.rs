//! A map file: which scenes, along which axes, and what is expected.
//!
//! ```json
//! {"maps": [{"name": "step", "scene": "sheet", "axes": {"step": [0.5, 1.5], "damping": [0, 0.1]},
//!            "values": {"sliver": 1}, "methods": ["explicit"], "border": {"along": "step", "within": 1e-3},
//!            "theory": {"methods": ["explicit"], "within": 0.01},
//!            "expect": [{"methods": ["explicit"], "where": {"step": [1.1, 2]}, "status": "unstable"}]}]}
//! ```
//!
//! Without `methods`, a map or a rule holds for every method that can run the scene; `film` is every integrator. The first rule that holds for a
//! cell decides; without one the run is expected to be `done`.

use super::Method;
use super::cell::{Cell, Question};
use super::scenes::{Parameter, StabilityScene, Values};
use crate::job::Status;

/// Expectation of any failure.
pub(super) const FAILS: &str = "fails";
/// Expectation that any outcome meets.
pub(super) const ANY: &str = "any";

/// An axis of a map.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Parameter.
    pub parameter: &'static Parameter,
    /// Values, ascending.
    pub values: Vec<f64>,
}

/// Where the outcome changes is searched along an axis.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Index of the axis.
    pub axis: usize,
    /// Relative width at which a search ends.
    pub within: f64,
}

/// What the border of a linear scene must agree with.
#[derive(Debug, Clone)]
pub struct Theory {
    /// Methods that have the limit 2/ω.
    pub methods: Vec<Method>,
    /// Largest relative difference.
    pub within: f64,
}

/// What is expected of some cells.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    pub(super) methods: Vec<Method>,
    pub(super) place: Vec<(&'static str, [f64; 2])>,
    pub(super) statuses: Vec<String>,
}

/// A map.
#[derive(Clone)]
pub struct Map {
    /// Name.
    pub name: String,
    /// Scene.
    pub scene: &'static StabilityScene,
    /// Methods.
    pub methods: Vec<Method>,
    /// Values of the parameters that are no axis.
    pub(super) values: Values,
    /// One or two axes; the first one is horizontal.
    pub axes: Vec<Axis>,
    /// The search of borders.
    pub search: Option<Search>,
    /// The limit of theory.
    pub theory: Option<Theory>,
    pub(super) rules: Vec<Rule>,
}

impl Map {
    /// The question of a cell at these values of the axes.
    pub fn question(&self, method: Method, at: &[f64]) -> Question {
        let mut values = self.values.clone();
        for (axis, value) in self.axes.iter().zip(at) {
            values.set(axis.parameter.name, *value);
        }
        Question { scene: self.scene, method, values }
    }

    /// Every place of the map: along the first axis, the lowest value of the second one first.
    pub fn places(&self) -> Vec<Vec<f64>> {
        let one = |value: &f64| vec![*value];
        let first: Vec<Vec<f64>> = self.axes[0].values.iter().map(one).collect();
        let Some(second) = self.axes.get(1) else { return first };
        let row = |y: &f64| first.iter().map(|x| vec![x[0], *y]).collect::<Vec<_>>();
        second.values.iter().flat_map(row).collect()
    }

    /// What is expected of a cell: names of statuses, `fails` or `any`.
    pub fn expected(&self, question: &Question) -> Vec<String> {
        let holds = |rule: &&Rule| {
            rule.methods.contains(&question.method)
                && rule
                    .place
                    .iter()
                    .all(|(name, [from, to])| (*from..=*to).contains(&question.values.get(name)))
        };
        let done = || vec![Status::Done.name().to_owned()];
        self.rules.iter().find(holds).map_or_else(done, |rule| rule.statuses.clone())
    }
}

/// Whether a cell is as expected.
pub fn meets(expected: &[String], cell: &Cell) -> bool {
    expected.iter().any(|word| match word.as_str() {
        ANY => true,
        FAILS => cell.fails(),
        status => status == cell.status,
    })
}
