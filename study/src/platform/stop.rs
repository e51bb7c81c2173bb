//! Stopping early: Ctrl-C and SIGTERM end a run in order, a third one on the spot.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// Whether to stop, and for which signal.
#[derive(Debug, Clone, Default)]
pub struct Stop {
    signal: Arc<AtomicI32>,
}

impl Stop {
    /// Nothing asks to stop yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks to stop when SIGINT or SIGTERM comes. The second one changes nothing: it often is the
    /// first one over again, sent to the process and to its group. The third one ends the program on
    /// the spot, which costs the running jobs and the newest table, nothing else.
    ///
    /// # Errors
    /// When the system refuses the handlers or the thread that waits for signals.
    pub fn on_signals() -> io::Result<Self> {
        let stop = Self::new();
        let mut signals = Signals::new([SIGINT, SIGTERM])?;
        let asked = stop.clone();
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            for (earlier, signal) in signals.forever().enumerate() {
                match earlier {
                    0 => asked.request(signal),
                    1 => eprintln!("billow: stopping; once more ends it on the spot"),
                    _ => std::process::exit(128 + signal),
                }
            }
        })?;
        Ok(stop)
    }

    /// Asks to stop, as that signal would.
    pub fn request(&self, signal: i32) {
        self.signal.store(signal, Ordering::SeqCst);
    }

    /// The signal that asked to stop.
    pub fn requested(&self) -> Option<i32> {
        match self.signal.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal),
        }
    }
}
