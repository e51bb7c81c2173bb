//! From axes to points: ranges, the product, the filter.

use std::collections::HashMap;
use std::rc::Rc;

use super::base::Base;
use super::grid::{Axis, Column, Grid, Target};
use super::resolve::{self, Fold};
use super::{Limits, StudyPoint};
use crate::input::expression::{Type, Variable};
use crate::input::keys::{self, KEYS, Key, Kind};
use crate::input::settings::{design, read};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::units::Dimension;
use crate::input::value::{Value, json_value};
use crate::job::point::Solved;
use crate::platform::error::InputError;
use billow_solver::models::{self};
use billow_solver::scene::error::SceneError;

/// Derived quantities an expression may use, before the keys of the same name.
const DERIVED: [(&str, Dimension); 6] = [
    ("phi", Dimension::Angle),
    ("alpha1", Dimension::Angle),
    ("ring_ratio", Dimension::Number),
    ("half_angle", Dimension::Angle),
    ("top_radius", Dimension::Length),
    ("height", Dimension::Length),
];

/// Values of an axis given as a range.
pub(super) fn range(
    key: &Key,
    members: &[(String, Json)],
    json: &Json,
    at: &str,
    source: &Source,
    limits: Limits,
) -> Result<Vec<Value>, InputError> {
    let allowed = "{\"from\", \"to\", and \"steps\" (how many values) or \"step\", \"spacing\": linear or log}";
    let refuse = |problem: &str| Err(source.error(at, &json.brief(), problem, allowed));
    let (Kind::Quantity(_) | Kind::Integer(..)) = key.kind else {
        return refuse("is a range of a key that is no number");
    };
    let number = |name: &str| -> Result<Option<f64>, InputError> {
        let Some((_, json)) = members.iter().find(|(member, _)| member == name) else {
            return Ok(None);
        };
        let at = format!("{at}.{name}");
        match read(key, json, &at, source)? {
            Value::Number(number) => Ok(Some(number)),
            Value::Integer(number) => Ok(Some(number as f64)),
            _ => Err(source.error(&at, &json.brief(), "is a word, not a number", allowed)),
        }
    };
    let (mut steps, mut log) = (None, false);
    for (name, value) in members {
        match (name.as_str(), value) {
            ("from" | "to" | "step", _) => {}
            ("steps", Json::Integer(count)) if *count >= 2 => {
                steps = Some(usize::try_from(*count).unwrap_or(usize::MAX));
            }
            ("spacing", Json::Text(spacing)) if spacing == "linear" => log = false,
            ("spacing", Json::Text(spacing)) if spacing == "log" => log = true,
            ("steps", _) => return refuse("`steps` is not a whole number of 2 or more"),
            ("spacing", _) => return refuse("`spacing` is neither \"linear\" nor \"log\""),
            (other, _) => return refuse(&format!("`{other}` is no key of a range")),
        }
    }
    let (Some(from), Some(to)) = (number("from")?, number("to")?) else {
        return refuse("has no `from` or no `to`");
    };
    // The width of a step need not itself be an allowed value, but it has its dimension.
    let step = match members.iter().find(|(member, _)| member == "step") {
        None => None,
        Some((_, step)) => {
            let number = match (step, key.kind) {
                (Json::Integer(number), _) => Some(*number as f64),
                (Json::Number(number), _) => Some(*number),
                (Json::Text(text), Kind::Quantity(quantity)) => {
                    crate::input::units::parse_powers(text, quantity.dimension.powers()).ok()
                }
                _ => None,
            };
            match number {
                Some(step) if step > 0.0 => Some(step),
                _ => return refuse("`step` is no positive quantity of the key's dimension"),
            }
        }
    };
    if from >= to {
        return refuse("`from` is not below `to`");
    }
    let too_many = |count: f64| {
        let problem = format!("has {count:.0} values; a grid may have {} points", limits.points);
        Err(source.error(at, &json.brief(), problem, allowed))
    };
    let numbers: Vec<f64> = match (steps, step) {
        (Some(_), Some(_)) | (None, None) => {
            return refuse("needs `steps` or `step`, one of them");
        }
        (Some(steps), None) if steps > limits.points => return too_many(steps as f64),
        (Some(steps), None) if log => {
            if from <= 0.0 {
                return refuse("has logarithmic spacing, so `from` must be above 0");
            }
            let ratio = libm::log(to / from) / (steps - 1) as f64;
            let between = (0..steps).map(|i| tidy(from * libm::exp(ratio * i as f64)));
            ends(between.collect(), from, to)
        }
        (Some(steps), None) => {
            let width = (to - from) / (steps - 1) as f64;
            ends((0..steps).map(|i| tidy(from + width * i as f64)).collect(), from, to)
        }
        (None, Some(_)) if log => return refuse("has logarithmic spacing, so it needs `steps`"),
        (None, Some(step)) => {
            // A last value that rounding alone keeps above `to` belongs to the range.
            let widths = (to - from) / step * (1.0 + 1e-12);
            let count = widths.floor() + 1.0;
            if widths - widths.floor() > 2e-12 * widths {
                let last = tidy(from + step * widths.floor());
                return refuse(&format!("does not end at `to`: its last step is {last}"));
            }
            if count > limits.points as f64 {
                return too_many(count);
            }
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
            let count = count as usize;
            (0..count).map(|i| tidy(from + step * i as f64).min(to)).collect()
        }
    };
    numbers
        .into_iter()
        .enumerate()
        .map(|(i, number)| {
            let place = format!("{at} (value {})", i + 1);
            read(key, &Json::Number(number), &place, source)
        })
        .collect()
}

