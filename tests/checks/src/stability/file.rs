//! A map file: which scenes, along which axes, and what is expected.
//!
//! ```json
//! {"maps": [{"name": "step", "description": "what is asked", "scene": "sheet",
//!            "axes": {"step": [0.5, 1.5], "damping": [0, 0.1]}, "values": {"sliver": 1}, "methods": ["explicit"],
//!            "border": {"along": "step", "within": 1e-3}, "theory": {"methods": ["explicit"], "within": 0.01},
//!            "strip": {"methods": ["explicit"], "where": {"step": 1.5}},
//!            "expect": [{"methods": ["explicit"], "where": {"step": [1.1, 2]}, "status": "unstable", "why": "…"}]}]}
//! ```
//!
//! Without `methods`, a map or a rule holds for every method that can run the scene; `film` is every integrator. The
//! first rule that holds for a cell decides; without one the run is expected to be `done`.

use super::Method;
use super::cell::{Cell, Question};
use super::scenes::{Parameter, StabilityScene, Values};
use billow_study::job::Status;

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

/// Some cells of a map.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    pub(super) methods: Vec<Method>,
    pub(super) place: Vec<(&'static str, [f64; 2])>,
}

impl Choice {
    /// Whether a cell is one of them.
    pub(super) fn holds(&self, question: &Question) -> bool {
        let within = |(name, [from, to]): &(&str, [f64; 2])| {
            (*from..=*to).contains(&question.values.get(name))
        };
        self.methods.contains(&question.method) && self.place.iter().all(within)
    }
}

/// What is expected of some cells.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    pub(super) of: Choice,
    pub(super) statuses: Vec<String>,
    /// Why; may be empty.
    pub(super) why: String,
}

/// A map.
#[derive(Clone)]
pub struct Map {
    /// Name.
    pub name: String,
    /// What is asked; may be empty.
    pub description: String,
    /// Scene.
    pub scene: &'static StabilityScene,
    /// Methods.
    pub methods: Vec<Method>,
    /// Values of the parameters that are no axis.
    pub(super) values: Values,
    /// One or two axes.
    pub axes: Vec<Axis>,
    /// The search of borders.
    pub search: Option<Search>,
    /// The limit of theory.
    pub theory: Option<Theory>,
    /// The cells of which one is shown as a strip.
    pub(super) strip: Option<Choice>,
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
        let done = || vec![Status::Done.name().to_owned()];
        let first = self.rules.iter().find(|rule| rule.of.holds(question));
        first.map_or_else(done, |rule| rule.statuses.clone())
    }

    /// The reasons of the failures that are expected, with the methods they are of: each once.
    pub fn reasons(&self) -> Vec<(Vec<Method>, &str)> {
        let mut reasons: Vec<(Vec<Method>, &str)> = Vec::new();
        let of_failure = |rule: &&Rule| !rule.why.is_empty() && failure_expected(&rule.statuses);
        for rule in self.rules.iter().filter(of_failure) {
            let methods: Vec<Method> = self
                .methods
                .iter()
                .copied()
                .filter(|method| rule.of.methods.contains(method))
                .collect();
            let reason = (methods, rule.why.as_str());
            if !reason.0.is_empty() && !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        reasons
    }

    /// Index of the horizontal axis of pictures: that of the search, else the first one.
    pub fn horizontal(&self) -> usize {
        self.search.map_or(0, |search| search.axis)
    }
}

/// Whether a failure is expected, and nothing else.
pub fn failure_expected(expected: &[String]) -> bool {
    let well = [Status::Done.name(), ANY];
    !expected.iter().any(|word| well.contains(&word.as_str()))
}

/// Whether a cell is as expected.
pub fn meets(expected: &[String], cell: &Cell) -> bool {
    expected.iter().any(|word| match word.as_str() {
        ANY => true,
        FAILS => cell.fails(),
        status => status == cell.status,
    })
}
