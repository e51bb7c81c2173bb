//! Notes on the memory of the jobs of a study: what a job needs, and which jobs this process has no memory
//! for. Those end as `out_of_memory`; the others run.

use std::num::NonZero;

use billow_solver::scene::Scene;

use crate::job::memory;
use crate::job::point::Point;
use crate::platform::error::{Error, Result};
use crate::platform::memory::{Limit, limits, size, smallest};
use crate::print::count;
use crate::study::Study;

/// Names of jobs in a note, at most. Chosen: one line.
const MAX_NAMES: usize = 3;

/// The memory of this process for jobs on a number of threads.
pub struct Memory {
    limit: Option<Limit>,
    /// Number of threads.
    pub threads: usize,
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
        memory::estimate(scene).total <= self.usable()
    }

    /// A note on the jobs that do not fit, or are above the limit of the study; `None` without one.
    pub fn note(&self, study: &Study) -> Option<String> {
        let (usable, of_study) = (self.usable(), study.job_limits().memory);
        let allowed = usable.min(of_study.unwrap_or(u64::MAX));
        let (mut names, mut number, mut needed) = (Vec::new(), 0, 0);
        for point in feasible(study) {
            let total = memory::estimate(&point.job.scene).total;
            if total > allowed {
                number += 1;
                needed = total.max(needed);
                if number <= MAX_NAMES {
                    names.push(study.label(&point.job.parameters, study.display_units()));
                }
            }
        }
        names.retain(|name| !name.is_empty());
        if number > MAX_NAMES {
            names.push(format!("{} more", number - MAX_NAMES));
        }
        let names =
            if names.is_empty() { String::new() } else { format!(" ({})", names.join("; ")) };
        let limit = match (of_study, self.limit) {
            (Some(limit), _) if limit <= usable => format!("job_limits.memory is {}", size(limit)),
            (_, Some(limit)) => format!("{} usable of {limit}", size(usable)),
            _ => return None,
        };
        let points = count(feasible(study).count(), "point");
        (number > 0).then(|| {
            format!(
                "note: {number} of {points}{names} will end as out_of_memory: up to {} needed, {limit}\n  next: a coarser \
                 mesh (design.subdivisions 5 to 16 is enough for a study), or a larger limit",
                size(needed)
            )
        })
    }

    /// What the largest job that fits needs, as text; `None` without a job that needs more than the program
    /// itself.
    pub fn forecast(&self, study: &Study) -> Option<String> {
        let all = feasible(study).map(|point| memory::estimate(&point.job.scene).total);
        let largest = all.filter(|needed| *needed <= self.usable()).max()?;
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

/// Memory of a job below which `plan` says nothing, bytes. Chosen: every machine has it.
const MIN_SHOWN: u64 = 50_000_000;

fn feasible(study: &Study) -> impl Iterator<Item = &Point> {
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
