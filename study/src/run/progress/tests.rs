//! The lines and bars of a run, event by event.

use std::io;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;
use billow_solver::output::outcome::FailureKind;
use indicatif::TermLike;

use super::lines::duration_text;
use super::*;
use crate::job::{JobId, Status};

fn events() -> Vec<Event> {
    let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
    let progress = Progress { time: 0.5, end_time: 2.0, z_centre: 0.3, pressure: 51.0 };
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
    let mut lines = Lines::new(Vec::new(), true);
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
    let mut lines = Lines::new(Vec::new(), false);
    let [started, _, job, sample, finished] = events().try_into().unwrap();
    lines.event(&started);
    lines.event(&job);
    lines.event(&sample);
    assert_eq!(String::from_utf8(lines.out.clone()).unwrap().lines().count(), 1, "not yet");
    // As if it had started 100 s ago: a quarter of the only open job is done.
    let long_ago = Instant::now().checked_sub(Duration::from_secs(100)).unwrap();
    lines.start = Some((long_ago, 3));
    lines.last = Some(long_ago);
    lines.event(&sample);
    lines.event(&sample);
    let written = String::from_utf8(lines.out.clone()).unwrap();
    let expected = "4 jobs, 3 finished, 1 to run\n\
                    3 of 4 jobs finished, 0 failed, about 5 min remaining\n\
                    \x20 abababab N=5 M=2  t 0.5000 of 2 s  z_centre 0.300 m  p 51.0000 Pa\n";
    assert_eq!(written, expected, "one report, not one per sample");
    lines.event(&finished);
    assert!(lines.running.is_empty());
    assert_eq!(duration_text(Duration::from_secs(7_300)), "2.0 h");
}

#[test]
fn a_study_without_jobs_to_run_writes_no_line() {
    let mut lines = Lines::new(Vec::new(), false);
    lines.event(&Event::GenerationStarted { number: 0, jobs: 4, finished: 4 });
    lines.event(&Event::Ended);
    assert!(lines.out.is_empty());
}

/// A terminal that keeps everything that was written to it.
#[derive(Debug, Clone, Default)]
struct Screen(Arc<Mutex<String>>);

impl TermLike for Screen {
    fn width(&self) -> u16 {
        100
    }

    fn move_cursor_up(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.write_str(&format!("{text}\n"))
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.0.lock().unwrap().push_str(text);
        Ok(())
    }

    fn clear_line(&self) -> io::Result<()> {
        self.write_str("<clear>")
    }

    fn flush(&self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn bars_show_the_study_and_the_running_job_and_are_cleared() {
    let screen = Screen::default();
    let target = ProgressDrawTarget::term_like(Box::new(screen.clone()));
    let mut bars = Bars::new(target, false, false);
    for event in events() {
        bars.event(&event);
    }
    bars.study.force_draw();
    bars.jobs[1].force_draw();
    let text = screen.0.lock().unwrap().clone();
    assert!(text.contains("note: a line is torn"), "{text}");
    assert!(text.contains("4/4 jobs  1 failed"), "{text}");
    assert!(text.contains("abababab N=5 M=2  t 0.500 s  z 0.300 m  p 51.0000 Pa"), "{text}");
    assert!(!text.contains('\x1b'), "no colour was asked for");
    bars.event(&Event::Ended);
    assert!(screen.0.lock().unwrap().ends_with("<clear>"));
}
