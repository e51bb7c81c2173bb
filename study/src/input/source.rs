//! Where a value came from: the file, or a `--set` flag; errors name it.

use crate::platform::error::InputError;

/// Origin of the values of a study or a scene.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// The file, as errors call it.
    pub file: String,
    /// Dotted key and the flag that set it.
    pub sets: Vec<(String, String)>,
}

impl Source {
    pub fn new(file: &str) -> Self {
        Self { file: file.to_owned(), sets: Vec::new() }
    }

    /// An error about a key; named after the flag where a flag set it.
    pub fn error(
        &self,
        key: &str,
        value: &str,
        problem: impl Into<String>,
        allowed: impl Into<String>,
    ) -> InputError {
        let within = |outer: &str| {
            key.strip_prefix(outer)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let flag = self.sets.iter().rev().find(|(set, _)| within(set));
        InputError {
            file: flag.map_or_else(|| self.file.clone(), |(_, flag)| flag.clone()),
            key: key.to_owned(),
            value: value.to_owned(),
            problem: problem.into(),
            allowed: allowed.into(),
            hint: String::new(),
        }
    }
}

/// A number as a study file would have it: in shortest digits, small ones with an exponent.
pub(crate) fn shown(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}
