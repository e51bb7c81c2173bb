//! Two threads for one job: what may be done at the same time, and by whom.
//!
//! The solver asks no machine how many threads there are: whoever starts a job hands it [`Workers`], which
//! are the caller alone or the caller and one helper. [`Workers::both`] does two things at once and comes
//! back when both are done. Whoever does them, the bits are those of doing one after the other: nothing
//! that is added up depends on who was faster.
//!
//! ```text
//!              caller                     helper
//! Free   →  Asked   puts an errand down
//!           Asked → Taken                 takes it up       (or the caller takes it back: → Free)
//!           Taken → Done                  has done it
//! Done   →  Free    has seen so
//! ```
//!
//! A step has errands of some microseconds, so the helper waits for the next by looking, not by sleeping;
//! where none comes for about a millisecond it sleeps. A caller that is ready before the helper took its
//! errand up does it by itself: on a machine that is busy elsewhere nobody waits for a thread that does
//! not run.

#![expect(unsafe_code, reason = "an errand lives on the caller's stack while the helper does it")]

use core::cell::UnsafeCell;
use core::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread::{self, JoinHandle, Thread};

/// The most threads a job has use for.
pub const MOST: usize = 2;

/// Looks at the desk before a thread lets others run, about 0.1 ms.
const LOOKS: u32 = 2_000;
/// Times it lets others run before it sleeps, about 1 ms where there are none.
const TURNS: u32 = 2_000;

const FREE: u8 = 0;
const ASKED: u8 = 1;
const TAKEN: u8 = 2;
const DONE: u8 = 3;
/// No more will come.
const CLOSED: u8 = 4;

/// The caller alone, or with a helper of its own.
#[derive(Default)]
pub struct Workers {
    helper: Option<Helper>,
}

struct Helper {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

/// Where errands lie.
struct Desk {
    state: AtomicU8,
    /// Whether the helper sleeps, or is about to.
    asleep: AtomicBool,
    /// Written by the caller while the desk is free, read by the helper once it has taken it.
    errand: UnsafeCell<Option<Errand>>,
}

/// What to call, and with what.
#[derive(Clone, Copy)]
struct Errand {
    call: unsafe fn(*mut ()),
    with: *mut (),
}

// SAFETY: `errand` is reached as its comment says, which the order of states keeps to one thread at a
// time; what it points to may be sent (`Workers::both` asks for it) and outlives the errand.
unsafe impl Sync for Desk {}
// SAFETY: as above.
unsafe impl Send for Desk {}

/// Something to do, then its end.
struct Job<F, B> {
    work: Option<F>,
    end: Option<thread::Result<B>>,
}

/// Does a job.
///
/// # Safety
/// `job` points to a `Job<F, B>` nobody else reaches meanwhile.
unsafe fn perform<F: FnOnce() -> B, B>(job: *mut ()) {
    // SAFETY: the caller's promise.
    let job = unsafe { &mut *job.cast::<Job<F, B>>() };
    if let Some(work) = job.work.take() {
        job.end = Some(catch_unwind(AssertUnwindSafe(work)));
    }
}

impl Workers {
    /// The caller alone.
    pub const fn alone() -> Self {
        Self { helper: None }
    }

    /// So many threads, the caller among them; [`MOST`] at most, and the caller alone where the system
    /// gives no other.
    pub fn of(threads: usize) -> Self {
        Self { helper: (threads >= MOST).then(Helper::start).flatten() }
    }

    /// How many threads they are.
    pub fn threads(&self) -> usize {
        1 + usize::from(self.helper.is_some())
    }

    /// Does both, `second` on another thread where there is one; what they give.
    ///
    /// # Panics
    /// With the panic of the first that panics, after both have ended.
    pub fn both<A, B: Send>(
        &mut self,
        first: impl FnOnce() -> A,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.helper {
            Some(helper) => helper.both(first, second),
            None => (first(), second()),
        }
    }
}

impl fmt::Debug for Workers {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Workers({})", self.threads())
    }
}

impl Helper {
    fn start() -> Option<Self> {
        let desk = Arc::new(Desk {
            state: AtomicU8::new(FREE),
            asleep: AtomicBool::new(false),
            errand: UnsafeCell::new(None),
        });
        let own = Arc::clone(&desk);
        let named = thread::Builder::new().name("billow-helper".to_owned());
        let thread = named.spawn(move || own.serve()).ok()?;
        Some(Self { desk, thread: Some(thread) })
    }

    fn thread(&self) -> Option<&Thread> {
        self.thread.as_ref().map(JoinHandle::thread)
    }

