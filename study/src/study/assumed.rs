//! The section `assumed` of a study: the ranges of what is assumed.

use crate::accuracy::{ASSUMED_KEYS, AssumedRanges, assumed_value};
use crate::input::json::Json;
use crate::input::keys::{self, KEYS, STUDY};
use crate::input::object::{list, object};
use crate::input::source::Source;
use crate::input::value::{Value, short_number};
use crate::platform::error::InputError;

/// The section, for errors.
const ASSUMED: &str = "assumed";

/// Reads the ranges; those that the study does not give are those of the table of mesh errors.
pub(super) fn read(json: Option<&Json>, source: &Source) -> Result<AssumedRanges, InputError> {
    let mut ranges = AssumedRanges::default();
    let Some(json) = json else { return Ok(ranges) };
    let known = AssumedRanges::default();
    let mut given = Vec::new();
    for (name, value) in object(json, &STUDY, ASSUMED, source)? {
        let path = format!("{ASSUMED}.{name}");
        let index = keys::find(name);
        let position = ASSUMED_KEYS.iter().position(|key| index == keys::index(key));
        let (Some(index), Some(position)) = (index, position) else {
            let allowed = ASSUMED_KEYS.join(" and ");
            return Err(source.error(&path, value, "is not among what is assumed", allowed));
        };
        if given.contains(&position) {
            return Err(source.error(&path, value, "is given twice", "each key once"));
        }
        given.push(position);
        let key = &KEYS[index];
        let ([least, most], base) = (known.0[position], assumed_value(position));
        let allowed = format!(
            "[low, high], from {} to {} {}, about the default {}",
            short_number(least),
            short_number(most),
            key.unit(),
            short_number(base)
        );
        let ends = list(value, &path, source, &allowed)?;
        let number = |(index, end): (usize, &Json)| {
            Ok(match key.value(end, &format!("{path}[{index}]"), source)? {
                Value::Number(number) => Some(number),
                _ => None,
            })
        };
        let ends: Vec<Option<f64>> =
            ends.iter().enumerate().map(number).collect::<Result<_, InputError>>()?;
        let [Some(low), Some(high)] = ends[..] else {
            return Err(source.error(&path, value, "is not a range", allowed));
        };
        if low < least || high > most || low > base || high < base {
            let problem = "is not a range that the table of mesh errors has";
            return Err(source.error(&path, value, problem, allowed));
        }
        ranges.0[position] = [low, high];
    }
    Ok(ranges)
}

#[cfg(test)]
mod tests {
    use crate::study::{MAX_POINTS, Study};

    fn study(assumed: &str) -> Result<Study, String> {
        let text = format!(
            r#"{{"design": {{"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1}},
            "solver": {{"end_time": 0.5}}, "gas": {{"mass_flow_rate": 0.005}}, "assumed": {assumed}}}"#
        );
        Study::from_text(&text, "test.json", "test", &[], MAX_POINTS)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn ranges_are_those_of_the_study_or_of_the_table() {
        let ranges = |text| study(text).unwrap().assumed().0;
        assert_eq!(ranges("{}"), [[0.003, 0.03], [0.1, 1.0]]);
        assert_eq!(ranges(r#"{"loss_factor": [0.01, 0.02]}"#), [[0.01, 0.02], [0.1, 1.0]]);
        let heat = r#"{"gas.heat_transfer": ["0.3 W/(m2 K)", "0.5 W/(m2 K)"]}"#;
        assert_eq!(ranges(heat), [[0.003, 0.03], [0.3, 0.5]]);
        for (text, problem) in [
            (r#"{"loss_factor": [0.001, 0.02]}"#, "from 0.003 to 0.03 1, about the default 0.015"),
            (r#"{"loss_factor": [0.02, 0.03]}"#, "is not a range that the table"),
            (r#"{"loss_factor": [0.01]}"#, "is not a range"),
            (
                r#"{"loss_factor": [0.01, 0.02], "film.loss_factor": [0.01, 0.03]}"#,
                "is given twice",
            ),
            (r#"{"thickness": [1, 2]}"#, "film.loss_factor and gas.heat_transfer"),
        ] {
            let error = study(text).unwrap_err();
            assert!(error.contains(problem), "{text}: {error}");
        }
    }
}
