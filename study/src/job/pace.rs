//! How many steps a run takes until it is asked again whether it goes on.

use std::time::{Duration, Instant};

/// Time between two questions. Chosen: short against the 2 s in which a signal ends the program, long
/// against the cost of a question.
const TARGET: Duration = Duration::from_millis(50);

/// Adapts the number of steps to about 50 ms of wall time. No result depends on it.
#[derive(Debug, Clone)]
pub struct Pace {
    steps: u64,
    asked: Instant,
}

impl Pace {
    /// Starts with one step, whose cost is not known yet.
    pub fn new() -> Self {
        Self { steps: 1, asked: Instant::now() }
    }

    /// Number of steps until the next question.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Notes a question, and adapts the number of steps to the time since the last one.
    pub fn asked(&mut self) {
        self.adapt(self.asked.elapsed());
        self.asked = Instant::now();
    }

    fn adapt(&mut self, elapsed: Duration) {
        if elapsed < TARGET / 2 {
            self.steps = self.steps.saturating_mul(2);
        } else if elapsed > 2 * TARGET {
            self.steps = (self.steps / 2).max(1);
        }
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_steps_approaches_the_target_from_both_sides() {
        for microseconds_per_step in [1, 30, 700, 40_000, 900_000] {
            let mut pace = Pace::new();
            let step = Duration::from_micros(microseconds_per_step);
            for _ in 0..40 {
                pace.adapt(step * u32::try_from(pace.steps()).unwrap());
            }
            let elapsed = step * u32::try_from(pace.steps()).unwrap();
            let near = (TARGET / 2..=2 * TARGET).contains(&elapsed);
            assert!(near || pace.steps() == 1, "{microseconds_per_step} us: {elapsed:?}");
        }
    }
}
