//! Runs the program in a temporary folder and reads its results.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use serde_json::Value;

/// A temporary folder in which commands run.
pub struct TestFolder {
    folder: tempfile::TempDir,
}

impl TestFolder {
    /// A folder with this study in `grid.json`.
    pub fn new(study: &Value) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("grid.json"), study.to_string()).unwrap();
        Self { folder }
    }

    /// The same, and the study has run. A study runs once; every folder has a copy of its results.
    pub fn finished(study: &Value) -> Self {
        /// Where the runs are kept; `cargo` places it below `target`.
        const KEPT: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/finished");
        static RUNS: LazyLock<Mutex<BTreeMap<String, Arc<OnceLock<PathBuf>>>>> =
            LazyLock::new(|| {
                let _ = fs::remove_dir_all(KEPT);
                Mutex::default()
            });
        let (number, run) = {
            let mut runs = RUNS.lock().unwrap();
            (runs.len(), Arc::clone(runs.entry(study.to_string()).or_default()))
        };
        let kept = run.get_or_init(|| {
            let folder = Self::new(study);
            folder.stdout(&["run", "grid.json", "-q"]);
            let kept = Path::new(KEPT).join(number.to_string());
            fs::create_dir_all(&kept).unwrap();
            copy(&folder.path().join("results"), &kept);
            kept.join("results")
        });
        let folder = Self::new(study);
        copy(kept, folder.path());
        folder
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Default results folder of the study.
    pub fn results(&self) -> PathBuf {
        self.path().join("results/grid")
    }

    /// The command `billow` with arguments, in this folder.
    pub fn billow(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
        command.args(arguments).current_dir(self.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the command to its end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.billow(arguments).output().unwrap()
    }

    /// Runs the command, which must succeed; its stdout.
    pub fn stdout(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs the command, which must be refused: exit code 2, this text on stderr, nothing on stdout.
    pub fn refuses(&self, arguments: &[&str], text: &str) {
        let output = self.run(arguments);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(text), "{arguments:?}: {text:?} is not in {said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }

    /// The points of the table: one row for all runs of a point.
    pub fn points(&self, results: &str) -> Vec<Value> {
        let text = self.stdout(&["table", results, "--json"]);
        serde_json::from_str(&text).unwrap()
    }

    /// The rows of the table, one per run.
    pub fn rows(&self, results: &str) -> Vec<Value> {
        let text = self.stdout(&["table", results, "--runs", "--json"]);
        serde_json::from_str(&text).unwrap()
    }
}

/// Copies a folder into another one, with all times of change.
fn copy(from: &Path, into: &Path) {
    assert!(Command::new("cp").arg("-a").args([from, into]).status().unwrap().success());
}

/// The stderr of a command.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A small grid, N × M × ratio × residual gas, with infeasible points.
pub fn small_grid() -> Value {
    grid(&serde_json::json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [0.8, 1, 9.0],
        "mass_flow_rate": ["2 g/s"], "residual_gas_mass": [0, "0.05 g"]
    }))
}

/// A piston study with these axes.
pub fn grid(axes: &Value) -> Value {
    serde_json::json!({
        "design": { "fit": "height", "bottom_radius": "500 mm", "height": "1 m" },
        "gas": { "species": "nitrogen" },
        "solver": { "model": "piston", "end_time": "0.6 s" },
        "grid": axes
    })
}

/// The fold of the paper's capsule on a film of this mesh.
pub fn paper_design(subdivisions: u32) -> Value {
    serde_json::json!({
        "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m",
        "subdivisions": subdivisions,
    })
}

/// Rows without cost and provenance.
pub fn without_costs(rows: Vec<Value>) -> Vec<Value> {
    let strip = |mut row: Value| {
        for column in ["wall_seconds", "time_per_zone_cycle", "commit", "program_version"] {
            row.as_object_mut().unwrap().remove(column);
        }
        row
    };
    rows.into_iter().map(strip).collect()
}

/// The bytes of every history file, by name.
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

/// Sends a signal to a running command.
pub fn signal(child: &Child, name: &str) {
    // The shell's builtin: a minimal system has no kill program.
    let kill = format!("kill {name} {}", child.id());
    let sent = Command::new("sh").args(["-c", &kill]).status().unwrap();
    assert!(sent.success());
}

/// The finished small grid.
pub fn ran() -> TestFolder {
    TestFolder::finished(&small_grid())
}

/// The small grid with a step limit at which every job fails.
pub fn failed() -> TestFolder {
    let mut study = small_grid();
    study["solver"]["step_limit"] = serde_json::json!(3);
    let folder = TestFolder::new(&study);
    assert_eq!(folder.run(&["run", "grid.json", "-q"]).status.code(), Some(1));
    folder
}

/// The JSON output of a command, which must succeed.
pub fn json_of(folder: &TestFolder, arguments: &[&str]) -> Value {
    serde_json::from_str(&folder.stdout(&[arguments, &["--json"]].concat())).unwrap()
}

/// Job ids of the rows with a status.
pub fn ids(folder: &TestFolder, status: &str) -> Vec<String> {
    let rows = folder.rows("results/grid");
    let matching = rows.iter().filter(|row| row["status"] == status);
    matching.map(|row| row["job"].as_str().unwrap().to_owned()).collect()
}

/// The history file of a job.
pub fn file_of(folder: &TestFolder, id: &str) -> PathBuf {
    folder.results().join(format!("jobs/{}/{id}.h5", &id[..2]))
}

/// Width and height of a PNG, pixels.
pub fn png_size(path: &Path) -> [u32; 2] {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

/// Fails unless a file is valid by its schema.
pub fn assert_valid(schema: &jsonschema::Validator, text: &str) {
    let json = serde_json::from_str(text).unwrap();
    let errors: Vec<_> =
        schema.iter_errors(&json).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:?} in {text}");
}
