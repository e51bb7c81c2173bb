//! Columns of the table that follow from the rows of a study, not from one job.

use super::columns::CellType;

/// A column that follows from others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DerivedColumn {
    /// Whether every limit is met for certain.
    Safety,
    /// The smallest margin.
    SmallestMargin,
    /// The measure that has it.
    SmallestMarginOf,
    /// Numerical choices that change the verdict.
    VerdictDependsOn,
}

impl DerivedColumn {
    /// Its entry in [`DERIVED_COLUMNS`].
    pub const fn row(self) -> &'static DerivedRow {
        &DERIVED_COLUMNS[self as usize]
    }

    /// Name in the table.
    pub const fn name(self) -> &'static str {
        self.row().name
    }
}

/// Name, type, unit and meaning of such a column.
#[derive(Debug, Clone, Copy)]
pub struct DerivedRow {
    /// Identifier in the code.
    pub id: DerivedColumn,
    /// Name in the table.
    pub name: &'static str,
    /// Type of its cells.
    pub cell_type: CellType,
    /// SI unit.
    pub unit: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
}

/// Every derived column with a fixed name, in the order of [`DerivedColumn`]. A limit of the study also has `margin_<measure>`.
pub static DERIVED_COLUMNS: [DerivedRow; 4] = [
    DerivedRow {
        id: DerivedColumn::Safety,
        name: "safety",
        cell_type: CellType::Text,
        unit: "",
        meaning: "safe: every limit is met, by more than the uncertainty of its measure; unsafe: one is missed by more, or missed \
                  with an uncertainty that is not known; uncertain: neither can be said. Null where a measure has no value, or \
                  without limits",
    },
    DerivedRow {
        id: DerivedColumn::SmallestMargin,
        name: "smallest_margin",
        cell_type: CellType::Number,
        unit: "1",
        meaning: "smallest margin of the limits of the study: distance from the limit over the limit, negative \
                  beyond it; 1 or -1 for a verdict",
    },
    DerivedRow {
        id: DerivedColumn::SmallestMarginOf,
        name: "smallest_margin_of",
        cell_type: CellType::Text,
        unit: "",
        meaning: "the measure with the smallest margin",
    },
    DerivedRow {
        id: DerivedColumn::VerdictDependsOn,
        name: "verdict_depends_on",
        cell_type: CellType::Text,
        unit: "",
        meaning: "numerical choices (seed, mesh, CFL number, …) that change the verdict, all else being equal",
    },
];
