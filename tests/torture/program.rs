//! A folder of a trial, and runs of the program in it, from outside.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// Path of the program.
const BILLOW: &str = env!("CARGO_BIN_EXE_billow");
/// Arguments that run or resume the study of a place.
pub const RUN: &str = "run s.json --quiet --threads 2";
/// Pause between two looks at a running program.
const LOOK: Duration = Duration::from_micros(300);
/// Time after which a program counts as hanging and is killed. Chosen: far above every command of the
/// trials, also on a busy machine and with little memory.
const HANG: Duration = Duration::from_mins(3);

/// A folder in which the program runs. What it says goes to two files beside the folder.
#[derive(Clone)]
pub struct Place(PathBuf);

impl Place {
    /// An empty place below `root`; what was there is removed.
    pub fn new(root: &Path) -> Self {
        let place = Self(root.join("work"));
        place.remove();
        fs::create_dir_all(&place.0).expect("a folder of a trial");
        place
    }

    /// A new place within this one.
    pub fn within(&self, name: &str) -> Self {
        let place = Self(self.join(name));
        fs::create_dir_all(&place.0).expect("a folder of a trial");
        place
    }

    /// A path in the folder.
    pub fn join(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Folder of the results of the study `s.json`.
    pub fn results(&self) -> PathBuf {
        self.join("results/s")
    }

    /// Writes the study `s.json`.
    pub fn write_study(&self, study: &Value) {
        self.write("s.json", study.to_string().as_bytes());
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.join(name), bytes).expect("a file of a trial");
    }

    /// Copies everything in a folder, with links and the times of the files.
    pub fn copy_from(&self, folder: &Path) {
        let status = Command::new("cp").arg("-a").arg(folder.join(".")).arg(&self.0).status();
        assert!(status.is_ok_and(|status| status.success()), "cp -a {}", folder.display());
    }

    /// Removes the place and its root.
    pub fn remove(&self) {
        let _ = self.0.parent().map(fs::remove_dir_all);
    }

    /// The command `billow` in this place.
    pub fn billow(&self, arguments: &str) -> Command {
        let mut command = Command::new(BILLOW);
        command.args(arguments.split(' ')).current_dir(&self.0);
        command
    }

    /// A script of the shell, in which `"$0"` is the program.
    pub fn shell(&self, script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script, BILLOW]).current_dir(&self.0);
        command
    }

    /// The command `billow` with a limit of its address space.
    pub fn limited(&self, megabytes: u32, arguments: &str) -> Command {
        self.shell(&format!("ulimit -v {megabytes}000; exec \"$0\" {arguments}"))
    }

    /// Runs a script that may mount: its mounts end with it. `None` where nothing may be mounted.
    pub fn run_mounted(&self, mount: &str, script: &str) -> Option<Finish> {
        let mut command = Command::new("unshare");
        let script = format!("{mount} || exit 99\n{script}");
        command.args(["--map-root-user", "--mount", "sh", "-c", &script, BILLOW]);
        command.current_dir(&self.0);
        let finish = self.start(command).finish();
        (finish.code != Some(99) && !finish.stderr.starts_with("unshare")).then_some(finish)
    }

    /// Starts a command whose streams go to the two files.
    pub fn start(&self, mut command: Command) -> Running {
        let file = |ending| File::create(self.0.with_extension(ending)).expect("a file of a trial");
        command.stdin(Stdio::null()).stdout(file("stdout")).stderr(file("stderr"));
        command.env_remove("RUST_BACKTRACE");
        let started = Instant::now();
        let child = command.spawn().expect("the program starts");
        Running { child, started, place: self.clone() }
    }

    /// Runs `billow` to its end.
    pub fn run(&self, arguments: &str) -> Finish {
        self.start(self.billow(arguments)).finish()
    }
}

/// Every file under a folder, in order; hidden ones, too.
pub fn files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(root).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            found.extend(files(&entry.path()));
        } else {
            found.push(entry.path());
        }
    }
    found.sort();
    found
}

/// A run that has started.
pub struct Running {
    child: Child,
    started: Instant,
    place: Place,
}

impl Running {
    /// Whether it has ended.
    pub fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits until the run has taken its lock: it then answers to signals.
    pub fn wait_for_lock(&mut self) {
        let lock = self.place.results().join("lock");
        while !lock.exists() && !self.has_ended() {
            sleep(Duration::from_millis(1));
        }
    }

    /// Sends a signal by name, with the builtin of the shell.
    pub fn signal(&self, name: &str) {
        let kill = format!("kill -{name} {}", self.child.id());
        let _ = Command::new("sh").args(["-c", &kill]).stderr(Stdio::null()).status();
    }

    /// Waits for its end, or kills it when it hangs.
    pub fn finish(mut self) -> Finish {
        let from = Instant::now();
        let mut hung = false;
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if !hung && from.elapsed() > HANG => {
                    hung = true;
                    let _ = self.child.kill();
                }
                Ok(None) => sleep(LOOK),
                Err(_) => break None,
            }
        };
        let text = |ending| {
            let bytes = fs::read(self.place.0.with_extension(ending)).unwrap_or_default();
            String::from_utf8_lossy(&bytes).into_owned()
        };
        Finish {
            code: status.and_then(|status| status.code()),
            signal: status.and_then(|status| status.signal()),
            stdout: text("stdout"),
            stderr: text("stderr"),
            wall: self.started.elapsed(),
            hung,
        }
    }
}

/// How a run ended.
pub struct Finish {
    /// Exit code; `None` after a signal.
    pub code: Option<i32>,
    /// The signal that ended it.
    pub signal: Option<i32>,
    /// Its stdout.
    pub stdout: String,
    /// Its stderr.
    pub stderr: String,
    /// Elapsed time.
    pub wall: Duration,
    /// It was killed because it did not end.
    pub hung: bool,
}

impl Finish {
    /// Exit code 0.
    pub fn succeeded(&self) -> bool {
        self.code == Some(0)
    }

    /// The end of stderr, on one line.
    pub fn said(&self) -> String {
        let text = if self.stderr.trim().is_empty() { &self.stdout } else { &self.stderr };
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let start = line.char_indices().rev().nth(239).map_or(0, |(at, _)| at);
        line[start..].to_owned()
    }
}
