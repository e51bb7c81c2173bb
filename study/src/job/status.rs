//! The status of a job: one enum with one set of names, for table, journal and history files.

use std::fmt;

use billow_solver::output::outcome::FailureKind;

/// How a job, or the run of a single scene, stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The job has not ended yet.
    Pending,
    /// The run reached its end time, or the static solver its equilibrium.
    Done,
    /// No fold pattern satisfies the design: nothing was run.
    Infeasible,
    /// The model refused the scene before its first step.
    Invalid,
    /// The program panicked.
    Panicked,
    /// The run stopped before its end time. There is no result.
    Failed(FailureKind),
    /// The job reached its limit of wall time. It has no measures.
    Timeout,
    /// The job needs more memory than it may use. It did not run, or has no measures.
    OutOfMemory,
    /// The process died twice while the job ran. It runs again only on request.
    Crashed,
    /// The run was cancelled. A study keeps nothing of it.
    Cancelled,
    /// The run of a single scene was paused; its checkpoint continues it. Never in a study.
    Paused,
    /// The static solver found no equilibrium for a single scene. Never in a study.
    NoEquilibrium,
}

impl Status {
    /// Every status.
    pub fn all() -> impl Iterator<Item = Self> {
        [
            Self::Pending,
            Self::Done,
            Self::Infeasible,
            Self::Invalid,
            Self::Panicked,
            Self::Timeout,
            Self::OutOfMemory,
            Self::Crashed,
            Self::Cancelled,
            Self::Paused,
            Self::NoEquilibrium,
        ]
        .into_iter()
        .chain(FailureKind::ALL.map(Self::Failed))
    }

    /// The name, as in the column `status`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pending => "pending",
            Self::Done => "done",
            Self::Infeasible => "infeasible",
            Self::Invalid => "invalid",
            Self::Panicked => "panicked",
            Self::Failed(kind) => kind.name(),
            Self::Timeout => "timeout",
            Self::OutOfMemory => "out_of_memory",
            Self::Crashed => "crashed",
            Self::Cancelled => "cancelled",
            Self::Paused => "paused",
            Self::NoEquilibrium => "no_equilibrium",
        }
    }

    /// The status with that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|status| status.name() == name)
    }

    /// Whether a job of a study can have it.
    pub fn has_job(self) -> bool {
        !matches!(self, Self::Infeasible | Self::Cancelled | Self::Paused | Self::NoEquilibrium)
    }

    /// Whether a job with this status and without a history was ended by a limit of the study, or crashed: it can
    /// resume from its checkpoint, or run again.
    pub fn is_limit(self) -> bool {
        let step_limit = Self::Failed(FailureKind::StepLimit);
        [Self::Timeout, Self::OutOfMemory, Self::Crashed, step_limit].contains(&self)
    }

    /// Whether a job with this status failed: it will not give a result, though its point has a
    /// pattern.
    pub fn is_failure(self) -> bool {
        match self {
            Self::Invalid
            | Self::Panicked
            | Self::Failed(_)
            | Self::Timeout
            | Self::OutOfMemory
            | Self::Crashed
            | Self::NoEquilibrium => true,
            Self::Pending | Self::Done | Self::Infeasible | Self::Cancelled | Self::Paused => false,
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_status_is_found_by_its_name_and_names_differ() {
        for status in Status::all() {
            assert_eq!(Status::from_name(status.name()), Some(status));
        }
        let names: BTreeSet<&str> = Status::all().map(Status::name).collect();
        assert_eq!(names.len(), Status::all().count());
        assert_eq!(Status::from_name("finished"), None);
    }
}
