//! The reference cases: what `billow validate` runs, judged against closed forms and series.
//!
//! ```text
//! error = |value/reference − 1|        in band where error ≤ band and order ≥ what is asked
//! ```
//!
//! A case is a row of [`CASES`] and a function; it gives one [`Row`] a quantity. Cases go through
//! the functions a capsule goes through: the scene of a film, its explicit step, its gas, its model.
//! Numbers and bands come from `tests/reference` and are never loosened here. A case that fails or
//! panics is a row out of band that says why.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use rayon::ThreadPool;

pub mod reference;
pub mod rig;
mod row;
pub mod shapes_dynamic;
mod shapes_static;
mod table;

pub mod capsule_run;
pub mod contact_capsule;
mod contact_meetings;
mod contact_relaxed;
pub mod contact_rig;
mod contact_rubbing;
mod contact_stack;
mod contact_tube;
mod damping;
mod drum;
mod forces;
mod gas_piston;
mod gas_vessel;
mod invariants;
mod oscillation;
mod piston_model;
mod sphere_motion;
mod static_airbag;
mod static_discs;
mod static_end_state;
mod static_polygon;
mod static_rest;
mod static_shells;
mod static_wrinkling;
mod step_limit;

pub use rig::Rig;
pub use row::Row;
pub use table::CASES;

/// When a case is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// Always.
    Quick,
    /// Not with `--quick`.
    Long,
}

/// What a case gives: its rows, or why it has none.
pub type Outcome = Result<Vec<Row>, String>;

/// One reference case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// What it compares with what.
    pub compares: &'static str,
    /// When it is run.
    pub tier: Tier,
    /// Its body.
    pub body: fn(&Rig) -> Outcome,
}

/// A case that was run.
#[derive(Debug, Clone)]
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
    /// Runs it. What goes wrong on the way is a row out of band.
    pub fn run(&self, rig: &Rig) -> Judged {
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.body)(rig)));
        let rows = match outcome {
            Ok(Ok(rows)) if !rows.is_empty() => rows,
            Ok(Ok(_)) => vec![Row::failed("the case judged nothing")],
            Ok(Err(reason)) => vec![Row::failed(&reason)],
            Err(panic) => vec![Row::failed(&format!("panicked: {}", told(panic.as_ref())))],
        };
        Judged { name: self.name, rows, seconds: start.elapsed().as_secs_f64() }
    }
}

/// What a panic said.
fn told(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a word")
}

/// Runs cases on a pool, telling each as it ends; what comes back is in the order given, whatever
/// the threads.
pub fn run_all(
    pool: &ThreadPool,
    cases: &[&Case],
    rig: &Rig,
    tell: &(dyn Fn(&Judged) + Sync),
) -> Vec<Judged> {
    let next = AtomicUsize::new(0);
    let ended = Mutex::new(Vec::with_capacity(cases.len()));
    pool.broadcast(|_| {
        while let Some((at, case)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            cases.get(at).map(|case| (at, case))
        } {
            let judged = case.run(rig);
            tell(&judged);
            ended.lock().unwrap_or_else(PoisonError::into_inner).push((at, judged));
        }
    });
    let mut ended = ended.into_inner().unwrap_or_else(PoisonError::into_inner);
    ended.sort_by_key(|(at, _)| *at);
    ended.into_iter().map(|(_, judged)| judged).collect()
}

#[cfg(test)]
mod tests;
