//! Progress bars on a terminal: one for the study, one for every running job.

use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{JobCounts, finished_line};
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
    counts: JobCounts,
}

impl Bars {
    pub(super) fn new(target: ProgressDrawTarget, colour: bool, verbose: bool) -> Self {
        let (bar, job) = if colour {
            ("{bar:30.cyan/blue}", "  {bar:12.green/black} {msg}")
        } else {
            ("{bar:30}", "  {bar:12} {msg}")
        };
        let study =
            format!("{bar} {{pos}}/{{len}} jobs  {{msg}}  {{elapsed}} elapsed, {{eta}} remaining");
        let all = MultiProgress::with_draw_target(target);
        let bar = all.add(ProgressBar::new(0).with_style(style(&study)));
        bar.enable_steady_tick(REDRAW_INTERVAL);
        Self {
            all,
            study: bar,
            jobs: Vec::new(),
            job_style: style(job),
            verbose,
            counts: JobCounts::default(),
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
        self.counts.add(event);
        match event {
            Event::GenerationStarted { .. } => {
                self.study.set_length(self.counts.jobs as u64);
                self.study.set_position(self.counts.finished as u64);
                // Jobs of an earlier run do not enter the estimate of the remaining time.
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
                self.study.set_position(self.counts.finished as u64);
                self.study.set_message(format!("{} failed", self.counts.failed));
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
