//! The measures that film without rings has in place of those of a top ring.

use super::ColumnId;

/// A measure of a top ring, and that of film without rings.
const IN_PLACE: [(ColumnId, ColumnId); 7] = [
    (ColumnId::T90ZRim, ColumnId::T90Volume),
    (ColumnId::T90ZRimSinceRelease, ColumnId::T90VolumeSinceRelease),
    (ColumnId::T50ZRim, ColumnId::T50Volume),
    (ColumnId::PeakVz, ColumnId::PeakFilmSpeed),
    (ColumnId::PeakSpeed, ColumnId::PeakFilmSpeed),
    (ColumnId::FinalZRim, ColumnId::FinalHeight),
    (ColumnId::LargestZRim, ColumnId::LargestHeight),
];

impl ColumnId {
    /// The measure that film without rings has in place of this one; itself where it has this one.
    #[must_use]
    pub fn without_rings(self) -> Self {
        let found = IN_PLACE.iter().find(|(of_ring, _)| *of_ring == self);
        found.map_or(self, |(_, other)| *other)
    }
}
