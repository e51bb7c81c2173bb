//! Contact of film with film and with plates: energies, forces, stiffness, and steps without a passage.
//!
//! ```text
//! pair energy  k (o − d)³/(6 o)  while d < o     force k (o − d)²/(2 o) along the line between closest points
//! k = κ ω² m                                      ω: highest natural frequency of the film; m: mass of the pair
//! ```
//!
//! Symbols: d distance (gap) of a node from a feature of the film (element, edge, node), or of two
//! edges, m; o offset of the pair, m. The offset is the contact distance. A pair that was closer at
//! the start, or that became a contact by sliding sideways, has its gap at that time as offset, so
//! that becoming a contact creates no energy. The force starts with zero slope at d = o, so a contact
//! that begins within a step costs little accuracy. The stiffness grows to k at d = 0.
//!
//! - **Candidates.** A pair is in the [`candidates`] list only if it may come within the contact
//!   distance soon; otherwise it is pending, in a queue or
//!   in the broad phase ([`crate::collision::broad_phase`]).
//! - **Contacts.** A node is in contact with a feature that is a nearest feature of its
//!   neighbourhood: an edge or a node counts only if all elements that contain it agree, and it counts
//!   once ([`contacts`]). A contact that slides to a neighbouring feature keeps penetration and
//!   stiffness. Two edges are in contact if their closest points lie inside both, at half the contact
//!   distance.
//! - **Adhesion** pulls over a range beyond the offset ([`force_law`]).
//! - **Safe step.** The straight motion of each candidate is tested by continuous collision detection
//!   ([`ccd`], [`safe_step`]): a step is safe while no pair loses more than nine tenths of its distance.
//!   How an integrator keeps its steps safe is its choice; explicit central differences give colliding
//!   pairs impulses ([`crate::integrators::explicit`]).

pub mod broad_phase_fault;
pub mod candidates;
pub mod ccd;
pub mod contacts;
pub mod distance;
pub mod distance_batch;
pub mod force_law;
pub mod model;
pub mod pair;
pub mod plates;
pub mod pressure;
pub mod safe_step;
pub mod state;
pub mod stiffness;

pub use broad_phase_fault::BroadPhaseFault;
pub use candidates::SearchProgress;
pub use force_law::Contact;
pub use model::{Adhesion, ContactModel, DISTANCE_PER_GAP, default_distance};
pub use pair::{Pair, PairKind};
pub use state::{ContactState, PlateState};