    fn both<A, F: FnOnce() -> B + Send, B: Send>(
        &self,
        first: impl FnOnce() -> A,
        second: F,
    ) -> (A, B) {
        let mut job = Job { work: Some(second), end: None };
        let job: *mut Job<F, B> = &raw mut job;
        let errand = Errand { call: perform::<F, B>, with: job.cast() };
        // SAFETY: the desk is free, since every errand is seen to its end below, and `Workers` is borrowed
        // for as long.
        unsafe { *self.desk.errand.get() = Some(errand) };
        self.desk.state.store(ASKED, Ordering::SeqCst);
        // Either this sees the helper asleep, or the helper, about to sleep, sees the errand.
        if self.desk.asleep.load(Ordering::SeqCst)
            && let Some(thread) = self.thread()
        {
            thread.unpark();
        }
        // Not before the helper is done may this frame be left.
        let one = catch_unwind(AssertUnwindSafe(first));
        if self.desk.take_back() {
            if one.is_ok() {
                // SAFETY: the helper has not taken it, and will not.
                unsafe { perform::<F, B>(job.cast()) };
            }
        } else {
            self.desk.wait();
        }
        // SAFETY: nobody else reaches the job any more.
        let other = unsafe { (*job).end.take() };
        match (one, other) {
            (Ok(one), Some(Ok(other))) => (one, other),
            (Err(panic), _) | (_, Some(Err(panic))) => resume_unwind(panic),
            (Ok(_), None) => unreachable!("both are done"),
        }
    }
}

impl Drop for Helper {
    fn drop(&mut self) {
        self.desk.state.store(CLOSED, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // It catches every panic of an errand, so it has none of its own.
            let _ = thread.join();
        }
    }
}

impl Desk {
    /// Takes an errand back nobody has begun; whether there was time.
    fn take_back(&self) -> bool {
        let swap = self.state.compare_exchange(ASKED, FREE, Ordering::AcqRel, Ordering::Acquire);
        swap.is_ok()
    }

    /// Until an errand taken up is done.
    fn wait(&self) {
        let mut looks = 0;
        while self.state.load(Ordering::Acquire) != DONE {
            looks += 1;
            if looks < LOOKS { core::hint::spin_loop() } else { thread::yield_now() }
        }
        self.state.store(FREE, Ordering::Release);
    }

    /// What the helper does all its life.
    fn serve(&self) {
        let mut looks = 0;
        loop {
            match self.state.load(Ordering::Acquire) {
                ASKED => {
                    looks = 0;
                    let swap = self.state.compare_exchange(
                        ASKED,
                        TAKEN,
                        Ordering::AcqRel,
                        Ordering::Acquire,
                    );
                    if swap.is_ok() {
                        // SAFETY: taken, so the caller has written it and leaves it alone.
                        if let Some(errand) = unsafe { *self.errand.get() } {
                            // SAFETY: the job outlives the errand, and the caller does not reach it.
                            unsafe { (errand.call)(errand.with) };
                        }
                        self.state.store(DONE, Ordering::Release);
                    }
                }
                CLOSED => return,
                _ if looks < LOOKS => {
                    looks += 1;
                    core::hint::spin_loop();
                }
                _ if looks < LOOKS + TURNS => {
                    looks += 1;
                    thread::yield_now();
                }
                _ => {
                    self.asleep.store(true, Ordering::SeqCst);
                    if !matches!(self.state.load(Ordering::SeqCst), ASKED | CLOSED) {
                        thread::park();
                    }
                    self.asleep.store(false, Ordering::SeqCst);
                    looks = 0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_done_whoever_there_is() {
        for threads in [0, 1, 2, 5] {
            let mut workers = Workers::of(threads);
            assert_eq!(workers.threads(), threads.clamp(1, MOST));
            let mut numbers = vec![0_u64; 1000];
            for round in 0..20_000 {
                let (low, high) = numbers.split_at_mut(500);
                let add = |part: &mut [u64]| {
                    for number in part.iter_mut() {
                        *number += round;
                    }
                    part.len()
                };
                assert_eq!(workers.both(|| add(low), || add(high)), (500, 500));
            }
            let sum: u64 = (0..20_000).sum();
            assert!(numbers.iter().all(|number| *number == sum), "{threads}");
        }
    }

    #[test]
    fn a_helper_that_sleeps_is_woken() {
        let mut workers = Workers::of(2);
        let helper = Arc::clone(&workers.helper.as_ref().unwrap().desk);
        for round in 0..3 {
            while !helper.asleep.load(Ordering::SeqCst) {
                thread::yield_now();
            }
            // The first waits for the second: only another thread can do that one.
            let begun = AtomicBool::new(false);
            let wait = || {
                while !begun.load(Ordering::SeqCst) {
                    core::hint::spin_loop();
                }
            };
            let own = thread::current().id();
            let tell = || {
                begun.store(true, Ordering::SeqCst);
                thread::current().id() != own
            };
            assert!(workers.both(wait, tell).1, "{round}");
        }
    }

    #[test]
    fn a_panic_of_either_comes_through_and_leaves_the_workers_sound() {
        let text = |panic: Box<dyn core::any::Any + Send>| *panic.downcast::<&str>().unwrap();
        for threads in [1, 2] {
            let mut workers = Workers::of(threads);
            for _ in 0..100 {
                let first = catch_unwind(AssertUnwindSafe(|| {
                    workers.both(|| resume_unwind(Box::new("one")), || ());
                }));
                assert_eq!(text(first.unwrap_err()), "one");
                let second = catch_unwind(AssertUnwindSafe(|| {
                    workers.both(|| (), || resume_unwind(Box::new("two")));
                }));
                assert_eq!(text(second.unwrap_err()), "two");
                assert_eq!(workers.both(|| 1, || 2), (1, 2));
            }
        }
    }
}
