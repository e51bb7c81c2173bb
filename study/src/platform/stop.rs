//! Early stop: the first Ctrl-C, SIGTERM, SIGUSR1 or SIGHUP ends a command in order, within 2 s.
//!
//! A watchdog ends the process if the command has not ended by then: everything on disk is written as a
//! whole or not at all, so only work since the last checkpoint is lost.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level;

/// Signals that end a command, with their exit codes and names.
pub const STOPPING_SIGNALS: [(i32, &str); 4] =
    [(SIGHUP, "SIGHUP"), (SIGINT, "SIGINT"), (SIGUSR1, "SIGUSR1"), (SIGTERM, "SIGTERM")];
/// Time after the first signal at which the process ends, whatever it does. Chosen: within 2 s, also
/// where the system needs time to take back the memory of a large mesh.
const MAX_STOP_TIME: Duration = Duration::from_millis(1600);
/// Time for a message to stderr before the process ends: stderr may be blocked.
const MESSAGE_TIME: Duration = Duration::from_millis(100);

/// A request to stop, with its signal.
#[derive(Debug, Clone, Default)]
pub struct Stop {
    signal: Arc<AtomicI32>,
}

impl Stop {
    /// No request yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Requests a stop at one of [`STOPPING_SIGNALS`]; not at SIGHUP where it is ignored, as under nohup.
    /// The second signal changes nothing: it often is the first one again, sent to the process and to its
    /// group. The third one ends the program at once.
    ///
    /// # Errors
    /// When the system refuses the signal handlers or the thread that waits for signals.
    pub fn on_signals() -> io::Result<Self> {
        let stop = Self::new();
        let numbers = STOPPING_SIGNALS.map(|(number, _)| number);
        let wanted = numbers.into_iter().filter(|number| *number != SIGHUP || !is_ignored(*number));
        let mut signals = Signals::new(wanted)?;
        let request = stop.clone();
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            for (earlier, signal) in signals.forever().enumerate() {
                match earlier {
                    0 => {
                        request.request(signal);
                        // Without the watchdog the command still ends, only later.
                        let _ = thread::Builder::new()
                            .name("watchdog".to_owned())
                            .spawn(move || end_late(signal));
                    }
                    1 => eprintln!("billow: stopping; another signal ends the program at once"),
                    _ => low_level::exit(128 + signal),
                }
            }
        })?;
        Ok(stop)
    }

    /// Requests a stop, as that signal does.
    pub fn request(&self, signal: i32) {
        self.signal.store(signal, Ordering::SeqCst);
    }

    /// The signal of the request; `None` without a request.
    pub fn requested(&self) -> Option<i32> {
        match self.signal.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal),
        }
    }
}

/// Ends the process when its time is over.
fn end_late(signal: i32) {
    thread::sleep(MAX_STOP_TIME.saturating_sub(MESSAGE_TIME));
    let _ = thread::Builder::new().spawn(move || {
        eprintln!(
            "billow: stopped by signal {signal} before the end of its work; what was stored is kept, the \
             same command continues"
        );
    });
    thread::sleep(MESSAGE_TIME);
    // Not std::process::exit, which waits for libraries that another thread may be using.
    low_level::exit(128 + signal);
}

/// Whether this process ignores a signal. Other systems than Linux do not say.
fn is_ignored(signal: i32) -> bool {
    crate::platform::files::process_status().is_some_and(|status| ignores(&status, signal))
}

/// Whether the text of /proc/self/status (`proc_pid_status(5)`) has a signal in its mask of ignored ones.
fn ignores(status: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mask_of_ignored_signals_is_read() {
        let status = "Name:\tbillow\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\n";
        assert!(ignores(status, SIGHUP) && !ignores(status, SIGINT) && !ignores(status, SIGTERM));
        assert!(!ignores("Name:\tbillow\n", SIGHUP) && !ignores("SigIgn:\tx\n", SIGHUP));
    }
}
