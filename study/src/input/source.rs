//! Where a value comes from, for errors: the file, or a `--set` flag.

use std::cell::RefCell;
use std::fmt::{Display, Write as _};
use std::rc::Rc;

use crate::input::json::Json;
use crate::input::plausible::Implausible;
use crate::platform::error::InputError;

/// The file and the flags that give the values of a study or a scene.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// Name of the file in errors.
    pub file: String,
    /// Dotted keys, and the flag that sets each.
    pub sets: Vec<(String, String)>,
    /// Warnings about values, in the order of reading; those of a copy too.
    warnings: Rc<RefCell<Vec<Warning>>>,
}

/// A warning about the values of one place: a key, or all values of an axis.
#[derive(Debug, Clone)]
struct Warning {
    /// What the warning is about, without the number of a value in a list.
    place: String,
    text: InputError,
    /// Number of further ones with the same problem.
    more: usize,
}

impl Source {
    pub fn new(file: &str) -> Self {
        Self { file: file.to_owned(), sets: Vec::new(), warnings: Rc::default() }
    }

    /// Keeps a warning about a value that is read. Further values of a list are counted.
    pub fn warn(&self, key: &str, value: &Json, implausible: Implausible) {
        let place = key.rsplit_once('[').filter(|(_, index)| index.ends_with(']'));
        let place = place.map_or(key, |(place, _)| place);
        // A list may have numbers with and without a unit.
        let kind = if let Json::Text(_) = value { "with a unit" } else { "" };
        self.keep(format!("{place} {kind}"), key, value, implausible);
    }

    /// Keeps a warning about a point of the study. Further points are counted.
    pub fn warn_point(&self, key: &str, value: impl Display, implausible: Implausible) {
        self.keep(format!("point {key}"), key, value, implausible);
    }

    fn keep(&self, place: String, key: &str, value: impl Display, implausible: Implausible) {
        let mut warnings = self.warnings.borrow_mut();
        if let Some(known) = warnings.iter_mut().find(|known| known.place == place) {
            known.more += 1;
            return;
        }
        let mut text = self.error(key, value, implausible.problem, "");
        text.hint = implausible.next;
        warnings.push(Warning { place, text, more: 0 });
    }

    /// The warnings so far, one text each.
    pub fn warnings(&self) -> Vec<String> {
        let warnings = self.warnings.borrow();
        let text = |warning: &Warning| {
            let mut error = warning.text.clone();
            if warning.more > 0 {
                let _ = write!(error.value, " (and {} more)", warning.more);
            }
            format!("warning: {error}")
        };
        warnings.iter().map(text).collect()
    }

    /// An error about a key. It names the flag where a flag sets the key, the file otherwise.
    pub fn error(
        &self,
        key: &str,
        value: impl Display,
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
            value: value.to_string(),
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
