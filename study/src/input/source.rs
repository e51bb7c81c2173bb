//! Where a value comes from, for errors: the file, or a `--set` flag.

use crate::platform::error::InputError;

/// The file and the flags that give the values of a study or a scene.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// Name of the file in errors.
    pub file: String,
    /// Dotted keys, and the flag that sets each.
    pub sets: Vec<(String, String)>,
}

impl Source {
    pub fn new(file: &str) -> Self {
        Self { file: file.to_owned(), sets: Vec::new() }
    }

    /// An error about a key. It names the flag where a flag sets the key, the file otherwise.
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

/// A number as a study file has it: shortest digits, small ones with an exponent.
pub(crate) fn shown(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}
