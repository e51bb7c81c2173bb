//! Limits of one job: `job_limits` of a study. They are no part of a scene and of a job id; a job that
//! reaches one has a row without measures.

use crate::job::Status;
use crate::platform::memory::{Limit as MemoryLimit, size};

/// Limits of every job of a study. `None`: no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JobLimits {
    /// Wall time of one attempt, s.
    pub wall_time: Option<f64>,
    /// Steps of the job.
    pub steps: Option<u64>,
    /// Memory of the job, bytes.
    pub memory: Option<u64>,
}

/// A limit that a job reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// [`JobLimits::wall_time`], s.
    WallTime(f64),
    /// [`JobLimits::steps`].
    Steps(u64),
    /// [`JobLimits::memory`], bytes, and the estimate of the job, bytes.
    Memory {
        /// The limit.
        limit: u64,
        /// What the job needs.
        needed: u64,
    },
    /// The memory that this process may use, and the estimate of the job, bytes.
    Available {
        /// What limits it.
        limit: MemoryLimit,
        /// What the job needs.
        needed: u64,
    },
}

impl Limit {
    /// The status of a job that reached it.
    pub fn status(self) -> Status {
        match self {
            Self::WallTime(_) => Status::Timeout,
            Self::Steps(_) => {
                Status::Failed(billow_solver::output::outcome::FailureKind::StepLimit)
            }
            Self::Memory { .. } | Self::Available { .. } => Status::OutOfMemory,
        }
    }

    /// What happened, and the next step, without a measured time.
    pub fn reason(self) -> String {
        let next = |key: &str| {
            let status = self.status();
            format!("next: billow run STUDY --again {status} --set job_limits.{key}=…")
        };
        match self {
            Self::WallTime(limit) => {
                format!("job_limits.wall_time of {limit} s is reached; {}", next("wall_time"))
            }
            Self::Steps(limit) => {
                format!("job_limits.steps of {limit} is reached; {}", next("steps"))
            }
            Self::Memory { limit, needed } => format!(
                "the job needs {} MB, job_limits.memory is {} MB; {}",
                megabytes(needed),
                megabytes(limit),
                next("memory")
            ),
            Self::Available { limit, needed } => format!(
                "the job needs about {} of memory, and {limit} leaves less; next: a coarser mesh, or billow run \
                 STUDY --again out_of_memory with more memory",
                size(needed)
            ),
        }
    }
}

/// Bytes in MB, rounded up.
fn megabytes(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_names_key_value_and_next_step() {
        let reason = Limit::WallTime(10.0).reason();
        assert_eq!(
            reason,
            "job_limits.wall_time of 10 s is reached; next: billow run STUDY --again timeout --set \
             job_limits.wall_time=…"
        );
        assert!(Limit::Steps(7).reason().contains("--again step_limit --set job_limits.steps=…"));
        let memory = Limit::Memory { limit: 1_000_000, needed: 1_000_001 }.reason();
        assert!(memory.starts_with("the job needs 2 MB, job_limits.memory is 1 MB"), "{memory}");
    }
}
