//! The measures whose mesh error is promised, and the columns that hold it.

use crate::job::row::ColumnId;

/// A measure with a known mesh error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Promised {
    /// The measure.
    pub measure: ColumnId,
    /// Name of the column of its error.
    pub error_column: &'static str,
    /// Whether the measure tends to a limit as the mesh is refined. The error of one that does not is its change
    /// up to the finest mesh of the table.
    pub has_limit: bool,
}

const fn limit(measure: ColumnId, error_column: &'static str) -> Promised {
    Promised { measure, error_column, has_limit: true }
}

const fn change(measure: ColumnId, error_column: &'static str) -> Promised {
    Promised { measure, error_column, has_limit: false }
}

/// The promised measures, in the order of their columns. A test compares them with the table of mesh errors.
pub const PROMISED: [Promised; 6] = [
    change(ColumnId::T50ZRim, "t_50_z_rim_change_to_n24"),
    limit(ColumnId::T90ZRim, "t_90_z_rim_error"),
    change(ColumnId::PeakVz, "peak_vz_change_to_n24"),
    limit(ColumnId::PeakKineticEnergy, "peak_kinetic_energy_error"),
    limit(ColumnId::FinalZRim, "final_z_rim_error"),
    limit(ColumnId::FinalVolume, "final_volume_error"),
];

/// Name of the column that says why a row has no mesh errors.
pub const NO_ERROR_REASON: &str = "no_error_reason";
/// Meaning of that column, one line.
pub const NO_ERROR_REASON_MEANING: &str = "why the table of mesh errors has none for this row: what its scene has that the runs of the table have not, or a model other than film; values extrapolated from three meshes have an error all the same";

impl Promised {
    /// Whether an accuracy that is asked for holds for it: `peak_vz` scatters by more from seed to seed.
    pub fn is_asked(&self) -> bool {
        self.measure != ColumnId::PeakVz
    }

    /// Whether it is the state at the end of a run: it has a mesh error only where the capsule is deployed.
    pub fn is_at_end(&self) -> bool {
        matches!(self.measure, ColumnId::FinalZRim | ColumnId::FinalVolume)
    }

    /// Its meaning, one line.
    pub fn meaning(&self) -> String {
        let measure = self.measure.name();
        if self.has_limit {
            format!(
                "mesh error of {measure}: 9 of 10 runs are nearer to the limit of fine meshes; null where it is not known \
                 (no_error_reason)"
            )
        } else {
            format!(
                "change of {measure} up to n 24: 9 of 10 runs change less; no limit of fine meshes is known, and null \
                 where the change is not (no_error_reason)"
            )
        }
    }
}

/// The promise for a measure, also for a time since the release; `None` for a measure without one.
pub fn promise(measure: &str) -> Option<&'static Promised> {
    let measure = match ColumnId::from_name(measure)? {
        ColumnId::T50ZRimSinceRelease => ColumnId::T50ZRim,
        ColumnId::T90ZRimSinceRelease => ColumnId::T90ZRim,
        measure => measure,
    };
    PROMISED.iter().find(|promised| promised.measure == measure)
}

/// Name of the column with the mesh error of a measure.
pub fn error_column(measure: &str) -> Option<&'static str> {
    promise(measure).map(|promised| promised.error_column)
}

/// Whether a column holds mesh errors.
pub fn is_error_column(name: &str) -> bool {
    PROMISED.iter().any(|promised| promised.error_column == name)
}
