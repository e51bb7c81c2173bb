//! The limits of jobs: from the study file, and from the command line.

use crate::input::json::Json;
use crate::input::keys::{KEYS, position};
use crate::input::value::Value;
use crate::job::limits::JobLimits;
use crate::platform::error::{Error, Result};

/// Positions of the keys in [`KEYS`].
const WALL_TIME: usize = position(KEYS, "job_limits.wall_time");
const STEPS: usize = position(KEYS, "job_limits.steps");
const MEMORY: usize = position(KEYS, "job_limits.memory");
/// The word of the command line for a limit that does not count.
const NONE: &str = "none";

/// The limits that the keys have; `value` gives the value of a key by its position.
pub(super) fn of(value: impl Fn(usize) -> Value) -> JobLimits {
    let mut limits = JobLimits::default();
    for key in [WALL_TIME, STEPS, MEMORY] {
        set(&mut limits, key, &value(key));
    }
    limits
}

fn set(limits: &mut JobLimits, key: usize, value: &Value) {
    let number = match value {
        Value::Number(number) => Some(*number),
        _ => None,
    };
    match key {
        WALL_TIME => limits.wall_time = number,
        STEPS => {
            limits.steps = match value {
                Value::Integer(number) => u64::try_from(*number).ok(),
                _ => None,
            }
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1e15")]
        _ => limits.memory = number.map(|bytes| bytes as u64),
    }
}

/// The limits with those of the command line, each as `KEY=VALUE`.
///
/// # Errors
/// [`Error::Input`] for another key, or a value that the key does not allow.
pub fn with_options(mut limits: JobLimits, options: &[String]) -> Result<JobLimits> {
    for option in options {
        let refuse = |problem: &str, allowed: &str| {
            Error::invalid_option("--job-limit", option, problem, allowed, "")
        };
        let allowed = "wall_time, steps, memory; as in --job-limit wall_time=\"2 h\"";
        let (name, text) = option.split_once('=').ok_or_else(|| refuse("has no `=`", allowed))?;
        let (name, text) = (name.trim(), text.trim());
        let name = name.strip_prefix("job_limits.").unwrap_or(name);
        let key = [WALL_TIME, STEPS, MEMORY].into_iter().find(|key| KEYS[*key].leaf() == name);
        let key = key.ok_or_else(|| refuse("is not a limit of jobs", allowed))?;
        let json = match (text.parse::<i64>(), text.parse::<f64>()) {
            (Ok(number), _) => Json::Integer(number),
            (_, Ok(number)) => Json::Number(number),
            _ => Json::Text(text.to_owned()),
        };
        let value = if text == NONE {
            Value::Null
        } else {
            let read = KEYS[key].read(&json);
            read.map_err(|refusal| {
                let allowed = format!("{}; or {NONE} for no limit", refusal.allowed);
                refuse(&refusal.problem, &allowed)
            })?
        };
        set(&mut limits, key, &value);
    }
    Ok(limits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{MAX_POINTS, Study};

    fn study(limits: &str) -> Study {
        let text = format!(
            r#"{{"design": {{"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1}},
                "solver": {{"end_time": 0.1, "model": "piston"}}, "gas": {{"mass_flow_rate": 0.005}}
                {limits}}}"#
        );
        Study::from_text(&text, "s.json", "s", &[], MAX_POINTS).unwrap()
    }

    #[test]
    fn limits_are_read_with_units() {
        let limits =
            study(r#", "job_limits": {"wall_time": "2 h", "steps": 1000, "memory": "1.5 GiB"}"#);
        let expected =
            JobLimits { wall_time: Some(7200.0), steps: Some(1000), memory: Some(1_610_612_736) };
        assert_eq!(limits.job_limits(), expected);
        assert_eq!(study("").job_limits(), JobLimits::default());
    }

    #[test]
    fn options_replace_and_remove_limits() {
        let options = |texts: &[&str]| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            with_options(study(r#", "job_limits": {"steps": 7}"#).job_limits(), &texts)
        };
        let limits = options(&["wall_time=1 min", "job_limits.memory=500 MB"]).unwrap();
        let expected =
            JobLimits { wall_time: Some(60.0), steps: Some(7), memory: Some(500_000_000) };
        assert_eq!(limits, expected);
        assert_eq!(options(&["steps=none"]).unwrap(), JobLimits::default());
        for (option, problem) in [
            ("wall_time", "has no `=`"),
            ("time=3", "is not a limit of jobs"),
            ("wall_time=0", "out of range"),
            ("memory=3 kg", "is a mass"),
            ("steps=1.5", "whole number"),
        ] {
            let error = options(&[option]).unwrap_err().to_string();
            assert!(error.contains(problem) && error.contains("--job-limit"), "{option}: {error}");
        }
    }
}
