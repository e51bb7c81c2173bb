//! Runs the programs in a temporary folder.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A temporary folder in which `billow-checks` runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Runs a study of `billow` into the folder of this name.
    pub fn study(&self, name: &str, study: &serde_json::Value) {
        let [file, results] = [format!("{name}.json"), name.to_owned()]
            .map(|name| self.path().join(name).to_string_lossy().into_owned());
        std::fs::write(&file, study.to_string()).unwrap();
        let line = ["billow", "run", &file, "--results", &results, "-q"];
        billow_study::cli::command(line, &mut Vec::new()).unwrap();
    }

    /// Runs the command to its end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_billow-checks"));
        command.args(arguments).current_dir(self.path()).stdin(Stdio::null()).output().unwrap()
    }

    /// Runs the command, which must succeed; its stdout.
    pub fn stdout(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }
}

/// The stderr of a command.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
