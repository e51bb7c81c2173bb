//! Runs failed jobs again with remedies, one after another, until one has a result or none remains.
//!
//! A run with a remedy is another job: another scene, another id. Its record and the link from the planned job are
//! written together, so an interrupted run leaves the row of the point as it was, and the same command resumes.

use std::collections::{BTreeMap, BTreeSet};

use super::State;
use crate::job::{Job, JobId};
use crate::platform::error::Result;
use crate::run::event::{Event, Reporter};
use crate::store::journal::{self, RemedyLink};
use crate::store::remedied::{self, Attempt};

impl State<'_, '_> {
    /// Runs the failed ones of the jobs of [`crate::run::runner::Rerun`] with remedies.
    pub(in crate::run::runner) fn run_remedies(
        &mut self,
        reporter: &mut dyn Reporter,
    ) -> Result<()> {
        let Some(rerun) = self.run.rerun.filter(|rerun| rerun.remedy) else { return Ok(()) };
        let shown = |state: &Self| state.points.iter().filter(|point| point.shows_remedy()).count();
        let before = shown(self);
        let mut tried = BTreeSet::new();
        while self.run.stop.requested().is_none() {
            let attempts: Vec<Attempt> = self
                .next_attempts(rerun.jobs)
                .into_iter()
                .filter(|attempt| {
                    tried.insert((attempt.link.planned.clone(), attempt.job.id.clone()))
                })
                .collect();
            if attempts.is_empty() {
                break;
            }
            reporter.event(&Event::Note(note(&attempts)));
            let jobs = self.begin_attempts(attempts, reporter)?;
            if !jobs.is_empty() {
                reporter.event(&Event::RemediesStarted { jobs: jobs.len() });
                self.run_jobs(jobs, reporter)?;
            }
            let mut points = std::mem::take(&mut self.points);
            self.show_remedies(&mut points);
            self.points = points;
            self.table_outdated = true;
        }
        self.summary.remedied += shown(self) - before;
        Ok(())
    }

    /// The next run of each of these jobs that has failed.
    fn next_attempts(&self, jobs: &BTreeSet<JobId>) -> Vec<Attempt> {
        let failed = self.points.iter().filter(|point| {
            let cells = journal::cells_of(point, &self.records);
            jobs.contains(&point.job.id) && cells.is_some_and(|cells| cells.status().is_failure())
        });
        failed.filter_map(|point| remedied::next(point, &|id| self.record(id))).collect()
    }

    /// Takes what the journal already has of these runs, and returns the jobs that must run.
    fn begin_attempts(
        &mut self,
        attempts: Vec<Attempt>,
        reporter: &mut dyn Reporter,
    ) -> Result<Vec<Job>> {
        let mut jobs: Vec<Job> = Vec::new();
        let mut known: Vec<RemedyLink> = Vec::new();
        for Attempt { job, link, .. } in attempts {
            let reached_limit = self.record(&job.id).is_some_and(journal::Record::reached_limit);
            let is_new = !self.open_links.contains_key(&job.id);
            let runs = if !is_new {
                true
            } else if let Some(record) = self.records.get(&job.id) {
                // Another point has this job.
                if reached_limit {
                    self.old_records.insert(job.id.clone(), record.clone());
                }
                reached_limit
            } else {
                self.must_run(&job.id, reached_limit, reporter)?
            };
            if !runs {
                known.push(link);
                continue;
            }
            self.open_links.entry(job.id.clone()).or_default().push(link);
            if is_new {
                self.deaths.forget(&job.id);
                jobs.push(job);
            }
        }
        if !known.is_empty() {
            self.log.writer().append_remedies(&[], &known)?;
            self.add_links(known);
        }
        Ok(jobs)
    }

    /// Adds links that the journal has.
    pub(super) fn add_links(&mut self, links: Vec<RemedyLink>) {
        for link in links {
            journal::add_link(&mut self.links, link);
        }
    }
}

/// What runs now: "remedies: solver.cfl 0.9 -> 0.45 (2 jobs); …".
fn note(attempts: &[Attempt]) -> String {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    for attempt in attempts {
        *numbers.entry(&attempt.text).or_default() += 1;
    }
    let texts: Vec<String> = numbers
        .into_iter()
        .map(|(text, number)| {
            format!("{text} ({number} {})", if number == 1 { "job" } else { "jobs" })
        })
        .collect();
    format!("remedies: {}", texts.join("; "))
}
