//! `table` of an inflow window: the mass flow rate over time as points, in the scene or the study, or in a CSV file.
//!
//! ```text
//! ṁ(t) is linear from point to point; the run takes each segment as PARTS windows of equal length and constant rate, that
//! in their middle, so the mass is exact at each of their ends
//! ```

use std::path::Path;

use billow_solver::scene::InflowWindow;

use super::Checked;
use super::reader::Reader;
use crate::input::json::Json;
use crate::input::keys::{Key, SCENE_WINDOW_KEYS};
use crate::input::settings::FlowTables;
use crate::input::source::Source;
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::platform::error::{Error, InputError, Result};

/// Windows of a segment. Chosen: the rate is then within a thirtieth of the change of the segment.
const PARTS: u32 = 16;
/// Most points. Chosen: a step looks at every window.
const MAX_POINTS: usize = 200;

const ALLOWED: &str = "2 to 200 points of ascending time, as in [[\"0 s\", \"0 g/s\"], [\"0.2 s\", \"5 g/s\"]], or the \
                       name of a CSV file with two columns: time (s), mass_flow_rate (kg/s); other units stand in \
                       parentheses in its first line";

/// The tables of the inflow windows of a study, by strategy and window, their times counted from the start of the window.
/// A CSV file becomes points in the study, so that a results folder needs no other file.
///
/// # Errors
/// A file that cannot be read; a table that is none; a table beside other keys of an inflow.
pub(crate) fn of_study(tree: &mut Json, source: &Source) -> Checked<FlowTables> {
    let mut tables = FlowTables::new();
    let Some(Json::Object(strategies)) = tree.get_mut("strategies") else { return Ok(tables) };
    let path = Path::new(&source.file);
    let mut reader = Reader { source: source.clone(), ..Reader::new(path) };
    for (name, strategy) in strategies {
        let Some(Json::List(windows)) = strategy.get_mut("inflow") else { continue };
        for (index, window) in windows.iter_mut().enumerate() {
            let key = format!("strategies.{name}.inflow[{index}].table");
            let beside = BESIDE.iter().find(|key| window.get(key).is_some()).copied();
            let Some(table) = window.get_mut("table") else { continue };
            if let Some(beside) = beside {
                let problem = format!("is given beside {beside}: it has all times and rates");
                return Err(source.error(&key, &*table, problem, "a table, or one rate"));
            }
            let points = points(table, &key, &mut reader).map_err(|error| match error {
                Error::Input(error) => error,
                other => source.error(&key, &*table, other.to_string(), ALLOWED),
            })?;
            let json = |x: f64| Json::Number(x);
            let stored = points.iter().map(|point| Json::List(point.map(json).to_vec()));
            *table = Json::List(stored.collect());
            tables.insert((name.clone(), index), windows_of(&points, [0.0, 0.0]));
        }
    }
    Ok(tables)
}

/// Keys of an inflow window that a table takes the place of.
pub(super) const BESIDE: [&str; 6] =
    ["to", "mass_flow_rate", "end_mass_flow_rate", "mass", "tank_pressure", "orifice_area"];

/// The windows of a table that a key names, its times counted from `start` (s), of gas at this temperature (K).
pub(super) fn windows(
    json: &Json,
    key: &str,
    start: [f64; 2],
    reader: &mut Reader,
) -> Result<Vec<InflowWindow>> {
    Ok(windows_of(&points(json, key, reader)?, start))
}

/// The points of a table that a key names: time (s) and mass flow rate (kg/s).
fn points(json: &Json, key: &str, reader: &mut Reader) -> Result<Vec<[f64; 2]>> {
    let points = match json {
        Json::Text(name) => {
            let bytes = reader.bytes(key, name)?;
            let text = String::from_utf8_lossy(&bytes).into_owned();
            csv(&text).map_err(|problem| refused(key, json, problem, reader))?
        }
        Json::List(items) => {
            let points: Option<Vec<[f64; 2]>> = items.iter().map(point).collect();
            let problem = "has an item that is not a time and a mass flow rate".to_owned();
            points.ok_or_else(|| refused(key, json, problem, reader))?
        }
        _ => {
            return Err(
                refused(key, json, "is neither a list nor a file".to_owned(), reader).into()
            );
        }
    };
    let ascending = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    let positive = points.iter().all(|[time, rate]| *time >= 0.0 && *rate >= 0.0);
    if !(2..=MAX_POINTS).contains(&points.len()) || !ascending || !positive {
        let problem = format!(
            "has {} points{}{}",
            points.len(),
            if ascending { "" } else { ", of times that do not ascend" },
            if positive { "" } else { ", with a negative one" }
        );
        return Err(refused(key, json, problem, reader).into());
    }
    // A rate whose unit is missing is said as for one that is constant.
    let largest = points.iter().fold(0.0_f64, |largest, [_, rate]| largest.max(*rate));
    if let Some(rate) = SCENE_WINDOW_KEYS.iter().find(|known| known.path == "mass_flow_rate") {
        rate.value(&Json::Number(largest), key, &reader.source)?;
    }
    Ok(points)
}

