use proptest::prelude::*;

use super::*;
use crate::input::units::Dimension;

fn variables() -> Vec<Variable> {
    let quantity = |name: &str, dimension| Variable {
        name: name.to_owned(),
        kind: Type::Quantity(dimension, &[]),
    };
    vec![
        quantity("N", Dimension::Number),
        quantity("height", Dimension::Length),
        quantity("gas.mass_flow_rate", Dimension::MassFlowRate),
        Variable {
            name: "strategy".to_owned(),
            kind: Type::Text(Some(vec!["direct".to_owned(), "delayed".to_owned()])),
        },
        Variable { name: "feasible".to_owned(), kind: Type::Bool },
        quantity("bottom_radius", Dimension::Length),
        Variable {
            name: "heat_transfer".to_owned(),
            kind: Type::Quantity(Dimension::HeatTransfer, &[("isothermal", f64::INFINITY)]),
        },
        quantity("half_angle", Dimension::Angle),
    ]
}

fn row() -> Vec<Value> {
    vec![
        Value::Integer(6),
        Value::Number(1.0),
        Value::Number(0.005),
        Value::Text("direct".to_owned()),
        Value::Bool(true),
        Value::Number(0.5),
        Value::Text("isothermal".to_owned()),
        Value::Null,
    ]
}

