//! The measures that film without rings has in place of those of a top ring.

use super::ColumnId;

/// A measure of a top ring, and that of film without rings.
const IN_PLACE: [(ColumnId, ColumnId); 7] = [
    // Of the times of a volume this one has a mesh error.
    (ColumnId::T90ZRim, ColumnId::TDeployed),
    (ColumnId::T90ZRimSinceRelease, ColumnId::TDeployed),
    (ColumnId::T50ZRim, ColumnId::T50Volume),
    (ColumnId::PeakVz, ColumnId::PeakFilmSpeed),
    (ColumnId::PeakSpeed, ColumnId::PeakFilmSpeed),
    (ColumnId::FinalZRim, ColumnId::FinalHeight),
    (ColumnId::LargestZRim, ColumnId::LargestHeight),
];

/// Further measures of a top ring.
const OF_RING: [ColumnId; 9] = [
    ColumnId::PeakDownwardVz,
    ColumnId::TPeakVz,
    ColumnId::PeakAcceleration,
    ColumnId::FirstPeakZRim,
    ColumnId::FirstMinimumZRim,
    ColumnId::LowestZRim,
    ColumnId::RingingRms,
    ColumnId::RingingFrequency,
    ColumnId::T50ZRimSinceRelease,
];

impl ColumnId {
    /// Whether film without rings has no such measure.
    pub fn needs_rings(self) -> bool {
        OF_RING.contains(&self) || self.without_rings() != self
    }

    /// The measure that film without rings has in place of this one; itself where it has this one.
    #[must_use]
    pub fn without_rings(self) -> Self {
        let found = IN_PLACE.iter().find(|(of_ring, _)| *of_ring == self);
        found.map_or(self, |(_, other)| *other)
    }
}
