//! One run of the program, from outside.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::place::Place;
use super::trial::{Fault, Trial};

/// Path of the program.
pub const BILLOW: &str = env!("CARGO_BIN_EXE_billow");
/// Pause between two looks at a running program.
const LOOK: Duration = Duration::from_micros(300);
/// Time after which a program counts as hanging, if its kind has no other limit. Chosen: far above
/// every command of the trials, also on a busy machine.
pub const HANG: Duration = Duration::from_mins(1);

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
    /// It was killed at the limit.
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

    /// Adds the faults that no command may have: panic, abort, hang.
    pub fn check_end(&self, trial: &mut Trial, command: &str) {
        if self.hung {
            trial.fault(Fault::Slow, format!("{command}: no end after {:.1?}", self.wall));
        } else if self.code == Some(101) || self.stderr.contains("panicked at") {
            trial.fault(Fault::Abort, format!("{command}: panic: {}", self.said()));
        } else if let Some(signal) = self.signal {
            trial.fault(Fault::Abort, format!("{command}: signal {signal}: {}", self.said()));
        }
    }

    /// Whether the end is a refusal with a next step. Otherwise adds a fault.
    pub fn check_refusal(&self, trial: &mut Trial, command: &str, codes: &[i32]) {
        self.check_end(trial, command);
        let Some(code) = self.code else { return };
        if !codes.contains(&code) {
            let text = format!("{command}: exit code {code}, expected {codes:?}: {}", self.said());
            trial.fault(Fault::WrongMessage, text);
        } else if code == 2 && !self.stderr.contains("next:") {
            trial.fault(Fault::WrongMessage, format!("{command}: no next step: {}", self.said()));
        }
    }
}

/// A run that has started.
pub struct Running {
    child: Child,
    started: Instant,
    place: Place,
}

impl Running {
    /// Its process id.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Kills it with SIGKILL.
    pub fn kill(&mut self) {
        let _ = self.child.kill();
    }

    /// Whether it has ended.
    pub fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Sends a signal by name, with the builtin of the shell.
    pub fn signal(&self, name: &str) {
        let kill = format!("kill -{name} {}", self.id());
        let _ = Command::new("sh").args(["-c", &kill]).stderr(Stdio::null()).status();
    }

    /// Waits for its end, or kills it after `limit` from now.
    pub fn finish(mut self, limit: Duration) -> Finish {
        let from = Instant::now();
        let mut hung = false;
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if !hung && from.elapsed() > limit => {
                    hung = true;
                    self.kill();
                }
                Ok(None) => sleep(LOOK),
                Err(_) => break None,
            }
        };
        Finish {
            code: status.and_then(|status| status.code()),
            signal: status.and_then(|status| status.signal()),
            stdout: text(&self.place, "stdout"),
            stderr: text(&self.place, "stderr"),
            wall: self.started.elapsed(),
            hung,
        }
    }
}

fn text(place: &Place, name: &str) -> String {
    String::from_utf8_lossy(&fs::read(place.said().join(name)).unwrap_or_default()).into_owned()
}

/// The command `billow` in a place. stdout and stderr go to files beside the place.
pub fn billow(place: &Place, arguments: &[&str]) -> Command {
    let mut command = Command::new(BILLOW);
    command.args(arguments).current_dir(place.path());
    command
}

/// The same under limits of `ulimit`, as in `-v 200000`.
pub fn limited(place: &Place, limits: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    let script = format!("ulimit {limits}; exec \"$0\" \"$@\"");
    command.args(["-c", &script, BILLOW]).args(arguments).current_dir(place.path());
    command
}

/// Starts a command whose streams go to files beside the place.
pub fn start(place: &Place, mut command: Command) -> Running {
    let file = |name: &str| File::create(place.said().join(name)).expect("a file of a trial");
    command.stdin(Stdio::null()).stdout(file("stdout")).stderr(file("stderr"));
    command.env_remove("RUST_BACKTRACE");
    start_as_is(place, command)
}

/// Starts a command with the streams that it has.
pub fn start_as_is(place: &Place, mut command: Command) -> Running {
    let started = Instant::now();
    let child = command.spawn().expect("the program starts");
    Running { child, started, place: place.clone() }
}

/// Runs `billow` to its end.
pub fn run(place: &Place, arguments: &[&str]) -> Finish {
    start(place, billow(place, arguments)).finish(HANG)
}
