//! Reads `{"minimise": …, "over": {…}, "budget": …}`.

use super::{Optimise, prior};
use crate::input::json::Json;
use crate::input::keys::numerical::is_of_method;
use crate::input::keys::{Key, KeyKind, OPTIMISE_KEYS};
use crate::input::object::{Object, list, members};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::{COLUMNS, CellType, ColumnGroup, ColumnId, RowColumn};
use crate::platform::error::InputError;
use crate::study::OPTIMISE;
use crate::study::grid::{Axis, AxisKind, Context, Grid};
use crate::study::result_limits::unknown;
use crate::surrogate::Coordinate;

/// Keys that it may vary at most. Chosen: a surrogate of more needs more points than a study of film has.
const MAX_INPUTS: usize = 16;
/// What it must look like, for errors.
const SECTION: &str = "{\"minimise\": \"peak_vz\", \"over\": {\"mass_flow_rate\": [\"1 g/s\", \"10 g/s\"]}, \"budget\": 40}";
/// What a range must look like, for errors.
const RANGE: &str = "[low, high] of a quantity or a whole number, or a list of words";

impl Grid {
    /// Reads the search of an optimum, with its first points as an axis.
    pub(in crate::study) fn read_optimise(
        &mut self,
        json: Option<&Json>,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Some(json) = json else { return Ok(()) };
        let source = context.source;
        let object =
            Object::new(json, OPTIMISE, "optimise", OPTIMISE_KEYS, &["minimise", "over"], source)?;
        let minimise = minimised(object.given("minimise"), source)?;
        let over = format!("{OPTIMISE}.over");
        let Some(ranges) = object.given("over") else {
            return Err(source.error(&over, "", "missing", SECTION));
        };
        let (mut columns, mut coordinates) = (Vec::new(), Vec::new());
        for (name, value) in members(ranges, &over, source, RANGE)? {
            let path = format!("{over}.{name}");
            let column = self.column(name, &path, value, context)?;
            if is_of_method(&self.columns[column].name) {
                let problem = "is a choice of the method: a search would find its error, not a better capsule";
                let allowed = "keys of the capsule, its gas and its strategy; the method belongs to solver and design";
                return Err(source.error(&path, value, problem, allowed));
            }
            let of = |item: &Json, path: &str| self.value_of(column, item, path, context);
            coordinates.push(range(self.columns[column].key, value, &path, source, &of)?);
            columns.push(column);
        }
        if columns.is_empty() || columns.len() > MAX_INPUTS {
            let problem = format!("has {} keys", columns.len());
            let allowed = format!("1 to {MAX_INPUTS} keys with their ranges");
            return Err(source.error(&over, ranges, problem, allowed));
        }
        let number = |name: &str| Ok(object.count(name)? as usize);
        let (budget, batch) = (number("budget")?, number("batch")?);
        let seed = object.count("seed")?;
        let has_prior = false;
        let optimise = Optimise { minimise, columns, coordinates, budget, batch, seed, has_prior };
        let rows = optimise.first_values();
        self.axes.push(Axis { columns: optimise.columns.clone(), rows, kind: AxisKind::Optimise });
        self.optimise = Some(optimise);
        Ok(())
    }

    /// Lets a cheap model say something of the points of the search before they run, where it can compute these first ones;
    /// returns whether it does: the search then begins with fewer.
    pub(in crate::study) fn with_prior(&mut self, points: &[Point]) -> bool {
        let Some(optimise) = self.optimise.as_mut().filter(|_| prior::is_of(points)) else {
            return false;
        };
        optimise.has_prior = true;
        let mut axes = self.axes.iter_mut();
        if let Some(axis) = axes.find(|axis| axis.kind == AxisKind::Optimise) {
            axis.rows = optimise.first_values();
        }
        true
    }

    /// Refuses a search of which no first point has a fold pattern: nothing says where one is.
    pub(in crate::study) fn refuse_without_fold(
        &self,
        points: &[Point],
        source: &Source,
    ) -> Result<(), InputError> {
        let none = points.iter().all(|point| point.infeasible.is_some());
        if self.optimise.is_none() || !none {
            return Ok(());
        }
        let problem = format!("has no fold pattern at any of its {} first points", points.len());
        let allowed = "ranges in which a part of the designs folds: billow fold";
        Err(source.error(&format!("{OPTIMISE}.over"), "", problem, allowed))
    }
}

/// The measures that become small.
fn minimised(json: Option<&Json>, source: &Source) -> Result<Vec<ColumnId>, InputError> {
    let path = format!("{OPTIMISE}.minimise");
    let names = match json {
        None => return Err(source.error(&path, "", "missing", SECTION)),
        Some(Json::List(names)) => names.iter().collect(),
        Some(name) => vec![name],
    };
    let mut found: Vec<ColumnId> = Vec::new();
    for name in &names {
        let text = if let Json::Text(text) = name { text.as_str() } else { "" };
        let Some(column) = COLUMNS.iter().find(|column| column.name == text && is_measure(column))
        else {
            let said = ["is not a measure", "peak_vz, peak_speed, t_deployed_since_release"];
            return Err(unknown(said, is_measure, text, (&path, name), source));
        };
        found.push(column.id);
    }
    if found.is_empty() || found.len() > 2 || (found.len() == 2 && found[0] == found[1]) {
        let given = json.map(ToString::to_string).unwrap_or_default();
        let allowed = "one measure, or two: the limits bound all others";
        return Err(source.error(&path, given, "is neither one measure nor two", allowed));
    }
    Ok(found)
}

fn is_measure(column: &RowColumn) -> bool {
    column.group == ColumnGroup::Measures
        && matches!(column.cell_type, CellType::Number | CellType::Integer)
}

/// The range of a key.
fn range(
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
    value: &dyn Fn(&Json, &str) -> Result<Value, InputError>,
) -> Result<Coordinate, InputError> {
    let items = list(json, path, source, RANGE)?;
    let ends = || match items {
        [low, high] => {
            let ends = [
                key.finite(low, &format!("{path}[0]"), source)?,
                key.finite(high, &format!("{path}[1]"), source)?,
            ];
            if ends[0] < ends[1] {
                return Ok(ends);
            }
            Err(source.error(path, json, "does not begin below its end", RANGE))
        }
        _ => Err(source.error(path, json, "is not a range: two values", RANGE)),
    };
    match key.kind {
        KeyKind::Quantity(_) => Ok(Coordinate::between(ends()?)),
        KeyKind::Integer(..) => Ok(Coordinate::Whole(ends()?)),
        _ => {
            let words = items.iter().enumerate();
            let words = words.map(|(index, item)| value(item, &format!("{path}[{index}]")));
            let words: Vec<Value> = words.collect::<Result<_, _>>()?;
            let differ = (1..words.len()).all(|index| !words[..index].contains(&words[index]));
            if words.len() < 2 || !differ {
                return Err(source.error(path, json, "is not two or more different words", RANGE));
            }
            Ok(Coordinate::Word(words))
        }
    }
}
