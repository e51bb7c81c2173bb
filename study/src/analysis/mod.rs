//! What the rows of a study show: comparisons, statistics, the answer.

pub mod answer;
pub mod compare;
pub mod statistics;
