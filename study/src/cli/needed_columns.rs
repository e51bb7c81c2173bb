//! The columns that a command reads of a table of which it need not read the others: how runs ended, and measures with
//! what says their errors.

use crate::accuracy::{NO_ERROR_REASON, error_column};
use crate::job::row::{ColumnId, SAME_JOB_AS};
use crate::store::table::extrapolated;

/// How a run ended, and whether it can be trusted.
const JUDGING: [ColumnId; 5] = [
    ColumnId::Status,
    ColumnId::Verdict,
    ColumnId::Passages,
    ColumnId::Intersections,
    ColumnId::NumericallyDamped,
];

/// Whether every command reads the column with that name.
pub fn is_judging(name: &str) -> bool {
    JUDGING.iter().any(|column| column.name() == name)
        || [NO_ERROR_REASON, SAME_JOB_AS].contains(&name)
}

/// Measures by their names.
pub struct Measures(Vec<String>);

impl Measures {
    /// These columns, with their mesh errors and extrapolated values.
    pub fn new(names: &[String]) -> Self {
        let mut all = names.to_vec();
        for name in names {
            let errors = error_column(name).into_iter().map(str::to_owned);
            let further: Vec<String> = errors.chain(extrapolated::names(name)).collect();
            all.extend(further.iter().flat_map(|name| extrapolated::names(name)));
            all.extend(further);
        }
        Self(all)
    }

    /// Whether a column is one of them, or says an error of one.
    pub fn need(&self, name: &str) -> bool {
        self.0.iter().any(|known| known == name)
    }
}
