//! Errors as a user meets them: one line of what, one of what is allowed, one of what to do next.

use std::path::PathBuf;

use crate::platform::exit_code::Exit;

/// Whatever ends a command early. Each variant has an [`Exit`].
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Something the user gave is wrong: exit code 2.
    #[error("{0}")]
    Input(InputError),
    /// The disk, or what lies on it, is not as it should be: exit code 2.
    #[error("{}: {problem}", path.display())]
    Disk {
        /// File or folder.
        path: PathBuf,
        /// What is wrong and what to do next.
        problem: String,
    },
    /// Jobs failed: exit code 1. Their rows stand in the table.
    #[error("{0}")]
    JobsFailed(String),
    /// A signal ended the command: exit code 128 + its number.
    #[error("stopped by signal {0}; what is finished is kept, the same command goes on from here")]
    Signal(i32),
    /// A signal ended a single run: exit code 128 + its number.
    #[error("stopped by signal {signal}; {next}")]
    Interrupted {
        /// Number of the signal.
        signal: i32,
        /// What is kept and how to go on.
        next: String,
    },
    /// The reader of our output went away: quiet, exit code 0.
    #[error("output closed")]
    OutputClosed,
}

/// A value, key, file or flag that is not as it must be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// File, or the flag it came from.
    pub file: String,
    /// Dotted key (`film.thickness`, `grid.N[2]`); empty when the file as a whole is meant.
    pub key: String,
    /// The value as written; empty when there is none.
    pub value: String,
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
    /// What to do next; empty when `allowed` says it.
    pub hint: String,
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.file)?;
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        if !self.value.is_empty() {
            write!(f, " = {}", self.value)?;
        }
        write!(f, ": {}", self.problem)?;
        if !self.allowed.is_empty() {
            write!(f, "\n  allowed: {}", self.allowed)?;
        }
        if !self.hint.is_empty() {
            write!(f, "\n  next: {}", self.hint)?;
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
            Self::OutputClosed => Exit::Success,
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

/// Result of anything a command does.
pub type Result<T> = std::result::Result<T, Error>;
