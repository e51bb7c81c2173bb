//! Memory of the running jobs: each reserves its estimate before it starts, and waits while the others hold
//! too much.
//!
//! Jobs start in the order in which they ask, so a large one never waits without end. A job that fits
//! alone always starts: at the latest when no other runs. No result depends on the order.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::platform::memory::{self, Limit};

/// Time without a check of the stop request, at most. Chosen: a stop is noticed within 0.1 s.
const MAX_WAIT: Duration = Duration::from_millis(50);

/// The memory that the jobs of a run share.
#[derive(Debug)]
pub struct Reservations {
    /// What limits it; `None` if the system reports no limit.
    limit: Option<Limit>,
    /// What jobs may use together, bytes.
    usable: u64,
    state: Mutex<State>,
    released: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// Reserved bytes.
    reserved: u64,
    /// Number of the next job that asks.
    next: u64,
    /// Numbers of the jobs that wait, in the order in which they asked.
    waiting: VecDeque<u64>,
}

/// The reserved memory of jobs, released on drop.
#[derive(Debug)]
pub struct Reservation {
    reservations: Arc<Reservations>,
    bytes: u64,
}

impl Reservations {
    /// The memory that the smallest of these limits leaves to jobs on this number of threads.
    pub fn of(limits: &[Limit], threads: usize) -> Arc<Self> {
        let limit = memory::smallest(limits, threads);
        let usable = limit.map_or(u64::MAX, |limit| limit.usable(threads));
        Arc::new(Self { limit, usable, state: Mutex::default(), released: Condvar::new() })
    }

    /// The limit that a job of this estimate (bytes) exceeds even alone.
    pub fn refuses(&self, bytes: u64) -> Option<Limit> {
        self.limit.filter(|_| bytes > self.usable)
    }

    /// Reserves memory (bytes; at most all that is usable). Waits while others hold too much; `None` when
    /// `ending` returns `true`.
    pub fn reserve(self: &Arc<Self>, bytes: u64, ending: &dyn Fn() -> bool) -> Option<Reservation> {
        let bytes = bytes.min(self.usable);
        let mut state = self.state();
        let number = state.next;
        state.next += 1;
        state.waiting.push_back(number);
        loop {
            if ending() {
                state.waiting.retain(|waiting| *waiting != number);
                self.released.notify_all();
                return None;
            }
            let first = state.waiting.front() == Some(&number);
            if first && bytes <= self.usable - state.reserved {
                state.waiting.pop_front();
                state.reserved += bytes;
                self.released.notify_all();
                return Some(Reservation { reservations: Arc::clone(self), bytes });
            }
            let waited = self.released.wait_timeout(state, MAX_WAIT);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.reservations.state().reserved -= self.bytes;
        self.reservations.released.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
    use std::thread;
    use std::time::Instant;

    use super::*;
    use crate::platform::memory::LimitKind;

    fn reservations(usable: u64) -> Arc<Reservations> {
        let limit = Limit { kind: LimitKind::ControlGroup, total: 700_000_000, free: 0 };
        let (state, released) = (Mutex::default(), Condvar::new());
        Arc::new(Reservations { limit: Some(limit), usable, state, released })
    }

    #[test]
    fn jobs_never_hold_more_than_is_usable_and_all_of_them_run() {
        let all = reservations(100);
        let (held, largest, ran) = (AtomicU64::new(0), AtomicU64::new(0), AtomicUsize::new(0));
        thread::scope(|scope| {
            for worker in 0..8_u64 {
                let (all, held, largest, ran) = (&all, &held, &largest, &ran);
                scope.spawn(move || {
                    for job in 0..50 {
                        // Also jobs that fit alone only.
                        let bytes =
                            if job % 10 == worker { 100 } else { 1 + (7 * job + worker) % 60 };
                        let reserved = all.reserve(bytes, &|| false).unwrap();
                        let now = held.fetch_add(bytes, Ordering::SeqCst) + bytes;
                        largest.fetch_max(now, Ordering::SeqCst);
                        thread::yield_now();
                        held.fetch_sub(bytes, Ordering::SeqCst);
                        drop(reserved);
                        ran.fetch_add(1, Ordering::SeqCst);
                    }
                });
            }
        });
        assert_eq!(ran.into_inner(), 400);
        assert!((61..=100).contains(&largest.into_inner()));
        assert_eq!(all.state().reserved, 0);
    }

    #[test]
    fn a_large_job_is_not_overtaken() {
        let all = reservations(100);
        let small = all.reserve(50, &|| false).unwrap();
        let large_runs = AtomicBool::new(false);
        thread::scope(|scope| {
            scope.spawn(|| {
                let _large = all.reserve(100, &|| false).unwrap();
                large_runs.store(true, Ordering::SeqCst);
            });
            while all.state().waiting.is_empty() {
                thread::yield_now();
            }
            // This one would fit now, but the large one asked first.
            scope.spawn(|| {
                let _later = all.reserve(10, &|| false).unwrap();
                assert!(large_runs.load(Ordering::SeqCst));
            });
            while all.state().waiting.len() < 2 {
                thread::yield_now();
            }
            drop(small);
        });
    }

    #[test]
    fn what_never_fits_is_refused_at_once_and_a_stop_ends_the_wait() {
        let all = reservations(100);
        assert_eq!(all.refuses(101), all.limit);
        assert_eq!(all.refuses(100), None);
        let _held = all.reserve(60, &|| false).unwrap();
        let start = Instant::now();
        let ending = || start.elapsed() > Duration::from_millis(20);
        assert!(all.reserve(60, &ending).is_none());
        assert!(start.elapsed() < Duration::from_millis(500));
        // The stopped job holds up no other.
        assert!(all.reserve(40, &|| false).is_some());
        assert_eq!(Reservations::of(&[], 1).refuses(u64::MAX), None);
    }
}
