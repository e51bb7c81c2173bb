//! Faults in the search for pairs in contact, for tests only: contact does not see some film, and a test
//! asks whether the tunnelling monitor notices what passes through.
//!
//! Without a fault no bit of a run changes.

use super::pair::Pair;

/// How contact is blinded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BroadPhaseFault {
    /// One of 32 parts of the film, subtrees of the hierarchy of elements, has no pairs, except of elements that share
    /// a node.
    SkippedPart(usize),
    /// Factor on all bounds of how far a pair is from contact. Above 1 a pair counts as farther away than it is.
    ScaledBounds(f64),
    /// Pairs that are pending at this path length (m) never come due.
    StoppedQueues(f64),
    /// This pair is never a candidate.
    LostPair(Pair),
    /// Edges have no contact with edges.
    NoEdgeContacts,
}