/// The ends of a range are what was written.
fn ends(mut numbers: Vec<f64>, from: f64, to: f64) -> Vec<f64> {
    if let [first, .., last] = numbers.as_mut_slice() {
        (*first, *last) = (from, to);
    }
    numbers
}

/// The number of fifteen digits where that is what rounding alone has left: a range gives the same
/// values, and so the same jobs, as the list a user would write.
fn tidy(number: f64) -> f64 {
    match format!("{number:.14e}").parse::<f64>() {
        Ok(short) if (short - number).abs() <= 1e-14 * number.abs() => short,
        _ => number,
    }
}

/// What an expression may name: varied keys, all keys, and what the fold solves.
pub(super) fn variables(grid: &Grid, base: &Base) -> Vec<Variable> {
    let mut variables = vec![Variable { name: "feasible".to_owned(), kind: Type::Bool }];
    variables.extend(DERIVED.iter().map(|(name, dimension)| Variable {
        name: (*name).to_owned(),
        kind: Type::Quantity(*dimension, &[]),
    }));
    for (name, source) in named(grid) {
        if variables.iter().any(|variable| variable.name == name) {
            continue;
        }
        let key = match source {
            Named::Key(at) => &KEYS[at],
            Named::Column(column) => column.target.key(),
        };
        let kind = match key.kind {
            Kind::Quantity(quantity) => Type::Quantity(quantity.dimension, quantity.words),
            Kind::Integer(..) => Type::Quantity(Dimension::Number, &[]),
            Kind::Choice(words) => {
                Type::Text(Some(words.iter().map(|word| (*word).to_owned()).collect()))
            }
            Kind::Text if key.path == "strategy" => {
                Type::Text(Some(base.strategies.keys().cloned().collect()))
            }
            // No key of a study is a flag or a vector.
            Kind::Text | Kind::Flag | Kind::Vector(_) => Type::Text(None),
        };
        variables.push(Variable { name, kind });
    }
    variables
}

enum Named<'a> {
    Key(usize),
    Column(&'a Column),
}

/// Names beside the derived ones, with duplicates.
fn named(grid: &Grid) -> impl Iterator<Item = (String, Named<'_>)> {
    let keys = KEYS.iter().enumerate().filter(|(_, key)| key.varies()).flat_map(|(at, key)| {
        [keys::short_name(at), key.path].map(|name| (name.to_owned(), Named::Key(at)))
    });
    let columns = grid.columns.iter().filter(|column| !matches!(column.target, Target::Key(_)));
    keys.chain(columns.map(|column| (column.name.clone(), Named::Column(column))))
}

/// The value of every variable at a point, in the order of [`variables`].
fn row(grid: &Grid, point: &Base, fold: &Fold) -> Vec<Value> {
    let mut row = vec![Value::Bool(matches!(fold, Fold::Solved(_)))];
    match fold {
        Fold::Solved(pattern) => row.extend(
            [
                pattern.angles.phi,
                pattern.angles.alpha1,
                pattern.angles.ring_ratio,
                pattern.half_angle,
                pattern.top_radius,
                pattern.height,
            ]
            .map(Value::Number),
        ),
        _ => row.extend(DERIVED.map(|(name, _)| {
            // Unsolved, the value asked for stands where there is one.
            keys::find(name).map_or(Value::Null, |at| point.settings.at(at).clone())
        })),
    }
    let mut seen: Vec<String> = Vec::new();
    for (name, source) in named(grid) {
        let taken = name == "feasible" || DERIVED.iter().any(|(derived, _)| *derived == name);
        if taken || seen.contains(&name) {
            continue;
        }
        seen.push(name);
        row.push(match source {
            Named::Key(at) => point.settings.at(at).clone(),
            Named::Column(column) => value_at(point, &column.target),
        });
    }
    row
}

/// The value a target has at a point.
fn value_at(point: &Base, target: &Target) -> Value {
    match target {
        Target::Key(at) => point.settings.at(*at).clone(),
        Target::Strategy(name, at) => {
            point.strategies.get(name).map_or(Value::Null, |strategy| strategy.values[*at].clone())
        }
        Target::Window(name, window, at) => point
            .strategies
            .get(name)
            .and_then(|strategy| strategy.inflow.get(*window))
            .map_or(Value::Null, |window| window[*at].clone()),
    }
}

