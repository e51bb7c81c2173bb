//! Which jobs of a plan a run takes.
//!
//! ```text
//! part k of n    job i of the plan (from 0, without infeasible points and repeated jobs) if i mod n = k - 1
//! ```
//!
//! Neighbours in a plan differ in one parameter, so every part has cheap and expensive jobs.

/// The jobs that a run takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Selection {
    /// All of them.
    #[default]
    All,
    /// One part of several.
    Part(Part),
}

impl Selection {
    /// Whether a run takes the job of this number in its generation, from 0.
    pub fn takes(self, number: usize) -> bool {
        match self {
            Self::All => true,
            Self::Part(part) => part.takes(number),
        }
    }
}

/// One part of the jobs of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Its number, from 1.
    number: usize,
    /// Number of parts.
    parts: usize,
}

impl Part {
    /// Reads "2/8": part 2 of 8. `None` for other text, and where there is no such part.
    pub fn parse(text: &str) -> Option<Self> {
        let (number, parts) = text.split_once('/')?;
        let (number, parts) = (number.trim().parse().ok()?, parts.trim().parse().ok()?);
        (1..=parts).contains(&number).then_some(Self { number, parts })
    }

    fn takes(self, number: usize) -> bool {
        number % self.parts == self.number - 1
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_read_and_others_are_not() {
        assert_eq!(Part::parse("2/8").map(|part| part.to_string()), Some("2/8".to_owned()));
        assert_eq!(Part::parse(" 1 / 1 "), Some(Part { number: 1, parts: 1 }));
        for text in ["", "2", "0/8", "9/8", "1/0", "-1/8", "1/8/2", "a/b", "1.0/2"] {
            assert_eq!(Part::parse(text), None, "{text}");
        }
    }

    #[test]
    fn every_job_is_in_one_part() {
        for parts in 1..9 {
            let all: Vec<Selection> =
                (1..=parts).map(|number| Selection::Part(Part { number, parts })).collect();
            for job in 0..40 {
                let takers = all.iter().filter(|part| part.takes(job)).count();
                assert_eq!(takers, 1);
            }
        }
    }
}
