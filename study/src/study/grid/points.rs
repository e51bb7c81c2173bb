//! The single points of a grid, and its filter.

use super::axis::value;
use super::{Context, Grid};
use crate::input::expression;
use crate::input::json::Json;
use crate::input::keys;
use crate::input::object::{list, members};
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::study::column;
use crate::study::filter::Filter;

impl Grid {
    /// Reads the single points.
    pub(super) fn read_points(
        &mut self,
        json: &Json,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Context { settings, source, .. } = context;
        let allowed = "a list of objects, as in [{\"N\": 6, \"M\": 3}]";
        for (number, point) in list(json, "grid.points", source, allowed)?.iter().enumerate() {
            let path = format!("grid.points[{number}]");
            let mut values: Vec<(usize, Value)> = Vec::new();
            for (name, json) in members(point, &path, source, allowed)? {
                let path = format!("{path}.{name}");
                let found = column::find(name, &path, json, settings, source)?;
                let value = value(&found, json, &path, context)?;
                let known = self.columns.iter().position(|known| *known == found);
                let column = known.unwrap_or_else(|| {
                    self.columns.push(found);
                    self.columns.len() - 1
                });
                if self.is_replicate(column) {
                    let problem = "is a replicate, of which every point has all values";
                    return Err(source.error(&path, json, problem, "keys that are not replicates"));
                }
                if values.iter().any(|(other, _)| *other == column) {
                    let problem = "gives this key twice";
                    return Err(source.error(&path, json, problem, "each key once"));
                }
                values.push((column, value));
            }
            self.points.push(values);
        }
        Ok(())
    }

    /// Reads the condition that the points of the product must meet.
    pub(super) fn read_filter(
        &mut self,
        json: &Json,
        context: Context<'_>,
    ) -> Result<(), InputError> {
        let Context { settings, source, .. } = context;
        let Json::Text(text) = json else {
            let problem = format!("is {}, not a text", json.kind());
            let allowed = "a condition, as in \"N == 6 and feasible\"";
            return Err(source.error("grid.filter", json, problem, allowed));
        };
        let filter = Filter::read(text, &self.columns, settings);
        let filter = filter.map_err(|error| {
            // The problem shows the expression, so the value does not repeat it.
            let problem = error.to_string();
            source.error("grid.filter", "", problem, error.allowed)
        })?;
        if let Some(replicate) = self.replicate_in(text).filter(|_| self.search.is_some()) {
            let problem =
                format!("names {replicate}, a replicate, of which a search needs all values");
            let allowed = "a condition on the other keys";
            return Err(source.error("grid.filter", json, problem, allowed));
        }
        self.filter = Some(filter);
        Ok(())
    }

    /// The first replicate that a condition names.
    fn replicate_in(&self, condition: &str) -> Option<String> {
        expression::names(condition).into_iter().find(|name| {
            let replicate = |column: &usize| keys::find(name) == Some(self.columns[*column].index);
            self.replicates().any(|axis| axis.columns.iter().any(replicate))
        })
    }
}
