//! Gives the jobs of a study to a cluster: one array of tasks, each with a chunk of the jobs.
//!
//! ```text
//! submissions/0001/chunks.json    the jobs of each task, fixed when they were submitted (submission)
//!                  array.sh       the script of the tasks (script): billow run RESULTS --shared --chunk 0001/K
//!                  merge.sh       the script that ends the study: billow merge RESULTS
//!                  queue.json     the numbers that the scheduler gave (submission)
//!                  task-K.txt     what task K printed
//! ```
//!
//! A task is a run that shares the folder ([`crate::run::runner::Run::shared`]), so it may be killed, started again or
//! run beside others: no result depends on it. What is missing afterwards is in the next submission.

pub mod chunks;
pub mod notation;
pub mod script;
pub mod slurm;
pub mod submission;
