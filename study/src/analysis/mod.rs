//! What the rows of a study say: comparisons, statistics, the answer.

pub mod answer;
pub mod compare;
pub mod statistics;
