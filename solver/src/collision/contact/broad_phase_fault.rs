//! Faults in the search for pairs in contact, for tests only: contact does not see some film, and a test
//! asks whether the tunnelling monitor notices what passes through.
//!
//! Without a fault no bit of a run changes.

use super::model::ContactModel;

/// How contact is blinded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BroadPhaseFault {
    /// The film of one motion cluster has no pairs, except of elements that share a node. The number is
    /// taken modulo the number of clusters.
    SkippedCluster(usize),
    /// Factor on all bounds of how far a pair is from contact. Above 1 a pair counts as farther away than it is.
    ScaledBounds(f64),
    /// Pairs that are pending at this path length (m) never come due.
    StoppedQueues(f64),
    /// Edges have no contact with edges.
    NoEdgeContacts,
}

impl ContactModel {
    /// Factor on all bounds of how far a pair is from contact: 1 without a fault.
    pub fn bound_factor(&self) -> f64 {
        match self.broad_phase_fault {
            Some(BroadPhaseFault::ScaledBounds(factor)) => factor,
            _ => 1.0,
        }
    }

    /// Whether edges can be in contact with edges.
    pub(super) fn has_edge_contacts(&self) -> bool {
        self.broad_phase_fault != Some(BroadPhaseFault::NoEdgeContacts)
    }

    /// Whether pending pairs never come due at this path length (m).
    pub(super) fn queues_stopped(&self, path_length: f64) -> bool {
        match self.broad_phase_fault {
            Some(BroadPhaseFault::StoppedQueues(length)) => path_length > length,
            _ => false,
        }
    }
}
