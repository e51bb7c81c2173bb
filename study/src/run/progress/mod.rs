//! How a run shows on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::input::value::short_number;
use crate::job::row;
use crate::run::event::{Event, Reporter};

/// Least time between two plain lines about where a study stands.
const LINE_INTERVAL: Duration = Duration::from_secs(5);
/// The same once it has run for long.
const LONGEST_INTERVAL: Duration = Duration::from_mins(1);
/// Running jobs told of in plain lines.
const SHOWN: usize = 8;

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
        return Box::new(crate::run::event::Silent);
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

/// Plain lines, for logs and pipes: every now and then where the study and its running jobs stand.
struct Lines<W> {
    out: W,
    verbose: bool,
    tally: Tally,
    /// When jobs began to run, and how many were finished then.
    start: Option<(Instant, usize)>,
    last: Option<Instant>,
    /// Running jobs: thread, name, where each stands.
    running: BTreeMap<usize, (String, Option<Progress>)>,
}

impl<W: Write> Lines<W> {
    fn new(out: W, verbose: bool) -> Self {
        let running = BTreeMap::new();
        Self { out, verbose, tally: Tally::default(), start: None, last: None, running }
    }

    fn line(&mut self, text: &str) {
        // A stderr that is gone is no reason to stop a study.
        let _ = writeln!(self.out, "{text}");
    }

    /// Whether it is time for a line: seldom in a long run, so that a log stays short.
    fn due(&self) -> bool {
        let Some((start, _)) = self.start else { return false };
        let interval = (start.elapsed() / 20).clamp(LINE_INTERVAL, LONGEST_INTERVAL);
        self.last.is_some_and(|last| last.elapsed() >= interval)
    }

    /// Where the study stands, how long it may take, and where the running jobs are.
    fn tell(&mut self) {
        let Tally { jobs, finished, failed } = self.tally;
        let mut text = format!("{finished} of {jobs} jobs finished, {failed} failed");
        if let Some(left) = self.left() {
            let _ = write!(text, ", about {} left", told(left));
        }
        self.line(&text);
        let standing: Vec<String> =
            self.running.values().take(SHOWN).filter_map(standing).collect();
        for text in standing {
            self.line(&text);
        }
        if self.running.len() > SHOWN {
            self.line(&format!("  and {} more jobs running", self.running.len() - SHOWN));
        }
        self.last = Some(Instant::now());
    }

    /// Time left, from what was done since the start, running jobs by their share of simulated
    /// time; none until that says something.
    fn left(&self) -> Option<Duration> {
        let (start, before) = self.start?;
        let shares = self.running.values().filter_map(|(_, progress)| *progress);
        let running: f64 = shares.map(|own| (own.time / own.end_time).clamp(0.0, 1.0)).sum();
        let done = (self.tally.finished - before) as f64 + running;
        let open = (self.tally.jobs - self.tally.finished) as f64 - running;
        let known = done > 0.01 && open > 0.0;
        let seconds = start.elapsed().as_secs_f64() * open / done;
        known.then(|| Duration::try_from_secs_f64(seconds).ok()).flatten()
    }
}

/// A running job as a line; nothing while it has told nothing.
fn standing((name, progress): &(String, Option<Progress>)) -> Option<String> {
    let own = (*progress)?;
    // Before its first step: the static states of a fine mesh take a while.
    if own.time <= 0.0 {
        return Some(format!(
            "  {name}  gets ready: its mesh, the static states it is judged against"
        ));
    }
    Some(format!(
        "  {name}  t {:.4} of {} s  z_centre {:.3} m  p {:.4} Pa",
        own.time,
        short_number(own.end_time),
        own.z_centre,
        own.pressure
    ))
}

/// A duration in its largest sensible unit.
fn told(duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..120 => format!("{} s", seconds.max(1)),
        seconds @ 120..7200 => format!("{} min", (seconds + 30) / 60),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

impl<W: Write> Reporter for Lines<W> {
    fn event(&mut self, event: &Event) {
        self.tally.hear(event);
        let Tally { jobs, finished, .. } = self.tally;
        match event {
            Event::GenerationStarted { .. } if finished < jobs => {
                self.line(&format!("{jobs} jobs, {finished} finished, {} to run", jobs - finished));
                let now = Instant::now();
                self.start.get_or_insert((now, finished));
                self.last = Some(now);
            }
            Event::JobStarted { id, label, thread } => {
                self.running.insert(*thread, (format!("{} {label}", id.short()), None));
            }
            Event::JobSample { thread, progress } => {
                if let Some((_, own)) = self.running.get_mut(thread) {
                    *own = Some(*progress);
                }
                if self.due() {
                    self.tell();
                }
            }
            Event::JobFinished { thread, .. } => {
                self.running.remove(thread);
                if self.verbose
                    && let Some(text) = finished_line(event)
                {
                    self.line(&text);
                }
                if finished == jobs || self.due() {
                    self.tell();
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
mod tests;