/// The windows between points, their times counted from `start` (s), of gas at this temperature (K).
pub(crate) fn windows_of(points: &[[f64; 2]], [start, temperature]: [f64; 2]) -> Vec<InflowWindow> {
    let mut windows = Vec::new();
    for pair in points.windows(2) {
        let [[t, a], [end, b]] = [pair[0], pair[1]];
        let at = |part: f64| t + (end - t) * part / f64::from(PARTS);
        for part in 0..PARTS {
            let part = f64::from(part);
            let mass_flow_rate = a + (b - a) * (part + 0.5) / f64::from(PARTS);
            let [from, to] = [at(part), at(part + 1.0)].map(|time| start + time);
            windows.push(InflowWindow { from, to, mass_flow_rate, temperature });
        }
    }
    windows
}

fn refused(key: &str, json: &Json, problem: String, reader: &Reader) -> InputError {
    reader.source.error(key, json, problem, ALLOWED)
}

/// A point in a scene: a time and a mass flow rate, SI or with a unit.
fn point(json: &Json) -> Option<[f64; 2]> {
    let Json::List(items) = json else { return None };
    let [time, rate] = items.as_slice() else { return None };
    let read = |name: &str, json: &Json| {
        let key: &Key = SCENE_WINDOW_KEYS.iter().find(|key| key.path == name)?;
        match key.read(json).ok()? {
            Value::Number(number) => Some(number),
            _ => None,
        }
    };
    Some([read("from", time)?, read("mass_flow_rate", rate)?])
}

/// The points of a CSV file.
fn csv(text: &str) -> std::result::Result<Vec<[f64; 2]>, String> {
    let text =
        text.strip_prefix('\u{feff}').unwrap_or(text).replace("\r\n", "\n").replace('\r', "\n");
    let cells = |line: &str| -> Vec<String> {
        line.split([',', ';', '\t']).map(|cell| cell.trim().trim_matches('"').to_owned()).collect()
    };
    let is_content = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
    let mut lines = (1..).zip(text.lines()).filter(is_content).peekable();
    let mut factors = [1.0; 2];
    if let Some((number, line)) = lines.peek()
        && cells(line).iter().all(|cell| cell.parse::<f64>().is_err())
    {
        for (factor, (cell, dimension)) in factors
            .iter_mut()
            .zip(cells(line).iter().zip([Dimension::Time, Dimension::MassFlowRate]))
        {
            let unit = cell.split_once('(').and_then(|(_, rest)| rest.split_once(')'));
            if let Some((unit, _)) = unit {
                let one = units::parse(&format!("1 {unit}"), dimension);
                *factor = one.map_err(|error| format!("line {number}: {}", error.problem))?;
            }
        }
        lines.next();
    }
    let point = |(number, line): (usize, &str)| {
        let numbers: Option<Vec<f64>> = cells(line)
            .iter()
            .map(|cell| cell.parse().ok().filter(|x: &f64| x.is_finite()))
            .collect();
        match numbers.as_deref() {
            Some([time, rate]) => Ok([time * factors[0], rate * factors[1]]),
            _ => Err(format!("line {number} is not two finite numbers")),
        }
    };
    lines.map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_csv_file_has_points_and_units() {
        let points = [[0.0, 0.0], [0.5, 0.002]];
        for text in [
            "0,0\n0.5,0.002\n",
            "time (s), mass_flow_rate (kg/s)\n0,0\n0.5,0.002",
            "\u{feff}t;rate\r\n0;0\r\n\r\n0.5;2e-3\r\n",
            "# measured\n\"time (ms)\",\"flow (g/s)\"\n0,0\n500,2\n",
            "0\t0\r0.5\t0.002\r",
        ] {
            assert_eq!(csv(text).unwrap(), points, "{text}");
        }
        for (text, problem) in [
            ("0,0,1\n", "line 1 is not two finite numbers"),
            ("t,rate\n0,x\n", "line 2 is not two finite numbers"),
            ("t (kg),rate (g/s)\n0,1\n", "line 1: "),
            ("t (s),rate (m/s)\n0,1\n", "line 1: "),
            ("0,1\n\n1\n", "line 3 is not two finite numbers"),
        ] {
            assert!(csv(text).unwrap_err().contains(problem), "{text}");
        }
    }
}
