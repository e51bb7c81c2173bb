//! A quantity over time, and the distance of two courses.
//!
//! ```text
//! d = √(∫ (f − g)² dt / ∫ g² dt)      over the common time, trapezoidal rule on the samples of g
//! ```

/// A quantity over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times, s, ascending.
    times: Vec<f64>,
    /// One value per time.
    values: Vec<f64>,
}

impl Course {
    /// A course; `None` unless it has two samples, equal lengths, ascending times and finite numbers.
    pub fn new(times: &[f64], values: &[f64]) -> Option<Self> {
        let finite = |list: &[f64]| list.iter().all(|number| number.is_finite());
        let ascending = times.windows(2).all(|pair| pair[0] < pair[1]);
        let valid = times.len() > 1 && times.len() == values.len();
        (valid && ascending && finite(times) && finite(values))
            .then(|| Self { times: times.to_vec(), values: values.to_vec() })
    }

    /// The value at a time, linear between samples; `None` outside.
    fn at(&self, time: f64) -> Option<f64> {
        let next = self.times.partition_point(|known| *known < time);
        if next == 0 {
            return (self.times[0] <= time).then(|| self.values[0]);
        }
        let (before, after) = (self.times[next - 1], *self.times.get(next)?);
        let part = (time - before) / (after - before);
        Some(self.values[next - 1] + part * (self.values[next] - self.values[next - 1]))
    }

    /// Relative distance of this course from another one; `None` without common time, or where the other one is
    /// zero.
    pub fn distance(&self, other: &Self) -> Option<f64> {
        let samples = other.times.iter().zip(&other.values);
        let common: Vec<[f64; 3]> = samples
            .filter_map(|(time, value)| {
                let difference = self.at(*time)? - value;
                Some([*time, difference * difference, value * value])
            })
            .collect();
        let integral = |of: usize| -> f64 {
            common
                .windows(2)
                .map(|pair| 0.5 * (pair[1][0] - pair[0][0]) * (pair[0][of] + pair[1][of]))
                .sum()
        };
        let (difference, norm) = (integral(1), integral(2));
        (norm > 0.0).then(|| (difference / norm).sqrt())
    }

    /// The mean of several courses at the samples of the first one, over their common time; `None` without any.
    pub fn mean(courses: &[&Self]) -> Option<Self> {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        for time in &courses.first()?.times {
            let here: Option<Vec<f64>> = courses.iter().map(|course| course.at(*time)).collect();
            if let Some(here) = here {
                times.push(*time);
                values.push(here.iter().sum::<f64>() / here.len() as f64);
            }
        }
        Self::new(&times, &values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(times: &[f64], of: impl Fn(f64) -> f64) -> Course {
        let values: Vec<f64> = times.iter().map(|time| of(*time)).collect();
        Course::new(times, &values).unwrap()
    }

    #[test]
    fn the_distance_of_a_shifted_line_is_that_of_its_integrals() {
        let fine: Vec<f64> = (0..=1000).map(|step| f64::from(step) * 1e-3).collect();
        let line = course(&fine, |t| t);
        // ∫ 0.01² dt / ∫ t² dt = 3e-4.
        let shifted = course(&[0.0, 0.5, 2.0], |t| t + 0.01);
        let distance = shifted.distance(&line).unwrap();
        assert!((distance - 3e-4_f64.sqrt()).abs() < 1e-6, "{distance}");
        assert_eq!(line.distance(&line), Some(0.0));
        assert_eq!(course(&[3.0, 4.0], |t| t).distance(&line), None, "no common time");
    }

    #[test]
    fn a_mean_spans_the_common_time() {
        let a = course(&[0.0, 1.0, 2.0], |t| t);
        let b = course(&[0.0, 1.5], |t| 3.0 * t);
        assert_eq!(Course::mean(&[&a, &b]).unwrap(), course(&[0.0, 1.0], |t| 2.0 * t));
        assert_eq!(Course::mean(&[]), None);
        assert_eq!(Course::new(&[0.0, 0.0], &[1.0, 1.0]), None);
    }
}