fn set(point: &mut Base, target: &Target, value: Value) {
    match target {
        Target::Key(at) => point.settings.set(*at, value),
        Target::Strategy(name, at) => {
            if let Some(strategy) = point.strategies.get_mut(name) {
                strategy.values[*at] = value;
            }
        }
        Target::Window(name, window, at) => {
            let strategy = point.strategies.get_mut(name);
            if let Some(window) = strategy.and_then(|strategy| strategy.inflow.get_mut(*window)) {
                window[*at] = value;
            }
        }
    }
}

/// Every point of a study, in plan order: the product, the first axis slowest, then the single
/// points; the filter has dropped the others.
pub(super) fn points(
    base: &Base,
    grid: &Grid,
    source: &Source,
    limits: Limits,
) -> Result<Vec<StudyPoint>, InputError> {
    let product = match (grid.axes.is_empty(), grid.points.is_empty()) {
        // Only single points: no product. Nothing at all: the study is one point.
        (true, false) => Some(0),
        _ => grid.axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.rows.len())),
    };
    let count = product.and_then(|product| product.checked_add(grid.points.len()));
    if count.is_none_or(|count| count > limits.points) {
        let size = count.map_or_else(|| "more than 10^19".to_owned(), |count| count.to_string());
        let problem = format!("has {size} points");
        let mut error =
            source.error("grid", "", problem, format!("up to {} points", limits.points));
        "fewer values an axis, or several studies".clone_into(&mut error.hint);
        return Err(error);
    }
    let mut expansion = Expansion { base, grid, source, folds: HashMap::new(), points: vec![] };
    for number in 0..product.unwrap_or(0) {
        let mut point = base.clone();
        let mut rest = number;
        // The last axis varies fastest; axes are independent, so the order of setting is free.
        for Axis { columns, rows } in grid.axes.iter().rev() {
            let row = &rows[rest % rows.len()];
            rest /= rows.len();
            for (column, value) in columns.iter().zip(row) {
                set(&mut point, &grid.columns[*column].target, value.clone());
            }
        }
        expansion.add(&point)?;
    }
    for values in &grid.points {
        let mut point = base.clone();
        for (column, value) in values {
            set(&mut point, &grid.columns[*column].target, value.clone());
        }
        expansion.add(&point)?;
    }
    if expansion.points.is_empty() {
        let problem = format!("keeps none of the {} points", count.unwrap_or(0));
        let text = grid.filter.as_ref().map_or("", |filter| filter.text());
        return Err(source.error("grid.filter", text, problem, "a condition some point meets"));
    }
    Ok(expansion.points)
}

struct Expansion<'a> {
    base: &'a Base,
    grid: &'a Grid,
    source: &'a Source,
    /// Designs already solved: points that share a design share its pattern.
    folds: HashMap<resolve::DesignKey, Rc<Fold>>,
    points: Vec<StudyPoint>,
}

impl Expansion<'_> {
    fn add(&mut self, point: &Base) -> Result<(), InputError> {
        debug_assert_eq!(self.base.supports, point.supports, "supports are no axis");
        let parameters = || {
            let columns = self.grid.columns.iter();
            columns.map(|column| (column.name.clone(), value_at(point, &column.target))).collect()
        };
        let place = |mut error: InputError| {
            if !self.grid.columns.is_empty() && error.hint.is_empty() {
                let parameters: Vec<(String, Value)> = parameters();
                let texts: Vec<String> =
                    parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
                error.hint = format!("this is the point {}", texts.join(", "));
            }
            error
        };
        let design = design(&point.settings, self.source).map_err(place)?;
        let fold = Rc::clone(
            self.folds
                .entry(resolve::design_key(&design))
                .or_insert_with(|| Rc::new(resolve::fold(&design))),
        );
        if let Some(filter) = &self.grid.filter
            && !filter.holds(&row(self.grid, point, &fold))
        {
            return Ok(());
        }
        let (infeasible, solved) = match &*fold {
            Fold::Solved(pattern) => (None, Some(Solved::of(pattern))),
            Fold::Infeasible(infeasible) => (Some(infeasible.clone()), None),
            Fold::Invalid { key, problem } => {
                let key = format!("design.{key}");
                let value = keys::index(&key).map(|at| point.settings.at(at));
                let value = value.filter(|value| **value != Value::Null);
                let value = value.map(|value| json_value(value).to_string()).unwrap_or_default();
                let allowed = keys::index(&key).map_or_else(String::new, |at| KEYS[at].allowed());
                return Err(place(self.source.error(&key, &value, problem.as_str(), allowed)));
            }
        };
        let scene = resolve::scene(point, design, self.source).map_err(place)?;
        models::check(&scene).map_err(|error| place(self.refused(&error)))?;
        self.points.push(StudyPoint { parameters: parameters(), scene, infeasible, solved });
        Ok(())
    }
    /// What the model says against a scene.
    fn refused(&self, error: &SceneError) -> InputError {
        let SceneError::Invalid { key, problem } = error else {
            return self.source.error("design", "", error.to_string(), "a design that folds");
        };
        let (problem, allowed) = problem.rsplit_once("; ").unwrap_or((problem, ""));
        let allowed = allowed.strip_prefix("allowed: ").unwrap_or(allowed);
        self.source.error(key, "", problem, allowed)
    }
}
