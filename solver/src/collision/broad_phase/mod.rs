//! What is near what, found without looking at everything again and again.
//!
//! The film is cut into patches of a few neighbouring elements, and they into a tree
//! ([`patches`]); boxes round them ([`boxes`]) say how far two patches are apart at least; a
//! [`lookout`] keeps every pair of patches waiting ([`bins`]) until their parts of the film
//! ([`zones`]), or what is round a node of theirs ([`stars`]), have moved so far that they could have met.

pub mod adjacent;
mod bisection;
pub mod clusters;
pub mod hierarchy;
pub mod kdop;
mod query;
pub mod queue;
pub mod scheduler;
