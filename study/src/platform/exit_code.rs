//! Exit codes of the program. The errors, `billow --help` and docs/reference/exit-codes.md use this
//! one table.

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The command finished.
    Success,
    /// The command ran and something failed.
    Failure,
    /// Something the user gave, or a file on disk, is invalid.
    InvalidInput,
    /// The signal of this number stopped the command.
    Signal(i32),
}

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExitCode {
    /// Number, as a shell shows it.
    pub number: &'static str,
    /// Name.
    pub name: &'static str,
    /// Meaning in a few words, for `--help`.
    pub brief: &'static str,
    /// Meaning in full.
    pub meaning: &'static str,
}

/// Every exit code.
pub const EXIT_CODES: [ExitCode; 4] = [
    ExitCode {
        number: "0",
        name: "success",
        brief: "the command finished",
        meaning: "The command finished. Infeasible points and stalled capsules are results, not failures.",
    },
    ExitCode {
        number: "1",
        name: "failure",
        brief: "a job or scene failed, or stored results are broken",
        meaning: "A job failed, `run --again` gave different bits, `merge` found different bits or a damaged \
                  history, `doctor` found a fault, or a scene of `solve` has no result. The output names \
                  each of them.",
    },
    ExitCode {
        number: "2",
        name: "invalid_input",
        brief: "a file, key, value or option is invalid, or a file cannot be read or written",
        meaning: "A file, key, value, option or name is invalid, or a file cannot be read or \
                  written. The message names it and says what is allowed.",
    },
    ExitCode {
        number: "128 + n",
        name: "signal",
        brief: "signal n stopped the command (129: SIGHUP, 130: Ctrl-C, 138: SIGUSR1, 143: SIGTERM)",
        meaning: "Signal n stopped the command within 2 s: 129 for SIGHUP (n = 1), 130 for Ctrl-C \
                  (SIGINT, n = 2), 138 for SIGUSR1 (n = 10), 143 for SIGTERM (n = 15). `run` and \
                  `run --again` keep the finished jobs and checkpoints of the running ones, and the same \
                  command continues them; `validate` prints the cases that have finished.",
    },
];

impl Exit {
    /// The number that the operating system gets.
    pub fn code(self) -> u8 {
        match self {
            Self::Success => 0,
            Self::Failure => 1,
            Self::InvalidInput => 2,
            Self::Signal(signal) => u8::try_from(128 + signal).unwrap_or(u8::MAX),
        }
    }

    /// The row of the table.
    pub fn row(self) -> &'static ExitCode {
        match self {
            Self::Success => &EXIT_CODES[0],
            Self::Failure => &EXIT_CODES[1],
            Self::InvalidInput => &EXIT_CODES[2],
            Self::Signal(_) => &EXIT_CODES[3],
        }
    }
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_the_numbers_the_program_returns() {
        for exit in [Exit::Success, Exit::Failure, Exit::InvalidInput] {
            assert_eq!(exit.row().number, exit.code().to_string());
        }
        assert_eq!(Exit::Signal(2).code(), 130);
        assert_eq!(Exit::Signal(15).code(), 143);
        for (signal, name) in crate::platform::stop::STOPPING_SIGNALS {
            let row = Exit::Signal(signal).row();
            let code = Exit::Signal(signal).code().to_string();
            assert!(row.meaning.contains(name) && row.meaning.contains(&code), "{name}");
            assert!(row.brief.contains(&code), "{name}");
        }
        assert!(Exit::Signal(15).row().meaning.contains("143"));
    }
}
