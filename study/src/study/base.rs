//! The study without its grid: the value of every key, strategies, supports.

use std::collections::BTreeMap;

use serde_json::{Map, json};

use super::strategy::{Strategy, read_strategy};
use crate::input::json::Json;
use crate::input::keys::{self, KEYS, STUDY, position};
use crate::input::settings::{Settings, check_version, object};
use crate::input::source::Source;
use crate::input::supports;
use crate::input::value::{Value, json_value};
use crate::platform::error::InputError;
use billow_solver::scene::Support;

/// What every point starts from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    pub settings: Settings,
    pub strategies: BTreeMap<String, Strategy>,
    pub supports: Vec<Support>,
}

impl Base {
    pub fn read(tree: &Json, source: &Source) -> Result<Self, InputError> {
        let settings = Settings::new(&STUDY);
        let mut base = Self { settings, strategies: BTreeMap::new(), supports: Vec::new() };
        check_version(tree, source)?;
        base.settings.read("", tree, source)?;
        base.check_stepping(tree, source)?;
        base.supports = supports::read(tree.get("supports"), source)?;
        base.strategies.insert("direct".to_owned(), Strategy::direct());
        if let Some(json) = tree.get("strategies") {
            for (name, value) in object(json, &STUDY, "strategies", source)? {
                let strategy = read_strategy(name, value, source)?;
                base.strategies.insert(name.clone(), strategy);
            }
        }
        base.check_strategy(base.strategy_name(), "strategy", source)?;
        Ok(base)
    }

    /// Refuses a step that is both adaptive and fixed; a fixed one replaces the default tolerance.
    fn check_stepping(&mut self, tree: &Json, source: &Source) -> Result<(), InputError> {
        let stepping = tree.get("solver").and_then(|solver| solver.get("stepping"));
        if let Some(stepping) = stepping {
            let given = |key: &str| stepping.get(key).is_some();
            if given("adaptive") && given("fixed") {
                return Err(source.error(
                    "solver.stepping",
                    &stepping.brief(),
                    "gives both adaptive and fixed",
                    "one of {\"adaptive\": 1e-6}, {\"fixed\": \"10 us\"}",
                ));
            }
            if given("fixed") {
                let index = const { position(KEYS, "solver.stepping.fixed") };
                let fixed = self.settings.at(index).clone();
                self.settings.set(index, fixed);
            }
        }
        Ok(())
    }

    /// Name of the strategy.
    pub fn strategy_name(&self) -> &str {
        self.settings.text("strategy").unwrap_or_default()
    }

    /// Refuses a strategy that the study does not have.
    pub fn check_strategy(&self, name: &str, key: &str, source: &Source) -> Result<(), InputError> {
        if self.strategies.contains_key(name) {
            return Ok(());
        }
        let near = keys::nearest(name, self.strategies.keys().map(String::as_str));
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near:?}?"));
        let known: Vec<&str> = self.strategies.keys().map(String::as_str).collect();
        let mut error = source.error(
            key,
            &Json::Text(name.to_owned()).brief(),
            format!("is not a strategy of this study{near}"),
            known.join(", "),
        );
        "name one of these, or define it under strategies".clone_into(&mut error.hint);
        Err(error)
    }

    /// Settings, strategies and supports, with every value they have.
    pub fn to_json(&self) -> serde_json::Value {
        let mut json = json!({});
        for (key, value) in KEYS.iter().zip(self.settings.values()) {
            if *value == Value::Null {
                continue;
            }
            let member = key.path.split('.').fold(&mut json, |object, part| &mut object[part]);
            *member = json_value(value);
        }
        let strategies = self.strategies.iter();
        let strategies = strategies.map(|(name, strategy)| (name.clone(), strategy.to_json()));
        json["strategies"] = strategies.collect::<Map<_, _>>().into();
        let supports = self
            .supports
            .iter()
            .map(|support| json!({"on": supports::place_name(support.on), "fix": support.fix}));
        json["supports"] = supports.collect::<Vec<_>>().into();
        json
    }
}
