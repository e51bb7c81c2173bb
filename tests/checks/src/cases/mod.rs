//! The reference cases of `billow-checks validate`: results against closed forms, series and quadratures.
//!
//! ```text
//! error = |value/reference − 1|        in band: error ≤ band and order ≥ least order
//! ```
//!
//! A case is an entry of [`CASES`] and a function that gives one [`Row`] for each quantity. Cases run
//! the same code as a capsule: the scene of a film, its explicit step, its gas, its model. Numbers and
//! bands come from `tests/reference`. A case that fails or panics gives a row out of band with the
//! reason.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use rayon::ThreadPool;
use rayon::prelude::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};

pub mod command;
pub mod prelude;
pub(crate) mod reference;
pub mod rig;
mod row;
mod table;

pub mod contact_capsule;
mod contact_impacts;
mod contact_relaxed;
mod contact_rig;
mod contact_stack;
mod contact_tube;
mod damping;
pub(crate) mod drum;
mod energy_balance;
mod friction_adhesion;
pub(crate) mod gas;
mod integrators;
mod invariants;
mod moving_fold;
mod oscillation;
pub mod shapes;
pub(crate) mod sphere_motion;
pub(crate) mod static_airbag;
mod static_discs;
mod static_end_state;
mod static_shells;
mod static_wrinkling;
mod storeys_model;

pub use rig::Rig;
pub use row::Row;
pub use table::CASES;

/// Whether a case is part of `--quick`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// Always run.
    Quick,
    /// Skipped with `--quick`.
    Long,
}

/// A result, or the reason why there is none.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// The rows of a case.
pub type Outcome = Result<Vec<Row>>;

/// One reference case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// What it compares.
    pub compares: &'static str,
    /// Whether `--quick` skips it.
    pub tier: Tier,
    /// The function that runs it.
    pub body: fn(&Rig) -> Outcome,
}

/// The result of a case.
pub struct Judged {
    /// Its name.
    pub name: &'static str,
    /// Its rows; at least one.
    pub rows: Vec<Row>,
    /// Wall time of the whole case, s.
    pub seconds: f64,
}

impl Judged {
    /// Whether every row is in band.
    pub fn pass(&self) -> bool {
        self.rows.iter().all(|row| row.pass)
    }
}

impl Case {
    /// Runs the case. An error or a panic gives a row out of band.
    pub fn run(&self, rig: &Rig) -> Judged {
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.body)(rig)));
        let rows = match outcome {
            Ok(Ok(rows)) if !rows.is_empty() => rows,
            Ok(Ok(_)) => vec![Row::failed("the case has no rows")],
            Ok(Err(reason)) => vec![Row::failed(&reason.to_string())],
            Err(panic) => vec![Row::failed(&format!("panicked: {}", message(panic.as_ref())))],
        };
        Judged { name: self.name, rows, seconds: start.elapsed().as_secs_f64() }
    }
}

/// The message of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}

/// Runs cases on a pool and reports each as it ends. The results are in the given order, whatever the
/// number of threads.
pub fn run_all(
    pool: &ThreadPool,
    cases: &[&Case],
    rig: &Rig,
    report: &(dyn Fn(&Judged) + Sync),
) -> Vec<Judged> {
    let run = |case: &&Case| {
        let judged = case.run(rig);
        report(&judged);
        judged
    };
    // One case at a time: the long ones stand beside each other.
    pool.install(|| cases.par_iter().with_max_len(1).map(run).collect())
}

#[cfg(test)]
mod tests;
