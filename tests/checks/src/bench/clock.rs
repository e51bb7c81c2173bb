//! The stopwatch of the bench: wall time of each stage of a step.

use std::time::{Duration, Instant};

use billow_solver::platform::stopwatch::{Stage, Stopwatch};

/// Total time of each stage.
#[derive(Debug, Default)]
pub struct Clock {
    totals: [Duration; Stage::ALL.len()],
    running: Option<(Stage, Instant)>,
}

impl Clock {
    /// Ends the running stage; none follows.
    pub fn stop(&mut self) {
        self.add(Instant::now());
        self.running = None;
    }

    /// Total time of a stage so far, s.
    pub fn seconds(&self, stage: Stage) -> f64 {
        self.totals[stage as usize].as_secs_f64()
    }

    fn add(&mut self, now: Instant) {
        if let Some((stage, since)) = self.running {
            self.totals[stage as usize] += now - since;
        }
    }
}

impl Stopwatch for Clock {
    fn begins(&mut self, stage: Stage) {
        let now = Instant::now();
        self.add(now);
        self.running = Some((stage, now));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_lasts_until_the_next_begins() {
        let mut clock = Clock::default();
        let start = Instant::now();
        clock.begins(Stage::Membrane);
        std::thread::sleep(Duration::from_millis(3));
        clock.begins(Stage::Audit);
        clock.begins(Stage::Membrane);
        std::thread::sleep(Duration::from_millis(2));
        clock.stop();
        let whole = start.elapsed().as_secs_f64();
        std::thread::sleep(Duration::from_millis(2));
        clock.stop();
        let membrane = clock.seconds(Stage::Membrane);
        assert!((5e-3..=whole).contains(&membrane), "{membrane} of {whole}");
        let all: f64 = Stage::ALL.into_iter().map(|stage| clock.seconds(stage)).sum();
        assert!(
            all <= whole && Stage::ALL.iter().all(|stage| (*stage as usize) < Stage::ALL.len())
        );
        assert!(clock.seconds(Stage::Search).abs() < f64::EPSILON);
    }
}
