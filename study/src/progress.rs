//! How a run shows on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::event::{Event, Reporter};
use crate::row;

/// Least time between two plain lines about jobs.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// How much is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loudness {
    /// Nothing but errors.
    Quiet,
    /// Where the study stands.
    Normal,
    /// Every job as it ends, too.
    Verbose,
}

/// The reporter for where stderr goes.
pub fn reporter(loudness: Loudness) -> Box<dyn Reporter> {
    if loudness == Loudness::Quiet {
        return Box::new(crate::event::Silent);
    }
    let verbose = loudness == Loudness::Verbose;
    if io::stderr().is_terminal() {
        let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Box::new(Bars::new(ProgressDrawTarget::stderr(), colour, verbose))
    } else {
        Box::new(Lines::new(io::stderr(), verbose))
    }
}

/// How far a study is.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    jobs: usize,
    finished: usize,
    failed: usize,
}

impl Tally {
    fn hear(&mut self, event: &Event) {
        match event {
            Event::GenerationStarted { jobs, finished, .. } => {
                self.jobs += jobs;
                self.finished += finished;
            }
            Event::JobFinished { status, .. } => {
                self.finished += 1;
                self.failed += usize::from(row::is_failure(status));
            }
            _ => {}
        }
    }
}

fn finished_line(event: &Event) -> Option<String> {
    let Event::JobFinished { id, status, verdict, .. } = event else { return None };
    let verdict = verdict.as_ref().map(|verdict| format!(", {verdict}")).unwrap_or_default();
    Some(format!("{} {status}{verdict}", id.short()))
}

/// Plain lines, for logs and pipes.
struct Lines<W> {
    out: W,
    verbose: bool,
    tally: Tally,
    last: Option<Instant>,
}

impl<W: Write> Lines<W> {
    fn new(out: W, verbose: bool) -> Self {
        Self { out, verbose, tally: Tally::default(), last: None }
    }

    fn line(&mut self, text: &str) {
        // A stderr that is gone is no reason to stop a study.
        let _ = writeln!(self.out, "{text}");
    }
}

impl<W: Write> Reporter for Lines<W> {
    fn event(&mut self, event: &Event) {
        self.tally.hear(event);
        let Tally { jobs, finished, failed } = self.tally;
        match event {
            Event::GenerationStarted { .. } if finished < jobs => {
                self.line(&format!("{jobs} jobs, {finished} finished, {} to run", jobs - finished));
                self.last = Some(Instant::now());
            }
            Event::JobFinished { .. } => {
                if self.verbose
                    && let Some(text) = finished_line(event)
                {
                    self.line(&text);
                }
                if finished == jobs || self.last.is_some_and(|last| last.elapsed() >= LINE_INTERVAL)
                {
                    self.line(&format!("{finished} of {jobs} jobs finished, {failed} failed"));
                    self.last = Some(Instant::now());
                }
            }
            Event::Note(text) => self.line(&format!("note: {text}")),
            _ => {}
        }
    }
}

/// One bar for the study, one for every running job.
struct Bars {
    all: MultiProgress,
    study: ProgressBar,
    jobs: Vec<ProgressBar>,
    job_style: ProgressStyle,
    verbose: bool,
    tally: Tally,
}

/// Steps of a job's bar.
const JOB_STEPS: u64 = 1000;

impl Bars {
    fn new(target: ProgressDrawTarget, colour: bool, verbose: bool) -> Self {
        let (study, job) = if colour {
            (
                "{bar:30.cyan/blue} {pos}/{len} jobs  {msg}  {elapsed} gone, {eta} left",
                "  {bar:12.green/black} {msg}",
            )
        } else {
            ("{bar:30} {pos}/{len} jobs  {msg}  {elapsed} gone, {eta} left", "  {bar:12} {msg}")
        };
        let all = MultiProgress::with_draw_target(target);
        let bar = all.add(ProgressBar::new(0).with_style(style(study)));
        bar.enable_steady_tick(Duration::from_millis(250));
        Self {
            all,
            study: bar,
            jobs: Vec::new(),
            job_style: style(job),
            verbose,
            tally: Tally::default(),
        }
    }

    fn job(&mut self, thread: usize) -> &ProgressBar {
        while self.jobs.len() <= thread {
            let bar = ProgressBar::new(JOB_STEPS).with_style(self.job_style.clone());
            self.jobs.push(self.all.add(bar));
        }
        &self.jobs[thread]
    }

    fn line(&self, text: &str) {
        let _ = self.all.println(text);
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

impl Reporter for Bars {
    fn event(&mut self, event: &Event) {
        self.tally.hear(event);
        match event {
            Event::GenerationStarted { .. } => {
                self.study.set_length(self.tally.jobs as u64);
                self.study.set_position(self.tally.finished as u64);
                // The jobs of an earlier run say nothing about the time left.
                self.study.reset_eta();
            }
            Event::JobStarted { id, label, thread } => {
                let bar = self.job(*thread);
                bar.set_position(0);
                bar.set_prefix(format!("{} {label}", id.short()));
                bar.set_message(bar.prefix());
            }
            Event::JobSample { thread, progress } => {
                let part = (progress.time / progress.end_time).clamp(0.0, 1.0);
                let bar = self.job(*thread);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "between 0 and JOB_STEPS"
                )]
                bar.set_position((part * JOB_STEPS as f64) as u64);
                bar.set_message(format!(
                    "{}  t {:.3} s  z {:.3} m  p {:.4} Pa",
                    bar.prefix(),
                    progress.time,
                    progress.z_centre,
                    progress.pressure
                ));
            }
            Event::JobFinished { .. } => {
                self.study.set_position(self.tally.finished as u64);
                self.study.set_message(format!("{} failed", self.tally.failed));
                if self.verbose
                    && let Some(text) = finished_line(event)
                {
                    self.line(&text);
                }
            }
            Event::Note(text) => self.line(&format!("note: {text}")),
            Event::Ended => {
                self.jobs.iter().for_each(ProgressBar::finish_and_clear);
                self.study.finish_and_clear();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use billow_solver::deployment::Progress;
    use indicatif::TermLike;

    use super::*;
    use crate::job::JobId;

    fn events() -> Vec<Event> {
        let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
        let progress = Progress { time: 0.5, end_time: 2.0, z_centre: 0.3, pressure: 51.0 };
        vec![
            Event::GenerationStarted { number: 0, jobs: 4, finished: 3 },
            Event::Note("a line is torn".to_owned()),
            Event::JobStarted { id: id.clone(), label: "N=5 M=2".to_owned(), thread: 1 },
            Event::JobSample { thread: 1, progress },
            Event::JobFinished { id, thread: 1, status: "unstable".to_owned(), verdict: None },
        ]
    }

    #[test]
    fn lines_say_where_the_study_stands() {
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
    fn nothing_to_run_is_no_line() {
        let mut lines = Lines::new(Vec::new(), false);
        lines.event(&Event::GenerationStarted { number: 0, jobs: 4, finished: 4 });
        lines.event(&Event::Ended);
        assert!(lines.out.is_empty());
    }

    /// A terminal that remembers all that was ever written to it.
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
    fn bars_show_the_study_and_the_running_job_and_then_go_away() {
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
}
