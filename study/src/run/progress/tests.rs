//! The lines of a run, event by event.

use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;
use billow_solver::output::outcome::FailureKind;

use super::work::duration_text;
use super::*;
use crate::job::{JobId, Status};

fn events() -> Vec<Event> {
    let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
    let progress = Progress { time: 0.5, end_time: 2.0, height: 0.3, pressure: 51.0 };
    vec![
        Event::GenerationStarted { number: 0, jobs: 4, finished: 3 },
        Event::Note("a line is torn".to_owned()),
        Event::JobStarted { id: id.clone(), label: "N=5 M=2".to_owned(), thread: 1 },
        Event::JobSample { thread: 1, progress },
        Event::JobFinished {
            id,
            thread: 1,
            status: Status::Failed(FailureKind::Unstable),
            verdict: None,
        },
    ]
}

#[test]
fn lines_report_the_progress_of_the_study() {
    let mut lines = Lines::new(Vec::new(), true, None, NonZero::new(1));
    for event in events() {
        lines.event(&event);
    }
    lines.event(&Event::Ended);
    let expected = "4 jobs, 3 finished, 1 to run\nnote: a line is torn\nabababab unstable\n\
                    4 of 4 jobs finished, 1 failed\n";
    assert_eq!(String::from_utf8(lines.out).unwrap(), expected);
}

#[test]
fn a_long_job_is_reported_from_time_to_time_with_the_remaining_time() {
    let mut lines = Lines::new(Vec::new(), false, None, NonZero::new(1));
    let [started, _, job, sample, finished] = events().try_into().unwrap();
    lines.event(&started);
    lines.event(&job);
    lines.event(&sample);
    assert_eq!(String::from_utf8(lines.out.clone()).unwrap().lines().count(), 1, "not yet");
    // As if it had started 100 s ago: a quarter of the only open job is done.
    let long_ago = Instant::now().checked_sub(Duration::from_secs(100)).unwrap();
    lines.work.start = Some((long_ago, 3));
    lines.last = Some(long_ago);
    lines.event(&sample);
    lines.event(&sample);
    let written = String::from_utf8(lines.out.clone()).unwrap();
    let expected = "4 jobs, 3 finished, 1 to run\n\
                    3 of 4 jobs finished, 0 failed, about 5 min remaining\n\
                    \x20 abababab  t 0.500 of 2 s  height 0.300 m  pressure 51 Pa  N=5 M=2\n";
    assert_eq!(written, expected, "one report, not one per sample");
    lines.event(&finished);
    assert!(lines.work.running.is_empty());
    assert_eq!(duration_text(Duration::from_secs(7_300)), "2.0 h");
}

#[test]
fn a_study_without_jobs_to_run_writes_no_line() {
    let mut lines = Lines::new(Vec::new(), false, None, NonZero::new(1));
    lines.event(&Event::GenerationStarted { number: 0, jobs: 4, finished: 4 });
    lines.event(&Event::Ended);
    assert!(lines.out.is_empty());
}

#[test]
fn a_terminal_has_a_bar_and_keeps_the_other_lines() {
    let mut lines = Lines::new(Vec::new(), true, Some(hidden_bar()), NonZero::new(1));
    let bar = lines.bar.clone().unwrap();
    let [started, note, job, sample, finished] = events().try_into().unwrap();
    for event in [started, note, job, sample] {
        lines.event(&event);
    }
    assert_eq!((bar.position(), bar.length()), (3, Some(4)));
    let running = "3 of 4 jobs finished, 0 failed; abababab  t 0.500 of 2 s  height 0.300 m";
    assert!(bar.message().starts_with(running), "{}", bar.message());
    lines.event(&finished);
    assert_eq!(bar.position(), 4);
    assert_eq!(bar.message(), "4 of 4 jobs finished, 1 failed");
    let expected = "4 jobs, 3 finished, 1 to run\nnote: a line is torn\nabababab unstable\n";
    assert_eq!(String::from_utf8(lines.out).unwrap(), expected);
}

#[test]
fn the_remaining_time_is_that_of_the_threads_of_the_run() {
    let started = Event::GenerationStarted { number: 0, jobs: 10, finished: 0 };
    let finished = |thread: usize| Event::JobFinished {
        id: JobId::from_digits(&"ab".repeat(16)).unwrap(),
        thread,
        status: Status::Done,
        verdict: None,
    };
    // Eight jobs in 40 s: one thread needs 5 s for one, four threads 20 s.
    for (threads, jobs_done, seconds) in [(1, 8, 10), (4, 8, 20), (4, 9, 17), (2, 5, 40)] {
        let mut work = work::Work::new(NonZero::new(threads));
        work.add(&started);
        assert_eq!(work.remaining_time(), None, "nothing has run yet");
        (0..jobs_done).for_each(|_| work.add(&finished(0)));
        assert_eq!(work.remaining_time(), None, "no time has passed yet");
        work.start = Some((Instant::now().checked_sub(Duration::from_secs(40)).unwrap(), 0));
        assert_eq!(work.summary().contains("of core time"), threads > 1 && jobs_done < 9);
        let remaining = work.remaining_time().unwrap().as_secs();
        assert!(remaining.abs_diff(seconds) <= 1, "{threads} {jobs_done}: {remaining} s");
    }
}
