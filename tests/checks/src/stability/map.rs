//! Runs the cells of a map, in parallel, and searches the borders.
//!
//! ```text
//! border: done at a, failing at b  →  the same at half the way, until |b − a| ≤ within · max(|a|, |b|, s)
//!         half the way: √(ab) if both are above 0, (a + b)/2 otherwise
//!         s: smallest value above 0 of the axis; without it a search from 0 never ends
//! ```

use billow_solver::scene::IntegratorKind;
use billow_study::job::Status;
use rayon::prelude::{IntoParallelIterator as _, ParallelIterator as _};

use super::Method;
use super::cell::{self, Cell};
use super::file::{Expected, Map};
use crate::cases::Rig;

/// The first change of the outcome along the first axis.
pub(super) struct Border {
    pub(super) method: Method,
    /// Value of the other axis; `None` without one.
    pub(super) at: Option<f64>,
    /// The value between both outcomes, and the status on the side of the failure; `None` where all have one outcome.
    pub(super) change: Option<(f64, Status)>,
    /// The border over the limit of theory; `None` where no theory is known.
    pub(super) of_theory: Option<f64>,
    /// Whether it must agree with the theory and does not.
    pub(super) is_wrong: bool,
}

/// A cell of a map with its place.
pub(super) struct Placed {
    pub(super) method: Method,
    /// Values of the axes.
    pub(super) at: Vec<f64>,
    /// What was found.
    pub(super) cell: Cell,
    /// What is expected.
    pub(super) expected: Vec<Expected>,
}

impl Placed {
    pub(super) fn is_wrong(&self) -> bool {
        !self.expected.iter().any(|expected| expected.is_met_by(self.cell.status))
    }
}

/// A map that has run.
pub(super) struct FinishedMap<'a> {
    pub(super) map: &'a Map,
    /// Method by method; along the first axis, the lowest value of the second one first.
    pub(super) cells: Vec<Placed>,
    pub(super) borders: Vec<Border>,
}

impl<'a> FinishedMap<'a> {
    /// Runs a map: first its cells, then its borders.
    pub(super) fn run(rig: &Rig, map: &'a Map) -> Self {
        let run = |method: Method, at: &[f64]| cell::run(rig, map.scene, method, &map.values(at));
        let places = map.places();
        let all =
            map.methods.iter().flat_map(|method| places.iter().map(|at| (*method, at.clone())));
        let placed = |(method, at): (Method, Vec<f64>)| {
            let (cell, expected) = (run(method, &at), map.expected(method, &at));
            Placed { method, at, cell, expected }
        };
        let cells: Vec<Placed> = all.collect::<Vec<_>>().into_par_iter().map(placed).collect();
        let lines: Vec<&[Placed]> =
            map.border.iter().flat_map(|_| cells.chunks(map.axes[0].1.len())).collect();
        let borders = lines.into_par_iter().map(|line| border(map, line, run)).collect();
        Self { map, cells, borders }
    }
}

/// The border of a line of cells along the first axis.
fn border(map: &Map, line: &[Placed], run: impl Fn(Method, &[f64]) -> Cell) -> Border {
    let (method, at) = (line[0].method, line[0].at.get(1).copied());
    let bound = map.theory.filter(|_| method == Method::Film(IntegratorKind::Explicit));
    let none = Border { method, at, change: None, of_theory: None, is_wrong: bound.is_some() };
    let is_done = |cell: &Cell| cell.status == Status::Done;
    let changes = |pair: &&[Placed]| is_done(&pair[0].cell) != is_done(&pair[1].cell);
    let Some(pair) = line.windows(2).find(changes) else { return none };
    let done_below = is_done(&pair[0].cell);
    let mut failing = pair[usize::from(done_below)].cell.clone();
    let (mut low, mut high) = (pair[0].at[0], pair[1].at[0]);
    let positive = map.axes[0].1.iter().copied().filter(|value| *value > 0.0);
    let smallest = positive.reduce(f64::min).unwrap_or(0.0);
    let within = map.border.unwrap_or(1.0);
    while high - low > within * high.abs().max(low.abs()).max(smallest) {
        let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
        let place: Vec<f64> = [middle].into_iter().chain(at).collect();
        let trial = run(method, &place);
        *(if is_done(&trial) == done_below { &mut low } else { &mut high }) = middle;
        if !is_done(&trial) {
            failing = trial;
        }
    }
    let value = 0.5 * (low + high);
    let of_theory = failing.theory.filter(|_| map.axes[0].0 == "step").map(|theory| value * theory);
    let close = |within| of_theory.is_some_and(|ratio| (ratio - 1.0).abs() <= within);
    let is_wrong = bound.is_some_and(|within| !close(within));
    Border { change: Some((value, failing.status)), of_theory, is_wrong, ..none }
}
