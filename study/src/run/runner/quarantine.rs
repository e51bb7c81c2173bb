//! Jobs whose process died while they ran. Such a job is a suspect: it runs after all other jobs, with no
//! other beside it. When the process died in two attempts, in the last one with no other job beside it,
//! the job is in quarantine: it has a row `crashed` and runs again only on request.

use std::collections::BTreeMap;

use crate::job::executor::Outcome;
use crate::job::row::Cells;
use crate::job::{Job, JobId, Parameters};
use crate::store::journal::{Death, Record};

/// Attempts in which the process died, from which a job is in quarantine. Chosen: one death may have had
/// another cause.
const MAX_DEATHS: usize = 2;
/// Jobs that a note names, at most.
const MAX_NAMED: usize = 5;

/// What is known of the deaths of earlier processes.
#[derive(Debug, Default)]
pub struct Deaths(BTreeMap<JobId, Vec<Death>>);

impl Deaths {
    /// The deaths of a journal.
    pub fn new(deaths: BTreeMap<JobId, Vec<Death>>) -> Self {
        Self(deaths)
    }

    /// Whether the process died while this job ran.
    pub fn is_suspect(&self, id: &JobId) -> bool {
        self.0.contains_key(id)
    }

    /// Whether the job is in quarantine.
    pub fn is_quarantined(&self, id: &JobId) -> bool {
        self.0.get(id).is_some_and(|deaths| {
            deaths.len() >= MAX_DEATHS && deaths.last().is_some_and(|death| death.alone)
        })
    }

    /// Forgets the deaths of a job that ended, or that a user asked for.
    pub fn forget(&mut self, id: &JobId) {
        self.0.remove(id);
    }
}

/// The record of a job in quarantine.
pub fn record(job: &Job) -> Option<Record> {
    let cells = Cells::of(job, &Outcome::Crashed, None)?;
    Some(Record { job: job.id.clone(), cells, file_hash: None, file_stamp: None })
}

/// The note about suspects; `None` without one.
pub fn suspects_note<'a>(
    jobs: impl Iterator<Item = &'a Job>,
    label: &dyn Fn(&Parameters) -> String,
) -> Option<String> {
    let names = named(jobs, label)?;
    Some(format!("the process died while these jobs ran: {names}; they run last and one at a time"))
}

/// The note about jobs in quarantine; `None` without one.
pub fn quarantine_note<'a>(
    jobs: impl Iterator<Item = &'a Job>,
    label: &dyn Fn(&Parameters) -> String,
    root: &str,
) -> Option<String> {
    let names = named(jobs, label)?;
    Some(format!(
        "the process died in two attempts at these jobs: {names}; they are not run again (status crashed); \
         to run them: billow run {root} --again crashed"
    ))
}

/// The names of jobs: short ids and parameters.
fn named<'a>(
    jobs: impl Iterator<Item = &'a Job>,
    label: &dyn Fn(&Parameters) -> String,
) -> Option<String> {
    let all: Vec<&Job> = jobs.collect();
    let name = |job: &&Job| match label(&job.parameters) {
        label if label.is_empty() => job.id.short().to_owned(),
        label => format!("{} ({label})", job.id.short()),
    };
    let mut names: Vec<String> = all.iter().take(MAX_NAMED).map(name).collect();
    if all.len() > MAX_NAMED {
        names.push(format!("and {} more", all.len() - MAX_NAMED));
    }
    (!names.is_empty()).then(|| names.join(", "))
}
