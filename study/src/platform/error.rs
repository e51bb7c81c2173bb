//! Errors for the user: what is wrong, what is allowed, the next step. One line each.

use std::path::PathBuf;

use crate::platform::exit_code::Exit;
use crate::platform::quote;

/// Characters of a file name or of an option in a message (chosen: a long path fits).
const MAX_FILE: usize = 300;
/// Characters of a key (chosen: the longest path of a key fits twice).
const MAX_KEY: usize = 120;
/// Characters of a line of a problem or of a next step (chosen: any sentence fits; a name of the user
/// in it may be longer).
const MAX_PROBLEM: usize = 600;

/// Whatever ends a command early. Each variant has an [`Exit`].
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A value, key, file or option of the user is wrong: exit code 2.
    #[error("{0}")]
    Input(InputError),
    /// The disk, or a file on it, cannot be used: exit code 2.
    #[error("{}: {}", quote::cut(&path.display().to_string(), MAX_FILE), quote::cut_lines(problem, MAX_PROBLEM))]
    Disk {
        /// File or folder.
        path: PathBuf,
        /// What is wrong, and the next step.
        problem: String,
    },
    /// Jobs failed: exit code 1. The table has their rows.
    #[error("{0}")]
    JobsFailed(String),
    /// A signal ended the command: exit code 128 + its number.
    #[error(
        "stopped by signal {0}; finished jobs are kept, the same command runs the remaining ones and continues \
         those that have a checkpoint"
    )]
    Signal(i32),
    /// A signal ended a single run: exit code 128 + its number.
    #[error("stopped by signal {signal}; {next}")]
    Interrupted {
        /// Number of the signal.
        signal: i32,
        /// What is kept, and how to continue.
        next: String,
    },
}

/// An invalid value, key, file or option.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// File, or the option of the command line.
    pub file: String,
    /// Dotted key (`film.thickness`, `grid.N[2]`); empty for a fault of the whole file.
    pub key: String,
    /// The value as written; empty without a value.
    pub value: String,
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
    /// The next step; empty when `allowed` says it.
    pub hint: String,
}

impl InputError {
    /// The same error with this next step.
    #[must_use]
    pub fn with_hint(self, hint: impl Into<String>) -> Self {
        Self { hint: hint.into(), ..self }
    }
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let lines = |text: &str| quote::cut_lines(text, MAX_PROBLEM);
        f.write_str(&quote::cut(&self.file, MAX_FILE))?;
        if !self.key.is_empty() {
            write!(f, ": {}", quote::cut(&self.key, MAX_KEY))?;
        }
        if !self.value.is_empty() {
            write!(f, " = {}", quote::echo(&self.value))?;
        }
        write!(f, ": {}", lines(&self.problem))?;
        if !self.allowed.is_empty() {
            // A list of names, written by this program.
            write!(f, "\n  allowed: {}", quote::printable(&self.allowed))?;
        }
        if !self.hint.is_empty() {
            write!(f, "\n  next: {}", lines(&self.hint))?;
        }
        Ok(())
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl Error {
    /// How the program ends with this error.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Input(_) | Self::Disk { .. } => Exit::InvalidInput,
            Self::JobsFailed(_) => Exit::Failure,
            Self::Signal(signal) | Self::Interrupted { signal, .. } => Exit::Signal(*signal),
        }
    }

    /// The error of an invalid value of a command-line option.
    pub fn invalid_option(
        option: &str,
        value: &str,
        problem: impl Into<String>,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Input(InputError {
            file: option.to_owned(),
            key: String::new(),
            value: value.to_owned(),
            problem: problem.into(),
            allowed: allowed.into(),
            hint: hint.into(),
        })
    }
}

/// Result of a command or a part of it.
pub type Result<T> = std::result::Result<T, Error>;
