//! Type check: every operand has the type its operator needs, before any row is read.

use super::tree::{
    ExpressionError, Node, Operator, Tree, TreeKind, Type, ValueKind, Variable, error_at,
};
use crate::input::keys;
use crate::input::units::{self, Powers};
use crate::platform::quote;

/// Checks a tree as a condition.
pub(super) fn condition(
    text: &str,
    tree: &Tree,
    variables: &[Variable],
) -> Result<Node, ExpressionError> {
    let checker = Checker { text, variables };
    let (node, kind) = checker.node(tree)?;
    if kind != ValueKind::Bool {
        return Err(checker.refuse(
            tree,
            format!("is {}, not a condition", describe(kind)),
            "something true or false, as in N == 6",
        ));
    }
    Ok(node)
}

struct Checker<'a> {
    text: &'a str,
    variables: &'a [Variable],
}

fn describe(kind: ValueKind) -> String {
    match kind {
        ValueKind::Number(None) => "a number".to_owned(),
        ValueKind::Number(Some(powers)) => units::describe(powers),
        ValueKind::Text => "a text".to_owned(),
        ValueKind::Bool => "true or false".to_owned(),
        ValueKind::Null => "null".to_owned(),
    }
}

impl Checker<'_> {
    fn refuse(&self, tree: &Tree, problem: String, allowed: &str) -> ExpressionError {
        error_at(self.text, tree.span, problem, allowed)
    }

    fn node(&self, tree: &Tree) -> Result<(Node, ValueKind), ExpressionError> {
        Ok(match &tree.kind {
            TreeKind::Number(number) => (Node::Number(*number), ValueKind::Number(None)),
            TreeKind::Text(text) => (Node::Text(text.clone()), ValueKind::Text),
            TreeKind::Bool(value) => (Node::Bool(*value), ValueKind::Bool),
            TreeKind::Null => (Node::Bool(false), ValueKind::Null),
            TreeKind::Name(name) => self.variable(tree, name)?,
            TreeKind::Negate(inner) => {
                let (node, kind) = self.number(inner, "-")?;
                (Node::Negate(Box::new(node)), ValueKind::Number(kind))
            }
            TreeKind::Not(inner) => {
                (Node::Not(Box::new(self.truth(inner, "not")?)), ValueKind::Bool)
            }
            TreeKind::Binary(operator, left, right) => match operator {
                Operator::And | Operator::Or => {
                    let word = if *operator == Operator::And { "and" } else { "or" };
                    let (left, right) = (self.truth(left, word)?, self.truth(right, word)?);
                    (Node::Logic(*operator, Box::new(left), Box::new(right)), ValueKind::Bool)
                }
                operator if operator.compares() => {
                    (self.comparison(tree, *operator, left, right)?, ValueKind::Bool)
                }
                _ => self.arithmetic(tree, *operator, left, right)?,
            },
        })
    }

    fn variable(&self, tree: &Tree, name: &str) -> Result<(Node, ValueKind), ExpressionError> {
        let Some(index) = self.variables.iter().position(|variable| variable.name == name) else {
            let near = keys::nearest(name, self.variables.iter().map(|v| v.name.as_str()));
            let near = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
            let names: Vec<&str> = self.variables.iter().map(|v| v.name.as_str()).collect();
            return Err(self.refuse(
                tree,
                format!("no variable is called {}{near}", quote::echo(name)),
                &format!("{}; a text is written in quotes", names.join(", ")),
            ));
        };
        Ok(match &self.variables[index].kind {
            Type::Quantity(dimension, words) => {
                (Node::Quantity(index, words), ValueKind::Number(Some(dimension.powers())))
            }
            Type::Text(_) => (Node::TextVariable(index), ValueKind::Text),
            Type::Bool => (Node::BoolVariable(index), ValueKind::Bool),
        })
    }

    fn truth(&self, tree: &Tree, word: &str) -> Result<Node, ExpressionError> {
        match self.node(tree)? {
            (node, ValueKind::Bool) => Ok(node),
            (_, kind) => Err(self.refuse(
                tree,
                format!("`{word}` needs a condition, this is {}", describe(kind)),
                "something true or false, as in N == 6",
            )),
        }
    }

    fn number(&self, tree: &Tree, sign: &str) -> Result<(Node, Option<Powers>), ExpressionError> {
        match self.node(tree)? {
            (node, ValueKind::Number(powers)) => Ok((node, powers)),
            (_, kind) => Err(self.refuse(
                tree,
                format!("`{sign}` needs a number, this is {}", describe(kind)),
                "a number or a quantity",
            )),
        }
    }

    fn arithmetic(
        &self,
        tree: &Tree,
        operator: Operator,
        left: &Tree,
        right: &Tree,
    ) -> Result<(Node, ValueKind), ExpressionError> {
        let sign = match operator {
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            _ => "/",
        };
        let (a, a_powers) = self.number(left, sign)?;
        let (b, b_powers) = self.number(right, sign)?;
        let powers = match (operator, a_powers, b_powers) {
            (_, None, None) => None,
            (Operator::Add | Operator::Subtract, Some(a), Some(b)) if a != b => {
                return Err(self.mismatch(tree, a, b, &format!("`{sign}`")));
            }
            (Operator::Add | Operator::Subtract, a, b) => a.or(b),
            (_, a, b) => {
                let (a, b) = (a.unwrap_or_default(), b.unwrap_or_default());
                let mut powers = a;
                for (power, other) in powers.iter_mut().zip(b) {
                    let sum = if operator == Operator::Multiply {
                        power.checked_add(other)
                    } else {
                        power.checked_sub(other)
                    };
                    *power = sum.ok_or_else(|| {
                        self.refuse(tree, "has too high a power".to_owned(), "a simpler product")
                    })?;
                }
                Some(powers)
            }
        };
        Ok((Node::Arithmetic(operator, Box::new(a), Box::new(b)), ValueKind::Number(powers)))
    }

    fn mismatch(&self, tree: &Tree, a: Powers, b: Powers, what: &str) -> ExpressionError {
        self.refuse(
            tree,
            format!("{what} between {} and {}", units::describe(a), units::describe(b)),
            "two quantities of one dimension",
        )
    }

    fn comparison(
        &self,
        tree: &Tree,
        operator: Operator,
        left: &Tree,
        right: &Tree,
    ) -> Result<Node, ExpressionError> {
        let (a, a_kind) = self.node(left)?;
        let (b, b_kind) = self.node(right)?;
        let equality = matches!(operator, Operator::Equal | Operator::Unequal);
        match (a_kind, b_kind) {
            (kind, ValueKind::Null) | (ValueKind::Null, kind) => {
                if !equality {
                    let problem = "null has no order".to_owned();
                    return Err(self.refuse(tree, problem, "x == null, x != null"));
                }
                let node = if b_kind == ValueKind::Null { a } else { b };
                Ok(Node::IsNull(Box::new(node), kind, operator == Operator::Equal))
            }
            (ValueKind::Number(Some(a)), ValueKind::Number(Some(b))) if a != b => {
                Err(self.mismatch(tree, a, b, "a comparison"))
            }
            (ValueKind::Number(_), ValueKind::Number(_)) => {
                Ok(Node::CompareNumbers(operator, Box::new(a), Box::new(b)))
            }
            (ValueKind::Number(Some(powers)), ValueKind::Text) => {
                let quantity = self.quantity(right, powers, &a)?;
                Ok(Node::CompareNumbers(operator, Box::new(a), Box::new(quantity)))
            }
            (ValueKind::Text, ValueKind::Number(Some(powers))) => {
                let quantity = self.quantity(left, powers, &b)?;
                Ok(Node::CompareNumbers(operator, Box::new(quantity), Box::new(b)))
            }
            (ValueKind::Text, ValueKind::Text) if equality => {
                self.known_word(&a, right)?;
                self.known_word(&b, left)?;
                Ok(Node::CompareTexts(operator, Box::new(a), Box::new(b)))
            }
            (ValueKind::Bool, ValueKind::Bool) if equality => {
                Ok(Node::CompareBools(operator, Box::new(a), Box::new(b)))
            }
            (ValueKind::Text, ValueKind::Text) | (ValueKind::Bool, ValueKind::Bool) => Err(self
                .refuse(
                    tree,
                    format!("{} has no order", describe(a_kind)),
                    "== or != between texts, or between conditions",
                )),
            _ => Err(self.refuse(
                tree,
                format!("a comparison between {} and {}", describe(a_kind), describe(b_kind)),
                "two values of one type",
            )),
        }
    }

    /// A quoted text compared with a quantity: a word of that quantity, or a number with a unit.
    fn quantity(&self, tree: &Tree, powers: Powers, other: &Node) -> Result<Node, ExpressionError> {
        let TreeKind::Text(text) = &tree.kind else {
            return Err(self.refuse(
                tree,
                format!("is a text, compared with {}", units::describe(powers)),
                "a number or a quantity",
            ));
        };
        if let Node::Quantity(_, words) = other
            && let Some((_, number)) = words.iter().find(|(word, _)| word == text)
        {
            return Ok(Node::Number(*number));
        }
        units::parse_powers(text, powers).map(Node::Number).map_err(|problem| {
            self.refuse(
                tree,
                problem,
                &format!("{} with its unit in the quotes", units::describe(powers)),
            )
        })
    }

    /// Refuses a quoted text that the variable compared with it never holds.
    fn known_word(&self, other: &Node, tree: &Tree) -> Result<(), ExpressionError> {
        let (Node::TextVariable(index), TreeKind::Text(text)) = (other, &tree.kind) else {
            return Ok(());
        };
        let variable = &self.variables[*index];
        match &variable.kind {
            Type::Text(Some(words)) if !words.contains(text) => {
                let near = keys::nearest(text, words.iter().map(String::as_str));
                let near =
                    near.map_or_else(String::new, |near| format!("; did you mean '{near}'?"));
                Err(self.refuse(
                    tree,
                    format!("{} is never '{text}'{near}", variable.name),
                    &words.join(", "),
                ))
            }
            _ => Ok(()),
        }
    }
}
