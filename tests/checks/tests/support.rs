//! Runs the programs in a temporary folder.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A temporary folder in which `billow-checks` runs.
pub struct Folder {
    folder: tempfile::TempDir,
}

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs a study of `billow` and returns the folder of its results.
    pub fn study(&self, name: &str, study: &serde_json::Value) -> PathBuf {
        let file = self.path().join(format!("{name}.json"));
        std::fs::write(&file, study.to_string()).unwrap();
        let results = self.path().join(name);
        let line: [&std::ffi::OsStr; 6] = [
            "billow".as_ref(),
            "run".as_ref(),
            file.as_ref(),
            "--results".as_ref(),
            results.as_ref(),
            "-q".as_ref(),
        ];
        billow_study::cli::command(line, &mut Vec::new()).unwrap();
        results
    }

    /// Runs the command to its end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        checks(arguments).current_dir(self.path()).output().unwrap()
    }

    /// Runs the command, which must succeed; its stdout.
    pub fn stdout(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }
}

/// `billow-checks` with arguments.
pub fn checks(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow-checks"));
    command.args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The stderr of a command.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
