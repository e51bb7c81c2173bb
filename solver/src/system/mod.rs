//! Film as a system: what is constant, what changes, and the forces and energies of any state.
//!
//! ```text
//! conservative part    (system, state, positions)        → energies Π, forces −∂Π/∂x, on request ∂²Π/∂x²
//! dissipative part     (system, state, velocities, step) → forces f, power f·v ≤ 0
//! ```
//!
//! A [`FilmSystem`] never changes; who needs another one builds it. A [`FilmState`] holds all fields at one
//! time and nothing that only one method needs. Evaluation changes neither: it writes to a [`Workspace`] of
//! the caller. What the film would remember of a trial (contacts) is in the workspace too, until
//! [`Workspace::commit`] makes it the state.
//!
//! The integrators are above this room, and know each other only through these types.

mod evaluation;
mod film_state;
mod film_system;
mod stiffness;

mod workspace;

pub use evaluation::Evaluation;
pub use film_state::FilmState;
pub(crate) use film_state::bind;
pub use film_system::{FilmSystem, PressureLoad};
pub use stiffness::{GasStiffness, TermStiffness};

pub use workspace::{ContactWorkspace, Workspace};
