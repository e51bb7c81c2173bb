//! What the rows of a study show: comparisons, statistics, the answer, the ranking.

pub mod answer;
pub mod at_limit;
pub mod compare;
pub mod ranking;
pub mod replicates;
pub mod statistics;
mod values;
pub mod work_precision;

#[cfg(test)]
pub mod fixture;
