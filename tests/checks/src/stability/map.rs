//! Runs the cells of maps, in parallel, and searches the borders.
//!
//! ```text
//! border: done at a, failing at b  →  the same at half the way, until |b − a| ≤ within · max(|a|, |b|, s)
//!         half the way: √(ab) if both are above 0, (a + b)/2 otherwise
//!         s: smallest value above 0 of the axis; without it a search from 0 never ends
//! ```
//!
//! Every trial is a cell, so a search that continues finds its trials among the finished cells.

use std::path::Path;
use std::sync::Mutex;

use billow_solver::scene::IntegratorKind;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::stop::Stop;
use rayon::prelude::{IntoParallelRefIterator as _, ParallelIterator as _};

use super::Method;
use super::cell::{self, Cell, Question};
use super::file::{Map, meets};
use super::stored::{self, Cells};
use crate::cases::Rig;

/// A place where the outcome changes along the axis of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// Method.
    pub method: Method,
    /// Value of the other axis; `None` without one.
    pub at: Option<f64>,
    /// The value between both outcomes; `None` where the cells of the axis all have one outcome.
    pub value: Option<f64>,
    /// Status on the side of the failure; empty without a border.
    pub status: String,
    /// The border over the limit of theory; `None` where no theory is known.
    pub of_theory: Option<f64>,
    /// Whether it must agree with the theory and does not.
    pub wrong: bool,
}

/// A cell of a map with its place.
#[derive(Clone)]
pub struct Placed {
    /// Question.
    pub question: Question,
    /// Values of the axes.
    pub at: Vec<f64>,
    /// What was found; `None` for a cell that did not run yet.
    pub cell: Option<Cell>,
    /// What is expected.
    pub expected: Vec<String>,
}

impl Placed {
    /// Whether it ran and is not as expected.
    pub fn is_wrong(&self) -> bool {
        self.cell.as_ref().is_some_and(|cell| !meets(&self.expected, cell))
    }
}

/// The finished cells of a folder while maps run.
pub struct Running<'a> {
    /// How scenes run.
    pub rig: Rig,
    /// Folder of the results.
    pub folder: &'a Path,
    /// Ends the runs.
    pub stop: &'a Stop,
    cells: Mutex<Cells>,
}

impl<'a> Running<'a> {
    /// Continues with these finished cells.
    pub fn new(rig: Rig, folder: &'a Path, stop: &'a Stop, cells: Cells) -> Self {
        Self { rig, folder, stop, cells: Mutex::new(cells) }
    }

    /// The finished cells.
    ///
    /// # Panics
    /// If a thread panicked while it stored a cell.
    pub fn cells(&self) -> Cells {
        self.cells.lock().expect("no thread panicked").clone()
    }

    /// The cell of a question: the finished one, or a run of it.
    ///
    /// # Errors
    /// A signal; a file that cannot be written.
    fn cell(&self, question: &Question) -> Result<Cell> {
        let key = question.key();
        if let Some(cell) = self.cells.lock().expect("no thread panicked").get(&key) {
            return Ok(cell.clone());
        }
        let stopped = || Error::Signal(self.stop.requested().unwrap_or_default());
        if self.stop.requested().is_some() {
            return Err(stopped());
        }
        let cell = cell::run(&self.rig, question, self.stop).ok_or_else(stopped)?;
        let mut cells = self.cells.lock().expect("no thread panicked");
        cells.insert(key, cell.clone());
        stored::write(self.folder, &cells)?;
        Ok(cell)
    }

    /// Runs what is missing of a map, in parallel: first its cells, then its borders.
    ///
    /// # Errors
    /// As for a cell.
    pub fn run(&self, map: &Map) -> Result<()> {
        let cells = placed(map, &Cells::new());
        cells.par_iter().try_for_each(|placed| self.cell(&placed.question).map(|_| ()))?;
        let ask = |question: &Question| self.cell(question);
        lines(map).par_iter().try_for_each(|line| border(map, *line, &ask).map(|_| ()))
    }
}

/// Every cell of a map, method by method.
pub fn placed(map: &Map, cells: &Cells) -> Vec<Placed> {
    let mut all = Vec::new();
    for method in &map.methods {
        for at in map.places() {
            let question = map.question(*method, &at);
            let cell = cells.get(&question.key()).cloned();
            let expected = map.expected(&question);
            all.push(Placed { question, at, cell, expected });
        }
    }
    all
}

/// A row of cells along the axis of the search: the method, and the value of the other axis.
type Line = (Method, Option<f64>);

fn lines(map: &Map) -> Vec<Line> {
    let Some(search) = map.search else { return Vec::new() };
    let others: Vec<Option<f64>> = match map.axes.get(1 - search.axis) {
        Some(axis) => axis.values.iter().copied().map(Some).collect(),
        None => vec![None],
    };
    map.methods.iter().flat_map(|method| others.iter().map(|at| (*method, *at))).collect()
}

/// The borders of a map as far as they are known from finished cells.
pub fn borders(map: &Map, cells: &Cells) -> Vec<Border> {
    let known = |question: &Question| {
        let missing = || Error::JobsFailed("a cell that did not run yet".to_owned());
        cells.get(&question.key()).cloned().ok_or_else(missing)
    };
    lines(map).into_iter().filter_map(|line| border(map, line, &known).ok()?).collect()
}

/// The border of a line: the first change of the outcome along the axis.
fn border(
    map: &Map,
    (method, at): Line,
    cell: &dyn Fn(&Question) -> Result<Cell>,
) -> Result<Option<Border>> {
    let Some(search) = map.search else { return Ok(None) };
    let ask = |value: f64| {
        let mut place = vec![value];
        if let Some(other) = at {
            place.insert(1 - search.axis, other);
        }
        cell(&map.question(method, &place))
    };
    let explicit = method == Method::Film(IntegratorKind::Explicit);
    let bound = search.theory.filter(|_| explicit);
    let none = Border {
        method,
        at,
        value: None,
        status: String::new(),
        of_theory: None,
        wrong: bound.is_some(),
    };
    let values = &map.axes[search.axis].values;
    let mut found: Vec<(f64, Cell)> = Vec::new();
    for value in values {
        found.push((*value, ask(*value)?));
    }
    let change = found.windows(2).find(|pair| pair[0].1.is_done() != pair[1].1.is_done());
    let Some([(mut low, first), (mut high, last)]) =
        change.map(|pair| [pair[0].clone(), pair[1].clone()])
    else {
        return Ok(Some(none));
    };
    let mut failing = if first.is_done() { last } else { first.clone() };
    let positive = values.iter().copied().filter(|value| *value > 0.0);
    let smallest = positive.reduce(f64::min).unwrap_or(0.0);
    while high - low > search.within * high.abs().max(low.abs()).max(smallest) {
        let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
        let trial = ask(middle)?;
        if !trial.is_done() {
            failing = trial.clone();
        }
        *(if trial.is_done() == first.is_done() { &mut low } else { &mut high }) = middle;
    }
    let value = 0.5 * (low + high);
    let of_step = map.axes[search.axis].parameter.name == "step";
    let of_theory = failing.theory.filter(|_| of_step).map(|theory| value * theory);
    let close = |within| of_theory.is_some_and(|ratio| (ratio - 1.0).abs() <= within);
    let wrong = bound.is_some_and(|within| !close(within));
    Ok(Some(Border { value: Some(value), status: failing.status, of_theory, wrong, ..none }))
}
