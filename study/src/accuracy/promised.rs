//! The measures whose mesh error is promised, and the columns that hold it.

use super::MeshErrors;
use crate::job::row::ColumnId;

/// A measure with a known error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Promised {
    /// The measure.
    pub measure: ColumnId,
    /// Names of the columns of its mesh error, below and above the value.
    pub error_columns: [&'static str; 2],
    /// Names of the columns of its change over the ranges of the assumed values, below and above the value.
    pub assumed_columns: [&'static str; 2],
    /// Whether an accuracy that is asked for holds for it: the others scatter by more from seed to seed.
    pub is_asked: bool,
}

/// A promised measure: column, name, whether it is asked.
macro_rules! promised {
    ($id:ident, $name:literal, $is_asked:literal) => {
        Promised {
            measure: ColumnId::$id,
            error_columns: [concat!($name, "_error_below"), concat!($name, "_error_above")],
            assumed_columns: [concat!($name, "_assumed_below"), concat!($name, "_assumed_above")],
            is_asked: $is_asked,
        }
    };
}

/// The promised measures, in the order of their columns.
pub const PROMISED: [Promised; 15] = [
    promised!(T50ZRim, "t_50_z_rim", true),
    promised!(T90ZRim, "t_90_z_rim", true),
    promised!(TDeployed, "t_deployed", false),
    promised!(PeakSpeed, "peak_speed", false),
    promised!(PeakAcceleration, "peak_acceleration", false),
    promised!(PeakFilmSpeed, "peak_film_speed", false),
    promised!(PeakBaseForce, "peak_base_force", false),
    promised!(PeakVz, "peak_vz", false),
    promised!(PeakDownwardVz, "peak_downward_vz", false),
    promised!(PeakKineticEnergy, "peak_kinetic_energy", true),
    promised!(LargestZRim, "largest_z_rim", false),
    promised!(FinalZRim, "final_z_rim", true),
    promised!(FinalVolume, "final_volume", true),
    promised!(PeakPressure, "peak_pressure", false),
    promised!(FilmStress99, "film_stress_99", false),
];

/// Name of the column that says why a row has no mesh errors.
pub const NO_ERROR_REASON: &str = "no_error_reason";
/// Meaning of that column, one line.
pub const NO_ERROR_REASON_MEANING: &str = "why the table of mesh errors has none for this row: what its scene has that \
     the runs of the table have not, or a model other than film; values extrapolated from three meshes have an error all \
     the same, and rows with the largest error of the pilots say so";

impl Promised {
    /// Whether it is the state at the end of a run: it has a mesh error only where the capsule is deployed.
    pub fn is_at_end(&self) -> bool {
        matches!(self.measure, ColumnId::FinalZRim | ColumnId::FinalVolume)
    }

    /// Names and meanings of the columns of its mesh error and of its change with the assumed values.
    pub fn columns(&self) -> [(&'static str, String); 4] {
        let measure = self.measure.name();
        let finest = MeshErrors::shipped().finest;
        let error = |side: &str| {
            format!(
                "mesh error of {measure}: how far {side} it the value on n {finest} may be, kept by 19 of 20 runs; null where it is not known (no_error_reason)"
            )
        };
        let assumed = |side: &str| {
            format!(
                "how far {side} it {measure} may be over the ranges of what is assumed (key assumed), film.loss_factor and gas.heat_transfer, in 19 of 20 runs; null where it is not known"
            )
        };
        let ([below, above], [less, more]) = (self.error_columns, self.assumed_columns);
        [
            (below, error("below")),
            (above, error("above")),
            (less, assumed("below")),
            (more, assumed("above")),
        ]
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

/// Names of the columns with the mesh error of a measure, below and above its value.
pub fn error_columns(measure: &str) -> Option<[&'static str; 2]> {
    promise(measure).map(|promised| promised.error_columns)
}

/// Whether a column holds mesh errors, or changes with the assumed values.
pub fn is_error_column(name: &str) -> bool {
    let is = |promised: &Promised| {
        promised.error_columns.contains(&name) || promised.assumed_columns.contains(&name)
    };
    PROMISED.iter().any(is)
}
