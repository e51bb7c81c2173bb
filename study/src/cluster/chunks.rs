//! Shares jobs out among tasks by their estimated cost.
//!
//! ```text
//! number of tasks    Σ cost / (cores · 10 min), rounded up; at most one a job and what the scheduler allows
//! chunk of a job     the one with the least cost so far, the dearest job first
//! ```
//!
//! So the dearest chunk costs at most 4/3 of what is possible (Graham 1969, list scheduling by decreasing cost).

use crate::job::JobId;

/// Time of a task by the estimate, s. Chosen: long against the start of a task, short against the wait for the last one.
const TASK_SECONDS: f64 = 600.0;
/// Estimated time over the wall time of a task, at most. Chosen: estimates and machines differ by a factor of two.
const WALL_TIME_SHARE: f64 = 0.4;

/// A job and its estimated time on one core, s.
#[derive(Debug, Clone, PartialEq)]
pub struct CostedJob {
    /// Its id.
    pub id: JobId,
    /// Estimated time on one core, s.
    pub seconds: f64,
}

/// Number of tasks for jobs of this cost (s in all, on one core), on this number of cores each with this wall time (s).
pub fn number(jobs: &[CostedJob], cores: usize, wall_time: f64, most: usize) -> usize {
    let seconds: f64 = jobs.iter().map(|job| job.seconds).sum();
    let each = TASK_SECONDS.min(WALL_TIME_SHARE * wall_time) * cores as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at least 1, and saturates"
    )]
    let wanted = libm::ceil(seconds / each).max(1.0) as usize;
    wanted.min(jobs.len().div_ceil(cores)).min(most).max(1)
}

/// Shares jobs out among this number of tasks. Every chunk has its jobs in the order of the plan; the same jobs give the
/// same chunks. No chunk is empty while there are jobs for it.
pub fn share(jobs: &[CostedJob], tasks: usize) -> Vec<Vec<JobId>> {
    let mut dearest: Vec<usize> = (0..jobs.len()).collect();
    dearest.sort_by(|a, b| jobs[*b].seconds.total_cmp(&jobs[*a].seconds).then(a.cmp(b)));
    let mut chunks: Vec<(f64, Vec<usize>)> = vec![(0.0, Vec::new()); tasks];
    for job in dearest {
        let cheapest =
            chunks.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.len().cmp(&b.1.len())));
        if let Some((seconds, chunk)) = cheapest {
            *seconds += jobs[job].seconds;
            chunk.push(job);
        }
    }
    let ordered = chunks.into_iter().map(|(_, mut chunk)| {
        chunk.sort_unstable();
        chunk.into_iter().map(|job| jobs[job].id.clone()).collect()
    });
    ordered.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jobs(seconds: &[f64]) -> Vec<CostedJob> {
        let job = |(number, seconds): (usize, &f64)| CostedJob {
            id: JobId::from_digits(&format!("{number:032x}")).unwrap(),
            seconds: *seconds,
        };
        seconds.iter().enumerate().map(job).collect()
    }

    #[test]
    fn every_job_is_in_one_chunk_and_chunks_cost_about_the_same() {
        let costs: Vec<f64> = (0..500).map(|n| 1.0 + f64::from(n * 37 % 101)).collect();
        let all = jobs(&costs);
        let chunks = share(&all, 7);
        let mut ids: Vec<&JobId> = chunks.iter().flatten().collect();
        assert!(chunks.iter().all(|chunk| chunk.is_sorted()));
        ids.sort();
        assert!(ids.iter().copied().eq(all.iter().map(|job| &job.id)));
        let cost = |chunk: &Vec<JobId>| -> f64 {
            let of =
                |id: &JobId| all.iter().find(|job| job.id == *id).map_or(0.0, |job| job.seconds);
            chunk.iter().map(of).sum()
        };
        let found: Vec<f64> = chunks.iter().map(cost).collect();
        let mean = costs.iter().sum::<f64>() / 7.0;
        assert!(found.iter().all(|cost| (cost / mean - 1.0).abs() < 0.02), "{found:?} {mean}");
        assert_eq!(chunks, share(&all, 7));
    }

    #[test]
    fn tasks_are_as_long_as_is_useful() {
        let hundred = jobs(&[60.0; 100]);
        assert_eq!(number(&hundred, 1, 3600.0, 1000), 10);
        assert_eq!(number(&hundred, 2, 3600.0, 1000), 5);
        // A short wall time makes more tasks, and the scheduler limits them.
        assert_eq!(number(&hundred, 1, 300.0, 1000), 50);
        assert_eq!(number(&hundred, 1, 300.0, 20), 20);
        // Not more tasks than there are jobs for their cores.
        assert_eq!(number(&jobs(&[1e6; 3]), 1, 3600.0, 1000), 3);
        assert_eq!(number(&jobs(&[1e6; 3]), 2, 3600.0, 1000), 2);
        assert_eq!(number(&jobs(&[1e-3; 3]), 4, 3600.0, 1000), 1);
        assert_eq!(share(&jobs(&[0.0; 3]), 3).iter().map(Vec::len).max(), Some(1));
    }
}
