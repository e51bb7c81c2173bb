//! The largest error of a configuration over the numbers of its scene.

use super::{Diagram, Errors, Point, Quantity, Reference};
use crate::analysis::statistics::Spread;

impl Diagram {
    /// The largest error over the numbers, by configuration; courses have no part. A configuration without one of
    /// them has no point. The uncertainty is the largest of theirs.
    pub fn largest(&self) -> Errors {
        let numbers: Vec<&Errors> = self
            .quantities
            .iter()
            .filter(|errors| !errors.quantity.is_course && errors.reference.is_some())
            .collect();
        let point = |index: usize| -> Option<Point> {
            let points: Option<Vec<&Point>> =
                numbers.iter().map(|errors| errors.points[index].as_ref()).collect();
            let points = points.filter(|points| !points.is_empty())?;
            let largest = |of: fn(&Spread) -> f64| {
                points.iter().map(|point| of(&point.error)).fold(0.0, f64::max)
            };
            let error = Spread {
                count: self.members[index].runs,
                least: largest(|error| error.least),
                median: largest(|error| error.median),
                largest: largest(|error| error.largest),
            };
            let is_reference = points.iter().any(|point| point.is_reference);
            Some(Point { value: None, error, order: None, is_reference, front: [false; 2] })
        };
        let uncertainty = numbers.iter().map(|errors| errors.uncertainty()).fold(0.0, f64::max);
        let member = numbers.iter().find_map(|errors| errors.reference.as_ref()?.member);
        let mut errors = Errors {
            quantity: Quantity {
                name: "largest".to_owned(),
                unit: "1".to_owned(),
                meaning: "largest error of the numbers of the scene".to_owned(),
                exact: None,
                is_course: false,
            },
            reference: (!numbers.is_empty()).then_some(Reference {
                value: None,
                member,
                uncertainty: Some(uncertainty),
            }),
            points: (0..self.members.len()).map(point).collect(),
            orders: Vec::new(),
        };
        errors.finish(&self.members, &self.chains);
        errors
    }
}
