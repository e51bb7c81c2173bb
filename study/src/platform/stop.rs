//! Early stop: the first Ctrl-C or SIGTERM ends a run in order, the third one at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

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

    /// Requests a stop at SIGINT or SIGTERM. The second signal changes nothing: it often is the first
    /// one again, sent to the process and to its group. The third one ends the program at once; only
    /// the running jobs and the newest table are lost then.
    ///
    /// # Errors
    /// When the system refuses the signal handlers or the thread that waits for signals.
    pub fn on_signals() -> io::Result<Self> {
        let stop = Self::new();
        let mut signals = Signals::new([SIGINT, SIGTERM])?;
        let request = stop.clone();
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            for (earlier, signal) in signals.forever().enumerate() {
                match earlier {
                    0 => request.request(signal),
                    1 => eprintln!("billow: stopping; another signal ends the program at once"),
                    _ => std::process::exit(128 + signal),
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
