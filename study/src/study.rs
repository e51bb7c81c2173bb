//! What a study file means: defaults filled, units converted, axes expanded.

/// A validated study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name: of the results folder.
    pub name: String,
    /// The question it answers, in words.
    pub question: String,
}
