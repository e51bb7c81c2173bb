//! Progress bars on a terminal: one for the study, one for every running job. Every line is cut to the
//! width of the terminal.

use std::num::NonZero;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::finished_line;
use super::work::Work;
use crate::run::event::{Event, Reporter};

/// Steps of the bar of a job.
const JOB_STEPS: u64 = 1000;
/// Time between two redraws of the elapsed time.
const REDRAW_INTERVAL: Duration = Duration::from_millis(250);

/// Draws progress bars.
pub(super) struct Bars {
    all: MultiProgress,
    pub(super) study: ProgressBar,
    /// Bars of running jobs, by thread.
    pub(super) jobs: Vec<ProgressBar>,
    job_style: ProgressStyle,
    verbose: bool,
    pub(super) work: Work,
}

impl Bars {
    pub(super) fn new(
        target: ProgressDrawTarget,
        colour: bool,
        verbose: bool,
        threads: Option<NonZero<usize>>,
    ) -> Self {
        let (bar, job) = if colour {
            ("{bar:12.cyan/blue}", "{bar:12.green/black} {wide_msg}")
        } else {
            ("{bar:12}", "{bar:12} {wide_msg}")
        };
        let all = MultiProgress::with_draw_target(target);
        let study = style(&format!("{bar} {{elapsed}} elapsed, {{wide_msg}}"));
        let bar = all.add(ProgressBar::new(0).with_style(study));
        bar.enable_steady_tick(REDRAW_INTERVAL);
        Self {
            all,
            study: bar,
            jobs: Vec::new(),
            job_style: style(job),
            verbose,
            work: Work::new(threads),
        }
    }

    fn job(&mut self, thread: usize) -> &ProgressBar {
        while self.jobs.len() <= thread {
            let bar = ProgressBar::new(JOB_STEPS).with_style(self.job_style.clone());
            self.jobs.push(self.all.add(bar));
        }
        &self.jobs[thread]
    }

    /// Draws the running job of a thread; a thread without one has an empty line.
    fn draw_job(&mut self, thread: usize) {
        let job = self.work.running.get(&thread);
        let (part, text) = job.map_or((0.0, String::new()), |job| (job.part(), job.text()));
        let bar = self.job(thread);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and JOB_STEPS"
        )]
        bar.set_position((part * JOB_STEPS as f64) as u64);
        bar.set_message(text);
    }

    fn draw_study(&self) {
        self.study.set_length(self.work.jobs as u64);
        self.study.set_position(self.work.finished as u64);
        self.study.set_message(self.work.summary());
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
        self.work.add(event);
        match event {
            Event::GenerationStarted { .. } => self.draw_study(),
            Event::JobStarted { thread, .. } => self.draw_job(*thread),
            Event::JobSample { thread, .. } => {
                self.draw_job(*thread);
                self.draw_study();
            }
            Event::JobFinished { thread, .. } => {
                self.draw_job(*thread);
                self.draw_study();
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