fn holds(text: &str) -> bool {
    match Expression::condition(text, &variables()) {
        Ok(expression) => expression.holds(&row()),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn conditions_are_evaluated() {
    for text in [
        "N == 6",
        "N = 6",
        "feasible",
        "not N < 6 and N <= 6",
        "1 + 2 * 3 == 7",
        "(1 + 2) * 3 == 9",
        "10 - 4 - 3 == 3",
        "12 / 2 / 3 == 2",
        "-2 * -3 == 6",
        "2 - -1 == 3",
        "N == 5 or N == 6 and feasible",
        "not (N == 5 or N == 7)",
        "not N == 5",
        "height == '1000 mm'",
        "N / 100 > 5%",
        "height / bottom_radius == 200 %",
        "'99 cm' < height",
        "height / bottom_radius == 2",
        "height * bottom_radius < '0.6 m2'",
        "height - 0.1 > '89 cm'",
        "gas.mass_flow_rate >= '5 g/s'",
        "strategy == \"direct\"",
        "strategy != 'delayed'",
        "(N > 5) == true",
        "heat_transfer == 'isothermal'",
        "heat_transfer > '0.3 W/(m2 K)'",
        "half_angle == null",
        "N != null",
        "half_angle > 0 or N == 6",
        "not (half_angle > 0 and N == 5)",
        "null == null",
    ] {
        assert!(holds(text), "{text}");
    }
    for text in [
        "N != 6",
        "half_angle > 0",
        "not half_angle > 0",
        "half_angle > 0 or N == 5",
        "half_angle + 1 == 1 + half_angle",
        "0 / 0 == 0 / 0",
    ] {
        assert!(!holds(text), "{text}");
    }
}

#[test]
fn carets_mark_the_faulty_part() {
    for (text, caret, problem) in [
        ("N == 6 and bogus > 2", "           ^^^^^", "no variable is called bogus"),
        ("strategy == 'delay'", "            ^^^^^^^", "did you mean 'delayed'?"),
        ("height > '5 kg'", "         ^^^^^^", "is a mass, not a length"),
        ("height + N > 1", "^^^^^^^^^^", "`+` between a length and a pure number"),
        ("height > gas.mass_flow_rate", "^^^^^^^^^^^^^^^^^^^^^^^^^^^", "a comparison between"),
        ("N == ", "     ^", "something is missing here"),
        ("(N == 6", "^", "`(` without its `)`"),
        ("N == 6)", "      ^", "`)` without its `(`"),
        ("1 < N < 7", "      ^", "comparisons do not chain"),
        ("N + 1", "^^^^^", "not a condition"),
        ("N and feasible", "^", "`and` needs a condition"),
        ("N == 6 && feasible", "       ^", "written `and`"),
        ("strategy > 'direct'", "^^^^^^^^^^^^^^^^^^^", "has no order"),
        ("N == 'six", "     ^^^^", "closing quote"),
        ("N == 1e999", "     ^^^^^", "not a number"),
        ("N 6", "  ^", "an operator is missing"),
        ("height > 5 mm and N == 6", "         ^^^^", "written in quotes"),
        ("gas.mass_flow_rate == 5g/s", "                      ^^^^", "written in quotes"),
        ("height > 5%", "         ^^", "is a pure number, not a length"),
        ("N == 5 % 2", "         ^", "an operator is missing"),
        ("N == \u{3b1} ", "     ^", "no variable is called α"),
        ("null > 3", "^^^^^^^^", "null has no order"),
    ] {
        let error = Expression::condition(text, &variables()).unwrap_err();
        let pointer = error.pointer("");
        let lines: Vec<&str> = pointer.lines().collect();
        assert_eq!(lines, [text, caret], "{text}: {error}");
        assert!(error.problem.contains(problem), "{text}: {error}");
        assert!(!error.allowed.is_empty());
    }
}

#[test]
fn excessive_depth_is_an_error() {
    for text in [
        "(".repeat(5_000),
        "-".repeat(5_000),
        "not ".repeat(2_000),
        format!("{}N == 1{}", "(".repeat(4_000), ")".repeat(4_000)),
        "N".repeat(20_000),
        "é".repeat(9_999),
    ] {
        assert!(Expression::condition(&text, &variables()).is_err());
    }
    assert!(holds(&vec!["N == 6"; 150].join(" or ")), "a long list of cases is not deep nesting");
    assert!(holds(&format!("{}1 > 1", "1 + ".repeat(2_000))));
}

proptest! {
    #[test]
    fn random_words_are_a_condition_or_an_error(words in prop::collection::vec(
        prop::sample::select(vec![
            "N", "height", "strategy", "feasible", "(", ")", "and", "or", "not", "==", "<", ">=",
            "+", "-", "*", "/", "6", "0.5", "'5 mm'", "'direct'", "null", "true", "half_angle",
        ]), 0..14)) {
        let text = words.join(" ");
        match Expression::condition(&text, &variables()) {
            Ok(expression) => {
                // The same text has the same truth. What holds without any value holds for every row,
                // unless it asks for a missing value.
                prop_assert_eq!(expression.holds(&row()), holds(&text));
                let always = expression.holds(&[]) && !text.contains("null");
                prop_assert!(!always || expression.holds(&row()), "{}", text);
            }
            Err(error) => prop_assert!(error.pointer("").contains('^')),
        }
    }

    /// Arithmetic gives the result of Rust.
    #[test]
    fn precedence_follows_arithmetic(a in 1_i32..9, b in 1_i32..9, c in 1_i32..9, d in 1_i32..9) {
        let value = f64::from(a) + f64::from(b) * f64::from(c) - f64::from(d) / f64::from(a);
        let text = format!("{a} + {b} * {c} - {d} / {a} == {value:?}");
        prop_assert_eq!(holds(&text), true, "{}", text);
        let either = a < b || b < c && c >= d;
        let text = format!("{a} < {b} or {b} < {c} and not {c} < {d}");
        prop_assert_eq!(holds(&text), either, "{}", text);
    }
}

#[test]
fn names_of_a_condition_are_found() {
    let condition = "film.loss_factor > 0.01 and (strategy=='late' or strategies.a.inflow[0].to<1)";
    let found = names(condition);
    for name in ["film.loss_factor", "strategy", "strategies.a.inflow[0].to"] {
        assert!(found.iter().any(|known| known == name), "{name}: {found:?}");
    }
    assert!(names("a 'b").is_empty());
}
