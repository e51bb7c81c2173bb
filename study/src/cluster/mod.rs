//! Gives the jobs of a study to a cluster: one array of tasks, each with a part of the jobs and a folder of its own.
//!
//! ```text
//! results/<study>/submission/array.sh    the script of the tasks (script): billow run RESULTS --points K/N --results RESULTS/parts/K-N
//!                            merge.sh    the script that ends the study: billow merge RESULTS
//!                            queue.json  the numbers that the scheduler gave (submission)
//!                            task-K.txt  what task K printed
//!                 parts/K-N/             results of task K of N
//! ```
//!
//! A task is a run like any other, so it may be killed and started again. What is missing after the merge is in the next
//! submission.

pub mod script;
pub mod slurm;
pub mod submission;
