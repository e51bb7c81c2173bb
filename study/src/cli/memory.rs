//! Notes on the memory of the jobs of a study: what a job needs, and which jobs this process has no memory
//! for. Those end as `out_of_memory`; the others run.

use std::num::NonZero;

use billow_solver::scene::Scene;

use super::print::count;
use crate::job::memory;
use crate::platform::error::{Error, Result};
use crate::platform::memory::{Limit, limits, size, smallest};
use crate::study::{Study, StudyPoint};

/// Names of jobs in a note, at most. Chosen: one line.
const MAX_NAMES: usize = 3;

/// The memory of this process for jobs on a number of threads.
pub struct Memory {
    limit: Option<Limit>,
    threads: usize,
}

impl Memory {
    /// The memory for jobs on this number of threads; `None` for one per core.
    pub fn new(threads: Option<NonZero<usize>>) -> Self {
        let threads = number(threads);
        Self { limit: smallest(&limits(), threads), threads }
    }

    /// What all jobs may use together, bytes.
    fn usable(&self) -> u64 {
        self.limit.map_or(u64::MAX, |limit| limit.usable(self.threads))
    }

    /// Refuses a process that has no memory for any job.
    ///
    /// # Errors
    /// [`Error::Disk`] with the limit.
    pub fn check(&self) -> Result<()> {
        let Some(limit) = self.limit.filter(|limit| limit.usable(1) == 0) else { return Ok(()) };
        Err(Error::Disk {
            path: "memory".into(),
            problem: format!(
                "{limit} leaves nothing for a job: the program itself needs all of it\n  next: raise the limit"
            ),
        })
    }

    /// Whether a job of this scene fits, if it runs alone.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.has_room_for(memory::estimate(scene).total)
    }

    /// Whether a job that needs this memory (bytes) fits, if it runs alone.
    pub fn has_room_for(&self, bytes: u64) -> bool {
        bytes <= self.usable()
    }

    /// A note on the jobs that do not fit; `None` without one.
    pub fn note(&self, study: &Study) -> Option<String> {
        self.machine_note(study).or_else(|| limited_note(study))
    }

    fn machine_note(&self, study: &Study) -> Option<String> {
        let limit = self.limit?;
        let large: Vec<&StudyPoint> =
            feasible(study).filter(|point| !self.fits(&point.scene)).collect();
        let needs = large.iter().map(|point| memory::estimate(&point.scene).total).max()?;
        let label = |point: &StudyPoint| study.label(&point.parameters, study.display_units());
        let mut names: Vec<String> =
            large.iter().take(MAX_NAMES).map(|point| label(point)).collect();
        if large.len() > MAX_NAMES {
            names.push(format!("{} more", large.len() - MAX_NAMES));
        }
        names.retain(|name| !name.is_empty());
        let names =
            if names.is_empty() { String::new() } else { format!(" ({})", names.join("; ")) };
        Some(format!(
            "note: {} of {}{names} will end as out_of_memory: up to {} needed, {} usable of {limit}\n  \
             next: a coarser mesh (design.subdivisions 5 to 16 is enough for a study), or a larger limit",
            large.len(),
            count(feasible(study).count(), "point"),
            size(needs),
            size(self.usable()),
        ))
    }

    /// What the largest job that fits needs, as text; `None` without a job that needs more than the program
    /// itself.
    pub fn forecast(&self, study: &Study) -> Option<String> {
        let fitting = feasible(study).filter(|point| self.fits(&point.scene));
        let largest = fitting.map(|point| memory::estimate(&point.scene).total).max()?;
        let limit = self.limit.filter(|_| largest >= MIN_SHOWN)?;
        let together = usize::try_from(self.usable() / largest).unwrap_or(usize::MAX).max(1);
        let usable = size(self.usable());
        Some(if together < self.threads {
            format!(
                "memory: up to {} a job; {together} of {} threads compute such jobs at a time ({usable} usable of \
                 {limit})",
                size(largest),
                self.threads
            )
        } else {
            format!("memory: up to {} a job ({usable} usable of {limit})", size(largest))
        })
    }
}

/// A note on the jobs above the limit of the study; `None` without one.
fn limited_note(study: &Study) -> Option<String> {
    let limit = study.job_limits().memory?;
    let needs = feasible(study).map(|point| memory::estimate(&point.scene).total);
    let above: Vec<u64> = needs.filter(|needed| *needed > limit).collect();
    let largest = above.iter().max()?;
    Some(format!(
        "note: {} of {} will end as out_of_memory: job_limits.memory is {}, up to {} needed",
        above.len(),
        count(feasible(study).count(), "point"),
        size(limit),
        size(*largest),
    ))
}

/// Memory of a job below which `plan` says nothing, bytes. Chosen: every machine has it.
const MIN_SHOWN: u64 = 50_000_000;

fn feasible(study: &Study) -> impl Iterator<Item = &StudyPoint> {
    study.points().iter().filter(|point| point.infeasible.is_none())
}

fn number(threads: Option<NonZero<usize>>) -> usize {
    threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZero::get)
}

/// The number of threads for which this process has memory, and a note if it is below the number asked for.
pub fn threads(asked: Option<NonZero<usize>>) -> (Option<NonZero<usize>>, Option<String>) {
    let wanted = number(asked);
    let fitting = limits().into_iter().map(|limit| (limit.threads(wanted), limit));
    match fitting.min_by_key(|(threads, _)| *threads) {
        Some((threads, limit)) if threads < wanted => {
            let note =
                format!("note: {limit} has room for {} of {wanted}", count(threads, "thread"));
            (NonZero::new(threads), Some(note))
        }
        _ => (asked, None),
    }
}
