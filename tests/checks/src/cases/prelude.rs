//! What most cases use: scenes of film, their shapes, the rig, reference numbers and rows.

pub use core::f64::consts::{PI, TAU};

pub use billow_solver::geometry::shapes::{
    icosphere, joined, moved, pseudo_random, ring_nodes, sheet,
};
pub use billow_solver::geometry::shell::Shell;
pub use billow_solver::integrators::{FilmSimulation, FilmView};
pub use billow_solver::mechanics::resultants::resultants;
pub use billow_solver::models::film::{FilmRun, capsule};
pub use billow_solver::models::run::Unobserved;
pub use billow_solver::scene::film_scene::{Filling, FilmContact, FilmScene};
pub use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
pub use billow_solver::scene::motion::{Motion, Profile, Rotation};
pub use billow_solver::scene::paper::{self, free_film, nitrogen_supply, window};
pub use billow_solver::scene::timeline::{Phase, Timeline};
pub use billow_solver::scene::{
    Film, GasSupply, HeatTransfer, IntegratorKind, ModelKind, Scene, Stepping,
};
pub use nalgebra::Vector3;

pub use super::contact_rig::{monitored_contact, plate, run_recorded};
pub use super::reference::{entry, number, numbers, rows};
pub use super::rig::{
    Rig, advance, compliant, equilibrium, held, inflated, mean, nitrogen_filling, on_plane,
};
pub use super::row::{Row, each, refined, worse};
pub use super::{Outcome, Result};
