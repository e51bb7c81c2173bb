//! Running the binary: a folder, a study file in it, commands, and what they leave.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A folder to run commands in.
pub struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    /// With this study in `study.json`.
    pub fn new(study: &Value) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("grid.json"), study.to_string()).unwrap();
        Self { folder }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Results of the study, where `billow run` puts them.
    pub fn results(&self) -> PathBuf {
        self.path().join("results/grid")
    }

    /// `billow` with arguments, to run in the folder.
    pub fn billow(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
        command.args(arguments).current_dir(self.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs it to its end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.billow(arguments).output().unwrap()
    }

    /// Runs it; it must succeed. What it printed.
    pub fn stdout(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// The rows of the table.
    pub fn rows(&self, results: &str) -> Vec<Value> {
        let text = self.stdout(&["table", results, "--json"]);
        serde_json::from_str(&text).unwrap()
    }
}

/// What a command said on stderr.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The user's main grid, small: N × M × flow × residual gas, with points no pattern meets.
pub fn small_grid() -> Value {
    grid(&serde_json::json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [0.8, 1, 9.0],
        "mass_flow_rate": ["2 g/s"], "residual_gas_mass": [0, "0.05 g"]
    }))
}

/// A study of that grid on the piston.
pub fn grid(axes: &Value) -> Value {
    serde_json::json!({
        "design": { "fit": "height", "bottom_radius": "500 mm", "height": "1 m" },
        "gas": { "species": "nitrogen" },
        "solver": { "model": "piston", "end_time": "0.6 s" },
        "grid": axes
    })
}

/// Rows without what a run cost and who made it.
pub fn without_costs(rows: Vec<Value>) -> Vec<Value> {
    let strip = |mut row: Value| {
        for column in ["wall_seconds", "ns_per_element_step", "commit", "program_version"] {
            row.as_object_mut().unwrap().remove(column);
        }
        row
    };
    rows.into_iter().map(strip).collect()
}

/// Bytes of every history file, by name.
pub fn histories(results: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in fs::read_dir(results.join("jobs")).unwrap() {
        for file in fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let name = PathBuf::from(path.file_name().unwrap());
            found.insert(name, fs::read(path).unwrap());
        }
    }
    found
}

/// The small grid, run.
pub fn ran() -> Desk {
    let desk = Desk::new(&small_grid());
    desk.stdout(&["run", "grid.json", "-q"]);
    desk
}

/// The small grid, with jobs that all fail.
pub fn failed() -> Desk {
    let mut study = small_grid();
    study["solver"]["step_limit"] = serde_json::json!(3);
    let desk = Desk::new(&study);
    desk.run(&["run", "grid.json", "-q"]);
    desk
}

/// What a command prints as JSON; it must succeed.
pub fn json_of(desk: &Desk, arguments: &[&str]) -> Value {
    serde_json::from_str(&desk.stdout(&[arguments, &["--json"]].concat())).unwrap()
}

/// Ids of the rows of that status.
pub fn ids(desk: &Desk, status: &str) -> Vec<String> {
    let rows = desk.rows("results/grid");
    let own = rows.iter().filter(|row| row["status"] == status);
    own.map(|row| row["job"].as_str().unwrap().to_owned()).collect()
}

/// The history file of a job.
pub fn file_of(desk: &Desk, id: &str) -> PathBuf {
    desk.results().join(format!("jobs/{}/{id}.h5", &id[..2]))
}
