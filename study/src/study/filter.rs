//! The filter of a grid: which points of the product a study keeps.

use billow_solver::geometry::fold::{FoldError, FoldPattern};

use super::column::Column;
use crate::input::expression::{self, Expression, ExpressionError, Type, Variable};
use crate::input::keys::{self, KEYS, KeyKind, position};
use crate::input::settings::Settings;
use crate::input::units::Dimension;
use crate::input::value::Value;

/// The fold pattern of a design, or why it has none.
pub(super) type Fold = Result<FoldPattern, FoldError>;

/// Whether the point is feasible.
const FEASIBLE: &str = "feasible";
/// The key whose words are the strategies of the study.
const STRATEGY: usize = position(KEYS, "strategy");

/// Name, dimension and value of a quantity that the fold solves.
type Solved = (&'static str, Dimension, fn(&FoldPattern) -> f64);

/// The quantities that the fold solves. A name stands for the solved value, not for the key of the same name;
/// without a fold, for the value the study asks for, where it has such a key.
const SOLVED: [Solved; 6] = [
    ("phi", Dimension::Angle, |pattern| pattern.angles.phi),
    ("alpha1", Dimension::Angle, |pattern| pattern.angles.alpha1),
    ("ring_ratio", Dimension::Number, |pattern| pattern.angles.ring_ratio),
    ("half_angle", Dimension::Angle, |pattern| pattern.half_angle),
    ("top_radius", Dimension::Length, |pattern| pattern.top_radius),
    ("height", Dimension::Length, |pattern| pattern.height),
];

/// What a name stands for.
#[derive(Debug, Clone, PartialEq)]
enum Named {
    Feasible,
    /// Position in [`SOLVED`].
    Solved(usize),
    /// Position in the settings.
    Value(usize),
}

/// A condition on the points of a study.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Filter {
    condition: Expression,
    /// What each of its variables stands for; `None` for those that it does not name.
    named: Vec<Option<Named>>,
}

impl Filter {
    /// Reads a condition on the keys, the varied keys of strategies, and what the fold solves.
    ///
    /// # Errors
    /// When it is no condition on these.
    pub fn read(
        text: &str,
        columns: &[Column],
        settings: &Settings,
    ) -> Result<Self, ExpressionError> {
        let mut variables = vec![(FEASIBLE.to_owned(), Type::Bool, Named::Feasible)];
        variables.extend(SOLVED.iter().enumerate().map(|(index, (name, dimension, _))| {
            ((*name).to_owned(), Type::Quantity(*dimension, &[]), Named::Solved(index))
        }));
        let keys = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
        let keys = keys.flat_map(|(index, key)| {
            [keys::short_name(index), key.path].map(|name| (name.to_owned(), index))
        });
        let strategies = columns.iter().filter(|column| column.index >= KEYS.len());
        let strategies = strategies.map(|column| (column.name.clone(), column.index));
        for (name, index) in keys.chain(strategies) {
            if !variables.iter().any(|(known, ..)| *known == name) {
                variables.push((name, kind(index, settings), Named::Value(index)));
            }
        }
        let used = expression::names(text);
        let named = variables
            .iter()
            .map(|(name, _, named)| used.contains(name).then(|| named.clone()))
            .collect();
        let variables: Vec<Variable> =
            variables.into_iter().map(|(name, kind, _)| Variable { name, kind }).collect();
        Ok(Self { condition: Expression::condition(text, &variables)?, named })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        self.condition.text()
    }

    /// Whether a point meets it; without a fold for film from a mesh.
    pub fn holds(&self, point: &Settings, fold: Option<&Fold>) -> bool {
        let value = |named: &Option<Named>| match (named, fold) {
            (None, _) | (Some(Named::Solved(_)), None) => Value::Null,
            (Some(Named::Feasible), fold) => Value::Bool(fold.is_none_or(Result::is_ok)),
            (Some(Named::Solved(index)), Some(Ok(pattern))) => {
                Value::Number((SOLVED[*index].2)(pattern))
            }
            (Some(Named::Solved(index)), Some(Err(_))) => {
                keys::find(SOLVED[*index].0).map_or(Value::Null, |key| point.at(key).clone())
            }
            (Some(Named::Value(index)), _) => point.at(*index).clone(),
        };
        self.condition.holds(&self.named.iter().map(value).collect::<Vec<_>>())
    }
}

fn kind(index: usize, settings: &Settings) -> Type {
    match settings.key(index).kind {
        KeyKind::Quantity(quantity) => Type::Quantity(quantity.dimension, quantity.words),
        KeyKind::Integer(..) => Type::Quantity(Dimension::Number, &[]),
        KeyKind::Choice(words) => {
            Type::Text(Some(words.iter().map(|word| word.name.to_owned()).collect()))
        }
        KeyKind::Text if index == STRATEGY => {
            Type::Text(Some(settings.strategies.keys().cloned().collect()))
        }
        // A study has no key that is a flag or a vector.
        KeyKind::Text | KeyKind::Flag | KeyKind::Vector(_) => Type::Text(None),
    }
}
