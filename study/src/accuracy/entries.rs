//! The entries of the table of mesh errors, found by measure, model and meshes without looking at all of them.

use std::cmp::Ordering;

use billow_solver::scene::ModelKind;
use serde::{Deserialize, Serialize};

use super::entry::{Entry, Method};

/// The entries, as they stand in the file, and their order. Only the entries are written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<Entry>", into = "Vec<Entry>")]
pub struct Entries {
    entries: Vec<Entry>,
    /// Positions of the entries in ascending order of measure, model, number of meshes, meshes.
    order: Vec<usize>,
}

impl From<Vec<Entry>> for Entries {
    fn from(entries: Vec<Entry>) -> Self {
        let mut order: Vec<usize> = (0..entries.len()).collect();
        order.sort_by(|a, b| {
            let b = &entries[*b];
            compare(&entries[*a], &b.measure, b.model, &b.meshes)
        });
        Self { entries, order }
    }
}

impl From<Entries> for Vec<Entry> {
    fn from(entries: Entries) -> Self {
        entries.entries
    }
}

impl Entries {
    /// The entries, as they stand in the file.
    pub fn all(&self) -> &[Entry] {
        &self.entries
    }

    /// The entry of a measure by a method.
    pub fn find(&self, measure: &str, method: &Method) -> Option<&Entry> {
        let is = |position: &usize| {
            compare(&self.entries[*position], measure, method.model, &method.meshes)
        };
        self.order.binary_search_by(is).ok().map(|found| &self.entries[self.order[found]])
    }

    /// The entries of a measure by a model on one mesh, coarsest first.
    pub fn single_meshes(&self, measure: &str, model: ModelKind) -> impl Iterator<Item = &Entry> {
        let first = self.order.partition_point(|position| {
            compare(&self.entries[*position], measure, model, &[0]).is_lt()
        });
        let ordered = self.order[first..].iter().map(|position| &self.entries[*position]);
        ordered.take_while(move |entry| {
            entry.meshes.len() == 1 && entry.model == model && entry.measure == measure
        })
    }
}

fn compare(entry: &Entry, measure: &str, model: ModelKind, meshes: &[u32]) -> Ordering {
    let by_measure = entry.measure.as_str().cmp(measure);
    let by_model = || (entry.model as u8).cmp(&(model as u8));
    let by_count = || entry.meshes.len().cmp(&meshes.len());
    let by_meshes = || entry.meshes.as_slice().cmp(meshes);
    by_measure.then_with(by_model).then_with(by_count).then_with(by_meshes)
}
