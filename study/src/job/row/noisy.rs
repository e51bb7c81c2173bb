//! Measures that small causes change much, and the measures that headlines use.
//!
//! A measure is noisy if the seed, the time step, the numerical damping or the contact distance changes it
//! by more than 3 % on the capsule of the paper (docs/experiments.md). Compare noisy measures over several
//! seeds. `billow compare` and the answer of a study use none by default, nor does the table, except `peak_vz`
//! where strategies are compared.

use super::ColumnId;

/// The measures that sum up a study: speed of the deployment, impact.
pub const HEADLINE: [ColumnId; 2] = [ColumnId::T90ZRimSinceRelease, ColumnId::PeakKineticEnergy];

/// Noisy measures.
pub const NOISY: [ColumnId; 16] = [
    ColumnId::PeakAcceleration,
    ColumnId::PeakFilmSpeed,
    ColumnId::PeakBaseForce,
    ColumnId::PeakVz,
    ColumnId::PeakDownwardVz,
    ColumnId::TPeakVz,
    ColumnId::FirstMinimumZRim,
    ColumnId::LowestZRim,
    ColumnId::RingingRms,
    ColumnId::RingingFrequency,
    ColumnId::TSettled,
    ColumnId::FilmStress,
    ColumnId::PeakLidForce,
    ColumnId::InterlayerPressure,
    ColumnId::ContactAreaFraction,
    ColumnId::SmallestGap,
];

impl ColumnId {
    /// Whether the column is a noisy measure.
    pub fn is_noisy(self) -> bool {
        NOISY.contains(&self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_headline_is_noisy() {
        assert!(HEADLINE.iter().all(|measure| !measure.is_noisy()));
    }
}
