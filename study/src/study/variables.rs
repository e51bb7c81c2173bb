//! The names that a filter may use, and their values at a point.

use super::base::Base;
use super::fold::Fold;
use super::target::{Column, Target};
use crate::input::expression::{Type, Variable};
use crate::input::keys::{self, KEYS, Key, KeyKind, named, position};
use crate::input::units::Dimension;
use crate::input::value::Value;

/// The key whose words are the strategies of the study.
const STRATEGY: &Key = named(KEYS, "strategy");

/// Quantities that the fold solves. Their names stand for the solved values, not for the keys of the
/// same name.
const SOLVED: [(&str, Dimension); 6] = [
    ("phi", Dimension::Angle),
    ("alpha1", Dimension::Angle),
    ("ring_ratio", Dimension::Number),
    ("half_angle", Dimension::Angle),
    ("top_radius", Dimension::Length),
    ("height", Dimension::Length),
];

/// Whether the point is feasible.
const FEASIBLE: &str = "feasible";

/// What a name stands for.
enum Named<'a> {
    Key(usize),
    Column(&'a Column),
}

impl Named<'_> {
    fn key(&self) -> &'static Key {
        match self {
            Self::Key(index) => &KEYS[*index],
            Self::Column(column) => column.target.key(),
        }
    }

    fn value(&self, point: &Base) -> Value {
        match self {
            Self::Key(index) => point.settings.at(*index).clone(),
            Self::Column(column) => column.target.value(point),
        }
    }
}

/// The names of keys and columns, each once, without those of solved quantities.
fn names(columns: &[Column]) -> Vec<(String, Named<'_>)> {
    let keys = KEYS.iter().enumerate().filter(|(_, key)| key.varies()).flat_map(|(index, key)| {
        [keys::short_name(index), key.path].map(|name| (name.to_owned(), Named::Key(index)))
    });
    let strategies = columns.iter().filter(|column| !matches!(column.target, Target::Key(_)));
    let strategies = strategies.map(|column| (column.name.clone(), Named::Column(column)));
    let mut names: Vec<(String, Named<'_>)> = Vec::new();
    for (name, named) in keys.chain(strategies) {
        let solved = name == FEASIBLE || SOLVED.iter().any(|(solved, _)| *solved == name);
        if !solved && !names.iter().any(|(known, _)| *known == name) {
            names.push((name, named));
        }
    }
    names
}

/// What a filter may name: varied keys, all keys, and what the fold solves.
pub(super) fn variables(columns: &[Column], base: &Base) -> Vec<Variable> {
    let mut variables = vec![Variable { name: FEASIBLE.to_owned(), kind: Type::Bool }];
    variables.extend(SOLVED.iter().map(|(name, dimension)| Variable {
        name: (*name).to_owned(),
        kind: Type::Quantity(*dimension, &[]),
    }));
    variables.extend(names(columns).into_iter().map(|(name, named)| {
        let key = named.key();
        let kind = match key.kind {
            KeyKind::Quantity(quantity) => Type::Quantity(quantity.dimension, quantity.words),
            KeyKind::Integer(..) => Type::Quantity(Dimension::Number, &[]),
            KeyKind::Choice(words) => {
                Type::Text(Some(words.iter().map(|word| word.name.to_owned()).collect()))
            }
            KeyKind::Text if key.path == STRATEGY.path => {
                Type::Text(Some(base.strategies.keys().cloned().collect()))
            }
            // A study has no key that is a flag or a vector.
            KeyKind::Text | KeyKind::Flag | KeyKind::Vector(_) => Type::Text(None),
        };
        Variable { name, kind }
    }));
    variables
}

/// The value of every variable at a point, in the order of [`variables`].
pub(super) fn values(columns: &[Column], point: &Base, fold: &Fold) -> Vec<Value> {
    let mut values = vec![Value::Bool(matches!(fold, Fold::Solved(_)))];
    match fold {
        Fold::Solved(pattern) => values.extend(
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
        // Without a fold, the value the study asks for, where it asks for one.
        Fold::Infeasible(_) | Fold::Invalid { .. } => {
            const NONE: usize = usize::MAX;
            const ASKED: [usize; SOLVED.len()] = [
                NONE,
                NONE,
                NONE,
                position(KEYS, "design.half_angle"),
                position(KEYS, "design.top_radius"),
                position(KEYS, "design.height"),
            ];
            values.extend(ASKED.map(|index| match index {
                NONE => Value::Null,
                index => point.settings.at(index).clone(),
            }));
        }
    }
    values.extend(names(columns).iter().map(|(_, named)| named.value(point)));
    values
}
